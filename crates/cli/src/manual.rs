//! The manual page of a program, and the completions of its options for shells, by what it knows of its own options.
//!
//! `make install` asks a program for them by the environment variable `PCSSS_PRINT`, which is no matter of users: it is
//! `man`, `bash`, `fish` or `zsh`, and the text goes to stdout.

use crate::{Failure, print};
use clap::{Command, Parser};
use clap_complete::{Shell, generate};
use clap_mangen::Man;
use std::io;

/// The variable that asks for a text instead of work.
const VARIABLE: &str = "PCSSS_PRINT";

/// What a manual page says of the exit status, as roff.
const EXIT_STATUS: &str = ".SH \"EXIT STATUS\"
.TP
0
Success.
.TP
1
Of compare: the images differ beyond a gate.
.TP
2
Bad input or usage, with one message.
.TP
3
A number that is not finite would have been written.
.TP
128 + N
Ended by signal N.
";

const SEE_ALSO: &str = ".SH \"SEE ALSO\"
.BR sample-surface (1),
.BR calibrate (1),
.BR gather (1),
.BR compare (1)
";

/// The arguments of the process. If a text about them is asked for, prints that and ends the process.
pub fn parse<P: Parser>() -> P {
    let Some(wanted) = std::env::var_os(VARIABLE) else {
        return P::parse();
    };
    let printed = text(P::command(), &wanted.to_string_lossy()).and_then(|text| print(&text));
    let code = printed.map_or_else(
        |failure| {
            crate::terminal::tell(failure.message);
            i32::from(failure.code)
        },
        |()| 0,
    );
    std::process::exit(code)
}

/// The manual page of a command, or its completions for a shell.
fn text(mut command: Command, wanted: &str) -> Result<String, Failure> {
    let name = command.get_name().to_owned();
    let mut bytes = Vec::new();
    match wanted {
        "man" => page(command, &mut bytes)?,
        "bash" => generate(Shell::Bash, &mut command, name, &mut bytes),
        "fish" => generate(Shell::Fish, &mut command, name, &mut bytes),
        "zsh" => generate(Shell::Zsh, &mut command, name, &mut bytes),
        _ => return Err(Failure::usage(format!("{VARIABLE}={wanted}: it is one of man, bash, fish, zsh"))),
    }
    Ok(String::from_utf8(bytes)?)
}

fn page(command: Command, bytes: &mut Vec<u8>) -> io::Result<()> {
    let page = Man::new(command);
    page.render_title(bytes)?;
    page.render_name_section(bytes)?;
    page.render_synopsis_section(bytes)?;
    page.render_description_section(bytes)?;
    page.render_options_section(bytes)?;
    bytes.extend_from_slice(EXIT_STATUS.as_bytes());
    bytes.extend_from_slice(SEE_ALSO.as_bytes());
    page.render_version_section(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    /// Turns a page.
    #[derive(Parser)]
    #[command(name = "turn", version)]
    struct Arguments {
        /// Degrees to turn by
        #[arg(long, value_name = "DEGREES")]
        _by: f64,
    }

    #[test]
    fn each_text_has_the_options() {
        for (wanted, words) in [
            ("man", [".TH turn 1", "\\-\\-by", "Degrees to turn by", "EXIT STATUS"]),
            ("bash", ["_turn()", "--by", "complete -F _turn", "turn"]),
            ("fish", ["complete -c turn", "-l by", "Degrees to turn by", "turn"]),
            ("zsh", ["#compdef turn", "--by=", "Degrees to turn by", "_turn"]),
        ] {
            let text = text(Arguments::command(), wanted).expect("is known");
            assert!(words.iter().all(|word| text.contains(word)), "{wanted}: {text}");
        }
        assert!(text(Arguments::command(), "csh").is_err());
    }
}

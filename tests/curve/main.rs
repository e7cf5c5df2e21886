//! `curve --meshes FOLDER --programs FOLDER --output FOLDER [--full]`: time against error of the two programs, as
//! `speed.md`, its plots and `speed.csv`. Minutes; with `--full` an hour or so. With `--scale` what sizes cost instead, as
//! `scale.md`: minutes.
//!
//! FOLDER of `--meshes` should hold `bunny.glb` and `dragon.glb`, and `../peers` beside it the scenes that other
//! renderers were measured on. `--tiny` tries the program itself: half a minute, and figures that mean nothing.

mod accuracy;
mod behaviour;
mod bench;
mod clouds;
mod configuration;
mod document;
mod effort;
mod error;
mod estimate;
mod everywhere;
mod findings;
mod forecast;
mod frame;
mod growth;
mod linear;
mod measure;
mod model;
mod peers;
mod picture;
mod plot;
mod program;
mod race;
mod record;
mod reference;
mod scale;
mod scaling;

use bench::Bench;
use configuration::{MARBLE, MEDIA, SKIM_MILK, Subjects};
use effort::Effort;
use error::Error;
use findings::Findings;
use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

fn main() -> ExitCode {
    match Arguments::parse(std::env::args().skip(1)).and_then(|arguments| run(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("curve: {error}");
            ExitCode::from(2)
        }
    }
}

const USAGE: &str = "usage: curve --meshes FOLDER --programs FOLDER --output FOLDER [--full | --tiny | --scale]";

struct Arguments {
    meshes: PathBuf,
    programs: PathBuf,
    output: PathBuf,
    effort: Effort,
    scale: bool,
}

impl Arguments {
    fn parse(mut words: impl Iterator<Item = String>) -> Result<Arguments, Error> {
        let usage = || Error::Usage(USAGE.into());
        let (mut meshes, mut programs, mut output, mut effort, mut scale) = (None, None, None, Effort::Quick, false);
        while let Some(word) = words.next() {
            match word.as_str() {
                "--full" => effort = Effort::Full,
                "--tiny" => effort = Effort::Tiny,
                "--scale" => scale = true,
                "--meshes" => meshes = words.next(),
                "--programs" => programs = words.next(),
                "--output" => output = words.next(),
                _ => return Err(usage()),
            }
        }
        let [meshes, programs, output] = [meshes, programs, output].map(|path| path.map(PathBuf::from));
        match (meshes, programs, output) {
            (Some(meshes), Some(programs), Some(output)) => Ok(Arguments { meshes, programs, output, effort, scale }),
            _ => Err(usage()),
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Error> {
    let gallery = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    let write = |name: &str, text: String| {
        let path = arguments.output.join(name);
        fs::write(&path, text).map_err(Error::file(&path))
    };
    if arguments.scale {
        return write("scale.md", scale::scale(&arguments.programs, &gallery)?);
    }
    let subjects = Subjects::find(&arguments.meshes, &gallery);
    let mut bench = Bench::new(&arguments.programs, arguments.effort, &subjects.main[0])?;
    let findings = measure_all(&mut bench, &subjects)?;
    for (name, plot) in &findings.plots {
        write(&format!("speed-{name}.svg"), plot.to_svg())?;
    }
    write("speed.csv", record::table(&bench.records))?;
    write("speed.md", document::document(&bench, &findings, &subjects.remarks))?;
    bench.say("written");
    Ok(())
}

/// All parts, in the order of the document.
fn measure_all(bench: &mut Bench, subjects: &Subjects) -> Result<Findings, Error> {
    let main = &subjects.main;
    let mut findings = Findings::default();
    let (raced, media) = match bench.effort {
        Effort::Full => (&main[..], &MEDIA[..]),
        _ => (&main[..1], &[MARBLE, SKIM_MILK][..]),
    };
    for subject in raced {
        for medium in media {
            findings.add(race::race(bench, subject, *medium)?);
        }
    }
    findings.add(peers::peers(bench, subjects)?);
    findings.add(everywhere::everywhere(bench, main)?);
    findings.add(frame::frame(bench, &main[main.len() - 1])?);
    findings.add(clouds::clouds(bench, subjects.bunny_of_peers.as_ref().unwrap_or(&main[0]))?);
    findings.add(growth::growth(bench, &main[0])?);
    findings.add(accuracy::accuracy(bench, main)?);
    findings.add(estimate::estimate(bench, main)?);
    findings.add(scaling::scaling(bench, &main[0])?);
    Ok(findings)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Arguments, Error> {
        Arguments::parse(line.split_whitespace().map(String::from))
    }

    #[test]
    fn the_command_line_is_checked() {
        let arguments = parse("--meshes a --programs b --output c --full").unwrap();
        assert_eq!((arguments.meshes.to_str(), arguments.effort), (Some("a"), Effort::Full));
        assert!(parse("--meshes a --programs b").is_err());
        assert!(parse("--meshes a --programs b --output c --fast").is_err());
    }
}

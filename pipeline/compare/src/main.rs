//! `compare REFERENCE TEST` prints metrics and a verdict, and exits with 0, 1 or 2.

use arguments::Arguments;
use cli::Failure;
use compare::{Mismatch, compare};
use index_command::IndexArguments;

mod accept;
mod arguments;
mod gate_options;
mod index_command;
mod inputs;
mod lock;
mod noise_mode;
mod outputs;

fn main() {
    cli::run("compare", || match IndexArguments::asked_for() {
        Some(arguments) => arguments.run(),
        None => {
            let arguments: Arguments = cli::parse();
            noise_mode::asked_for(&arguments).unwrap_or_else(|| judge(&arguments))
        }
    })
}

fn judge(arguments: &Arguments) -> Result<u8, Failure> {
    accept::check(arguments)?;
    outputs::check(arguments)?;
    if cli::is_same_file(&arguments.reference, &arguments.test) {
        arguments.common.warn("REFERENCE and TEST are one file, so that nothing is tested");
    }
    let settings = arguments.settings()?;
    if settings.judges_by_flip_alone() {
        return Err(Failure::usage(
            "--max-flip: the mean of FLIP misses single bright pixels and a small bias of the whole picture; give another \
             limit beside it, such as --max-bias or --max-outliers",
        ));
    }
    let _lock = accept::lock(arguments)?;
    let [old, new] = inputs::read_both(arguments)?;
    let (reference, test) = (&old.image, &new.image);
    let report = arguments.common.in_pool(|| compare(reference, test, &settings))?.map_err(|mismatch| {
        let (test, reference) = (arguments.test.display(), arguments.reference.display());
        let way_out = match mismatch {
            Mismatch::Inputs { .. } => "; give --ignore-meta to compare all the same",
            Mismatch::NoLayer { .. } => "; choose one of them with --layer, or in the limits file",
            _ => "",
        };
        Failure::usage(format!("{test}: {mismatch}{way_out} (the reference is {reference})"))
    })?;
    let name = arguments.test.file_name().unwrap_or_default().to_string_lossy();
    let verdict = report.verdict(&name);
    outputs::write(arguments, &settings, [reference, test], &report, &verdict)?;
    let accepted =
        if arguments.accept { Some(accept::accept(arguments, [&old, &new], &report, &verdict)?) } else { None };
    if !arguments.common.quiet {
        cli::print(&report.table())?;
    }
    cli::print(&verdict)?;
    if let Some(words) = &accepted {
        cli::print(words)?;
    }
    Ok(if report.pass || accepted.is_some() { 0 } else { 1 })
}

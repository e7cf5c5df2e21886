//! `compare REFERENCE TEST`: metrics, verdict, exit code 0, 1 or 2.

use arguments::Arguments;
use clap::Parser;
use cli::Failure;
use compare::compare;
use formats::image::Image;
use index_command::IndexArguments;
use std::num::NonZeroUsize;

mod accept;
mod arguments;
mod index_command;
mod noise_mode;
mod outputs;

fn main() {
    cli::run("compare", || match IndexArguments::asked_for() {
        Some(arguments) => arguments.run(),
        None => {
            let arguments = Arguments::parse();
            noise_mode::asked_for(&arguments).unwrap_or_else(|| judge(&arguments))
        }
    })
}

fn judge(arguments: &Arguments) -> Result<u8, Failure> {
    accept::check(arguments)?;
    outputs::check(arguments)?;
    if cli::is_same_file(&arguments.reference, &arguments.test) {
        arguments.common.warn("REFERENCE and TEST are one file: nothing is tested");
    }
    let settings = arguments.settings()?;
    if settings.judges_by_flip_alone() {
        return Err(Failure::usage(
            "--max-flip: a mean of what is seen misses single bright pixels and a small bias of the whole picture; give \
             another limit beside it, such as --max-bias or --max-outliers",
        ));
    }
    let (reference, test) = read_both(arguments)?;
    let report = arguments.common.in_pool(|| compare(&reference, &test, &settings))?.map_err(|mismatch| {
        let (test, reference) = (arguments.test.display(), arguments.reference.display());
        Failure::usage(format!("{test}: {mismatch} (the reference is {reference})"))
    })?;
    let name = arguments.test.file_name().unwrap_or_default().to_string_lossy();
    let verdict = report.verdict(&name);
    outputs::write(arguments, &settings, [&reference, &test], &report, &verdict)?;
    let accepted = if arguments.accept { Some(accept::accept(arguments, &report, &verdict)?) } else { None };
    if !arguments.common.quiet {
        cli::print(&report.table())?;
    }
    cli::print(&verdict)?;
    if let Some(done) = &accepted {
        cli::print(done)?;
    }
    Ok(if report.pass || accepted.is_some() { 0 } else { 1 })
}

/// Both images at once, each by half of the threads: much of reading a file is not shared among threads.
fn read_both(arguments: &Arguments) -> Result<(Image, Image), Failure> {
    let threads = arguments.threads();
    let read = |path, threads| Image::read_with(path, threads);
    let Some(half) = NonZeroUsize::new(threads.get() / 2) else {
        return Ok((read(&arguments.reference, threads)?, read(&arguments.test, threads)?));
    };
    std::thread::scope(|scope| {
        let reference = scope.spawn(|| read(&arguments.reference, half));
        let test = read(&arguments.test, half);
        let reference = reference.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        Ok((reference?, test?))
    })
}

//! `contact-sheet -o SHEET.png TITLE=FILE.png ...`: pictures side by side, made smaller, each with its title.

mod sheet;

use clap::Parser;
use cli::Failure;
use formats::atomic;
use picture::Picture;
use sheet::{Cell, Sheet};
use std::path::{Path, PathBuf};

/// Puts PNG pictures on one sheet.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Pictures, down the first column, then down the next; a slash in a title starts a new line
    #[arg(value_name = "TITLE=FILE.png", required = true)]
    pictures: Vec<String>,
    /// PNG file to write
    #[arg(short, long, value_name = "SHEET.png")]
    output: PathBuf,
    /// Pictures in a column
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..=64))]
    rows: u16,
    /// Width and height of a picture on the sheet, pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 256, value_parser = clap::value_parser!(u16).range(16..=1024))]
    side: u16,
}

/// Most pictures of a sheet.
const MOST: usize = 256;

fn main() {
    let arguments = Arguments::parse();
    cli::run("contact-sheet", || run(&arguments).map(|()| 0));
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.pictures.len() > MOST {
        return Err(Failure::usage(format!("{} pictures; a sheet takes {MOST}", arguments.pictures.len())));
    }
    let cells: Vec<Cell> = arguments.pictures.iter().map(|text| cell(text, arguments)).collect::<Result<_, _>>()?;
    let sheet = Sheet::new(&cells, usize::from(arguments.rows), usize::from(arguments.side));
    atomic::write(&arguments.output, &sheet.encode()?)?;
    Ok(())
}

fn cell(text: &str, arguments: &Arguments) -> Result<Cell, Failure> {
    let (title, file) = text
        .split_once('=')
        .ok_or_else(|| Failure::usage(format!("`{text}`: give TITLE=FILE.png; a title may be empty")))?;
    let picture = Picture::read(Path::new(file))?.fit(usize::from(arguments.side));
    Ok(Cell { title: title.split('/').map(String::from).collect(), picture })
}

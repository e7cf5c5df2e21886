//! `contact-sheet -o SHEET.png TITLE=FILE.png ...` puts pictures side by side on one sheet, reduced and with their
//! titles.

mod sheet;

use clap::Parser;
use cli::{Failure, Files, file_name};
use formats::atomic;
use picture::{Picture, PictureError};
use sheet::{Cell, Sheet};
use std::path::{Path, PathBuf};

/// Puts PNG pictures on one sheet.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Pictures, which fill the first column downwards, then the next; a slash in a title starts a new line
    #[arg(value_name = "TITLE=FILE.png", required = true)]
    pictures: Vec<String>,
    /// PNG file to write
    #[arg(short, long, value_name = "SHEET.png", value_parser = file_name())]
    output: PathBuf,
    /// Number of pictures in a column
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..=64))]
    rows: u16,
    /// Width and height of a picture on the sheet in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 256, value_parser = clap::value_parser!(u16).range(16..=1024))]
    side: u16,
}

/// The largest number of pictures on a sheet.
const MAX_PICTURES: usize = 256;

fn main() {
    let arguments = Arguments::parse();
    cli::run("contact-sheet", || run(&arguments).map(|()| 0));
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.pictures.len() > MAX_PICTURES {
        let count = arguments.pictures.len();
        return Err(Failure::usage(format!("there are {count} pictures, but a sheet takes at most {MAX_PICTURES}")));
    }
    let pictures: Vec<_> = arguments.pictures.iter().map(|text| titled(text)).collect::<Result<_, _>>()?;
    let mut files = Files::default();
    pictures.iter().try_for_each(|(_, file)| files.reads("FILE.png", file))?;
    files.writes("--output", &arguments.output)?;
    let side = usize::from(arguments.side);
    let cells: Vec<Cell> = pictures.iter().map(|picture| cell(*picture, side)).collect::<Result<_, _>>()?;
    let sheet = Sheet::new(&cells, usize::from(arguments.rows), side);
    atomic::write(&arguments.output, &sheet.encode()?)?;
    Ok(())
}

/// The title and the file of an argument.
fn titled(text: &str) -> Result<(&str, &Path), Failure> {
    let (title, file) = text
        .split_once('=')
        .ok_or_else(|| Failure::usage(format!("`{text}`: it is not TITLE=FILE.png; a title may be empty")))?;
    Ok((title, Path::new(file)))
}

fn cell((title, file): (&str, &Path), side: usize) -> Result<Cell, Failure> {
    let picture = Picture::read(file).map_err(|error| match error {
        PictureError::Kind(_) => Failure::usage(format!("{error}; write it with `gather --preview`")),
        error => error.into(),
    })?;
    let picture = picture.fit(side);
    Ok(Cell { title: title.split('/').map(String::from).collect(), picture })
}

//! `compare --html-index FILE REPORT.html...` compares no images, so it has a command line of its own.

use std::path::PathBuf;

use clap::Parser;
use cli::{Failure, Files};

/// List reports made with --html on one page, the worst first
#[derive(Debug, Parser)]
#[command(name = "compare", version)]
pub(crate) struct IndexArguments {
    /// The page to write
    #[arg(long, value_name = "FILE")]
    html_index: PathBuf,
    /// Reports, in any order
    #[arg(required = true, value_name = "REPORT.html")]
    reports: Vec<PathBuf>,
    #[command(flatten)]
    common: cli::Common,
}

impl IndexArguments {
    /// The arguments of the process if they ask for an index.
    pub(crate) fn asked_for() -> Option<IndexArguments> {
        let is_option = |argument: std::ffi::OsString| {
            let text = argument.to_string_lossy().into_owned();
            text == "--html-index" || text.starts_with("--html-index=")
        };
        std::env::args_os().take_while(|argument| argument != "--").any(is_option).then(IndexArguments::parse)
    }

    /// Writes the page.
    pub(crate) fn run(&self) -> Result<u8, Failure> {
        let mut files = Files::default();
        self.reports.iter().try_for_each(|path| files.reads("REPORT.html", path))?;
        files.writes("--html-index", &self.html_index)?;
        formats::atomic::write(&self.html_index, &compare::html::index(&self.html_index, &self.reports)?)?;
        self.common.say(format_args!("{}: the index lists {} reports", self.html_index.display(), self.reports.len()));
        Ok(0)
    }
}

//! The index: many reports on one page, the worst first.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::embed;
use super::thumbnail::{HEAT_RANGE, Thumbnails};

/// The number of bytes at the beginning of a report in which its numbers and small pictures are searched for.
const HEAD: u64 = 1 << 28;

/// Why there is no index.
#[derive(Debug, thiserror::Error)]
pub enum IndexError {
    /// The operating system refused to read a report, or to find the folder of the index.
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    /// The file is something else, or from another version.
    #[error("{}: the file is not an HTML report of compare", path.display())]
    NotAReport { path: PathBuf },
    /// The page cannot be written.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
}

/// The part of the JSON of a report that the index needs.
#[derive(Deserialize)]
struct Numbers {
    reference: String,
    test: String,
    verdict: String,
    pass: bool,
    judged: Vec<String>,
    gates: Vec<Value>,
    layers: Vec<Value>,
}

/// A row of the index.
#[derive(Serialize)]
struct Row {
    /// The path from the index to the report, with `/` between its parts and not yet escaped.
    link: String,
    reference: String,
    test: String,
    verdict: String,
    pass: bool,
    /// The largest ratio of value and limit of the gates that failed. It is infinite if there is no such number, 0 if
    /// no gate failed.
    excess: f64,
    /// The relMSE of the worst channel that was judged. It is infinite if there is no such number.
    relmse: f64,
    thumbnails: Thumbnails,
}

/// The page that lists reports of [`super::page`], to be written to the file `target`. Those that failed come first, by
/// the ratio to their limit, then the others by relMSE.
pub fn index(target: &Path, reports: &[PathBuf]) -> Result<Vec<u8>, IndexError> {
    let folder = target.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let folder = folder.canonicalize().map_err(|source| IndexError::Io { path: target.to_owned(), source })?;
    let mut rows = reports.iter().map(|report| row(&folder, report)).collect::<Result<Vec<_>, _>>()?;
    rows.sort_by(|a, b| {
        let by_numbers = b.excess.total_cmp(&a.excess).then(b.relmse.total_cmp(&a.relmse));
        a.pass.cmp(&b.pass).then(by_numbers).then_with(|| a.link.cmp(&b.link))
    });
    let data = embed::json("comparisons", &json!({ "rows": rows, "heat_range": HEAT_RANGE }))?;
    Ok(embed::page(include_str!("page/index.html"), &script(), &data))
}

/// The script of the page.
pub(super) fn script() -> String {
    [embed::COMMON, include_str!("page/numbers.js"), include_str!("page/index.js")].concat()
}

fn row(folder: &Path, report: &Path) -> Result<Row, IndexError> {
    let fail = |source| IndexError::Io { path: report.to_owned(), source };
    let (numbers, thumbnails) = read(report).map_err(fail)?;
    let not_a_report = || IndexError::NotAReport { path: report.to_owned() };
    let numbers: Numbers = serde_json::from_str(&numbers).map_err(|_| not_a_report())?;
    let thumbnails: Thumbnails = serde_json::from_str(&thumbnails).map_err(|_| not_a_report())?;
    let is_judged = |layer: &&Value| numbers.judged.iter().any(|name| layer["name"] == name.as_str());
    let channels = numbers.layers.iter().filter(is_judged).flat_map(|layer| layer["channels"].as_array()).flatten();
    let relmse = channels.map(|channel| channel["relmse"].as_f64().unwrap_or(f64::INFINITY));
    Ok(Row {
        link: link(folder, report).map_err(fail)?,
        pass: numbers.pass,
        excess: numbers.gates.iter().filter(|gate| gate["ok"] != true).map(excess).fold(0.0, f64::max),
        relmse: relmse.fold(0.0, f64::max),
        thumbnails: if thumbnails.are_pictures() { thumbnails } else { Thumbnails::default() },
        reference: numbers.reference,
        test: numbers.test,
        verdict: numbers.verdict,
    })
}

/// The text of the blocks `report` and `thumbnails`, empty if there is no such block.
fn read(path: &Path) -> std::io::Result<(String, String)> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(std::io::Error::other("it is not a regular file"));
    }
    let (mut report, mut thumbnails) = (String::new(), String::new());
    let mut reader = BufReader::new(File::open(path)?.take(HEAD));
    let mut line = Vec::new();
    while (report.is_empty() || thumbnails.is_empty()) && reader.read_until(b'\n', &mut line)? > 0 {
        let text = String::from_utf8_lossy(&line);
        for (id, found) in [("report", &mut report), ("thumbnails", &mut thumbnails)] {
            let block = text.strip_prefix(embed::json_start(id).as_str());
            if let Some(block) = block.and_then(|rest| rest.strip_suffix(embed::END)) {
                *found = block.to_owned();
            }
        }
        line.clear();
    }
    Ok((report, thumbnails))
}

/// The ratio of value and limit, which is infinite for a limit of zero.
fn excess(gate: &Value) -> f64 {
    match (gate["value"].as_f64(), gate["limit"].as_f64()) {
        (Some(value), Some(limit)) if limit > 0.0 => value / limit,
        _ => f64::INFINITY,
    }
}

/// The relative path from the canonical folder of the index to a report.
fn link(folder: &Path, report: &Path) -> std::io::Result<String> {
    let report = report.canonicalize()?;
    let common = folder.components().zip(report.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(common).map(|_| "..".to_owned());
    let down = report.components().skip(common).map(|part| part.as_os_str().to_string_lossy().into_owned());
    Ok(up.chain(down).collect::<Vec<_>>().join("/"))
}

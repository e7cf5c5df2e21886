//! The limits file that is kept beside a reference, with gates and the reason for each limit.

use std::io::Read;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::{gate::Gate, layer::Choice};

/// The length of the longest file that is read, in bytes.
const MAX_LENGTH: u64 = 1 << 20;
/// The only version of the keys.
const SCHEMA: u32 = 1;

/// A gate with the layers that it judges and the reason for its limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// The gate.
    pub gate: Gate,
    /// The layers that it judges.
    pub choice: Choice,
    /// The reason for its limit.
    pub reason: String,
}

/// Why a limits file cannot be used. The message names the file.
#[derive(Debug, thiserror::Error)]
pub enum LimitsError {
    /// The operating system refused to read it.
    #[error("{}: the limits cannot be read: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    /// It is not the JSON that docs/compare.md describes: `what` names the entry and its fault.
    #[error("{}: {what}", path.display())]
    Invalid { path: PathBuf, what: String },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    schema: u32,
    limits: Vec<LimitEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LimitEntry {
    gate: String,
    limit: f64,
    threshold: Option<f64>,
    layer: Option<String>,
    reason: String,
}

/// Reads a limits file.
pub fn read_limits(path: &Path) -> Result<Vec<Limit>, LimitsError> {
    let text = read(path).map_err(|source| LimitsError::Io { path: path.to_owned(), source })?;
    parse(&text).map_err(|what| LimitsError::Invalid { path: path.to_owned(), what })
}

fn read(path: &Path) -> std::io::Result<String> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(std::io::Error::other("it is not a regular file"));
    }
    let mut text = String::new();
    std::fs::File::open(path)?.take(MAX_LENGTH + 1).read_to_string(&mut text)?;
    if text.len() as u64 > MAX_LENGTH {
        return Err(std::io::Error::other("it is longer than 1 MiB"));
    }
    Ok(text)
}

fn parse(text: &str) -> Result<Vec<Limit>, String> {
    // Guards against a byte order mark, with which some editors begin a file.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document: Document = serde_json::from_str(text).map_err(|error| error.to_string())?;
    if document.schema != SCHEMA {
        return Err(format!("`schema` is {}, but this program reads {SCHEMA} only", document.schema));
    }
    if document.limits.is_empty() {
        return Err("`limits` is empty, so that every image would pass; give at least one limit".to_owned());
    }
    let mut limits: Vec<Limit> = Vec::new();
    for (number, entry) in document.limits.into_iter().enumerate() {
        let name = entry.gate.clone();
        let fault = |what: String| format!("limit {} (`{name}`): {what}", number + 1);
        let limit = check(entry).map_err(fault)?;
        let layer = |limit: &Limit| limit.gate.layer(&limit.choice).map(str::to_owned);
        if limits.iter().any(|known| layer(known) == layer(&limit) && known.gate.is_same_question(limit.gate)) {
            return Err(fault("it occurs twice for this layer; keep one".to_owned()));
        }
        limits.push(limit);
    }
    Ok(limits)
}

fn check(entry: LimitEntry) -> Result<Limit, String> {
    if entry.reason.trim().is_empty() {
        return Err("`reason` is empty; give the reason for this limit".to_owned());
    }
    let gate = Gate::new(&entry.gate, entry.limit, entry.threshold)?;
    Ok(Limit { gate, choice: Choice::new(entry.layer.as_deref()), reason: entry.reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(entry: &str) -> Result<Vec<Limit>, String> {
        parse(&format!(r#"{{"schema": 1, "limits": [{entry}]}}"#))
    }

    #[test]
    fn entries_become_gates() {
        let found = one(r#"{"gate": "max-bias", "limit": 5e-3, "reason": "energy"},
            {"gate": "max-outliers", "limit": 3, "threshold": 0.5, "layer": "all", "reason": "edges"},
            {"gate": "exact", "limit": 0, "layer": "Z", "reason": "no randomness"}"#);
        let gate = |name, limit, threshold| Gate::new(name, limit, threshold).unwrap();
        let limit = |gate, choice, reason: &str| Limit { gate, choice, reason: reason.to_owned() };
        let expected = [
            limit(gate("max-bias", 0.005, None), Choice::Default, "energy"),
            limit(gate("max-outliers", 3.0, Some(0.5)), Choice::All, "edges"),
            limit(gate("exact", 0.0, None), Choice::Named("Z".to_owned()), "no randomness"),
        ];
        assert_eq!(found.unwrap(), expected);
    }

    /// Wrong entries, and words of the message. Seen to catch: each check of this file and of `Gate::new` left out.
    #[test]
    fn what_would_let_faults_pass_is_refused() {
        for (entry, words) in [
            (r#"{"gate": "max-bias", "limit": NaN, "reason": "r"}"#, "line 1"),
            (r#"{"gate": "max-bias", "limit": 1e999, "reason": "r"}"#, "out of range"),
            (r#"{"gate": "max-bias", "limit": "1", "reason": "r"}"#, "invalid type"),
            (r#"{"gate": "max-bias", "limit": -1, "reason": "r"}"#, "at least 0"),
            (r#"{"gate": "max-bias", "reason": "r"}"#, "missing field `limit`"),
            (r#"{"gate": "max-bias", "limit": 1}"#, "missing field `reason`"),
            (r#"{"gate": "max-bias", "limit": 1, "reason": " \n"}"#, "`reason` is empty"),
            (r#"{"gate": "max-bias", "limit": 1, "limit": 2, "reason": "r"}"#, "duplicate field"),
            (r#"{"gate": "max-bias", "limit": 1, "layr": "Z", "reason": "r"}"#, "unknown field `layr`"),
            (r#"{"gate": "max-bais", "limit": 1, "reason": "r"}"#, "no gate `max-bais`"),
            (r#"{"gate": "max-bias", "limit": 1, "threshold": 1, "reason": "r"}"#, "`threshold`"),
            (r#"{"gate": "max-outliers", "limit": 1, "reason": "r"}"#, "`threshold`"),
            (r#"{"gate": "max-outliers", "limit": 0.5, "threshold": 1, "reason": "r"}"#, "whole number"),
            (r#"{"gate": "max-outliers", "limit": 1, "threshold": -1, "reason": "r"}"#, "at least 0"),
            (r#"{"gate": "exact", "limit": 1, "reason": "r"}"#, "must be 0"),
            ("", "`limits` is empty"),
        ] {
            let message = one(entry).unwrap_err();
            assert!(message.contains(words), "{entry}: {message}");
        }
        assert!(parse(r#"{"schema": 2, "limits": []}"#).unwrap_err().contains("`schema`"));
    }

    #[test]
    fn a_question_is_asked_once() {
        let bias = r#"{"gate": "max-bias", "limit": 1, "reason": "r"}"#;
        let other = r#"{"gate": "max-bias", "limit": 2, "layer": "beauty", "reason": "r"}"#;
        assert!(one(&format!("{bias}, {other}")).unwrap_err().contains("limit 2 (`max-bias`): it occurs twice"));
        let outliers =
            |threshold| format!(r#"{{"gate": "max-outliers", "limit": 1, "threshold": {threshold}, "reason": "r"}}"#);
        assert!(one(&format!("{}, {}", outliers(1), outliers(2))).is_ok());
        assert!(one(&format!("{}, {}", outliers(1), outliers(1))).unwrap_err().contains("limit 2"));
    }
}

//! The two programs as child processes, and their cost.

use crate::error::Error;
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::Instant,
};

/// Cost of one process, from its start to its end, and its statistics.
#[derive(Clone, Debug)]
pub struct Spent {
    /// Seconds of wall clock time.
    pub wall: f64,
    /// User and system seconds of the whole process; wall clock time where the system does not report them (correct
    /// for one thread).
    pub cpu: f64,
    /// The contents of `--stats`.
    pub statistics: Value,
}

impl Spent {
    /// Seconds of one step, from the statistics.
    pub fn step(&self, name: &str) -> f64 {
        self.statistics["seconds"][name].as_f64().unwrap_or(0.0)
    }

    /// A number of the statistics; none if it is missing or null.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.statistics[name].as_f64()
    }
}

/// A program that writes statistics.
#[derive(Clone, Debug)]
pub struct Program {
    path: PathBuf,
}

impl Program {
    /// Finds a program in a folder; the error says how to build it.
    pub fn of(folder: &Path, name: &str) -> Result<Program, Error> {
        let path = folder.join(name);
        match fs::metadata(&path) {
            Ok(_) => Ok(Program { path }),
            Err(source) => Err(Error::Start { program: path, source }),
        }
    }

    /// What the program prints of its version.
    pub fn version(&self) -> Result<String, Error> {
        let output = Command::new(&self.path).arg("--version").stdin(Stdio::null()).output();
        let output = output.map_err(|source| Error::Start { program: self.path.clone(), source })?;
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    }

    /// Runs the program to its end; `statistics` is the file for its statistics.
    pub fn run(&self, arguments: &[String], statistics: &Path) -> Result<Spent, Error> {
        self.run_list(arguments, statistics, statistics)
    }

    /// The same for a program that writes statistics of each image: `last` is the file that is read.
    pub fn run_list(&self, arguments: &[String], statistics: &Path, last: &Path) -> Result<Spent, Error> {
        let mut command = Command::new(&self.path);
        command.args(arguments).arg("--stats").arg(statistics).args(["--quiet", "--progress", "none"]);
        command.stdin(Stdio::null()).stdout(Stdio::null());
        let (before, start) = (children_cpu_seconds(), Instant::now());
        let output = command.output().map_err(|source| Error::Start { program: self.path.clone(), source })?;
        let wall = start.elapsed().as_secs_f64();
        let cpu = before.zip(children_cpu_seconds()).map_or(wall, |(before, after)| after - before);
        if !output.status.success() {
            let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
            let (program, arguments) = (self.path.clone(), arguments.to_vec());
            return Err(Error::Failed { program, arguments, code: output.status.code(), message });
        }
        let text = fs::read_to_string(last).map_err(Error::file(last))?;
        let unreadable = |e: serde_json::Error| Error::Unreadable { path: last.to_owned(), message: e.to_string() };
        Ok(Spent { wall, cpu, statistics: serde_json::from_str(&text).map_err(unreadable)? })
    }
}

/// User and system seconds of all children that have ended, where the system reports them: fields 16 and 17 of
/// /proc/self/stat, in ticks of 10 ms on every Linux (proc(5); USER_HZ is part of its interface).
fn children_cpu_seconds() -> Option<f64> {
    children_ticks(&fs::read_to_string("/proc/self/stat").ok()?).map(|ticks| ticks / 100.0)
}

/// Fields are counted from the last bracket, because the name of the process may hold spaces and brackets.
fn children_ticks(text: &str) -> Option<f64> {
    let (_, rest) = text.rsplit_once(')')?;
    let mut fields = rest.split_whitespace().skip(13);
    let mut next = || fields.next()?.parse::<f64>().ok();
    Some(next()? + next()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_of_children_are_found_behind_any_name() {
        let line = "7 (a) b (c) S 1 7 7 0 -1 4194304 10 20 0 0 3 4 50 60 20 0 1 0 100";
        assert_eq!(children_ticks(line), Some(110.0));
        assert_eq!(children_ticks("7 (short) S 1"), None);
    }

    #[test]
    fn missing_programs_say_how_to_get_them() {
        let error = Program::of(Path::new("/nowhere"), "gather").unwrap_err();
        assert!(error.to_string().contains("make build"), "{error}");
    }
}

//! How long the steps of a run take, for its statistics.

use std::{collections::BTreeMap, time::Instant};

/// Seconds of each step since a start.
#[derive(Debug)]
pub struct Seconds {
    start: Instant,
    steps: BTreeMap<&'static str, f64>,
}

impl Seconds {
    /// Starts the clock.
    pub fn start() -> Seconds {
        Seconds { start: Instant::now(), steps: BTreeMap::new() }
    }

    /// Does the work of a step and notes how long it took.
    pub fn time<T>(&mut self, step: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.steps.insert(step, start.elapsed().as_secs_f64());
        result
    }

    /// Seconds of a step, if it was done.
    pub fn of(&self, step: &str) -> Option<f64> {
        self.steps.get(step).copied()
    }

    /// The steps done so far, and `total`: all seconds since the start, those between the steps included.
    pub fn table(&self) -> BTreeMap<&'static str, f64> {
        let total = ("total", self.start.elapsed().as_secs_f64());
        self.steps.iter().map(|(step, seconds)| (*step, *seconds)).chain([total]).collect()
    }
}

//! The effort of the measurements.

/// Half a minute, minutes, or about an hour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// A trial of the program: the figures mean nothing.
    Tiny,
    /// `make curve`.
    Quick,
    /// `make curve-full`.
    Full,
}

impl Effort {
    /// Chooses the setting for this effort.
    pub fn of<T>(self, tiny: T, quick: T, full: T) -> T {
        match self {
            Effort::Tiny => tiny,
            Effort::Quick => quick,
            Effort::Full => full,
        }
    }

    /// Predicted seconds of the longest single run that is started.
    pub fn longest_run(self) -> f64 {
        self.of(2.0, 100.0, 100.0)
    }
}

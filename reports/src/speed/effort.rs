//! How long the measurements may take.

/// Minutes, an hour or so, or just long enough to see that the program works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Half a minute; the figures mean nothing.
    Tiny,
    /// `make curve`.
    Quick,
    /// `make curve-full`.
    Full,
}

impl Effort {
    /// The setting for this effort.
    pub fn of<T>(self, tiny: T, quick: T, full: T) -> T {
        match self {
            Effort::Tiny => tiny,
            Effort::Quick => quick,
            Effort::Full => full,
        }
    }

    /// The longest single run that is started, seconds as predicted.
    pub fn longest_run(self) -> f64 {
        self.of(2.0, 100.0, 100.0)
    }
}

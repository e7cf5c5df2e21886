//! The kinds of gates: the value that each limits, and its name on the command line and in limits files.

use super::picture::Pair;

/// A kind of gate: its row in [`super::GATES`] makes it an option of the program and an entry of limits files.
#[derive(Debug)]
pub struct GateKind {
    /// The name of the option, without its dashes, and of the entry in a limits file.
    pub name: &'static str,
    /// The help of the option.
    pub help: &'static str,
    /// The value that the gate limits.
    pub value: GateValue,
}

/// The value that a gate limits.
#[derive(Clone, Copy, Debug)]
pub enum GateValue {
    /// The metric of this key, of the channel of a layer where its absolute value is largest.
    Channel(&'static str),
    /// The metric of the picture of this key, whatever layer is chosen.
    Picture(&'static str),
    /// The number of pixels of a layer that differ by more than a threshold.
    Pixels(fn(&[Pair<'_>], f64) -> u64),
    /// A number of samples of a layer of which none may be there.
    Samples(fn(&[Pair<'_>]) -> u64),
}

impl PartialEq for GateKind {
    /// The name of a kind is unique.
    fn eq(&self, other: &GateKind) -> bool {
        self.name == other.name
    }
}

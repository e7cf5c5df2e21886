//! The layers that the gates of the command line judge.

use crate::layer::BEAUTY;

/// The layers that the gates judge.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Choice {
    /// The beauty layer and its alpha; for `exact`, which is about the file, all layers.
    #[default]
    Default,
    /// All layers.
    All,
    /// The layer of this name.
    Named(String),
}

impl Choice {
    /// The choice by the name of a layer, or by `all`. `beauty` is a layer like any other if it is named.
    pub fn new(name: Option<&str>) -> Choice {
        match name {
            None => Choice::Default,
            Some("all") => Choice::All,
            Some(name) => Choice::Named(name.to_owned()),
        }
    }

    /// The name of the layer, which is beauty by default, or `None` for all layers.
    pub(crate) fn layer(&self) -> Option<&str> {
        match self {
            Choice::Default => Some(BEAUTY),
            Choice::All => None,
            Choice::Named(name) => Some(name),
        }
    }
}

//! The settings of a comparison.

use crate::{gate::Gate, layer::Choice, limits::Limit};

/// The settings of a comparison.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Gates on the chosen layers.
    pub gates: Vec<Gate>,
    /// Further gates, each on layers of its own.
    pub limits: Vec<Limit>,
    /// The layers that the gates judge.
    pub choice: Choice,
    /// Values that are not finite do not fail by themselves; they still fail every gate on their channel.
    pub allow_nonfinite: bool,
    /// FLIP is measured, which takes longer than all else. A gate on FLIP asks for it too.
    pub flip: bool,
    /// Images of different clouds or scenes may be compared.
    pub ignore_meta: bool,
}

impl Settings {
    /// Every gate with its layers and, if it has one, its reason. Those of the command line come first.
    pub(crate) fn all_gates(&self) -> impl Iterator<Item = (Gate, &Choice, Option<&String>)> {
        let own = self.gates.iter().map(|gate| (*gate, &self.choice, None));
        own.chain(self.limits.iter().map(|Limit { gate, choice, reason }| (*gate, choice, Some(reason))))
    }

    /// Whether FLIP is to be measured.
    pub(crate) fn wants_flip(&self) -> bool {
        self.flip || self.all_gates().any(|(gate, ..)| gate.needs_flip())
    }

    /// Whether gates on FLIP judge alone, which the program refuses: the mean of FLIP misses single bright pixels and a
    /// small bias of the whole picture.
    pub fn judges_by_flip_alone(&self) -> bool {
        self.all_gates().next().is_some() && self.all_gates().all(|(gate, ..)| gate.needs_flip())
    }
}

//! A medium under one BSSRDF model, prepared for the estimators.

use super::falloff_tables::FalloffTables;
use bssrdf::{AnyLanes, Far, Medium, Model, Partition, simd::Level};
use std::sync::OnceLock;

/// A medium under one BSSRDF model, prepared for sums over samples.
pub struct Scatterer {
    model: Model,
    medium: Medium,
    /// The size of the surface, m; see [`FalloffTables::new`].
    size: f64,
    /// The part of the model that is summed.
    partition: Partition,
    /// The model as the estimators evaluate it.
    pub(super) lanes: AnyLanes,
    /// `σ_tr` of the three channels, 1/m.
    pub(super) transport: [f64; 3],
    tables: OnceLock<FalloffTables>,
    /// The instruction set that sums are made with; all give the same bits.
    pub level: Level,
}

impl Scatterer {
    /// `size` is that of the surface, m, which is nearly a plane over shorter distances; it changes only how fast the
    /// cut is, and may be infinite.
    pub fn new(model: Model, medium: &Medium, size: f64) -> Scatterer {
        Scatterer {
            model,
            medium: medium.clone(),
            size,
            partition: Partition::NONE,
            lanes: model.lanes(medium),
            transport: model.of(medium).transport(),
            tables: OnceLock::new(),
            level: Level::widest(),
        }
    }

    /// The same medium, of which the far part alone is summed.
    pub fn far(self, partition: Partition) -> Scatterer {
        Scatterer { partition, lanes: self.lanes.far(partition), tables: OnceLock::new(), ..self }
    }

    /// The relative refractive index of the medium.
    pub fn eta(&self) -> f64 {
        self.medium.eta
    }

    /// The tables by which the cut opens nodes. Only the cut needs them, so the first that asks makes them.
    pub(super) fn tables(&self) -> &FalloffTables {
        let far = || Far { model: self.model.of(&self.medium), partition: self.partition };
        self.tables.get_or_init(|| FalloffTables::new(&self.medium, &far(), self.size))
    }
}

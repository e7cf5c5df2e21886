//! Hard cases by name. Every test is short, says which guard it exercises, and asserts something definite; numbers
//! must be finite and not negative everywhere. Points are evaluated by all models, in float64, in float32 lanes and
//! through all estimators; scenes go through both phases.

mod cameras;
mod clouds;
mod document;
mod evaluate;
mod files;
mod fireflies;
mod forge;
mod hostile;
mod interface;
mod lights;
mod media;
mod meshes;
mod overflow;
mod scale;
mod scenes;
mod separations;
mod thin_sheet;

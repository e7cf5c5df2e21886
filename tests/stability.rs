//! Hard cases by name. Every one is short, says which guard it exercises, and asserts a definite thing; numbers must be
//! finite and not negative wherever they come from. Points are evaluated by all models, in float64, in float32 lanes and
//! through all estimators; scenes go through both phases.

#[path = "stability/cameras.rs"]
mod cameras;
#[path = "stability/clouds.rs"]
mod clouds;
#[path = "stability/document.rs"]
mod document;
#[path = "stability/evaluate.rs"]
mod evaluate;
#[path = "stability/files.rs"]
mod files;
#[path = "stability/fireflies.rs"]
mod fireflies;
#[path = "stability/forge.rs"]
mod forge;
#[path = "stability/hostile.rs"]
mod hostile;
#[path = "stability/interface.rs"]
mod interface;
#[path = "stability/lights.rs"]
mod lights;
#[path = "stability/media.rs"]
mod media;
#[path = "stability/meshes.rs"]
mod meshes;
#[path = "stability/overflow.rs"]
mod overflow;
#[path = "stability/scale.rs"]
mod scale;
#[path = "stability/scenes.rs"]
mod scenes;
#[path = "stability/separations.rs"]
mod separations;
#[path = "stability/thin_sheet.rs"]
mod thin_sheet;

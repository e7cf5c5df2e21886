//! Import, rays and lights from outside the crate.

mod asset;
mod exactness;
mod import;
mod import_faults;
mod import_files;
mod import_lights;
mod import_mutations;
mod import_quantised;
mod lights;
mod meshes;
mod rays;
mod shadows;

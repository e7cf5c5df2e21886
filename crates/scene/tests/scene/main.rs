//! Import, rays and lights from outside the crate.

mod along;
mod copies;
mod cutouts;
mod environment;
mod exactness;
mod framing;
mod identity;
mod import;
mod import_faults;
mod import_files;
mod import_lights;
mod import_quantized;
mod import_textures;
mod import_volumes;
mod import_work;
mod lights;
mod many_lights;
mod mesh_defects;
mod meshes;
mod rays;
mod shadows;
mod unhonoured;

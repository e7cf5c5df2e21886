//! Import, rays and lights from outside the crate.

mod along;
mod copies;
mod cutouts;
mod environment;
mod exactness;
mod glow;
mod identity;
mod import;
mod import_compressed;
mod import_faults;
mod import_files;
mod import_formats;
mod import_lights;
mod import_poses;
mod import_quantized;
mod import_textures;
mod import_volumes;
mod import_work;
mod lights;
mod many_lights;
mod mesh_defects;
mod meshes;
mod panes;
mod rays;
mod shadows;
mod unhonoured;

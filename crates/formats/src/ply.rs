//! Clouds as PLY, for viewers: binary little-endian.

use crate::{Error, atomic::Output, cloud::Cloud};
use std::{io::Write, path::Path};

/// Writes position (m), normal, direction to the light and flux (W) of every stored sample; the caller commits the
/// file. Positions are relative to [`crate::cloud::Meta::exchange_origin_m`], which a comment of the header states
/// unless it is 0.
pub fn write_ply(path: &Path, cloud: &Cloud) -> Result<Output, Error> {
    let mut output = Output::create(path)?;
    let fail = |source| Error::write(path, source);
    let names = ["x", "y", "z", "nx", "ny", "nz", "wx", "wy", "wz", "flux_r", "flux_g", "flux_b"];
    let properties: String = names.iter().map(|n| format!("property float {n}\n")).collect();
    let count = cloud.len();
    let about = cloud.meta().exchange_origin_m();
    let comment = match about {
        [0.0, 0.0, 0.0] => String::new(),
        [x, y, z] => format!("comment x y z are relative to originM {x} {y} {z}\n"),
    };
    let head =
        format!("ply\nformat binary_little_endian 1.0\n{comment}element vertex {count}\n{properties}end_header\n");
    output.write_all(head.as_bytes()).map_err(fail)?;
    let origin = glam::DVec3::from_array(cloud.meta().origin_m) - glam::Vec3::from_array(about).as_dvec3();
    for sample in cloud.meta().materials.iter().flat_map(|m| cloud.samples(m)) {
        let position = (sample.position.as_dvec3() + origin).as_vec3();
        for v in [position, sample.normal.as_vec3(), sample.direction.as_vec3(), sample.flux] {
            for x in v.to_array() {
                output.write_all(&x.to_le_bytes()).map_err(fail)?;
            }
        }
    }
    Ok(output)
}

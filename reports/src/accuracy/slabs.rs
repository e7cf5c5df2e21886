//! Slabs: what is reflected and transmitted in the middle of a wide sheet, by the calibrated model and by the models
//! alone, against random walks in a slab without sides.

use crate::{
    accuracy::{
        Effort,
        half_spaces::{COLUMNS, percent},
    },
    error::Error,
    markdown::table,
};
use bssrdf::{DVec3, Model, half_space::exit_moment};
use calibration::{Factors, Site, Task, WALKS, calibrate};
use gather::estimator::Estimator;
use scene::{
    NormalKind,
    random::{Purpose, Stream},
    warp,
};
use std::slice::from_ref;
use test_support::{
    half_space::transmission,
    meshes::{Light, Part, World, slab, world},
    pipeline::{Lit, Point, cloud, gray, stratified},
    walk,
};

const ETA: f64 = 1.3;
const ALBEDOS: [f64; 3] = [0.9, 0.99, 0.999];
/// Mean free paths.
const THICKNESSES: [f64; 5] = [0.5, 1.0, 2.0, 5.0, 20.0];

/// The share of the width, from the middle, that is looked at.
const MIDDLE: f64 = 1.0 / 3.0;

/// The table.
pub fn document(effort: Effort) -> Result<String, Error> {
    let mut rows = Vec::new();
    for (i, albedo) in ALBEDOS.into_iter().enumerate() {
        for (j, thickness) in THICKNESSES.into_iter().enumerate() {
            eprintln!("slab of albedo {albedo}, {thickness} mean free paths");
            let matter = walk::Matter { albedo, asymmetry: 0.0, eta: ETA };
            let walks = effort.of(10_000, 1_000_000);
            let exact = walk::slab(&matter, thickness, 1.0, walks, 7000 + (10 * i + j) as u64);
            let exact = [exact.reflected.mean, exact.transmitted.mean];
            let calibrated = calibrated(albedo, thickness, effort)?;
            let mut row = vec![albedo.to_string(), thickness.to_string()];
            row.extend(exact.map(|x| format!("{x:.4}")));
            row.extend((0..2).map(|k| format!("{:.4} ({})", calibrated[k], percent(calibrated[k] / exact[k] - 1.0))));
            row.extend(COLUMNS.map(|model| {
                let value = transmission(model, albedo, ETA, thickness);
                format!("{value:.4} ({})", percent(value / exact[1] - 1.0))
            }));
            rows.push(row);
        }
    }
    let header = [
        "reduced albedo",
        "thickness",
        "walk R",
        "walk T",
        "R calibrated",
        "T calibrated",
        "T half-space",
        "T directional",
        "T better",
        "T standard",
    ];
    Ok(INTRODUCTION.to_owned() + &table(&header, &rows) + "\n")
}

const INTRODUCTION: &str = "## Thin slabs

A slab of index 1.3 under normal incidence; thickness in reduced mean free paths. *Calibrated* is the middle third of a
wide box, calibrated with the default number of walks and integrated over all directions. Models alone reflect as much
as a half-space; `T` is what they transmit when points of the back gather the samples of the front.

";

/// Reflectance and transmittance of the middle of a sheet by the calibrated half-space model; lengths are mean free
/// paths.
fn calibrated(albedo: f64, thickness: f64, effort: Effort) -> Result<[f64; 2], Error> {
    let half_width = 18.0 + 2.4 * thickness;
    let mesh = slab(DVec3::new(half_width, half_width, 0.5 * thickness), 24);
    let sun = Light::Directional { towards: DVec3::Z, irradiance: DVec3::ONE };
    let world = world(&[Part::translucent(mesh)], &[sun], DVec3::ZERO);
    let cloud = cloud(&world, &stratified(effort.of(1 << 14, 1 << 19), 1));
    let medium = gray(1.0 - albedo, albedo, 0.0, ETA);
    let task = Task {
        scene: &world.scene,
        rays: &world.rays,
        clouds: from_ref(&cloud),
        media: from_ref(&medium),
        model: Model::HalfSpace,
        normals: NormalKind::Geometric,
        walks: effort.of(5_000, WALKS),
        seed: 1,
    };
    let found = calibrate(&task, |_| ()).map_err(|e| Error::Usage(e.to_string()))?;
    let factors = Factors::new(&found.materials[0]);
    let lit = Lit::new(&cloud, &medium, Model::HalfSpace);
    Ok([1.0, -1.0].map(|side| exitance(&world, &lit, &factors, side, MIDDLE * half_width, effort)))
}

/// The mean power that leaves an area in the middle of the upper or the lower side. Seen along the normal, light of a
/// lobe whose power is that of `T21` has the factor `a + b`.
fn exitance(world: &World, lit: &Lit, factors: &Factors, side: f64, half_width: f64, effort: Effort) -> f64 {
    let mesh = &world.scene.mesh;
    let stream = Stream::new(9, Purpose::CalibrationPoint);
    let transmitted = exit_moment(0, ETA);
    let (mut sum, mut total) = (0.0, 0.0);
    let points = effort.of(1, 32);
    for k in 0..mesh.triangles.len() * points {
        let item = stream.item(k as u64);
        let weights = warp::triangle([item.uniform(0), item.uniform(1)]);
        let at = mesh.point((k / points) as u32, weights, NormalKind::Geometric);
        let (position, normal) = (at.position, at.geometric_normal);
        if side * normal.z > 0.9 && position.x.abs().max(position.y.abs()) < half_width {
            let radiance = lit.radiance(Estimator::Cut { accuracy: 0.01 }, Point { position, normal }, item.bits(2));
            let lobes = DVec3::from_array(factors.lobe().map(|[a, b]| a + b));
            let factor = factors.at(&Site { position, normal }, normal) / lobes;
            let area = mesh.area(k / points);
            sum += area * (radiance * factor).element_sum() / 3.0;
            total += area;
        }
    }
    transmitted * sum / total
}

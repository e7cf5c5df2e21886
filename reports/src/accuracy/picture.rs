//! The sphere by brute force and by each model, as pictures and as numbers.

use crate::accuracy::sphere::{Plane, SIDE, Setting, brute_force, model};
use bssrdf::{DVec3, Model, built_in};
use scene::Camera;
use std::{error::Error, f64::consts::PI, fs, path::Path};
use test_support::{
    meshes::repository_scene,
    pipeline::{DIPOLES, Lit, by_area, cloud, orthographic},
};

/// Number of photons of each channel.
const PHOTONS: u64 = 6_000_000;

/// Number of samples of the cloud.
const SAMPLES: u64 = 400_000;

/// The medium of the pictures.
pub const MEDIUM: &str = "skimmilk";

/// Comparison of one model's sphere with brute force.
pub struct Ratios {
    pub model: Model,
    /// Mean radiance over that of brute force, on the lit and on the dark side, per channel.
    pub lit: [f64; 3],
    pub dark: [f64; 3],
}

/// The sphere of `data/scenes/sphere.glb`, seen from the side of its light.
fn setting(radius: f64) -> Setting {
    let to_light = DVec3::new(1.0, 0.3, 0.4).normalize();
    let upright = Camera { right: DVec3::X, up: DVec3::Y, ..orthographic(DVec3::Z, radius) };
    Setting { radius, to_light, irradiance: PI, camera: upright }
}

/// Renders all pictures into `folder`.
pub fn spheres(folder: &Path) -> Result<Vec<Ratios>, Box<dyn Error>> {
    let medium = built_in(MEDIUM)?;
    let setting = setting(0.02);
    let exact = [0, 1, 2].map(|c| brute_force(&setting, &medium, c, PHOTONS, c as u64 + 1));
    let world = repository_scene("sphere");
    let cloud = cloud(&world, &by_area(SAMPLES, 1));
    let mut all = Vec::new();
    for kind in DIPOLES {
        let shown = model(&setting, &Lit::new(&cloud, &medium, kind), medium.eta);
        fs::write(folder.join(format!("sphere-{}.png", kind.name())), panels(&exact, &shown)?)?;
        all.push(ratios(&setting, kind, &exact, &shown));
    }
    Ok(all)
}

/// Mean ratios over the points whose normal turns to the light by more than 30 degrees, or away by more than 30.
fn ratios(setting: &Setting, model: Model, exact: &[Plane; 3], shown: &[Plane; 3]) -> Ratios {
    let over = |accept: &dyn Fn(f64) -> bool| {
        let inside = |k: usize| setting.pixel_normal(k).is_some_and(|n| accept(n.dot(setting.to_light)));
        let sum = |plane: &Plane| (0..SIDE * SIDE).filter(|k| inside(*k)).map(|k| plane[k]).sum::<f64>();
        [0, 1, 2].map(|c| sum(&shown[c]) / sum(&exact[c]))
    };
    Ratios { model, lit: over(&|c| c > 0.5), dark: over(&|c| c < -0.5) }
}

/// Enlargement of a pixel.
const ZOOM: usize = 4;

/// Three panels: brute force, model, and their relative difference (red: the model is brighter, blue: darker; full
/// color at 50 %).
fn panels(exact: &[Plane; 3], shown: &[Plane; 3]) -> Result<Vec<u8>, png::EncodingError> {
    let tone = |x: f64| (255.0 * (1.0 - (-1.5 * x.max(0.0)).exp()).powf(1.0 / 2.2)).round() as u8;
    let picture = |planes: &[Plane; 3], k: usize| [0, 1, 2].map(|c| tone(planes[c][k]));
    let sum = |planes: &[Plane; 3], k: usize| planes.iter().map(|p| p[k]).sum::<f64>();
    let difference = |k: usize| {
        let (a, b) = (sum(exact, k), sum(shown, k));
        let d = if a > 0.0 { (2.0 * (b / a - 1.0)).clamp(-1.0, 1.0) } else { 0.0 };
        let fade = (255.0 * (1.0 - d.abs())).round() as u8;
        if d > 0.0 { [255, fade, fade] } else { [fade, fade, 255] }
    };
    let (width, height) = (3 * SIDE * ZOOM, SIDE * ZOOM);
    let mut bytes = Vec::with_capacity(3 * width * height);
    for y in 0..height {
        for x in 0..width {
            let (panel, column) = (x / (SIDE * ZOOM), x % (SIDE * ZOOM));
            let k = y / ZOOM * SIDE + column / ZOOM;
            bytes.extend(match panel {
                0 => picture(exact, k),
                1 => picture(shown, k),
                _ => difference(k),
            });
        }
    }
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(&bytes)?;
    Ok(file)
}

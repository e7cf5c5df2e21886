//! The pictures of the peaches and of their table. Colors are codes of sRGB from 0 to 255, mixed as they are: a power
//! would not have the same bytes on every machine.

use glam::{DVec2, DVec3};
use picture::Picture;

use crate::fruit::{SLICE_MM, from_disc, whole};
use crate::noise::{at_lattice, layered, repeating, smooth, step};

const SKIN_PIXELS: usize = 448;
const BUMPS_PIXELS: usize = 192;
/// Pores along each side of the picture of bumps.
const PORES: i64 = 18;
/// The slope of the side of a pore.
const SLOPE: f64 = 0.55;
const TABLE_PIXELS: usize = 384;

const YELLOW: DVec3 = DVec3::new(240.0, 172.0, 72.0);
const ORANGE: DVec3 = DVec3::new(232.0, 128.0, 62.0);
const RED: DVec3 = DVec3::new(178.0, 42.0, 38.0);
const DARK_RED: DVec3 = DVec3::new(112.0, 20.0, 30.0);
const GREEN: DVec3 = DVec3::new(206.0, 186.0, 92.0);

/// The direction from which the sun has shone on the fruit, in the axes of its picture: right, up, towards the camera.
const SUN: DVec3 = DVec3::new(0.62, 0.62, 0.48);
/// The stem in those axes.
const STEM: DVec3 = DVec3::new(0.09, 0.85, 0.52);

/// The skin of a fruit in `fruit::disc`: yellow, with a red cheek that has streaks from stem to tip, and lighter dots.
pub fn skin() -> Picture {
    painted([SKIN_PIXELS; 2], |uv| {
        let d = from_disc(uv);
        let stem = STEM.normalize();
        let height = d.dot(stem);
        let aside = d - height * stem;
        // Equal on the way from stem to tip.
        let around = aside / aside.length().max(0.02);
        let streaks = layered(9.0 * around + DVec3::splat(1.3 * height + 20.0), 11);
        let clouds = layered(2.2 * d + DVec3::splat(30.0), 23);
        let cheek = d.dot(SUN.normalize()) + 1.1 * (clouds - 0.5) + 0.75 * (streaks - 0.5);
        let mut color = YELLOW.lerp(ORANGE, step(-0.45, 0.25, cheek));
        color = color.lerp(RED, step(0.0, 0.62, cheek));
        color = color.lerp(DARK_RED, 0.8 * step(0.55, 1.15, cheek));
        color = color.lerp(GREEN, 0.75 * step(0.93, 1.0, height + 0.05 * streaks));
        let dots = dots(d);
        color.lerp(if cheek > 0.22 { ORANGE } else { RED }, 0.5 * dots)
    })
}

/// 1 in small dots, 0 between them.
fn dots(d: DVec3) -> f64 {
    let p = 26.0 * d;
    // Dots of less than half a cell reach from these cells alone.
    let nearest = (p - DVec3::splat(0.5)).floor();
    let mut all: f64 = 0.0;
    for k in 0..8i32 {
        let cell = nearest + DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
        let lattice = cell.to_array().map(|x| x as i64);
        if at_lattice(lattice, 90) < 0.6 {
            continue;
        }
        let place = cell + DVec3::new(at_lattice(lattice, 91), at_lattice(lattice, 92), at_lattice(lattice, 93));
        let radius = 0.2 + 0.22 * at_lattice(lattice, 94);
        all = all.max(1.0 - step(0.4, 1.0, p.distance(place) / radius));
    }
    all
}

/// A slice in `fruit::section`: skin outside, yellow flesh with fibers, and red around the stone.
pub fn flesh() -> Picture {
    painted([160, 256], |uv| {
        let [out, up] = SLICE_MM;
        let p = DVec2::new(out * uv.x, up * (1.0 - 2.0 * uv.y));
        let radius = p.length();
        let stone = ((p.x / 8.5) * (p.x / 8.5) + (p.y / 14.0) * (p.y / 14.0)).sqrt();
        let along = p / radius.max(1.0);
        let fibers = layered(DVec3::new(11.0 * along.x, 11.0 * along.y, 0.1 * radius) + DVec3::splat(40.0), 51);
        let clouds = smooth(DVec3::new(0.2 * p.x, 0.2 * p.y, 9.0), 61);
        let light = DVec3::new(250.0, 206.0, 112.0);
        let deep = DVec3::new(240.0, 170.0, 66.0);
        let mut color = light.lerp(deep, step(0.25, 0.75, 0.7 * fibers + 0.3 * clouds));
        let red = 1.0 - step(1.0, 1.5, stone - 0.55 * (fibers - 0.5));
        color = color.lerp(DVec3::new(176.0, 40.0, 40.0), 0.9 * red);
        color.lerp(DVec3::new(196.0, 62.0, 44.0), step(-1.6, -0.7, whole(DVec3::new(p.x, p.y, 0.0))))
    })
}

/// The pores as a normal map that repeats.
pub fn pores() -> Picture {
    let side = BUMPS_PIXELS as f64;
    let height = |x: i64, y: i64| {
        let wrapped = |k: i64| k.rem_euclid(BUMPS_PIXELS as i64) as f64 / side;
        pore_depth(DVec2::new(wrapped(x), wrapped(y)))
    };
    let texel = PORES as f64 / side;
    let mut picture = Picture::new(BUMPS_PIXELS, BUMPS_PIXELS, [128, 128, 255]);
    for (y, x) in (0..BUMPS_PIXELS as i64).flat_map(|y| (0..BUMPS_PIXELS as i64).map(move |x| (y, x))) {
        let slope_x = SLOPE * (height(x + 1, y) - height(x - 1, y)) / (2.0 * texel);
        // Rows go down, and the second axis of a normal map up.
        let slope_y = SLOPE * (height(x, y - 1) - height(x, y + 1)) / (2.0 * texel);
        let normal = DVec3::new(-slope_x, -slope_y, 1.0).normalize();
        let code = |c: f64| (128.0 + 127.0 * c + 0.5).floor() as u8;
        picture.dot(x as usize, y as usize, [code(normal.x), code(normal.y), code(normal.z)]);
    }
    picture
}

/// Height between the pores' bottoms and the skin around them, in units of their distance.
fn pore_depth(uv: DVec2) -> f64 {
    let p = PORES as f64 * uv;
    let (x, y) = (p.x.floor() as i64, p.y.floor() as i64);
    let waves = 0.5 * repeating(DVec3::new(0.5 * p.x, 0.5 * p.y, 0.0), [PORES / 2, PORES / 2, 1], 70);
    let neighbors = (-1..=1i64).flat_map(|dy| (-1..=1i64).map(move |dx| (x + dx, y + dy)));
    neighbors.fold(waves, |height, (i, j)| {
        let cell = [i.rem_euclid(PORES), j.rem_euclid(PORES), 0];
        let place =
            DVec2::new(i as f64 + 0.2 + 0.6 * at_lattice(cell, 71), j as f64 + 0.2 + 0.6 * at_lattice(cell, 72));
        let radius = 0.32 + 0.2 * at_lattice(cell, 73);
        let t = (1.0 - p.distance_squared(place) / (radius * radius)).max(0.0);
        height - 0.5 * radius * t * t
    })
}

/// Boards of dark wood, which repeat.
pub fn wood() -> Picture {
    const BOARDS: f64 = 4.0;
    painted([TABLE_PIXELS; 2], |uv| {
        let board = (BOARDS * uv.y).floor();
        let within = BOARDS * uv.y - board;
        let shift = at_lattice([board as i64, 0, 0], 80);
        let noise = |x: i64, y: i64, seed: u32| {
            repeating(DVec3::new(x as f64 * (uv.x + shift), y as f64 * uv.y, 0.0), [x, y, 1], seed)
        };
        let bend = 0.5 * noise(3, 12, 81) + 0.12 * noise(12, 24, 82);
        let phase = 7.0 * (within + bend) + 3.0 * shift;
        let ring = phase - phase.floor();
        let rings = step(0.0, 0.7, ring) * (1.0 - step(0.8, 1.0, ring));
        let fibers = 0.6 * noise(10, 160, 83) + 0.4 * noise(20, 256, 84);
        let tone = 0.45 * rings + 0.55 * fibers + 0.5 * (shift - 0.5);
        let color = DVec3::new(84.0, 54.0, 38.0).lerp(DVec3::new(134.0, 90.0, 60.0), tone.clamp(0.0, 1.0));
        let edge = within.min(1.0 - within);
        color * (0.35 + 0.65 * step(0.0, 0.02, edge))
    })
}

/// A picture of these columns and rows, whose colors are those of the middles of its texels.
fn painted([width, height]: [usize; 2], color: impl Fn(DVec2) -> DVec3) -> Picture {
    let mut picture = Picture::new(width, height, [0; 3]);
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let uv = DVec2::new((x as f64 + 0.5) / width as f64, (y as f64 + 0.5) / height as f64);
        let codes = color(uv).to_array().map(|c| (c + 0.5).floor().clamp(0.0, 255.0) as u8);
        picture.dot(x, y, codes);
    }
    picture
}

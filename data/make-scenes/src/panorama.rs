//! Equirectangular pictures as Radiance HDR files of the kind that `--environment` takes: their middle towards +X, columns
//! on to the right towards +Z, top row +Y.

use glam::{DVec2, DVec3};

use crate::turned::circle;

/// Largest length of a run, and of values without one.
const LONGEST: usize = 127;
/// Shortest run that is worth its two bytes.
const SHORTEST: usize = 3;

/// A picture of these columns and rows, whose scanlines are not compressed.
pub fn flat(size: [usize; 2], radiance: impl Fn(DVec3) -> DVec3) -> Vec<u8> {
    let mut bytes = header(size);
    rows(size, radiance).flatten().for_each(|pixel| bytes.extend(pixel));
    bytes
}

/// The same with runs of equal values.
pub fn compressed(size: [usize; 2], radiance: impl Fn(DVec3) -> DVec3) -> Vec<u8> {
    let mut bytes = header(size);
    for row in rows(size, radiance) {
        bytes.extend([2, 2, (size[0] >> 8) as u8, (size[0] & 255) as u8]);
        for component in 0..4 {
            let values: Vec<u8> = row.iter().map(|pixel| pixel[component]).collect();
            runs(&values, &mut bytes);
        }
    }
    bytes
}

fn header([width, height]: [usize; 2]) -> Vec<u8> {
    format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes()
}

fn rows(size: [usize; 2], radiance: impl Fn(DVec3) -> DVec3) -> impl Iterator<Item = Vec<[u8; 4]>> {
    let fine = fine_circle(size[0]);
    (0..size[1]).map(move |row| {
        let pixel = |column| rgbe(radiance(direction(&fine, column, row)));
        (0..size[0]).map(pixel).collect()
    })
}

/// One component of a scanline: runs of equal values, and values between them.
fn runs(values: &[u8], bytes: &mut Vec<u8>) {
    let run_at = |at: usize| values[at..].iter().take(LONGEST).take_while(|v| **v == values[at]).count();
    let mut at = 0;
    while at < values.len() {
        let run = run_at(at);
        if run >= SHORTEST {
            bytes.extend([128 + run as u8, values[at]]);
            at += run;
            continue;
        }
        let end = (at + 1..values.len().min(at + LONGEST)).find(|k| run_at(*k) >= SHORTEST);
        let end = end.unwrap_or(values.len().min(at + LONGEST));
        bytes.push((end - at) as u8);
        bytes.extend(&values[at..end]);
        at = end;
    }
}

/// Unit direction through the middle of a pixel. Both angles are taken from the same table of a circle, which has four
/// steps for a column: a column's middle is two on, and a row is as wide as a column.
fn direction(fine: &[DVec2], column: usize, row: usize) -> DVec3 {
    let azimuth = fine[(4 * column + 2 + fine.len() / 2) % fine.len()];
    let elevation = fine[(fine.len() / 4 + fine.len() - (4 * row + 2)) % fine.len()];
    DVec3::new(elevation.x * azimuth.x, elevation.y, elevation.x * azimuth.y)
}

fn fine_circle(columns: usize) -> Vec<DVec2> {
    let mut around = circle();
    while around.len() < 4 * columns {
        let next = |k: usize| around[(k + 1) % around.len()];
        around = (0..around.len()).flat_map(|k| [around[k], (around[k] + next(k)).normalize()]).collect();
    }
    around
}

/// A pixel in RGBE: three mantissas of eight bits and their common exponent.
fn rgbe(color: DVec3) -> [u8; 4] {
    let (mut scale, mut exponent) = (1.0, 0i32);
    while color.max_element() * scale >= 1.0 {
        (scale, exponent) = (0.5 * scale, exponent + 1);
    }
    while color.max_element() * scale < 0.5 && exponent > -127 {
        (scale, exponent) = (2.0 * scale, exponent - 1);
    }
    let [r, g, b] = (color * scale * 256.0).to_array().map(|x| x as u8);
    [r, g, b, (exponent + 128) as u8]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_is_towards_x_and_the_top_is_up() {
        let fine = fine_circle(128);
        assert!(direction(&fine, 64, 32).distance(DVec3::X) < 0.05);
        assert!(direction(&fine, 96, 32).distance(DVec3::Z) < 0.05);
        assert!(direction(&fine, 5, 0).distance(DVec3::Y) < 0.05);
    }

    #[test]
    fn colors_are_kept_to_a_part_in_128() {
        let color = DVec3::new(3.0, 0.75, 1.5);
        let [r, g, b, e] = rgbe(color);
        let scale = (f64::from(e) - 136.0).exp2();
        assert!((DVec3::new(r.into(), g.into(), b.into()) * scale).distance(color) < 3.0 / 128.0);
    }

    #[test]
    fn runs_are_the_values() {
        let values: Vec<u8> = [vec![7; 300], vec![1, 2, 2, 3, 3, 3, 3], (0..200).collect(), vec![9; 3]].concat();
        let (mut bytes, mut read, mut at) = (Vec::new(), Vec::new(), 0);
        runs(&values, &mut bytes);
        while at < bytes.len() {
            let count = usize::from(bytes[at]);
            if count > 128 {
                read.extend(vec![bytes[at + 1]; count - 128]);
                at += 2;
            } else {
                read.extend(&bytes[at + 1..=at + count]);
                at += 1 + count;
            }
        }
        assert_eq!(read, values);
    }
}

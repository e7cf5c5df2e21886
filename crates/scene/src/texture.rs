//! Textures: pictures of eight-bit sRGB, interpolated in linear light.

use color::srgb;
use glam::{DVec3, DVec4};
use std::sync::{Arc, LazyLock};

/// A decoded picture. `v` is 0 at the top of its first row.
#[derive(Debug, PartialEq, Eq)]
pub struct Picture {
    /// Texels per row.
    pub width: usize,
    /// Red, green and blue as sRGB codes, and alpha, row after row.
    pub texels: Vec<[u8; 4]>,
}

/// How a picture continues beyond its edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

/// A picture and its sampler.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// Textures may share a picture.
    pub picture: Arc<Picture>,
    /// Wrap modes along `u` and `v`.
    pub wrap: [Wrap; 2],
    /// True for the nearest texel instead of bilinear interpolation.
    pub nearest: bool,
}

/// The linear value of each code of sRGB.
static LINEAR: LazyLock<[f64; 256]> = LazyLock::new(|| std::array::from_fn(|code| srgb::decode_byte(code as u8)));

impl Wrap {
    /// The index of the texel, of `count`, that `index` is mapped to.
    fn texel(self, index: i64, count: i64) -> i64 {
        match self {
            Wrap::Repeat => index.rem_euclid(count),
            Wrap::Clamp => index.clamp(0, count - 1),
            Wrap::Mirror => {
                let twice = index.rem_euclid(2 * count);
                twice.min(2 * count - 1 - twice)
            }
        }
    }
}

impl Texture {
    /// Linear red, green and blue, and alpha, at texture coordinates.
    pub fn at(&self, coordinates: [f64; 2]) -> DVec4 {
        self.decoded_at(coordinates, Texture::linear)
    }

    /// The codes of the channels over 255, as they are: numbers instead of colors.
    pub fn numbers_at(&self, coordinates: [f64; 2]) -> DVec4 {
        self.codes_at(coordinates) / 255.0
    }

    /// The codes from 0 to 255, for pictures whose numbers are no colors.
    pub fn codes_at(&self, coordinates: [f64; 2]) -> DVec4 {
        self.decoded_at(coordinates, |codes| DVec4::from_array(codes.map(f64::from)))
    }

    #[inline(always)]
    fn decoded_at(&self, [u, v]: [f64; 2], decode: impl Fn([u8; 4]) -> DVec4) -> DVec4 {
        let (width, height) = (self.picture.width, self.picture.texels.len() / self.picture.width);
        let [x, y] = [u * width as f64, v * height as f64];
        if self.nearest {
            return decode(self.texel(x.floor() as i64, y.floor() as i64));
        }
        // The center of a texel is half a texel from its edges.
        let [x, y] = [x - 0.5, y - 0.5];
        let [left, top] = [x.floor(), y.floor()];
        let row = |j: i64| {
            let i = left as i64;
            decode(self.texel(i, j)).lerp(decode(self.texel(i.saturating_add(1), j)), x - left)
        };
        row(top as i64).lerp(row((top as i64).saturating_add(1)), y - top)
    }

    fn texel(&self, i: i64, j: i64) -> [u8; 4] {
        let Picture { width, texels } = &*self.picture;
        let [x, y] = [self.wrap[0].texel(i, *width as i64), self.wrap[1].texel(j, (texels.len() / width) as i64)];
        texels[y as usize * width + x as usize]
    }

    /// Linear red, green and blue, and alpha, of a texel.
    pub(crate) fn linear([r, g, b, a]: [u8; 4]) -> DVec4 {
        DVec3::from_array([r, g, b].map(|c| LINEAR[c as usize])).extend(f64::from(a) / 255.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A texture whose red is the column and whose green is the row.
    fn texture(wrap: Wrap, nearest: bool) -> Texture {
        let texels = (0..6).map(|k| [k % 3, k / 3, 0, 51 * k]).collect();
        Texture { picture: Arc::new(Picture { width: 3, texels }), wrap: [wrap; 2], nearest }
    }

    /// Seen to catch: `v` upwards; a mirror that does not repeat the edge texel; a remainder with the sign of the
    /// index.
    #[test]
    fn beyond_the_edges() {
        let rows = [
            (Wrap::Repeat, [2, 0, 1, 2, 0, 1, 2, 0]),
            (Wrap::Mirror, [0, 0, 1, 2, 2, 1, 0, 0]),
            (Wrap::Clamp, [0, 0, 1, 2, 2, 2, 2, 2]),
        ];
        for (wrap, expected) in rows {
            let texture = texture(wrap, true);
            for (k, code) in expected.into_iter().enumerate() {
                let u = (k as f64 - 0.5) / 3.0;
                assert_eq!(texture.at([u, 0.2]).x, LINEAR[code], "{wrap:?} at {u}");
                assert_eq!(texture.at([u, 0.2]).y, 0.0);
                assert_eq!(texture.at([u, 0.8]).y, LINEAR[1]);
            }
            assert!(texture.at([1e30, -1e30]).is_finite());
        }
    }

    /// Seen to catch: the half texel left out.
    #[test]
    fn between_texels_light_is_linear() {
        let texture = texture(Wrap::Clamp, false);
        let texel = |k: u8| DVec4::new(LINEAR[k as usize % 3], LINEAR[k as usize / 3], 0.0, 0.2 * f64::from(k));
        assert!(texture.at([0.5, 0.25]).abs_diff_eq(texel(1), 1e-15));
        let mean = (texel(1) + texel(2)) * 0.5;
        assert!(texture.at([2.0 / 3.0, 0.25]).abs_diff_eq(mean, 1e-15));
        let four = (texel(0) + texel(1) + texel(3) + texel(4)) * 0.25;
        assert!(texture.at([1.0 / 3.0, 0.5]).abs_diff_eq(four, 1e-15));
        assert!(texture.at([-5.0, 7.0]).abs_diff_eq(texel(3), 1e-15));
    }
}

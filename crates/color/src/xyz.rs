//! The matrices between linear red, green and blue and CIE X, Y, Z.

/// Rows of a matrix.
pub type Matrix = [[f64; 3]; 3];

/// X, Y, Z of a chromaticity, with Y = 1.
const fn tristimulus([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// The matrix from linear red, green and blue to X, Y, Z relative to those of white, by CIE x and y of the primaries
/// and of white. The brightnesses of the primaries follow from the condition that together they make white.
pub const fn from_rgb([red, green, blue]: [[f64; 2]; 3], white: [f64; 2]) -> Matrix {
    let (columns, white) = ([tristimulus(red), tristimulus(green), tristimulus(blue)], tristimulus(white));
    let mut matrix = [[0.0; 3]; 3];
    let mut i = 0;
    while i < 9 {
        matrix[i / 3][i % 3] = columns[i % 3][i / 3];
        i += 1;
    }
    let brightness = multiply(inverse(matrix), white);
    i = 0;
    while i < 9 {
        matrix[i / 3][i % 3] *= brightness[i % 3] / white[i / 3];
        i += 1;
    }
    matrix
}

const fn multiply(matrix: Matrix, v: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = matrix;
    [
        a[0] * v[0] + a[1] * v[1] + a[2] * v[2],
        b[0] * v[0] + b[1] * v[1] + b[2] * v[2],
        c[0] * v[0] + c[1] * v[1] + c[2] * v[2],
    ]
}

/// The inverse of a matrix by cofactors.
pub const fn inverse(m: Matrix) -> Matrix {
    let mut inverse = [[0.0; 3]; 3];
    let mut i = 0;
    while i < 9 {
        let ([a, b], [c, d]) = ([(i / 3 + 1) % 3, (i / 3 + 2) % 3], [(i % 3 + 1) % 3, (i % 3 + 2) % 3]);
        inverse[i % 3][i / 3] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        i += 1;
    }
    let determinant = m[0][0] * inverse[0][0] + m[0][1] * inverse[1][0] + m[0][2] * inverse[2][0];
    i = 0;
    while i < 9 {
        inverse[i / 3][i % 3] /= determinant;
        i += 1;
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LUMINANCE, PRIMARIES, WHITE};

    #[test]
    fn luminance_of_the_primaries() {
        for (found, expected) in from_rgb(PRIMARIES, WHITE)[1].iter().zip(LUMINANCE) {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
    }
}

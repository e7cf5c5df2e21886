//! A sparse matrix, row by row, and the conjugate gradient method.

/// A sparse matrix.
#[derive(Clone, Debug)]
pub struct Sparse {
    /// The columns and values of all rows, row after row.
    entries: Vec<(u32, f64)>,
    /// Where each row ends among them.
    ends: Vec<u32>,
}

impl Sparse {
    /// Each row lists columns and values.
    pub fn new(rows: Vec<Vec<(u32, f64)>>) -> Sparse {
        let lengths = rows.iter().scan(0, |end, row| {
            *end += row.len() as u32;
            Some(*end)
        });
        Sparse { ends: lengths.collect(), entries: rows.into_iter().flatten().collect() }
    }

    fn rows(&self) -> impl Iterator<Item = &[(u32, f64)]> {
        self.ends.iter().scan(0, |start, end| {
            let row = &self.entries[*start..*end as usize];
            *start = *end as usize;
            Some(row)
        })
    }

    /// `A v`.
    pub fn times(&self, v: &[f64]) -> Vec<f64> {
        self.rows().map(|row| row.iter().map(|(j, a)| a * v[*j as usize]).sum()).collect()
    }

    /// `Aᵀ v`.
    pub fn transposed_times(&self, v: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; v.len()];
        for (row, x) in self.rows().zip(v) {
            row.iter().for_each(|(j, a)| result[*j as usize] += a * x);
        }
        result
    }

    /// The diagonal of `Aᵀ W A` for a diagonal `W`.
    pub fn gram_diagonal(&self, w: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; w.len()];
        for (row, w) in self.rows().zip(w) {
            row.iter().for_each(|(j, a)| result[*j as usize] += w * a * a);
        }
        result
    }
}

/// Largest number of steps of [`solve`], and the relative residual at which it ends.
const STEPS: usize = 300;
const RESIDUAL: f64 = 1e-3;

/// Solves `A x = b` for a positive definite `A` by conjugate gradients, preconditioned by the diagonal of `A`.
pub fn solve(multiply: impl Fn(&[f64]) -> Vec<f64>, diagonal: &[f64], b: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; b.len()];
    let mut residual = b.to_vec();
    let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(diagonal).map(|(r, d)| r / d).collect() };
    let mut z = scaled(&residual);
    let mut direction = z.clone();
    let mut rz = dot(&residual, &z);
    let enough = RESIDUAL * RESIDUAL * rz;
    for _ in 0..STEPS {
        if rz <= enough {
            break;
        }
        let image = multiply(&direction);
        let step = rz / dot(&direction, &image);
        for k in 0..b.len() {
            x[k] += step * direction[k];
            residual[k] -= step * image[k];
        }
        z = scaled(&residual);
        let next = dot(&residual, &z);
        let growth = next / rz;
        rz = next;
        direction.iter_mut().zip(&z).for_each(|(d, z)| *d = z + growth * *d);
    }
    x
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_of_three_is_solved() {
        let a =
            Sparse::new(vec![vec![(0, 4.0), (1, 1.0)], vec![(0, 1.0), (1, 3.0), (2, 1.0)], vec![(1, 1.0), (2, 2.0)]]);
        let known = [1.0, -2.0, 3.0];
        let b = a.times(&known);
        let x = solve(|v| a.times(v), &[4.0, 3.0, 2.0], &b);
        assert!(x.iter().zip(known).all(|(x, known)| (x - known).abs() < 1e-4), "{x:?}");
        assert_eq!(a.times(&known), a.transposed_times(&known));
    }
}

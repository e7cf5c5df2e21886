//! The choice of one cell of a grid in proportion to its weight, by numbers that stay well spread (hierarchical sample
//! warping, Clarberg et al. 2005).

use crate::random::BELOW_ONE;

/// Sums of weights over squares of 1, 2, 4, ... cells a side, the finest level first. Weights are relative to each
/// other, and the probability of a cell is computed from the stored sums: their rounding makes no error in a density.
#[derive(Debug)]
pub(super) struct HierarchicalSampler2d {
    levels: Vec<Level>,
    /// The weight that is stored as 1.
    unit: f64,
}

#[derive(Debug)]
struct Level {
    width: usize,
    height: usize,
    weights: Vec<f32>,
}

/// A chosen cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub column: usize,
    pub row: usize,
    pub probability: f64,
    /// The uniform numbers again, within the cell's share, in [0, 1).
    pub xi: [f64; 2],
}

impl Level {
    fn at(&self, column: usize, row: usize) -> f64 {
        let inside = column < self.width && row < self.height;
        if inside { f64::from(self.weights[row * self.width + column]) } else { 0.0 }
    }

    /// The sum over the square of four cells whose first one this is.
    fn square_sum(&self, x: usize, y: usize) -> f64 {
        self.at(x, y) + self.at(x + 1, y) + self.at(x, y + 1) + self.at(x + 1, y + 1)
    }

    /// Sums over squares of two cells a side.
    fn coarser(&self) -> Level {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let sum = |k: usize| self.square_sum(k % width * 2, k / width * 2) as f32;
        Level { width, height, weights: (0..width * height).map(sum).collect() }
    }
}

impl HierarchicalSampler2d {
    /// The grid of these weights, finite and not negative; `weight` takes column and row.
    pub fn new(width: usize, height: usize, weight: impl Fn(usize, usize) -> f64) -> HierarchicalSampler2d {
        let of = |k: usize| weight(k % width, k / width);
        let unit = (0..width * height).map(of).fold(0.0, f64::max);
        // A positive weight stays positive: no cell becomes impossible by rounding.
        let relative = |w: f64| if w > 0.0 { ((w / unit) as f32).max(f32::MIN_POSITIVE) } else { 0.0 };
        let weights = (0..width * height).map(|k| relative(of(k))).collect();
        let mut levels = vec![Level { width, height, weights }];
        while let Some(finer) = levels.last().filter(|l| l.weights.len() > 1) {
            levels.push(finer.coarser());
        }
        HierarchicalSampler2d { levels, unit }
    }

    /// Sum of all weights.
    pub fn total(&self) -> f64 {
        self.unit * self.levels.last().map_or(0.0, |top| top.at(0, 0))
    }

    /// The finest level that has no more than these numbers of columns and rows.
    pub fn level_within(&self, columns: usize, rows: usize) -> usize {
        self.levels.iter().position(|l| l.width <= columns && l.height <= rows).unwrap_or(0)
    }

    /// Columns and rows of a level.
    pub fn size(&self, level: usize) -> (usize, usize) {
        (self.levels[level].width, self.levels[level].height)
    }

    /// Sum of the weights below a cell of a level.
    pub fn weight(&self, level: usize, column: usize, row: usize) -> f64 {
        self.unit * self.levels[level].at(column, row)
    }

    /// The level of a single cell.
    pub fn top(&self) -> usize {
        self.levels.len() - 1
    }

    /// The cell that two uniform numbers choose; the total must not be 0.
    pub fn choose(&self, xi: [f64; 2]) -> Cell {
        self.choose_below(self.top(), Cell { column: 0, row: 0, probability: 1.0, xi })
    }

    /// The cell that is chosen below one of a coarser level, whose weight must not be 0.
    pub fn choose_below(&self, level: usize, from: Cell) -> Cell {
        let Cell { column: mut x, row: mut y, mut probability, mut xi } = from;
        for finer in self.levels[..level].iter().rev() {
            (x, y) = (2 * x, 2 * y);
            let [a, b, c, d] = [finer.at(x, y), finer.at(x + 1, y), finer.at(x, y + 1), finer.at(x + 1, y + 1)];
            let lower = split(&mut xi[1], a + b, c + d, &mut probability);
            let (left, right) = if lower { (c, d) } else { (a, b) };
            y += usize::from(lower);
            x += usize::from(split(&mut xi[0], left, right, &mut probability));
        }
        Cell { column: x, row: y, probability, xi }
    }

    /// The probability with which a cell is chosen below its ancestor on a level.
    pub fn probability(&self, level: usize, column: usize, row: usize) -> f64 {
        let share = |(k, finer): (usize, &Level)| {
            let (x, y) = (column >> k, row >> k);
            let own = finer.at(x, y);
            if own > 0.0 { own / finer.square_sum(x & !1, y & !1) } else { 0.0 }
        };
        self.levels[..level].iter().enumerate().map(share).product()
    }
}

/// True if the uniform number `xi` chooses the second of two weights. It becomes uniform again within the chosen one,
/// whose share `probability` is multiplied by.
pub(super) fn split(xi: &mut f64, first: f64, second: f64, probability: &mut f64) -> bool {
    let total = first + second;
    let target = *xi * total;
    // A second weight of 0 must not be chosen by rounding.
    let chosen = target >= first && second > 0.0;
    let (before, own) = if chosen { (first, second) } else { (0.0, first) };
    *probability *= own / total;
    *xi = ((target - before) / own).clamp(0.0, BELOW_ONE);
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every cell is chosen as often as its weight says, by its own probability, and the numbers left are uniform.
    ///
    /// Seen to catch: halves taken in the wrong order, a probability of one direction only, a border cell lost, a
    /// parent's cell divided by the sum of other cells.
    #[test]
    fn cells_are_chosen_in_proportion_to_their_weights() {
        let weights = [[1.0, 0.0, 3.0, 2.0, 4.0], [0.0, 0.0, 0.5, 1.5, 1e-60], [2.0, 6.0, 0.0, 0.0, 5.0]];
        let sampler = HierarchicalSampler2d::new(5, 3, |x, y| weights[y][x]);
        // Weights are rounded to float32.
        assert!((sampler.total() - 25.0).abs() < 1e-5);
        let n = 1000;
        let mut chosen = [[0u32; 5]; 3];
        let mut rest = [0.0; 2];
        for k in 0..n * n {
            let xi = [k % n, k / n].map(|i| (f64::from(i) + 0.5) / f64::from(n));
            let cell = sampler.choose(xi);
            chosen[cell.row][cell.column] += 1;
            assert!((cell.probability - weights[cell.row][cell.column] / 25.0).abs() < 1e-6);
            let again = sampler.probability(sampler.top(), cell.column, cell.row);
            assert!((again / cell.probability - 1.0).abs() < 1e-12);
            (0..2).for_each(|d| rest[d] += (cell.xi[d] - 0.5) / f64::from(n * n));
        }
        for (row, counts) in chosen.iter().enumerate() {
            for (column, count) in counts.iter().enumerate() {
                let (found, expected) = (f64::from(*count) / f64::from(n * n), weights[row][column] / 25.0);
                assert!((found - expected).abs() < 3e-3, "{row} {column}: {found}, not {expected}");
            }
        }
        assert!(rest.iter().all(|r| r.abs() < 1e-3), "{rest:?}");
        // A tiny weight still has a chance.
        assert!(sampler.weight(0, 4, 1) > 0.0 && sampler.weight(0, 1, 1) == 0.0);
        let last = sampler.choose([1.0 - f64::EPSILON / 2.0; 2]);
        assert_eq!((last.column, last.row), (4, 2));
    }

    #[test]
    fn below_a_cell_the_choice_is_among_its_own() {
        let sampler = HierarchicalSampler2d::new(8, 4, |x, y| (x + 8 * y) as f64);
        let level = sampler.level_within(4, 4);
        assert_eq!((level, sampler.size(level)), (1, (4, 2)));
        let weight = sampler.weight(level, 3, 1);
        assert!((weight - f64::from(22 + 23 + 30 + 31)).abs() < 1e-5);
        let cell = sampler.choose_below(level, Cell { column: 3, row: 1, probability: 0.25, xi: [0.999, 0.0] });
        assert_eq!((cell.column, cell.row), (7, 2));
        assert!((cell.probability - 0.25 * 23.0 / weight).abs() < 1e-6);
    }
}

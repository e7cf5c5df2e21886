//! The lit samples of one material as the estimators read them: blocks of sixteen, entry refraction done.

use bssrdf::{
    fresnel,
    lanes::{Block, LANES, Lane},
};
use formats::cloud::Sample;
use scene::DVec3;

/// What the sum needs of sixteen samples besides their positions.
#[derive(Clone, Debug)]
struct Rest {
    normal: [Lane; 3],
    refracted: [Lane; 3],
    /// `T12 Φ`, W.
    flux: [Lane; 3],
}

/// Samples that carry light into one medium. The last block is filled up with samples that carry none.
#[derive(Clone, Debug, Default)]
pub struct LitSamples {
    positions: Vec<[Lane; 3]>,
    rest: Vec<Rest>,
    len: usize,
}

/// The exitant point that a sum is for.
#[derive(Clone, Copy, Debug)]
pub struct Exit {
    /// `x_o` as float32, m.
    high: [f32; 3],
    /// What float32 left over of it: `x_o − x_i` then has the digits of float64.
    low: [f32; 3],
    /// `n_o`.
    pub normal: [f32; 3],
    /// Random numbers of this gather.
    pub key: u64,
}

impl Exit {
    pub fn new(position: DVec3, normal: DVec3, key: u64) -> Exit {
        let high = position.as_vec3();
        let low = (position - high.as_dvec3()).as_vec3();
        Exit { high: high.to_array(), low: low.to_array(), normal: normal.as_vec3().to_array(), key }
    }

    /// `x_o − x_i`, m.
    #[inline(always)]
    pub fn offset(&self, position: [f32; 3]) -> [f32; 3] {
        [0, 1, 2].map(|c| (self.high[c] - position[c]) + self.low[c])
    }
}

impl LitSamples {
    /// Refracts every sample into a medium of relative index `eta`; what is reflected wholly is left out.
    pub fn new(samples: impl Iterator<Item = Sample>, eta: f64) -> LitSamples {
        let mut lit = LitSamples::default();
        let mut last = None;
        for sample in samples {
            let Some(entry) = fresnel::enter(sample.normal, sample.direction, eta) else {
                continue;
            };
            let flux = sample.flux.as_dvec3() * entry.transmittance;
            lit.push(sample.position.to_array(), sample.normal, entry.direction, flux);
            last = Some((sample.position.to_array(), sample.normal, entry.direction));
        }
        let len = lit.len;
        while let Some((position, normal, refracted)) = last.filter(|_| lit.len % LANES != 0) {
            lit.push(position, normal, refracted, DVec3::ZERO);
        }
        lit.len = len;
        lit
    }

    fn push(&mut self, position: [f32; 3], normal: DVec3, refracted: DVec3, flux: DVec3) {
        let lane = self.len % LANES;
        if lane == 0 {
            let zero = [[0.0; LANES]; 3];
            self.positions.push(zero);
            self.rest.push(Rest { normal: zero, refracted: zero, flux: zero });
        }
        let block = self.len / LANES;
        for c in 0..3 {
            self.positions[block][c][lane] = position[c];
            self.rest[block].normal[c][lane] = normal[c] as f32;
            self.rest[block].refracted[c][lane] = refracted[c] as f32;
            self.rest[block].flux[c][lane] = flux[c] as f32;
        }
        self.len += 1;
    }

    /// Samples, fillers not counted.
    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Positions of all blocks, m.
    #[inline(always)]
    pub fn positions(&self) -> &[[Lane; 3]] {
        &self.positions
    }

    /// One whole block as seen from `exit`, with its flux.
    #[inline(always)]
    pub fn block(&self, index: usize, exit: &Exit) -> (Block, [Lane; 3]) {
        let (positions, rest) = (&self.positions[index], &self.rest[index]);
        let mut offset = [[0.0; LANES]; 3];
        for c in 0..3 {
            for i in 0..LANES {
                offset[c][i] = (exit.high[c] - positions[c][i]) + exit.low[c];
            }
        }
        (Block { offset, normal_in: rest.normal, refracted: rest.refracted }, rest.flux)
    }

    /// Any sixteen samples as seen from `exit`, with their flux.
    #[inline(always)]
    pub fn pick(&self, indices: &[u32; LANES], exit: &Exit) -> (Block, [Lane; 3]) {
        let zero = [[0.0; LANES]; 3];
        let (mut block, mut flux) = (Block { offset: zero, normal_in: zero, refracted: zero }, zero);
        for (i, index) in indices.iter().enumerate() {
            let (b, lane) = (*index as usize / LANES, *index as usize % LANES);
            let (positions, rest) = (&self.positions[b], &self.rest[b]);
            for c in 0..3 {
                block.offset[c][i] = (exit.high[c] - positions[c][lane]) + exit.low[c];
                block.normal_in[c][i] = rest.normal[c][lane];
                block.refracted[c][i] = rest.refracted[c][lane];
                flux[c][i] = rest.flux[c][lane];
            }
        }
        (block, flux)
    }
}

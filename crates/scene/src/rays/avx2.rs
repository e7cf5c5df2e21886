//! AVX2: twice the rays per second of the plain version, where they meet something.
//!
//! The one invariant: an [`Avx2`] exists only on a processor that has the features, because only [`Avx2::detect`] makes
//! one. Loads and stores go through references to arrays of their size and need no alignment.
#![allow(unsafe_code)]

use super::{
    node::Node,
    ray::BoxRay,
    triangle::{Crossings, Leaf, TriangleTest},
    vectors::{Query, Vectors},
};
use std::arch::x86_64::*;

/// Bytes of a cache line.
const LINE: usize = 64;

/// The proof that the processor has AVX2 and BMI1.
#[derive(Clone, Copy)]
pub(super) struct Avx2(());

impl Avx2 {
    #[inline(always)]
    pub fn detect() -> Option<Avx2> {
        (is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi1")).then_some(Avx2(()))
    }

    /// Runs a query that is compiled for these features.
    #[inline(always)]
    pub fn run<Q: Query>(self, query: Q) -> Q::Found {
        // SAFETY: the processor has the features, or `self` would not exist.
        unsafe { run(query, self) }
    }
}

#[target_feature(enable = "avx2,bmi1")]
fn run<Q: Query>(query: Q, vectors: Avx2) -> Q::Found {
    query.run(vectors)
}

impl Vectors for Avx2 {
    #[inline(always)]
    fn boxes(self, node: &Node, ray: &BoxRay, limit: f32) -> ([f32; 8], u32) {
        // SAFETY: the processor has the features, or `self` would not exist.
        unsafe { boxes(node, ray, limit) }
    }

    #[inline(always)]
    fn triangles(self, leaf: &Leaf, test: &TriangleTest, limit: f64) -> (Crossings, u32) {
        // SAFETY: as above.
        unsafe { triangles(leaf, test, limit) }
    }

    #[inline(always)]
    fn prefetch<T>(self, value: &T) {
        let start = std::ptr::from_ref(value).cast::<i8>();
        for line in (0..size_of::<T>()).step_by(LINE) {
            // SAFETY: nothing is read, whatever the address.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(line)) };
        }
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn boxes(node: &Node, ray: &BoxRay, limit: f32) -> ([f32; 8], u32) {
    // SAFETY: eight numbers are read from an array of eight.
    let load = |values: &[f32; 8]| unsafe { _mm256_loadu_ps(values.as_ptr()) };
    let (mut near, mut far) = (_mm256_setzero_ps(), _mm256_set1_ps(limit));
    for axis in 0..3 {
        let (origin, inverse) = (_mm256_set1_ps(ray.origin[axis]), _mm256_set1_ps(ray.inverse[axis]));
        let [first, last] = node.planes(axis, ray).map(|p| _mm256_mul_ps(_mm256_sub_ps(load(p), origin), inverse));
        // If the first argument is not a number, these return the second.
        near = _mm256_max_ps(first, near);
        far = _mm256_min_ps(last, far);
    }
    let mut entries = [0.0; 8];
    // SAFETY: eight numbers are written to an array of eight.
    unsafe { _mm256_storeu_ps(entries.as_mut_ptr(), near) };
    (entries, _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32)
}

/// [`TriangleTest::crossings`].
#[inline]
#[target_feature(enable = "avx2")]
fn triangles(leaf: &Leaf, test: &TriangleTest, limit: f64) -> (Crossings, u32) {
    // SAFETY: four numbers are read from an array of four.
    let load = |values: &[f32; 4]| unsafe { _mm256_cvtps_pd(_mm_loadu_ps(values.as_ptr())) };
    let [origin_x, origin_y, origin_z] = test.origin.map(|x| _mm256_set1_pd(x));
    let [shear_x, shear_y, shear_z] = test.shear.map(|x| _mm256_set1_pd(x));
    let [xs, ys, zs] = test.axes.map(|axis| &leaf.corners[axis]);
    let corner = |k: usize| {
        let z = _mm256_sub_pd(load(&zs[k]), origin_z);
        let x = _mm256_sub_pd(_mm256_sub_pd(load(&xs[k]), origin_x), _mm256_mul_pd(shear_x, z));
        let y = _mm256_sub_pd(_mm256_sub_pd(load(&ys[k]), origin_y), _mm256_mul_pd(shear_y, z));
        [x, y, z]
    };
    let (a, b, c) = (corner(0), corner(1), corner(2));
    let area = |p: [__m256d; 3], q: [__m256d; 3]| _mm256_sub_pd(_mm256_mul_pd(p[0], q[1]), _mm256_mul_pd(p[1], q[0]));
    let (u, v, w) = (area(c, b), area(a, c), area(b, a));
    let low = _mm256_min_pd(_mm256_min_pd(u, v), w);
    let high = _mm256_max_pd(_mm256_max_pd(u, v), w);
    let zero = _mm256_setzero_pd();
    let crosses = _mm256_xor_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(low, zero), _mm256_cmp_pd::<_CMP_GT_OQ>(high, zero));
    let weighted = _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(u, a[2]), _mm256_mul_pd(v, b[2])), _mm256_mul_pd(w, c[2]));
    let sum = _mm256_add_pd(_mm256_add_pd(u, v), w);
    let distance = _mm256_mul_pd(shear_z, _mm256_div_pd(weighted, sum));
    let within = _mm256_and_pd(
        _mm256_cmp_pd::<_CMP_LE_OQ>(zero, distance),
        _mm256_cmp_pd::<_CMP_LE_OQ>(distance, _mm256_set1_pd(limit)),
    );
    let store = |value: __m256d| {
        let mut values = [0.0; 4];
        // SAFETY: four numbers are written to an array of four.
        unsafe { _mm256_storeu_pd(values.as_mut_ptr(), value) };
        values
    };
    let crossings = Crossings { distances: store(distance), areas: [store(u), store(v), store(w)] };
    (crossings, _mm256_movemask_pd(_mm256_and_pd(crosses, within)) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        random::{Item, Purpose, Stream},
        rays::{ray::Ray, vectors::Plain},
    };
    use glam::{DVec3, Vec3};
    use std::array::from_fn;

    /// One of few numbers, so that rays run through edges, corners and planes of boxes.
    fn coarse(item: Item, dimension: u64) -> f64 {
        (item.uniform(dimension) * 9.0).floor() - 4.0
    }

    fn ray(item: Item) -> Ray {
        let [origin, direction] = [0, 3].map(|d| DVec3::from_array(from_fn(|k| coarse(item, d + k as u64))));
        let direction = if direction == DVec3::ZERO { DVec3::NEG_Y } else { direction.normalize() };
        Ray { origin, direction, inverse: 1.0 / direction, skipped: 0.0, from: None }
    }

    #[test]
    fn boxes_are_met_alike_with_and_without_avx2() {
        let Some(avx2) = Avx2::detect() else { return };
        let mut met = 0;
        for k in 0..20_000 {
            let item = Stream::new(1, Purpose::Surface).item(k);
            let mut node = Node::EMPTY;
            for slot in 0..7 {
                let d = 10 + 6 * slot as u64;
                let corner = |e: u64| from_fn(|axis| coarse(item, d + e + axis as u64) as f32);
                let [a, b]: [[f32; 3]; 2] = [corner(0), corner(3)];
                node.set(slot, a.into(), from_fn(|i| a[i].max(b[i])).into(), 0);
            }
            let ray = ray(item).for_boxes();
            let limit = [f32::INFINITY, 3.0][(k % 2) as usize];
            let [one, two] = [Plain.boxes(&node, &ray, limit), avx2.boxes(&node, &ray, limit)];
            assert_eq!(one.0.map(f32::to_bits), two.0.map(f32::to_bits), "item {k}");
            assert_eq!(one.1, two.1, "item {k}");
            assert!(one.1 < 128, "the eighth has no box");
            assert!(one.0.iter().all(|x| x.is_sign_positive() && !x.is_nan()), "item {k}: {:?}", one.0);
            met += one.1.count_ones();
        }
        assert!((3_000..100_000).contains(&met), "{met} boxes");
    }

    #[test]
    fn triangles_are_met_alike_with_and_without_avx2() {
        let Some(avx2) = Avx2::detect() else { return };
        let mut met = 0;
        for k in 0..20_000 {
            let item = Stream::new(2, Purpose::Surface).item(k);
            let corner =
                |t: u32, c: usize| from_fn(|i| coarse(item, u64::from(9 * t) + (3 * c + i) as u64 + 10) as f32);
            let leaf = Leaf::new(&[0, 1, 2], |t| from_fn(|c| Vec3::from_array(corner(t, c))));
            let ray = ray(item);
            let test = TriangleTest::new(ray.origin, ray.direction);
            let limit = [f64::INFINITY, 3.0][(k % 2) as usize];
            let [(plain, one), (wide, two)] =
                [Plain.triangles(&leaf, &test, limit), avx2.triangles(&leaf, &test, limit)];
            assert_eq!(one, two, "item {k}");
            assert!(one < 8, "the fourth is a point");
            for lane in (0..4).filter(|lane| one >> lane & 1 == 1) {
                let bits = |c: &Crossings| [c.distances, c.areas[0], c.areas[1], c.areas[2]].map(|x| x[lane].to_bits());
                assert_eq!(bits(&plain), bits(&wide), "item {k}");
                assert!((0.0..=limit).contains(&plain.distances[lane]), "item {k}");
            }
            met += one.count_ones();
        }
        assert!((1_000..30_000).contains(&met), "{met} triangles");
    }
}

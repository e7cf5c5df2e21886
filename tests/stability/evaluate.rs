//! One pair of points by every model: in float64, in float32 lanes, and through every estimator.

use bssrdf::{
    Exitant, Incident, Medium, Model, Separation, evaluate,
    lanes::{Block, LANES},
};
use formats::cloud::{Cloud, Record, Sample};
use gather::{
    estimator::{Estimator, Scatterer},
    samples::{Exit, LitSamples},
};
use glam::{DVec3, Vec3};
use std::{cell::RefCell, rc::Rc};
use test_support::{
    lit::{scatterer, sum},
    pipeline::{ESTIMATORS, MODELS},
    planted::{alternating, cloud_of},
};

/// Value of one model, R, G, B; 1/(m² sr).
#[derive(Clone, Copy, Debug)]
pub struct Value {
    pub model: Model,
    /// In float64.
    pub exact: DVec3,
    /// In float32 lanes.
    pub fast: DVec3,
}

impl Value {
    /// Relative difference of the two; 0 where both vanish, and below what float32 can hold.
    pub fn error(&self) -> f64 {
        let of = |c: usize| {
            let (exact, fast) = (self.exact[c], self.fast[c]);
            if exact.max(fast) < 1e-30 { 0.0 } else { (fast / exact - 1.0).abs() }
        };
        of(0).max(of(1)).max(of(2))
    }
}

/// Fails unless the two evaluations of every model agree.
pub fn assert_close(values: &[Value], tolerance: f64) {
    for value in values {
        assert!(value.error() < tolerance, "{value:?} differ by {:.1e}", value.error());
    }
}

/// Fails unless `value` is `expected`, each channel.
pub fn assert_is(what: &str, value: DVec3, expected: DVec3, tolerance: f64) {
    for c in 0..3 {
        let error = if value[c] == expected[c] { 0.0 } else { (value[c] / expected[c] - 1.0).abs() };
        assert!(error <= tolerance, "{what}, channel {c}: {:e} is not {:e}: {error:.1e}", value[c], expected[c]);
    }
}

fn assert_sane(value: DVec3, what: impl std::fmt::Debug) {
    assert!(value.is_finite() && value.min_element() >= 0.0, "{value}: {what:?}");
}

/// The directional dipole among [`MODELS`].
pub const DIRECTIONAL: usize = 1;
const _: () = assert!(matches!(MODELS[DIRECTIONAL], Model::DirectionalDipole));

/// `S_bare` by all models.
pub fn bare(medium: &Medium, separation: &Separation) -> [Value; MODELS.len()] {
    MODELS.map(|model| {
        let of = model.of(medium);
        let exact = DVec3::from_array([0, 1, 2].map(|c| of.bare(c, separation)));
        let fast = in_float32(model, medium, separation);
        assert_sane(exact, (model, medium, separation));
        assert_sane(fast, (model, medium, separation));
        Value { model, exact, fast }
    })
}

fn in_float32(model: Model, medium: &Medium, s: &Separation) -> DVec3 {
    let lanes = |v: DVec3| v.as_vec3().to_array().map(|x| [x; LANES]);
    let block = Block { offset: lanes(s.offset), normal_in: lanes(s.normal_in), refracted: lanes(s.refracted) };
    let values = model.lanes(medium).bare(&block, s.normal_out.as_vec3().to_array());
    DVec3::from_array(values.map(|lane| f64::from(lane[0])))
}

thread_local! {
    /// Caches the last cloud of one sample and the last scatterers of a medium: sweeps ask for the same ones again
    /// and again.
    static CLOUD: RefCell<Option<(Sample, Rc<Cloud>)>> = const { RefCell::new(None) };
    static SCATTERERS: RefCell<Option<(Medium, Rc<[Scatterer; MODELS.len()]>)>> = const { RefCell::new(None) };
}

/// The cached value of this key, or a new one.
fn kept<K: Clone + PartialEq, V>(last: &RefCell<Option<(K, Rc<V>)>>, key: &K, make: impl FnOnce() -> V) -> Rc<V> {
    match &mut *last.borrow_mut() {
        Some((k, value)) if k == key => value.clone(),
        other => {
            let value = Rc::new(make());
            *other = Some((key.clone(), value.clone()));
            value
        }
    }
}

/// `S_gather` by all models, as the exhaustive sum gives it for a cloud of one sample. The cut, which has
/// nothing to choose from, must give exactly that. Every rule of the roulette must give it divided by the acceptance
/// probability, or zero; at the sample itself it must accept.
pub fn gather(medium: &Medium, incident: &Incident, exitant: &Exitant) -> [Value; MODELS.len()] {
    let Incident { position, normal, direction } = *incident;
    let sample = Sample { position: position.as_vec3(), normal, direction, flux: Vec3::ONE };
    let cloud = CLOUD.with(|last| kept(last, &sample, || cloud_of(&alternating([sample]))));
    let scatterers = SCATTERERS.with(|last| kept(last, medium, || MODELS.map(|m| scatterer(m, medium))));
    let samples = LitSamples::new(&cloud, &cloud.meta().materials[0].halves[0], medium.eta);
    let exit = |key: u64| Exit::new(exitant.position, exitant.normal, key);
    [0, 1, 2, 3].map(|k| {
        let (model, scatterer) = (MODELS[k], &scatterers[k]);
        let of = model.of(medium);
        let value = |c| evaluate(&*of, medium.eta, c, incident, exitant).gather;
        let exact = DVec3::from_array([0, 1, 2].map(value));
        let fast = sum(scatterer, &samples, &exit(0), Estimator::Exhaustive).radiance;
        assert_sane(exact, (model, medium, incident, exitant));
        assert_sane(fast, (model, medium, incident, exitant));
        for (estimator, key) in ESTIMATORS.into_iter().flat_map(|e| (0..8).map(move |key| (e, key))) {
            let chosen = sum(scatterer, &samples, &exit(key), estimator).radiance;
            assert_sane(chosen, (model, estimator, medium, incident, exitant));
            let weighted = chosen.cmpge(fast * (1.0 - 1e-6)).all();
            let refused = chosen == DVec3::ZERO && exitant.position != position;
            let fits = match estimator {
                Estimator::Roulette(_) => weighted || refused,
                _ => chosen == fast,
            };
            assert!(fits, "{model:?} {estimator:?}: {chosen} of {fast}");
        }
        Value { model, exact, fast }
    })
}

/// Light onto the origin of the plane z = 0, from `direction` as a cloud stores it, to within 5·10⁻⁵.
pub fn onto_plane(direction: DVec3) -> Incident {
    let direction = direction.normalize();
    let sample = Sample { position: Vec3::ZERO, normal: DVec3::Z, direction, flux: Vec3::ONE };
    Incident { position: DVec3::ZERO, normal: DVec3::Z, direction: Record::new(&sample).sample().direction }
}

/// Straight out of the plane z = 0.
pub fn out_of_plane(x: f64) -> Exitant {
    Exitant { position: DVec3::new(x, 0.0, 0.0), normal: DVec3::Z, direction: DVec3::Z }
}

/// Light that enters the plane z = 0 at normal incidence and leaves it at the offset `x`.
pub fn along_plane(x: f64) -> Separation {
    Separation { offset: DVec3::new(x, 0.0, 0.0), normal_in: DVec3::Z, refracted: DVec3::NEG_Z, normal_out: DVec3::Z }
}

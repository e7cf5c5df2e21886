//! One walk.

use crate::{
    boundary::{Boundary, Meeting, Passage, Smooth},
    domain::{Crossing, Domain, Flight},
    matter::Matter,
    phase::{scatter, scatter_by},
    random::{FIRST, Sequence},
};
use glam::DVec3;

/// Where a walk begins: on the boundary, below it.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// m.
    pub position: DVec3,
    /// Unit, into the medium.
    pub direction: DVec3,
    /// The face that it lies on.
    pub face: Option<u32>,
}

/// Where a walk leaves.
#[derive(Clone, Copy, Debug)]
pub struct Exit {
    pub face: u32,
    /// m.
    pub position: DVec3,
    /// Unit, outside.
    pub direction: DVec3,
    /// Cosine of that direction from the outward normal.
    pub cosine: f64,
    /// The share of the walk's light that leaves.
    pub weight: f64,
}

/// How a walk ends.
#[derive(Clone, Copy, Debug)]
pub enum End {
    /// It leaves after one collision or more.
    Scattered(Exit),
    /// It leaves without a collision: this light is not part of what a BSSRDF describes.
    Unscattered(Exit),
    /// Roulette ended it, in place of absorption.
    Absorbed,
    /// It met an opaque surface inside the medium.
    Opaque,
    /// It left through a hole of the surface.
    Hole,
    /// It was reflected inside [`MAX_REFLECTIONS`] times in a row without a collision: the medium is too clear for its
    /// object.
    Trapped,
}

/// A point where light is scattered.
#[derive(Clone, Copy, Debug)]
pub struct Collision {
    /// m.
    pub position: DVec3,
    /// Unit direction of flight before it; none where the walk arrives from all directions alike.
    pub direction: Option<DVec3>,
    /// The share of the walk's light that is scattered there.
    pub weight: f64,
    /// What is known of the distance to the nearest surface, m: no surface is nearer.
    pub clearance: f64,
    /// The flight's [`Flight::nesting`].
    pub nesting: u32,
}

/// What watches a walk.
pub trait Observer {
    /// Whether it also wants the collisions inside the balls that walks jump through: one for each jump, which stands
    /// for all of them (docs/method.md 14.7).
    const SEES_JUMPS: bool;

    /// Sees a collision before the light is scattered.
    fn collide(&mut self, collision: &Collision, random: &mut Sequence);

    /// Sees where a walk of this weight meets the boundary after a collision, before it leaves or is reflected.
    fn meet(&mut self, meeting: &Meeting, weight: f64, random: &mut Sequence);
}

/// Nobody watches.
impl Observer for () {
    const SEES_JUMPS: bool = false;

    #[inline(always)]
    fn collide(&mut self, _: &Collision, _: &mut Sequence) {}

    #[inline(always)]
    fn meet(&mut self, _: &Meeting, _: f64, _: &mut Sequence) {}
}

/// Calls a function at the collisions outside of jumps.
struct Watch<F>(F);

impl<F: FnMut(&Collision, &mut Sequence)> Observer for Watch<F> {
    const SEES_JUMPS: bool = false;

    #[inline(always)]
    fn collide(&mut self, collision: &Collision, random: &mut Sequence) {
        self.0(collision, random);
    }

    #[inline(always)]
    fn meet(&mut self, _: &Meeting, _: f64, _: &mut Sequence) {}
}

/// Reflections without a collision after which a walk counts as trapped. In an object of a thousandth of a mean free
/// path, one walk in e³⁰ gets there.
pub const MAX_REFLECTIONS: u32 = 100_000;

/// Below [`LOW_WEIGHT`], a walk survives with the probability that its weight is of [`ROULETTE_WEIGHT`].
const LOW_WEIGHT: f64 = 0.1;
const ROULETTE_WEIGHT: f64 = 0.2;

/// Follows one walk below a smooth boundary to its end (docs/method.md section 14); `collide` sees every collision outside
/// of jumps, before the light is scattered.
pub fn walk<D: Domain>(
    domain: &D,
    matter: &Matter,
    start: &Start,
    random: &mut Sequence,
    collide: impl FnMut(&Collision, &mut Sequence),
) -> End {
    observed_walk(domain, matter, &Smooth { eta: matter.eta }, start, random, &mut Watch(collide))
}

/// Follows one walk below any boundary to its end while an observer sees it.
pub fn observed_walk<D: Domain, B: Boundary, O: Observer>(
    domain: &D,
    matter: &Matter,
    boundary: &B,
    start: &Start,
    random: &mut Sequence,
    observer: &mut O,
) -> End {
    let mut flight = Flight { position: start.position, direction: start.direction, from: start.face, nesting: 0 };
    let (mut weight, mut clearance, mut scattered, mut reflections) = (1.0, 0.0, false, 0);
    let mut first = random.take_first().map(First::new);
    loop {
        let free_path = first.as_mut().and_then(First::free_path).unwrap_or_else(|| random.exponential());
        let distance = free_path * matter.mean_free_path;
        if distance >= clearance {
            match domain.crossing(&mut flight, distance) {
                Crossing::Free => {}
                Crossing::Opaque => return End::Opaque,
                Crossing::Hole => return End::Hole,
                Crossing::Boundary { distance, face, normal } => {
                    let position = flight.position + flight.direction * distance;
                    let meeting = Meeting { position, face, normal, direction: flight.direction };
                    if scattered {
                        observer.meet(&meeting, weight, random);
                    }
                    let direction = match boundary.pass(&meeting, random) {
                        Passage::Out(direction) => direction,
                        Passage::Back(direction) => {
                            (flight.position, flight.direction, flight.from) = (position, direction, Some(face));
                            clearance = 0.0;
                            reflections += 1;
                            if reflections == MAX_REFLECTIONS {
                                return End::Trapped;
                            }
                            continue;
                        }
                    };
                    let exit = Exit { face, position, direction, cosine: direction.dot(normal), weight };
                    return if scattered { End::Scattered(exit) } else { End::Unscattered(exit) };
                }
            }
        }
        flight.position += flight.direction * distance;
        flight.from = None;
        (scattered, reflections) = (true, 0);
        weight *= matter.albedo;
        if !survives(&mut weight, random) {
            return End::Absorbed;
        }
        let Flight { position, direction, nesting, .. } = flight;
        clearance = domain.clearance(position);
        observer.collide(&Collision { position, direction: Some(direction), weight, clearance, nesting }, random);
        if clearance >= matter.jump_from
            && !jump(domain, matter, &mut flight, &mut weight, &mut clearance, random, observer)
        {
            return End::Absorbed;
        }
        flight.direction = match first.as_mut().and_then(First::scattering) {
            Some(xi) => scatter_by(flight.direction, matter.asymmetry, xi),
            None => scatter(flight.direction, matter.asymmetry, random),
        };
    }
}

/// The first numbers of a walk that were given, as far as they are not used yet.
struct First {
    free_paths: [Option<f64>; 2],
    scattering: Option<[f64; 2]>,
}

impl First {
    fn new([path, cosine, angle, second]: [f64; FIRST]) -> First {
        First { free_paths: [Some(path), Some(second)], scattering: Some([cosine, angle]) }
    }

    /// The next free path in mean free paths.
    fn free_path(&mut self) -> Option<f64> {
        let number = self.free_paths[0].take().or_else(|| self.free_paths[1].take());
        number.map(|u| -(1.0 - u).ln())
    }

    fn scattering(&mut self) -> Option<[f64; 2]> {
        self.scattering.take()
    }
}

/// Russian roulette: false if the walk ends.
#[inline(always)]
fn survives(weight: &mut f64, random: &mut Sequence) -> bool {
    if *weight >= LOW_WEIGHT {
        return true;
    }
    let survives = random.uniform() * ROULETTE_WEIGHT < *weight;
    *weight = ROULETTE_WEIGHT;
    survives
}

/// Moves a walk that was just scattered through balls without any surface (docs/method.md 14.4); false if roulette
/// ends it.
#[inline(always)]
fn jump<D: Domain, O: Observer>(
    domain: &D,
    matter: &Matter,
    flight: &mut Flight,
    weight: &mut f64,
    clearance: &mut f64,
    random: &mut Sequence,
    observer: &mut O,
) -> bool {
    // Light that flies along a direction is scattered about a point ahead (docs/method.md 14.6).
    let ahead = matter.asymmetry * matter.reduced_mean_free_path;
    if ahead != 0.0 {
        let center = flight.position + flight.direction * ahead;
        let around = domain.clearance(center);
        if around < matter.jump_from {
            return true;
        }
        if O::SEES_JUMPS {
            // The collisions that the factor below stands for, as those of a ball.
            let weight = *weight * matter.jump_collisions * ahead * ahead;
            let Flight { position, nesting, .. } = *flight;
            let collision = Collision { position, direction: None, weight, clearance: *clearance, nesting };
            observer.collide(&collision, random);
        }
        (flight.position, *clearance) = (center, around);
        // From all directions together, light is scattered about the collision itself.
        *weight *= ball_factor(matter.decay * ahead.abs());
    }
    while *clearance >= matter.jump_from {
        let radius = *clearance - matter.jump_gap;
        see_inside(matter, flight, *weight, radius, random, observer);
        flight.position += random.direction() * radius;
        *weight *= ball_factor(matter.decay * radius);
        if !survives(weight, random) {
            return false;
        }
        *clearance = domain.clearance(flight.position);
    }
    flight.direction = random.direction();
    true
}

/// `x/sinh(x)` of (docs/method.md 14.4).
#[inline(always)]
fn ball_factor(x: f64) -> f64 {
    // The series is exact to 1e-13 below this.
    if x < 1e-3 { 1.0 - x * x / 6.0 } else { x / x.sinh() }
}

/// Shows an observer one of the collisions inside the ball of a jump, with the weight of all of them.
#[inline(always)]
fn see_inside<O: Observer>(
    matter: &Matter,
    flight: &Flight,
    weight: f64,
    radius: f64,
    random: &mut Sequence,
    observer: &mut O,
) {
    if !O::SEES_JUMPS {
        return;
    }
    // The middle of three uniform numbers has the density 6t(1 − t).
    let [a, b, c] = [random.uniform(), random.uniform(), random.uniform()];
    let t = a.max(b).min(a.min(b).max(c));
    let x = matter.decay * radius;
    let decayed = if x < 1e-3 { 1.0 } else { (x * (1.0 - t)).sinh() / ((1.0 - t) * x.sinh()) };
    let weight = weight * matter.jump_collisions * radius * radius * decayed;
    let position = flight.position + random.direction() * (t * radius);
    let clearance = radius * (1.0 - t) + matter.jump_gap;
    observer.collide(&Collision { position, direction: None, weight, clearance, nesting: flight.nesting }, random);
}

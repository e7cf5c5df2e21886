//! Light of a point that is refracted in a plane.

use bsdf::fresnel;
use glam::DVec3;

/// A plane, by a point of it and its unit normal towards the light.
#[derive(Clone, Copy)]
pub struct Plane {
    pub point: DVec3,
    pub normal: DVec3,
}

/// The point of the plane at which light from `light` is refracted to `target` behind the plane (docs/method.md 14.9);
/// none if they are not on their sides. `eta` is the index behind the plane over that before it.
pub fn crossing(plane: Plane, light: DVec3, target: DVec3, eta: f64) -> Option<DVec3> {
    let height = plane.normal.dot(light - plane.point);
    let depth = -plane.normal.dot(target - plane.point);
    if height <= 0.0 || depth <= 0.0 {
        return None;
    }
    let (above, below) = (light - plane.normal * height, target + plane.normal * depth);
    let along = below - above;
    let distance = along.length();
    let share = if distance > 0.0 { share(height / distance, depth / distance, eta) } else { 0.0 };
    Some(above + along * share)
}

/// The root `u` in (0, 1) of `u/√(u² + h²) = η (1 − u)/√((1 − u)² + d²)`, whose left side grows and whose right side
/// falls: Newton's method, and bisection where that leaves the interval.
fn share(h: f64, d: f64, eta: f64) -> f64 {
    let (mut low, mut high, mut u) = (0.0, 1.0, h / (h + eta * d));
    for _ in 0..100 {
        let (v, a, b) = (1.0 - u, (u * u + h * h).sqrt(), ((1.0 - u) * (1.0 - u) + d * d).sqrt());
        let value = u / a - eta * v / b;
        if value < 0.0 {
            low = u
        } else {
            high = u
        }
        let slope = h * h / (a * a * a) + eta * d * d / (b * b * b);
        let next = u - value / slope;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - u).abs() <= 1e-14 {
            return next;
        }
        u = next;
    }
    u
}

/// The factor from the irradiance of the plane at the crossing to the fluence `E` behind it at `inside`, without the
/// medium's extinction: transmittance, and the spreading of a bundle of rays (docs/method.md 14.10). `outside` is the
/// distance of the light, infinite for parallel light.
pub fn gain(cosine: f64, refracted: f64, outside: f64, inside: f64, eta: f64) -> f64 {
    let share = if outside.is_finite() { inside / (outside * eta) } else { 0.0 };
    let (across, along) = (1.0 + share, 1.0 + share * cosine * cosine / (refracted * refracted));
    fresnel::transmittance(cosine, eta) / (refracted * across * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Snell's law holds at the crossing, and the gain is that of a thin bundle of rays.
    ///
    /// Seen to catch: the square of one cosine lost in the spreading; the index inverted in the root.
    #[test]
    fn a_bundle_of_rays_spreads_as_the_gain_says() {
        let plane = Plane { point: DVec3::ZERO, normal: DVec3::Z };
        for (eta, light, target) in [
            (1.3, DVec3::new(0.0, 0.0, 2.0), DVec3::new(1.5, 0.3, -0.7)),
            (2.0, DVec3::new(-3.0, 1.0, 0.2), DVec3::new(1.5, 0.3, -4.0)),
            (0.8, DVec3::new(0.3, 0.1, 2.0), DVec3::new(0.5, 0.3, -0.7)),
            (1.0, DVec3::new(0.3, 0.1, 2.0), DVec3::new(0.5, 0.3, -0.7)),
        ] {
            let refracted = |x: DVec3| {
                let towards = (light - x).normalize();
                (towards, fresnel::enter(DVec3::Z, towards, eta).expect("it enters").direction)
            };
            let x = crossing(plane, light, target, eta).expect("the light is in front");
            let (towards, direction) = refracted(x);
            let inside = x.distance(target);
            assert!(direction.distance((target - x) / inside) < 1e-9);
            // The bundle through a small parallelogram of the plane, and its cross-section at the target.
            let step = 1e-5;
            let through = |offset: DVec3| {
                let (_, direction) = refracted(x + offset);
                x + offset + direction * inside
            };
            let center = through(DVec3::ZERO);
            let [u, v] = [DVec3::X, DVec3::Y].map(|axis| (through(axis * step) - center) / step);
            let section = u.cross(v).dot(direction).abs();
            let cosines = (towards.z, -direction.z);
            let gain = gain(cosines.0, cosines.1, x.distance(light), inside, eta);
            assert!((gain * section / fresnel::transmittance(cosines.0, eta) - 1.0).abs() < 1e-3, "{eta}: {gain}");
        }
        assert!(crossing(plane, DVec3::NEG_Z, DVec3::NEG_Z, 1.3).is_none());
    }

    #[test]
    fn parallel_light_does_not_spread() {
        let far = gain(0.6, 0.8, 1e12, 1.0, 1.3333);
        assert!((far - gain(0.6, 0.8, f64::INFINITY, 1.0, 1.3333)).abs() < 1e-9);
    }
}

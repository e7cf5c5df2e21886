//! Media files.

use crate::file::with_file;
use bssrdf::{Medium, Model, Separation};
use scene::DVec3;

/// An accepted medium has finite coefficients and constants, and the values of every model are finite and not
/// negative.
pub fn medium(bytes: &[u8]) -> bool {
    let read = with_file("medium.json", bytes, |path| cli::read_medium(&path.to_string_lossy()));
    let Ok(medium) = read else { return false };
    check_medium(&medium);
    true
}

/// Checks what holds of every medium.
pub fn check_medium(medium: &Medium) {
    for c in &medium.channels {
        assert!([c.sigma_a, c.sigma_s].iter().all(|x| x.is_finite() && *x >= 0.0), "{c:?}");
        assert!((-1.0..=1.0).contains(&c.asymmetry) && (0.0..=1.0).contains(&c.reduced_albedo()), "{c:?}");
        assert!(
            !c.scatters() || (c.diffusion() > 0.0 && c.diffusion().is_finite() && c.transport().is_finite()),
            "{c:?}"
        );
    }
    let i = &medium.interface;
    let constants = [i.c_phi, i.c_e, i.exit_norm, i.reflection, i.reflection_egan];
    assert!(constants.iter().all(|x| x.is_finite()), "{i:?}");
    let path = medium.mean_free_path();
    for model in Model::ALL {
        let evaluator = model.of(medium);
        assert!(evaluator.transport().iter().all(|x| x.is_finite() && *x >= 0.0));
        assert!(model.unscattered_extinction(medium).iter().all(|x| x.is_finite() && *x >= 0.0));
        for channel in 0..3 {
            for distance in [0.0, 1e-6, 1e-3, 0.1 * path[channel], 10.0 * path[channel]] {
                let value = evaluator.bare(channel, &separation(distance.min(1e3)));
                assert!(
                    value.is_finite() && value >= 0.0,
                    "{model:?} {:?} {distance}: {value}",
                    medium.channels[channel]
                );
            }
        }
    }
}

/// Two points on a plane, m apart.
fn separation(distance: f64) -> Separation {
    let refracted = DVec3::new(0.3, 0.1, -1.0).normalize();
    Separation { offset: DVec3::X * distance, normal_in: DVec3::Z, refracted, normal_out: DVec3::Z }
}

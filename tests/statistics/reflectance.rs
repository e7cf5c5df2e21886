//! The table of reflectance errors behind the warnings to users, against random walks.

use bssrdf::Coefficients;
use test_support::{
    EFFORT,
    half_space::reflectance,
    pipeline::DIPOLES,
    walk::{Matter, slab},
};

/// The table has two decimals; its own walks have a standard error below 0.0005 of the incident light.
fn tolerance(walk: f64, model: f64, walk_error: f64) -> f64 {
    0.005 + 4.5 * walk_error.hypot(5e-4) * model / (walk * walk)
}

/// Seen to catch: a row moved by one albedo; the columns of the indices exchanged.
#[test]
fn the_table_of_reflectance_errors_is_what_random_walks_say() {
    let albedos: &[f64] = match EFFORT {
        1 => &[0.1, 0.9, 0.99],
        _ => &[0.02, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999],
    };
    for (k, albedo) in albedos.iter().copied().enumerate() {
        for (j, eta) in [1.3, 1.5].into_iter().enumerate() {
            let matter = Matter { albedo, asymmetry: 0.0, eta };
            let walk = slab(&matter, f64::INFINITY, 1.0, 20_000 * EFFORT, 900 + (2 * k + j) as u64).reflected;
            for model in DIPOLES {
                let value = reflectance(model, albedo, eta, 1.0);
                let channel = Coefficients { sigma_a: 1.0 - albedo, sigma_s: albedo, asymmetry: 0.0 };
                let table = model.reflectance_error(&channel, eta);
                let error = value / walk.mean - 1.0;
                let room = tolerance(walk.mean, value, walk.error);
                assert!((table - error).abs() < room, "{} {albedo} {eta}: {table} {error} ± {room}", model.name());
            }
        }
    }
}

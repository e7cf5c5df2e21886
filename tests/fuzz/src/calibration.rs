//! The facts of a calibration, which `bincode` decodes, in a file whose checksum is right.

use crate::file::with_file;
use calibration::{Factors, Site};
use formats::calibration::{Calibration, seal};
use scene::DVec3;

/// An accepted calibration is the same after it was written and read again, and its factors are finite and positive at
/// any point of space.
pub fn calibration(facts: &[u8]) -> bool {
    with_file("a.calibration", &seal(facts), |path| {
        let Ok(read) = Calibration::read(path) else { return false };
        let again = read.encode(path).expect("it fitted a file");
        assert_eq!(again, seal(facts));
        for material in &read.materials {
            let factors = Factors::new(material);
            for at in [0.0, 1e-3, 1.0, 1e6] {
                let site = Site { position: DVec3::splat(at), normal: DVec3::Z };
                let factor = factors.at(&site, DVec3::new(0.6, 0.0, 0.8));
                assert!(factor.is_finite(), "{factor}");
            }
        }
        true
    })
}

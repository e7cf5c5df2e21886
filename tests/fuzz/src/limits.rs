//! Limits files of `compare`.

use crate::file::with_file;
use compare::read_limits;

/// Accepted limits are numbers that images can be compared with.
pub fn limits(bytes: &[u8]) -> bool {
    let Ok(limits) = with_file("limits.json", bytes, read_limits) else { return false };
    assert!(!limits.is_empty());
    for limit in &limits {
        assert!(!limit.reason.trim().is_empty());
        for number in [limit.gate.limit(), limit.gate.threshold().unwrap_or(0.0)] {
            assert!(number.is_finite() && number >= 0.0, "{number}");
        }
    }
    true
}

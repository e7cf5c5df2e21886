//! Limits files of `compare`.

use crate::file::with_file;
use compare::{Gate, read_limits};

/// Accepted limits are numbers that images can be compared with.
pub fn limits(bytes: &[u8]) -> bool {
    let Ok(limits) = with_file("limits.json", bytes, read_limits) else { return false };
    assert!(!limits.is_empty());
    for limit in &limits {
        assert!(!limit.reason.trim().is_empty());
        let number = match limit.gate {
            Gate::Bias(x) | Gate::RelMse(x) | Gate::Rmse(x) | Gate::Abs(x) | Gate::Flip(x) => x,
            Gate::Outliers { threshold, .. } => threshold,
            Gate::Exact => 0.0,
        };
        assert!(number.is_finite() && number >= 0.0, "{number}");
    }
    true
}

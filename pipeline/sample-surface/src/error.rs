//! Why a scene cannot be sampled.

use cli::{count, count_up};

/// Why a scene cannot be sampled.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    #[error("the scene has no light")]
    NoLight,
    #[error(transparent)]
    Lost(#[from] scene::LostVolumes),
    #[error("no surface to sample: all of them emit")]
    NoSurface,
    #[error("shares of {sum} in all; {wanted}")]
    ShareSum { sum: f64, wanted: &'static str },
    #[error("{} samples have an error of {error:.2e}; the target needs about {}, there is room for {}", count(*samples), count_up(*next as f64), count(*max_samples))]
    TooMany { samples: u64, error: f64, next: u64, max_samples: u64 },
    #[error("{} samples have a flux that is no finite number: are light intensities or sizes absurd?", count(*samples))]
    NotFinite { samples: u64 },
}

//! Refuses images of random walks that leave their medium through holes: they would lack that light.

use crate::image_jobs::ImageJob;
use cli::Failure;
use gather::{Passes, counts::Counts};

/// Of walks, this share may leave through holes of the surface.
const ESCAPED: f64 = 1e-3;

/// Paths of a step of the probe.
const STEP: u64 = 2048;

/// The walks and the paths that are enough, as paths may meet nothing translucent; and those if more than the allowed
/// share of the walks escaped.
const ENOUGH: [u64; 2] = [1 << 12, 1 << 15];
const IN_DOUBT: [u64; 2] = [1 << 18, 1 << 21];

/// Refuses an image of these counts. Its walks are never just those of the probe, so that it is asked at the end too.
pub fn check(counts: &Counts, job: &ImageJob) -> Result<(), Failure> {
    let share = share(counts);
    if share > ESCAPED {
        let message = format!(
            "--reference: {:.2} % of the random walks left through holes of the surface: the mesh is open, and has no \
             inside that light could be followed in; no image was written",
            100.0 * share
        );
        return Err(job.failure(Failure::usage(message)));
    }
    Ok(())
}

/// Refuses an image that will not do by a few thousand walks of its first paths, before it takes minutes. What they leave
/// in doubt is left to the end.
pub fn probe(passes: &Passes, job: &ImageJob) -> Result<(), Failure> {
    if !job.settings.reference {
        return Ok(());
    }
    let settings = &job.settings;
    let most = settings.part().pixels() as u64 * u64::from(settings.paths_per_pixel);
    let (mut counts, mut done) = (Counts::default(), 0);
    while done < most {
        let end = most.min(done + STEP);
        counts.add(&passes.first_paths(done..end));
        done = end;
        if is_beyond_doubt(&counts) {
            return check(&counts, job);
        }
        let [walks, paths] = if share(&counts) > ESCAPED { IN_DOUBT } else { ENOUGH };
        if counts.walks >= walks || done >= paths {
            break;
        }
    }
    Ok(())
}

fn share(counts: &Counts) -> f64 {
    counts.walks_escaped as f64 / counts.walks.max(1) as f64
}

/// Whether chance does not explain that so many walks escaped: four standard deviations, as those of the three channels
/// of a path may escape together, and three paths where few are expected.
fn is_beyond_doubt(counts: &Counts) -> bool {
    let allowed = ESCAPED * counts.walks as f64;
    counts.walks_escaped as f64 > allowed + 4.0 * (3.0 * allowed).sqrt() + 9.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_walks_decide_only_what_is_clear() {
        let of = |walks_escaped, walks| is_beyond_doubt(&Counts { walks_escaped, walks, ..Counts::default() });
        assert!(!of(0, 0) && !of(9, 9) && of(12, 12));
        // A mesh at the limit would be refused by chance.
        assert!(!of(20, 6000) && of(40, 6000) && !of(66, 1 << 16) && !of(120, 1 << 16) && of(150, 1 << 16));
    }
}

//! Adds paths in steps of a second or two, between which the image can be written as it is, and rendering can end.

use crate::{display::Display, image_jobs::ImageJob};
use cli::{Asked, Progress};
use gather::{Passes, Tile, Watch};
use std::{
    num::NonZeroUsize,
    time::{Duration, Instant},
};

/// The shortest step, which every image has: one path for each half of the cloud.
const FIRST: u32 = 2;

/// How long a step should take.
const STEP: Duration = Duration::from_secs(2);

/// The share of the time left that a step may be expected to take.
const SHARE: f64 = 0.9;

/// What goes on beside the render.
pub struct Live<'a> {
    /// When it must end.
    pub deadline: Option<Instant>,
    /// Whether the user wants to see what there is.
    pub asked: &'a Asked,
    /// Writes what there is.
    pub write: &'a (dyn Fn(&Passes) + Sync),
    pub display: Option<Display>,
}

/// The time that is left for the images of a run.
pub struct Clock {
    end: Option<Instant>,
}

/// How long a pixel takes from the sums to the disk, on one thread, s.
const WRITING_S: f64 = 3e-6;

impl Clock {
    /// Starts the time of a run.
    pub fn start(limit: Option<Duration>) -> Clock {
        Clock { end: limit.and_then(|limit| Instant::now().checked_add(limit)) }
    }

    /// The seconds that are left, if the time is limited.
    pub fn left(&self) -> Option<f64> {
        Some(self.end?.saturating_duration_since(Instant::now()).as_secs_f64())
    }

    /// When the next of so many images must be rendered, so that it can be written and the others have their share.
    pub fn deadline(&self, job: &ImageJob, images: usize, threads: NonZeroUsize) -> Option<Instant> {
        let now = Instant::now();
        let left = self.end?.saturating_duration_since(now).as_secs_f64() / images.max(1) as f64;
        let writing = WRITING_S * job.settings.part().pixels() as f64 / threads.get().min(8) as f64;
        Some(now + Duration::from_secs_f64((left - writing).max(0.0)))
    }
}

/// The steps of an image.
pub struct Steps<'a> {
    live: &'a Live<'a>,
    /// Whether paths can be added in any portions. Those of several clouds are planned together.
    divides: bool,
    /// How long a path of all pixels takes, s.
    per_path: Option<f64>,
}

impl<'a> Steps<'a> {
    pub fn new(live: &'a Live<'a>, clouds: usize) -> Steps<'a> {
        Steps { live, divides: clouds < 2, per_path: None }
    }

    /// Adds `paths` to each pixel; false if the time is up before.
    pub fn add(&mut self, passes: &mut Passes, paths: u32, progress: &Progress) -> bool {
        let end = passes.paths().saturating_add(paths);
        while passes.paths() < end {
            let has_image = passes.paths() > 0;
            let deadline = self.live.deadline.filter(|_| has_image);
            let step = self.next(end - passes.paths(), deadline);
            let start = Instant::now();
            let display = self.live.display.as_ref();
            let added = step > 0 && passes.pass(step, &Watched { progress, display, deadline });
            if !added {
                return false;
            }
            self.per_path = Some(start.elapsed().as_secs_f64() / f64::from(step));
            if self.live.asked.take() {
                (self.live.write)(passes);
            }
        }
        true
    }

    /// The paths of the next step, of those that are `left`; none if they would last beyond the deadline.
    fn next(&self, left: u32, deadline: Option<Instant>) -> u32 {
        let time =
            deadline.map_or(f64::INFINITY, |end| SHARE * end.saturating_duration_since(Instant::now()).as_secs_f64());
        if !self.divides {
            let lasts = self.per_path.unwrap_or(0.0) * f64::from(left);
            return if time > 0.0 && lasts <= time { left } else { 0 };
        }
        let Some(per_path) = self.per_path else {
            return if time > 0.0 { left.min(FIRST) } else { 0 };
        };
        let paths = |seconds: f64| (seconds / per_path) as u32;
        let wanted = paths(STEP.as_secs_f64()).max(FIRST).min(paths(time));
        // Both halves of the cloud have as many paths; the last path of an odd number is added with those before it.
        if wanted >= left { left } else { wanted / 2 * 2 }
    }
}

/// Tells progress and viewer of the tiles of a step.
struct Watched<'a> {
    progress: &'a Progress,
    display: Option<&'a Display>,
    deadline: Option<Instant>,
}

impl Watch for Watched<'_> {
    fn done(&self, tile: &Tile) {
        self.progress.add(tile.paths);
        if let Some(display) = self.display {
            display.show(tile);
        }
    }

    fn stops(&self) -> bool {
        self.deadline.is_some_and(|end| Instant::now() >= end)
    }
}

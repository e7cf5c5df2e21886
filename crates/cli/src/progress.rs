//! Progress of long steps: a bar on a terminal, two lines elsewhere.

use crate::{
    common::{Common, ProgressStyle},
    count::count,
    terminal::tell,
};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle as Template};
use std::{
    io::{IsTerminal, stderr},
    time::Instant,
};

/// Progress of one step. Each call of [`Progress::add`] should stand for some milliseconds of work.
pub struct Progress {
    bar: ProgressBar,
    plain: bool,
    name: &'static str,
    start: Instant,
}

impl Progress {
    /// Starts a step of `total` units.
    pub fn start(common: &Common, name: &'static str, total: u64, unit: &str) -> Progress {
        let shown = !common.quiet && common.progress != ProgressStyle::None;
        let drawn = shown && common.progress == ProgressStyle::Auto && stderr().is_terminal();
        let target = if drawn { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(total), target);
        if let Ok(template) = Template::with_template("{msg} [{wide_bar}] {percent}% of {prefix}, {eta} left") {
            bar.set_style(template.progress_chars("=> "));
        }
        bar.set_message(name);
        bar.set_prefix(format!("{} {unit}", count(total)));
        let plain = shown && !drawn;
        if plain {
            common.say(format_args!("{name}: {} {unit}", count(total)));
        }
        Progress { bar, plain, name, start: Instant::now() }
    }

    /// Counts work done.
    pub fn add(&self, units: u64) {
        self.bar.inc(units);
    }

    /// Ends the step; returns its seconds.
    pub fn finish(self) -> f64 {
        let seconds = self.start.elapsed().as_secs_f64();
        self.bar.finish_and_clear();
        if self.plain {
            tell(format_args!("{}: done in {seconds:.2} s", self.name));
        }
        seconds
    }
}

//! The parts that the programs share: arguments, files that are read and written, exit codes, progress, signals.
//!
//! A program parses its arguments ([`parse`]), of which [`Common`] and [`SceneArgs`] are parts, and calls [`run`] with its work.
//! [`Files`] declares what is read and written before the work; [`Common::in_pool`] does it on as many threads as asked
//! for; [`Progress`] and [`Seconds`] report on it. A [`Failure`] ends the program with a message and an exit code.
//!
//! ```
//! use cli::{count, one_of, parse_count};
//! use clap::{Arg, Command};
//!
//! // Counts are read as people write them, and printed likewise.
//! assert_eq!(parse_count("2.3M"), Ok(2_300_000));
//! assert_eq!(count(2_345_678), "2.35M");
//!
//! // Words of the command line stand for the values of a library's type.
//! #[derive(Clone, Copy, Debug, PartialEq)]
//! enum Side {
//!     Left,
//!     Right,
//! }
//! const SIDES: [Side; 2] = [Side::Left, Side::Right];
//! let name = |side: Side| if side == Side::Left { "left" } else { "right" };
//! let command = Command::new("turn").arg(Arg::new("side").value_parser(one_of(&SIDES, name)));
//! let matches = command.get_matches_from(["turn", "right"]);
//! assert_eq!(matches.get_one::<Side>("side"), Some(&Side::Right));
//! ```

mod allocator;
mod asked;
mod assign_media;
mod blended;
mod cloud_files;
mod common;
mod count;
mod environment;
mod failure;
mod files;
mod lit_scene;
mod manual;
mod medium;
mod memory;
mod named;
mod progress;
mod scene_args;
mod scene_settings;
mod seconds;
mod shell;
mod tables;
mod terminal;
mod threads;
mod truncated;
mod units;
mod values;

pub use asked::Asked;
pub use assign_media::{AssignError, assign_media};
pub use blended::Blended;
pub use cloud_files::CloudFiles;
pub use common::{Common, print};
pub use count::{count, count_up, parse_count};
pub use environment::EnvironmentSource;
pub use failure::{Failure, run};
pub use files::{Files, file_name, is_same_file};
pub use lit_scene::{LitScene, Media, declare_inputs};
pub use manual::parse;
pub use medium::{ReadMediumError, blended_media, is_file, read_medium, scene_medium};
pub use memory::{Need, available_memory_bytes, peak_memory_bytes, require_memory};
pub use named::{Candidate, Unclear, the_one, word_for};
pub use progress::Progress;
pub use scene_args::SceneArgs;
pub use scene_settings::{SceneSettings, normal_kind};
pub use seconds::Seconds;
pub use shell::quoted;
pub use tables::{
    bounds_line, camera_names, camera_table, made_camera_names, material_names, material_table, media_line,
};
pub use terminal::printable;
pub use units::{UnitChoice, stored_unit};
pub use values::{one_of, parse_duration, parse_relative_error, parse_rgb};

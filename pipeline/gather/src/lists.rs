//! Lists that the program prints instead of an image.

use crate::settings::SceneLists;
use bssrdf::{Medium, built_in, built_in_names};
use cli::{Failure, bounds_line, camera_table, material_table, media_line, printable};
use std::{fmt::Write, path::PathBuf};

/// Prints the built-in media.
pub fn media() -> Result<(), Failure> {
    let mut text = format!("{:<28} {:>6}  {:<32} {:<32} source\n", "name", "eta", "sigma_a, 1/mm", "sigma_s, 1/mm");
    for name in built_in_names() {
        let medium = built_in(name)?;
        let three = |v: [f64; 3]| v.map(|x| format!("{:.4e}", x / 1000.0)).join(" ");
        let (absorption, scattering) = (three(medium.map(|c| c.sigma_a)), three(medium.map(|c| c.sigma_s)));
        let source = citation(&medium);
        writeln!(text, "{name:<28} {:>6}  {absorption:<32} {scattering:<32} {source}", medium.eta)?;
    }
    cli::print(&text)
}

/// First author and year of a medium's source.
fn citation(medium: &Medium) -> String {
    let author = medium.source.split(',').next().unwrap_or_default();
    let is_year = |word: &&str| word.len() == 4 && word.parse::<u16>().is_ok();
    let words = medium.source.split_whitespace().map(|word| word.trim_end_matches(','));
    format!("{author} et al. {}", words.into_iter().find(is_year).unwrap_or_default())
}

/// Prints the cameras or the materials of a scene, or both.
pub fn scene(lists: &SceneLists) -> Result<(), Failure> {
    let scene = lists.scene.sized_by_file()?.import(&lists.common)?;
    let mut text = String::new();
    if lists.cameras {
        text += &camera_table(&scene);
    }
    if lists.materials {
        text += &material_table(&scene)?;
    }
    text += &bounds_line(&scene);
    if lists.materials {
        text += &media_line(&scene);
    }
    cli::print(&text)
}

/// Prints the paths of files, one a line.
pub fn paths(paths: &[PathBuf]) -> Result<(), Failure> {
    let lines = paths.iter().map(|path| format!("{}\n", printable(&path.to_string_lossy())));
    cli::print(&lines.collect::<String>())
}

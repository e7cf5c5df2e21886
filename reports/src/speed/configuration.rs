//! The configurations, scenes and media that are compared.

use bssrdf::Model;
use std::path::{Path, PathBuf};

/// How `sample-surface` draws its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CloudKind {
    /// `--choice`
    pub choice: &'static str,
    /// `--pattern`
    pub pattern: &'static str,
}

/// How `gather` sums them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Summing {
    /// The note's roulette, with the acceptance rule that suits the medium.
    Roulette,
    /// The exhaustive sum.
    Exhaustive,
    /// The cut; none is the default accuracy.
    Cut(Option<f64>),
    /// Random walks instead of sums: exact, whatever the model.
    Walks,
}

/// A way to use the programs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Configuration {
    pub name: &'static str,
    pub cloud: CloudKind,
    pub summing: Summing,
    pub model: Model,
}

/// The model that is summed wherever sums are compared: the note's.
pub const MODEL: Model = Model::DirectionalDipole;

const INDEPENDENT_UNIFORM: CloudKind = CloudKind { choice: "uniform", pattern: "independent" };
pub const INDEPENDENT_AREA: CloudKind = CloudKind { choice: "area", pattern: "independent" };
const STRATIFIED_UNIFORM: CloudKind = CloudKind { choice: "uniform", pattern: "stratified" };
pub const STRATIFIED_AREA: CloudKind = CloudKind { choice: "area", pattern: "stratified" };

/// Accuracy of a gather that is as good as exact beside the error of a cloud.
pub const FINE: Summing = Summing::Cut(Some(0.003));

/// The configuration for errors so small that the default accuracy of the cut would show.
pub const FINE_NAME: &str = "all, accuracy 0.003";

/// All configurations: the note's settings, each ingredient alone, and all together.
pub const CONFIGURATIONS: [Configuration; 7] = [
    row("note", INDEPENDENT_UNIFORM, Summing::Roulette),
    row("area", INDEPENDENT_AREA, Summing::Roulette),
    row("stratified", STRATIFIED_UNIFORM, Summing::Roulette),
    row("area + stratified", STRATIFIED_AREA, Summing::Roulette),
    row("cut", INDEPENDENT_UNIFORM, Summing::Cut(None)),
    row("all", STRATIFIED_AREA, Summing::Cut(None)),
    row(FINE_NAME, STRATIFIED_AREA, FINE),
];

/// The programs as they are without options, but for the calibration.
pub const DEFAULTS: Configuration =
    Configuration { model: Model::HalfSpace, ..row("defaults", STRATIFIED_AREA, Summing::Cut(None)) };

/// `--samples` and `--spp` of the programs without options.
pub const DEFAULT_SAMPLES: u64 = 1_000_000;
pub const DEFAULT_PATHS: u64 = 16;

const fn row(name: &'static str, cloud: CloudKind, summing: Summing) -> Configuration {
    Configuration { name, cloud, summing, model: MODEL }
}

impl CloudKind {
    /// The name in tables.
    pub fn name(self) -> String {
        format!("{}, {}", self.choice, self.pattern)
    }
}

impl Configuration {
    /// Flags of `sample-surface`.
    pub fn sample_flags(&self) -> Vec<String> {
        ["--choice", self.cloud.choice, "--pattern", self.cloud.pattern].map(String::from).into()
    }

    /// Flags of `gather`, without those of a calibration.
    pub fn gather_flags(&self, medium: &Medium) -> Vec<String> {
        let accuracy;
        let how: &[&str] = match self.summing {
            Summing::Roulette => &["--estimator", "roulette", "--roulette", medium.rule],
            Summing::Exhaustive => &["--estimator", "exhaustive"],
            Summing::Cut(None) => &["--estimator", "cut"],
            Summing::Cut(Some(x)) => {
                accuracy = x.to_string();
                &["--estimator", "cut", "--accuracy", &accuracy]
            }
            Summing::Walks => return vec!["--reference".into()],
        };
        ["--bssrdf", self.model.name()].iter().chain(how).map(|f| (*f).to_owned()).collect()
    }

    /// `--bssrdf`; empty for random walks.
    pub fn model_name(&self) -> &'static str {
        if self.summing == Summing::Walks { "" } else { self.model.name() }
    }

    /// `--accuracy`, as the tables show it.
    pub fn accuracy(&self) -> String {
        match self.summing {
            Summing::Cut(Some(x)) => x.to_string(),
            Summing::Cut(None) => "default".into(),
            _ => String::new(),
        }
    }
}

/// A medium and the note's rule for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Medium {
    pub name: &'static str,
    /// `--roulette`: `mean` as in the note, `mixture` where the variance of `mean` is not finite.
    pub rule: &'static str,
}

pub const MARBLE: Medium = Medium { name: "marble", rule: "mean" };
pub const SKIM_MILK: Medium = Medium { name: "skimmilk", rule: "mean" };
pub const MEDIA: [Medium; 4] =
    [MARBLE, SKIM_MILK, Medium { name: "ketchup", rule: "mixture" }, Medium { name: "skin1", rule: "mixture" }];

/// A scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    pub name: String,
    pub path: PathBuf,
    /// Number of cameras in the file.
    pub cameras: usize,
    /// Flags of both programs.
    pub flags: &'static [&'static str],
    /// Flags that choose the camera.
    pub view: Vec<String>,
}

impl Subject {
    pub fn new(name: &str, path: PathBuf, cameras: usize) -> Subject {
        Subject { name: name.into(), path, cameras, flags: &[], view: Vec::new() }
    }
}

/// The scenes that were found; those of the folder of meshes may be missing.
pub struct Subjects {
    /// Bunny and dragon, or their replacement.
    pub main: Vec<Subject>,
    /// The scenes that other renderers were measured on.
    pub sphere_of_peers: Option<Subject>,
    pub bunny_of_peers: Option<Subject>,
    /// The scenes that are missing, in sentences.
    pub remarks: Vec<String>,
}

impl Subjects {
    /// Finds bunny and dragon in `meshes` and the scenes of the peers in the folder `peers` beside it, else takes the
    /// figure of the gallery.
    pub fn find(meshes: &Path, gallery: &Path) -> Subjects {
        let mut remarks = Vec::new();
        let mut found = |name: &str, path: PathBuf, cameras: usize| {
            if path.is_file() {
                return Some(Subject::new(name, path, cameras));
            }
            remarks.push(format!("`{}` is not there: {name} is left out.", short(&path)));
            None
        };
        let bunny = found("bunny", meshes.join("bunny.glb"), 3);
        let dragon = found("dragon", meshes.join("dragon.glb"), 2);
        let peers = meshes.join("../peers");
        let sphere_of_peers = found("sphere of the peers", peers.join("sphere.glb"), 1);
        let bunny_of_peers = found("bunny of the peers", peers.join("bunny.glb"), 1);
        let bunny_of_peers = bunny_of_peers.map(|s| Subject { flags: &["--normals", "geometric"], ..s });
        let mut main: Vec<Subject> = bunny.into_iter().chain(dragon).collect();
        if main.is_empty() {
            remarks.push("Instead of bunny and dragon, `data/scenes/figure.glb` is measured.".into());
            main.push(figure(gallery));
        }
        Subjects { main, sphere_of_peers, bunny_of_peers, remarks }
    }
}

/// The figure of the gallery, whose cameras are view files.
fn figure(gallery: &Path) -> Subject {
    let view = vec!["--view".into(), gallery.join("views/figure/front.json").display().to_string()];
    Subject { view, ..Subject::new("figure", gallery.join("scenes/figure.glb"), 0) }
}

/// The last two components of a path: documents do not mention folders of the machine.
fn short(path: &Path) -> String {
    let mut names: Vec<_> = path.iter().rev().take(2).map(|n| n.to_string_lossy()).collect();
    names.reverse();
    names.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_say_what_the_row_says() {
        let [note, .., all, fine] = CONFIGURATIONS;
        let dipole = ["--bssrdf", "directional-dipole", "--estimator"];
        assert_eq!(note.gather_flags(&MEDIA[2]), [&dipole[..], &["roulette", "--roulette", "mixture"]].concat());
        assert_eq!(note.gather_flags(&MARBLE)[5], "mean");
        assert_eq!(all.sample_flags(), ["--choice", "area", "--pattern", "stratified"]);
        assert_eq!(all.gather_flags(&MARBLE), [&dipole[..], &["cut"]].concat());
        assert_eq!(fine.gather_flags(&MARBLE), [&dipole[..], &["cut", "--accuracy", "0.003"]].concat());
        let walks = Configuration { summing: Summing::Walks, ..all };
        assert_eq!(walks.gather_flags(&MARBLE), ["--reference"]);
    }

    #[test]
    fn missing_meshes_are_replaced_and_named() {
        let subjects = Subjects::find(Path::new("/nowhere/meshes"), Path::new("/gallery"));
        assert_eq!(subjects.main.len(), 1);
        assert_eq!(subjects.main[0].name, "figure");
        assert_eq!(subjects.remarks.len(), 5);
        assert!(subjects.remarks[0].contains("`meshes/bunny.glb` is not there"), "{}", subjects.remarks[0]);
    }
}

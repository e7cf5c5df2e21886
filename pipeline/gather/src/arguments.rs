//! The command line: what the user typed.

use bssrdf::Model;
use clap::Parser;
use cli::{Common, SceneArgs, file_name, one_of, parse_duration, parse_relative_error};
use gather::{
    Crop, Filter,
    estimator::{Estimator, Rule},
};
use std::{path::PathBuf, time::Duration};

/// Renders a scene's translucent surfaces from a point cloud.
///
/// Lengths are metres, radiance W/(m² sr); media are in the unit that their file states.
#[derive(Parser)]
#[command(version, override_usage = "gather [OPTIONS] CLOUD... SCENE --output IMAGE.exr")]
pub struct Arguments {
    /// Clouds of sample-surface: one, or shards and seeds of one scene, which are gathered as one whatever their order;
    /// and last the scene that they were sampled from (with --list-cameras, --list-files or --list-materials, only the
    /// scene)
    #[arg(value_name = "CLOUD... SCENE", value_parser = file_name())]
    pub files: Vec<PathBuf>,
    /// OpenEXR image to write
    #[arg(short, long, value_name = "IMAGE.exr", value_parser = file_name(),
        required_unless_present_any = ["list_cameras", "list_files", "list_materials", "list_media"])]
    pub output: Option<PathBuf>,
    /// Camera of SCENE by its name, its node's name, or its index; index:N where a name could be taken for an index
    /// [default: the first]
    #[arg(long, value_name = "NAME|INDEX")]
    pub camera: Option<String>,
    /// Camera in a file of its own; beats --camera. A list of cameras makes as many images: IMAGE.NAME.exr by the
    /// view's name, or IMAGE.0000.exr by its index in the list; previews and statistics likewise
    #[arg(long, value_name = "FILE.json", value_parser = file_name())]
    pub view: Option<PathBuf>,
    /// Turn the camera about the vertical axis through the view's target, or through the middle of the translucent
    /// surfaces, in N equal steps: IMAGE.0000.exr and so on; previews and statistics likewise
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub orbit: Option<u32>,
    /// Width, pixels [default: 512, or by the height and the camera's aspect]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub width: Option<u32>,
    /// Height, pixels [default: by the camera's aspect]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub height: Option<u32>,
    /// Render only this part of the image: X columns from the left, Y rows from the top, W columns and H rows. Its
    /// values are those of the whole image
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_crop, conflicts_with = "target_error")]
    pub crop: Option<Crop>,
    /// Medium, by built-in name or from a file, of one material, by name or index:N, or of all materials (repeatable)
    /// [default: the media that SCENE gives its materials]
    #[arg(long, value_name = "[MATERIAL=]NAME|FILE.json")]
    pub medium: Vec<String>,
    /// BSSRDF model: how light scatters from point to point [default: that of --calibration, or half-space]
    #[arg(long, value_name = "MODEL", default_value_if("note", "true", "directional-dipole"),
        value_parser = one_of(&Model::ALL, Model::name))]
    pub bssrdf: Option<Model>,
    /// Calibration of `calibrate`, which brings its media along, or none [default: with --bssrdf half-space the shape
    /// is calibrated in memory first; other models are used as they were published]
    #[arg(long, value_name = "FILE|none", value_parser = file_name())]
    pub calibration: Option<PathBuf>,
    /// Sum over the cloud: hierarchical (cut), by the note's roulette, or over all samples (exhaustive)
    #[arg(long, value_name = "HOW", default_value = "cut", default_value_if("note", "true", "roulette"),
        value_parser = one_of(&Estimator::ALL, Estimator::name))]
    pub estimator: Estimator,
    /// Relative error that the cut may add to a pixel's scattered light [default: by the measured noise of the paths;
    /// 0.75 of a target error]
    #[arg(long, value_name = "X", value_parser = parse_relative_error)]
    pub accuracy: Option<f64>,
    /// Acceptance rule of the roulette; mean is the note's, and has unbounded variance in colored media
    #[arg(long, value_name = "RULE", default_value = "mixture", default_value_if("note", "true", "mean"),
        value_parser = one_of(&Rule::ALL, Rule::name))]
    pub roulette: Rule,
    /// Follow random walks through the medium instead of a BSSRDF, exact but slow: the truth to compare images with. Of
    /// CLOUD only its materials count
    #[arg(long, conflicts_with_all = ["bssrdf", "estimator", "accuracy", "roulette", "calibration"])]
    pub reference: bool,
    /// Camera paths per pixel; with --target-error, the largest number [default: 16, with --target-error 4096; with
    /// --reference 64 and 65536]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    pub spp: Option<u32>,
    /// Add paths until the image has this relative standard error, that of the cloud included: 95 of 100 images have an
    /// error of less than twice this
    #[arg(long, value_name = "X", value_parser = parse_relative_error)]
    pub target_error: Option<f64>,
    /// Stop after this time with the paths that there are, two of each pixel at least: 60s, 2m, 1h. Several images share
    /// what is left
    #[arg(long, value_name = "TIME", value_parser = parse_duration)]
    pub time_limit: Option<Duration>,
    /// Add the paths of --spp to those of this image, which was rendered with --keep-sums and the same settings: 16 and 48
    /// paths are the image of 64
    #[arg(long = "continue", value_name = "IMAGE.exr", value_parser = file_name())]
    pub continued: Option<PathBuf>,
    /// Also write IMAGE.sums, which --continue needs; --continue does so too
    #[arg(long)]
    pub keep_sums: bool,
    /// Spread the paths over the pixel (box), or send all through its center (point)
    #[arg(long, value_name = "FILTER", default_value = "box", value_parser = one_of(&Filter::ALL, Filter::name))]
    pub filter: Filter,
    /// Interface events that a path may have; paths that are cut off are counted
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub max_depth: u32,
    /// Show the camera a plain dark gray in place of the environment; surfaces still reflect and refract it
    #[arg(long)]
    pub backdrop: bool,
    #[command(flatten)]
    pub scene_args: SceneArgs,
    /// Layers to add to the image: albedo (color of the first surface), id (number of its material); separated by commas
    #[arg(long, value_name = "LAYERS", value_delimiter = ',', value_parser = one_of(&ExtraLayer::ALL, ExtraLayer::name))]
    pub layers: Vec<ExtraLayer>,
    /// Show the image in the viewer tev while it is rendered
    #[arg(long, value_name = "HOST:PORT", value_parser = parse_address)]
    pub display: Option<String>,
    /// Also write a tone-mapped picture
    #[arg(long, value_name = "FILE.png", value_parser = file_name())]
    pub preview: Option<PathBuf>,
    /// Brighten the preview by powers of two, beyond the exposure that it gives itself, which is the same for all views
    /// of the cloud in these media
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, value_parser = parse_stops, allow_hyphen_values = true)]
    pub exposure: f64,
    /// The preview does not expose itself: with 0 stops, a radiance of 0.18 is middle gray
    #[arg(long)]
    pub exposure_fixed: bool,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE", value_parser = file_name())]
    pub stats: Option<PathBuf>,
    /// Leave out of the image and its statistics everything that differs from run to run
    #[arg(long)]
    pub no_timings: bool,
    /// Print the cameras of SCENE
    #[arg(long)]
    pub list_cameras: bool,
    /// Print the materials of SCENE, with the media that it gives them
    #[arg(long)]
    pub list_materials: bool,
    /// Print the built-in media
    #[arg(long)]
    pub list_media: bool,
    /// Print the paths of the files that SCENE consists of, itself first
    #[arg(long)]
    pub list_files: bool,
    /// Print the paths of the images that --output becomes with this --view or --orbit
    #[arg(long)]
    pub list_images: bool,
    /// Print all lengths of media and objects, and warnings that sample-surface has printed
    #[arg(long)]
    pub verbose: bool,
    #[command(flatten)]
    pub common: Common,
}

/// A layer that an image has if it is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExtraLayer {
    Albedo,
    Id,
}

impl ExtraLayer {
    const ALL: [ExtraLayer; 2] = [ExtraLayer::Albedo, ExtraLayer::Id];

    fn name(self) -> &'static str {
        match self {
            ExtraLayer::Albedo => "albedo",
            ExtraLayer::Id => "id",
        }
    }
}

/// Checks `HOST:PORT`; the host is looked up later.
fn parse_address(text: &str) -> Result<String, String> {
    let parts = text.rsplit_once(':').filter(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok());
    parts.map(|_| text.to_owned()).ok_or_else(|| "expected HOST:PORT; tev listens at 127.0.0.1:14158".into())
}

fn parse_crop(text: &str) -> Result<Crop, String> {
    let expected = "expected X,Y,W,H: whole numbers of pixels, W and H at least 1";
    let numbers: Vec<u32> = text.split(',').map(|n| n.parse()).collect::<Result<_, _>>().map_err(|_| expected)?;
    match numbers[..] {
        [x, y, width, height] if width > 0 && height > 0 => {
            let [x, y, width, height] = [x, y, width, height].map(|n| n as usize);
            Ok(Crop { x, y, width, height })
        }
        _ => Err(expected.into()),
    }
}

fn parse_stops(text: &str) -> Result<f64, String> {
    let stops = text.parse().ok().filter(|x: &f64| x.abs() <= 64.0);
    stops.ok_or_else(|| "expected a number between -64 and 64".into())
}

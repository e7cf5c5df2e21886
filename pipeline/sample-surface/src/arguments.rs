//! The command line: what the user typed.

use clap::Parser;
use cli::{Common, SceneArgs, file_name, one_of, parse_count, parse_relative_error};
use formats::cloud::{Choice, Pattern, Shard};
use std::path::PathBuf;

/// Samples the lit surface of a scene into a point cloud, once for every camera and every medium.
///
/// Lengths are metres, radiance W/(m² sr), irradiance W/m², flux W.
#[derive(Parser)]
#[command(version)]
pub struct Arguments {
    /// Scene to light and sample: .glb or .gltf
    #[arg(value_parser = file_name())]
    pub scene: PathBuf,
    /// Cloud to write
    #[arg(short, long, value_name = "CLOUD", required_unless_present = "list_materials", value_parser = file_name())]
    pub output: Option<PathBuf>,
    /// Samples drawn over all translucent surfaces: 250k, 1M, 1e6
    #[arg(short = 'n', long, value_name = "K", default_value = "1M", value_parser = parse_samples)]
    pub samples: u64,
    /// Draw one shard of a cloud, with random numbers of its own: shard I of N, counted from 0. `gather` takes all
    /// shards together; --samples is the number of this shard, and need not be that of the others
    #[arg(long, value_name = "I/N", default_value = "0/1", value_parser = parse_shard)]
    pub shard: Shard,
    /// Draw as many samples as this medium needs to reach --target-error, judged by the half-space model
    #[arg(long, value_name = "NAME|FILE.json", requires = "target_error", conflicts_with = "samples")]
    pub for_medium: Option<String>,
    /// Relative standard error of the light that leaves the surface in the medium of --for-medium: 95 of 100 clouds
    /// have an error of less than twice this
    #[arg(long, value_name = "X", requires = "for_medium", value_parser = parse_relative_error)]
    pub target_error: Option<f64>,
    /// Material whose surfaces are sampled, by its name or index:N of --list-materials (repeatable) [default: those
    /// that the file marks as volumes; if it marks none, all that do not emit]
    #[arg(long, value_name = "NAME")]
    pub translucent: Vec<String>,
    /// Probability of a triangle: in proportion to its area, or uniform over all triangles as in the note
    #[arg(long, default_value = "area", default_value_if("note", "true", "uniform"),
        value_parser = one_of(Choice::ALL, Choice::name))]
    pub choice: Choice,
    /// Share of the samples that is drawn on the surfaces of one material (repeatable); the other materials share the
    /// rest by --choice
    #[arg(long, value_name = "MATERIAL=F", value_parser = parse_share)]
    pub share: Vec<(String, f64)>,
    /// How samples are spread: evenly, as a lattice along ribbons of triangles and with a scrambled sequence for the
    /// light, or independently as in the note
    #[arg(long, default_value = "stratified", default_value_if("note", "true", "independent"),
        value_parser = one_of(Pattern::ALL, Pattern::name))]
    pub pattern: Pattern,
    #[command(flatten)]
    pub scene_args: SceneArgs,
    /// Also write the cloud as binary PLY for viewers
    #[arg(long, value_name = "FILE", value_parser = file_name())]
    pub ply: Option<PathBuf>,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE", value_parser = file_name())]
    pub stats: Option<PathBuf>,
    /// Print the materials of SCENE
    #[arg(long)]
    pub list_materials: bool,
    #[command(flatten)]
    pub common: Common,
}

/// Fewer samples than this can be drawn: each of the two halves takes its numbers from one sequence.
pub const SAMPLES_LIMIT: u64 = 2 * scene::sequence::LENGTH;

/// Shards that a cloud can have.
const MAX_SHARDS: u32 = 65536;

fn parse_samples(text: &str) -> Result<u64, String> {
    match parse_count(text)? {
        0 => Err("at least one sample is needed".into()),
        SAMPLES_LIMIT.. => Err(format!("fewer than {SAMPLES_LIMIT} samples are possible")),
        count => Ok(count),
    }
}

fn parse_share(text: &str) -> Result<(String, f64), String> {
    let (name, share) = text.rsplit_once('=').ok_or("expected MATERIAL=F")?;
    let share = share.parse().ok().filter(|f: &f64| *f > 0.0 && *f < 1.0);
    Ok((name.to_owned(), share.ok_or("expected a share between 0 and 1")?))
}

fn parse_shard(text: &str) -> Result<Shard, String> {
    let (index, count) = text.split_once('/').ok_or("expected I/N, as 0/4")?;
    let number = |text: &str| text.parse::<u32>().map_err(|_| "expected I/N, two whole numbers");
    let shard = Shard { index: number(index)?, count: number(count)? };
    if shard.index < shard.count && shard.count <= MAX_SHARDS {
        return Ok(shard);
    }
    Err(format!("of N shards the first is 0 and the last N-1; N is 1 to {MAX_SHARDS}"))
}

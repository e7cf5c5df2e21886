//! `sample-surface SCENE -o CLOUD`: arguments and files; the phase itself is the library.

mod told;

use clap::Parser;
use cli::{
    Common, Failure, Files, Need, Progress, SceneArgs, count, file_name, is_file, material_table, parse_count,
    read_medium,
};
use formats::{
    atomic::{Group, Output},
    cloud::{self, Cloud, Options, Shard},
    write_ply,
};
use sample_surface::{
    Choice, Enough, Goal, Pattern, Plan, Round, SampleError, Sampled, Settings, sample, sample_enough,
};
use scene::{MeshDefects, Rays, Scene, light::Environment};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    time::{Instant, SystemTime},
};

/// Samples the lit surface of a scene into a point cloud, once for every camera and every medium.
///
/// Lengths are metres, radiance W/(m² sr), irradiance W/m², flux W.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Scene to light and sample: .glb or .gltf
    #[arg(value_parser = file_name())]
    scene: PathBuf,
    /// Cloud to write
    #[arg(short, long, value_name = "CLOUD", required_unless_present = "list_materials", value_parser = file_name())]
    output: Option<PathBuf>,
    /// Samples drawn over all translucent surfaces: 250k, 1M, 1e6
    #[arg(short = 'n', long, value_name = "K", default_value = "1M", value_parser = parse_samples)]
    samples: u64,
    /// Draw a part of a cloud, with random numbers of its own: part I of N, from 0. `gather` takes all parts
    /// together; --samples is this part's number, and need not be that of the others
    #[arg(long, value_name = "I/N", default_value = "0/1", value_parser = parse_shard)]
    shard: Shard,
    /// Draw as many samples as this medium needs for --target-error, by the directional dipole
    #[arg(long, value_name = "NAME|FILE.json", requires = "target_error", conflicts_with = "samples")]
    for_medium: Option<String>,
    /// Relative standard error of the light that leaves the surface, of --for-medium: 95 of 100 clouds are off by less
    /// than twice this
    #[arg(long, value_name = "X", requires = "for_medium", value_parser = parse_error)]
    target_error: Option<f64>,
    /// Material whose surfaces are sampled, by name or index:N of --list-materials (repeatable) [default: those the file marks as volumes; if there is none,
    /// all that do not emit]
    #[arg(long, value_name = "NAME")]
    translucent: Vec<String>,
    /// Which triangle: by area, or every one alike as in the note
    #[arg(long, default_value = "area", default_value_if("note", "true", "uniform"))]
    choice: Choice,
    /// Share of the samples that is drawn on the surfaces of one material (repeatable); the others share the rest by
    /// --choice
    #[arg(long, value_name = "MATERIAL=F", value_parser = parse_share)]
    share: Vec<(String, f64)>,
    /// Well-spread samples, or independent ones as in the note
    #[arg(long, default_value = "stratified", default_value_if("note", "true", "independent"))]
    pattern: Pattern,
    #[command(flatten)]
    scene_args: SceneArgs,
    /// Also write the cloud as binary PLY for viewers
    #[arg(long, value_name = "FILE", value_parser = file_name())]
    ply: Option<PathBuf>,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE", value_parser = file_name())]
    stats: Option<PathBuf>,
    /// Print the materials of SCENE
    #[arg(long)]
    list_materials: bool,
    #[command(flatten)]
    common: Common,
}

/// Bytes a sample takes while it is sampled, ordered and written: record, entry, tile, nodes and their moments.
const BYTES_PER_SAMPLE: u64 = 112;

/// Bytes of a sample in the file, with its part of the tree.
const BYTES_PER_STORED_SAMPLE: u64 = 40;

/// Bytes that a byte of a scene's file becomes, with the tree of its triangles. 36 bytes a triangle are 500 in memory.
const BYTES_PER_FILE_BYTE: u64 = 16;

/// Most samples: two halves of as many as a sequence has.
const MAX_SAMPLES: u64 = 2 * scene::sequence::LENGTH;

fn parse_error(text: &str) -> Result<f64, String> {
    let error = text.parse().ok().filter(|x: &f64| (1e-6..=1.0).contains(x));
    error.ok_or_else(|| "expected a number between 0.000001 and 1".into())
}

fn parse_share(text: &str) -> Result<(String, f64), String> {
    let (name, share) = text.rsplit_once('=').ok_or("expected MATERIAL=F")?;
    let share = share.parse().ok().filter(|f: &f64| *f > 0.0 && *f < 1.0);
    Ok((name.to_owned(), share.ok_or("expected a share between 0 and 1")?))
}

/// Most parts of a cloud.
const MAX_SHARDS: u32 = 65536;

fn parse_shard(text: &str) -> Result<Shard, String> {
    let (index, count) = text.split_once('/').ok_or("expected I/N, as 0/4")?;
    let number = |text: &str| text.parse::<u32>().map_err(|_| "expected I/N, two whole numbers");
    let shard = Shard { index: number(index)?, count: number(count)? };
    if shard.index < shard.count && shard.count <= MAX_SHARDS {
        return Ok(shard);
    }
    Err(format!("of N parts the first is 0 and the last N-1; N is 1 to {MAX_SHARDS}"))
}

fn parse_samples(text: &str) -> Result<u64, String> {
    match parse_count(text)? {
        0 => Err("at least one sample is needed".into()),
        MAX_SAMPLES.. => Err(format!("fewer than {MAX_SAMPLES} samples are possible")),
        count => Ok(count),
    }
}

fn main() {
    let arguments = Arguments::parse();
    cli::run("sample-surface", || run(&arguments).map(|()| 0));
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let start = Instant::now();
    let common = &arguments.common;
    if arguments.list_materials {
        let scene = arguments.scene_args.import(&arguments.scene, common)?;
        return cli::print(&material_table(&scene)?);
    }
    let output_path = arguments.output.as_deref().ok_or_else(|| Failure::usage("--output: give CLOUD"))?;
    let mut files = declare(arguments, output_path)?;
    check_memory(arguments)?;
    let medium = arguments.for_medium.as_deref().map(read_medium).transpose()?;
    let room = cli::available_memory_bytes().map_or(MAX_SAMPLES - 1, |bytes| bytes / BYTES_PER_SAMPLE);
    let goal = medium.as_ref().zip(arguments.target_error);
    let goal = goal.map(|(medium, error)| Goal { medium, error, most: room.min(MAX_SAMPLES - 1) });
    let mut seconds = Seconds::default();
    let mut scene = arguments.scene_args.import(&arguments.scene, common)?;
    scene.files.iter().try_for_each(|path| files.reads("a file that SCENE names", path))?;
    let settings = settings(arguments, &scene.environment);
    let mut plan = Plan::new(&scene, &settings).map_err(|e| named(&arguments.scene, &e))?;
    if let Some(goal) = &goal {
        plan.depends_on(goal);
    }
    let sampled = |material| plan.samples(material);
    arguments.scene_args.check_mesh(&mut scene, sampled, plan.defects, &arguments.scene, common)?;
    seconds.add("import", start);
    if plan.unmarked {
        common.say("no material is marked as a volume: all surfaces that do not emit are translucent");
    }
    let kept = is_current(output_path, &plan);
    let mut group = Group::default();
    let cloud = if kept {
        touch(output_path);
        common.say(format_args!("{}: up to date, kept", output_path.display()));
        Cloud::open(output_path)?
    } else {
        let mut output = Output::create(output_path)?;
        common.in_pool(|| {
            let work =
                Work { arguments, output_path, settings: &settings, scene: &scene, plan: &plan, goal: goal.as_ref() };
            work.sample_and_write(&mut output, &mut seconds)
        })??;
        let cloud = Cloud::open(output.written()?)?;
        group.add(output);
        cloud
    };
    if let Some(path) = &arguments.ply {
        group.add(write_ply(path, &cloud)?);
    }
    seconds.add("total", start);
    if let Some(path) = &arguments.stats {
        group.write(path, &statistics(&cloud, &plan.defects, &seconds, common, kept))?;
    }
    group.commit()?;
    report(&cloud, common);
    Ok(())
}

/// All files that the arguments name. Those that the scene names are known once it is read.
fn declare(arguments: &Arguments, output: &Path) -> Result<Files, Failure> {
    let mut files = Files::default();
    files.reads("SCENE", &arguments.scene)?;
    arguments.scene_args.declare(&mut files)?;
    if let Some(medium) = arguments.for_medium.as_deref().filter(|name| is_file(name)) {
        files.reads("--for-medium", Path::new(medium))?;
    }
    files.writes("--output", output)?;
    arguments.ply.iter().try_for_each(|path| files.writes("--ply", path))?;
    arguments.stats.iter().try_for_each(|path| files.writes("--stats", path))?;
    Ok(files)
}

/// Refuses what cannot fit before any work is done: the samples, and the scene's file once it is unpacked.
fn check_memory(arguments: &Arguments) -> Result<(), Failure> {
    let samples = arguments.samples;
    let file = std::fs::metadata(&arguments.scene).map_or(0, |meta| meta.len());
    let scene = file.saturating_mul(BYTES_PER_FILE_BYTE);
    let need = Need {
        held: samples.saturating_mul(BYTES_PER_SAMPLE).saturating_add(scene),
        mapped: samples.saturating_mul(BYTES_PER_STORED_SAMPLE),
    };
    cli::require_memory(&format!("--samples: a cloud of {} samples", count(samples)), need, "draw fewer")
}

fn settings(arguments: &Arguments, environment: &Environment) -> Settings {
    let scene = &arguments.scene_args;
    Settings {
        samples: arguments.samples,
        choice: arguments.choice,
        pattern: arguments.pattern,
        normals: scene.normal_kind(),
        translucent: arguments.translucent.clone(),
        shares: arguments.share.clone(),
        options: Options {
            seed: arguments.common.seed,
            shard: arguments.shard,
            choice: arguments.choice,
            pattern: arguments.pattern,
            shares: arguments.share.clone(),
            normals: scene.normals,
            metres_per_unit: scene.metres_per_unit,
            light_unit: scene.light_unit,
            emission_unit: scene.emission_unit(),
            environment: environment.identity(),
        },
    }
}

fn named(scene: &Path, error: &SampleError) -> Failure {
    let message = format!("{}: {error}", scene.display());
    match error {
        SampleError::NotFinite { .. } => Failure::numerical(message),
        _ => Failure::usage(message),
    }
}

/// True if the target already is what was asked for, undamaged.
fn is_current(path: &Path, plan: &Plan) -> bool {
    Cloud::open(path).is_ok_and(|c| c.meta().content == plan.content && c.verify(path).is_ok())
}

/// Renews the time stamp, so that make does not ask again.
fn touch(path: &Path) {
    if let Ok(file) = std::fs::OpenOptions::new().append(true).open(path) {
        file.set_modified(SystemTime::now()).ok();
    }
}

/// What is to be sampled.
struct Work<'a> {
    arguments: &'a Arguments,
    output_path: &'a Path,
    settings: &'a Settings,
    scene: &'a Scene,
    plan: &'a Plan,
    goal: Option<&'a Goal<'a>>,
}

impl Work<'_> {
    fn sample_and_write(&self, output: &mut Output, seconds: &mut Seconds) -> Result<(), Failure> {
        let start = Instant::now();
        let rays = Rays::of_scene(self.scene, |m| self.plan.samples(m));
        seconds.add("ray_tree", start);
        let start = Instant::now();
        let sampled = self.sample(&rays).map_err(|e| named(&self.arguments.scene, &e))?;
        seconds.add("sample", start);
        let start = Instant::now();
        cloud::write(output, self.output_path, &sampled.content, &sampled.meta)?;
        seconds.add("write", start);
        Ok(())
    }

    fn sample(&self, rays: &Rays) -> Result<Sampled, SampleError> {
        let common = &self.arguments.common;
        if let Some(goal) = self.goal {
            let medium = &goal.medium.name;
            let tell = |round: &Round| common.say(told::round(round, medium));
            let Enough { sampled, estimate } = sample_enough(self.scene, rays, self.settings, self.plan, goal, tell)?;
            match estimate {
                Some(estimate) => common.say(told::enough(&sampled, &estimate, medium)),
                None => common.warn(told::dark(&sampled, medium)),
            }
            return Ok(sampled);
        }
        let progress = Progress::start(common, "sampling", self.settings.samples, "samples");
        let sampled = sample(self.scene, rays, self.settings, self.plan, |n| progress.add(n))?;
        progress.finish();
        Ok(sampled)
    }
}

/// Seconds per step.
#[derive(Default)]
struct Seconds(Vec<(&'static str, f64)>);

impl Seconds {
    fn add(&mut self, step: &'static str, since: Instant) {
        self.0.push((step, since.elapsed().as_secs_f64()));
    }

    fn of(&self, step: &str) -> Option<f64> {
        self.0.iter().find(|(name, _)| *name == step).map(|(_, s)| *s)
    }
}

fn statistics(cloud: &Cloud, defects: &MeshDefects, seconds: &Seconds, common: &Common, kept: bool) -> Vec<u8> {
    let meta = cloud.meta();
    let rate = seconds.of("sample").filter(|s| *s > 0.0).map(|s| meta.shadow_rays as f64 / s);
    let table: serde_json::Map<_, _> = seconds.0.iter().map(|(k, v)| ((*k).to_owned(), (*v).into())).collect();
    let value = serde_json::json!({
        "schema": 1,
        "seconds": table,
        "peak_memory_bytes": cli::peak_memory_bytes(),
        "threads": common.thread_count(),
        "kept": kept,
        "shard": meta.options.shard.to_string(),
        "samples_drawn": meta.samples_drawn,
        "samples_stored": cloud.len(),
        "samples_dropped": meta.samples_dropped,
        "surface_area_m2": meta.surface_area_m2,
        "shadow_rays": meta.shadow_rays,
        "shadow_rays_per_second": rate,
        "mesh": defects.counts().into_iter().collect::<BTreeMap<_, _>>(),
        "mean_flux_w": meta.mean_flux_w,
        "file_bytes": cloud.bytes(),
        "content": cloud::hex(&meta.content),
        "materials": meta.materials.iter().map(|m| &m.name).collect::<Vec<_>>(),
    });
    format!("{value:#}\n").into_bytes()
}

fn report(cloud: &Cloud, common: &Common) {
    let meta = cloud.meta();
    let drawn = meta.samples_drawn as f64;
    let share = |n: u64| 100.0 * n as f64 / drawn;
    let dropped: Vec<String> = meta
        .samples_dropped
        .iter()
        .filter(|(_, n)| **n > 0)
        .map(|(reason, n)| format!("{:.1} % {}", share(*n), reason.replace('_', " ")))
        .collect();
    common.say(format_args!(
        "{} of {} samples carry light ({}); area {:.4e} m2, mean flux {:.4e} {:.4e} {:.4e} W",
        count(cloud.len()),
        count(meta.samples_drawn),
        if dropped.is_empty() { "none dropped".into() } else { dropped.join(", ") },
        meta.surface_area_m2,
        meta.mean_flux_w[0],
        meta.mean_flux_w[1],
        meta.mean_flux_w[2]
    ));
    if cloud.is_empty() {
        common.warn("no sample carries light: the image of this cloud will show no scattered light");
    }
}

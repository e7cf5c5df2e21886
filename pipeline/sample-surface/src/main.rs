//! `sample-surface SCENE -o CLOUD`: arguments and files; the phase itself is the library.

use clap::{Parser, ValueEnum};
use cli::{Common, Failure, Progress, SceneArgs, parse_count};
use formats::{
    atomic::{self, Output},
    cloud::{self, Cloud, Options},
    write_ply,
};
use sample_surface::{Choice, Plan, SampleError, Settings, sample};
use scene::{Rays, Scene};
use std::{
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
    scene: PathBuf,
    /// Cloud to write
    #[arg(short, long, value_name = "CLOUD")]
    output: PathBuf,
    /// Samples drawn over all translucent surfaces: 250k, 1M, 1e6
    #[arg(short = 'n', long, value_name = "K", default_value = "1M", value_parser = parse_samples)]
    samples: u64,
    /// Material whose surfaces are sampled (repeatable) [default: those the file marks as volumes; if there is none,
    /// all that do not emit]
    #[arg(long, value_name = "NAME")]
    translucent: Vec<String>,
    /// Which triangle: by area, or every one alike as in the note
    #[arg(long, default_value = "area")]
    choice: Choice,
    /// Well-spread samples (not built yet), or independent ones as in the note
    #[arg(long, default_value = "independent")]
    pattern: Pattern,
    #[command(flatten)]
    scene_args: SceneArgs,
    /// Also write the cloud as binary PLY for viewers
    #[arg(long, value_name = "FILE")]
    ply: Option<PathBuf>,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Pattern {
    Stratified,
    Independent,
}

/// Bytes a sample takes while it is sampled and written: twice in lists, once as file content.
const BYTES_PER_SAMPLE: u64 = 96;

fn parse_samples(text: &str) -> Result<u64, String> {
    match parse_count(text)? {
        0 => Err("at least one sample is needed".into()),
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
    if arguments.pattern == Pattern::Stratified {
        return Err(Failure::usage("--pattern stratified is not built yet; use --pattern independent"));
    }
    check_memory(arguments.samples)?;
    let settings = settings(arguments);
    let mut seconds = Seconds::default();
    let scene = arguments.scene_args.import(&arguments.scene, common)?;
    let plan = Plan::new(&scene, &settings).map_err(|e| named(&arguments.scene, &e))?;
    seconds.add("import", start);
    if plan.unmarked {
        common.say("no material is marked as a volume: all surfaces that do not emit are translucent");
    }
    let kept = is_current(&arguments.output, &plan);
    if kept {
        touch(&arguments.output);
        common.say(format_args!("{}: up to date, kept", arguments.output.display()));
    } else {
        let output = Output::create(&arguments.output)?;
        common.in_pool(|| sample_and_write(arguments, &settings, &scene, &plan, output, &mut seconds))??;
    }
    let cloud = Cloud::open(&arguments.output)?;
    if let Some(path) = &arguments.ply {
        write_ply(path, &cloud)?;
    }
    seconds.add("total", start);
    if let Some(path) = &arguments.stats {
        atomic::write(path, &statistics(&cloud, &seconds, common, kept))?;
    }
    report(&cloud, common);
    Ok(())
}

/// Refuses what cannot fit before any work is done.
fn check_memory(samples: u64) -> Result<(), Failure> {
    let needed = samples.saturating_mul(BYTES_PER_SAMPLE);
    match cli::available_memory_bytes() {
        Some(available) if needed > available => Err(Failure::usage(format!(
            "--samples: {samples} samples need {:.1} GiB of memory, {:.1} GiB are free; draw fewer",
            needed as f64 / 2f64.powi(30),
            available as f64 / 2f64.powi(30)
        ))),
        _ => Ok(()),
    }
}

fn settings(arguments: &Arguments) -> Settings {
    let scene = &arguments.scene_args;
    Settings {
        samples: arguments.samples,
        choice: arguments.choice,
        normals: scene.normal_kind(),
        translucent: arguments.translucent.clone(),
        options: Options {
            seed: arguments.common.seed,
            choice: arguments.choice.name().into(),
            pattern: "independent".into(),
            normals: scene.normals.name().into(),
            metres_per_unit: scene.metres_per_unit,
            light_unit: scene.light_unit.name().into(),
            environment: scene.radiance().to_array(),
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

fn sample_and_write(
    arguments: &Arguments,
    settings: &Settings,
    scene: &Scene,
    plan: &Plan,
    mut output: Output,
    seconds: &mut Seconds,
) -> Result<(), Failure> {
    let start = Instant::now();
    let rays = Rays::new(&scene.mesh);
    seconds.add("ray_tree", start);
    let progress = Progress::start(&arguments.common, "sampling", settings.samples, "samples");
    let sampled = sample(scene, &rays, settings, plan, |n| progress.add(n)).map_err(|e| named(&arguments.scene, &e))?;
    seconds.0.push(("sample", progress.finish()));
    let start = Instant::now();
    cloud::write(&mut output, &arguments.output, &sampled.samples, &sampled.meta)?;
    output.commit()?;
    seconds.add("write", start);
    Ok(())
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

fn statistics(cloud: &Cloud, seconds: &Seconds, common: &Common, kept: bool) -> Vec<u8> {
    let meta = cloud.meta();
    let rate = seconds.of("sample").filter(|s| *s > 0.0).map(|s| meta.shadow_rays as f64 / s);
    let table: serde_json::Map<_, _> = seconds.0.iter().map(|(k, v)| ((*k).to_owned(), (*v).into())).collect();
    let value = serde_json::json!({
        "schema": 1,
        "seconds": table,
        "peak_memory_bytes": cli::peak_memory_bytes(),
        "threads": common.thread_count(),
        "kept": kept,
        "samples_drawn": meta.samples_drawn,
        "samples_stored": cloud.len(),
        "samples_dropped": meta.samples_dropped,
        "surface_area_m2": meta.surface_area_m2,
        "shadow_rays": meta.shadow_rays,
        "shadow_rays_per_second": rate,
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
        cloud.len(),
        meta.samples_drawn,
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

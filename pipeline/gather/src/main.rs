//! `gather CLOUD... SCENE -o IMAGE.exr`: arguments and files; the phase itself is the library.

mod adaptive;
mod arguments;
mod image_jobs;
mod inputs;
mod outlook;
mod report;
mod settings;

use adaptive::{render_all, render_to};
use arguments::Arguments;
use bssrdf::{Medium, Model, built_in, built_in_names};
use clap::Parser;
use cli::{Failure, Need, camera_table, count, material_table, printable};
use formats::{
    atomic::{Group, Output},
    cloud::Cloud,
};
use gather::{Input, Rendered, Settings, film, media, preview, shards};
use image_jobs::{Shot, shots, warn_of_aspects};
use inputs::CloudFiles;
use report::{Facts, Seconds};
use scene::{DVec3, Rays, Scene};
use settings::{cameras, estimator, settings};
use std::{
    fmt::Write as _,
    io::Write as _,
    num::NonZeroUsize,
    path::{Path, PathBuf},
    time::Instant,
};

fn main() {
    let arguments = Arguments::parse();
    cli::run("gather", || run(&arguments).map(|()| 0));
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.list_media {
        return list_media();
    }
    if arguments.list_cameras || arguments.list_materials {
        return list_scene(arguments);
    }
    if arguments.list_files {
        return list_paths(&Scene::files_of(scene_alone(arguments)?)?);
    }
    if let Some(output) = arguments.output.as_deref().filter(|_| arguments.list_images) {
        return list_paths(&image_jobs::image_paths(arguments, output)?);
    }
    let start = Instant::now();
    let common = &arguments.common;
    let (cloud_paths, scene_path) = inputs::paths(arguments)?;
    let mut declared = inputs::declare(arguments)?;
    let estimator = estimator(arguments)?;
    let files = CloudFiles::open(cloud_paths)?;
    let clouds = files.clouds();
    let mut scene = inputs::import(arguments, scene_path)?;
    files.check_fit(&scene, scene_path, arguments)?;
    let sampled = |material| shards::materials(clouds).iter().any(|m| m.index == material);
    let cameras = cameras(arguments, &scene, scene_path, || scene.origin + middle(bounds(&scene, sampled)))?;
    let shots = shots(arguments, &cameras, |chosen| settings(arguments, chosen, estimator))?;
    warn_of_aspects(&shots, arguments);
    shots.iter().try_for_each(|shot| check_memory(&shot.settings).map_err(|e| shot.failure(e)))?;
    let defects = files.defects();
    arguments.scene_args.check_mesh(&mut scene, sampled, defects, scene_path, common)?;
    let media = media::assign(&arguments.medium, shards::materials(clouds), &scene.materials)?;
    show_scale(arguments, &scene, clouds, &media, shots[0].settings.model);
    let output_path = arguments.output.as_deref().ok_or_else(|| Failure::usage("--output: give IMAGE.exr"))?;
    scene.files.iter().try_for_each(|path| declared.reads("a file that SCENE names", path))?;
    inputs::declare_outputs(&mut declared, arguments, &shots, output_path)?;
    let mut first = shots.first().map(|shot| Output::create(&shot.file(output_path))).transpose()?;
    files.verify(threads(arguments))?;
    let mut seconds = Seconds(vec![("open", start.elapsed().as_secs_f64())]);
    let ray_tree = Instant::now();
    let rays = common.in_pool(|| Rays::of_scene(&scene, sampled))?;
    seconds.0.push(("ray_tree", ray_tree.elapsed().as_secs_f64()));

    let mut start = start;
    for shot in &shots {
        let (settings, path) = (&shot.settings, shot.file(output_path));
        let output = first.take().map_or_else(|| Output::create(&path), Ok)?;
        let input = Input { scene: &scene, rays: &rays, clouds, media: &media, camera: &shot.camera };
        let render = Instant::now();
        let rendered = common.in_pool(|| match arguments.target_error {
            None => render_all(&input, settings, common),
            Some(target) => render_to(target, &input, settings, common),
        })?;
        files.check_unchanged()?;
        seconds.0.push(("render", render.elapsed().as_secs_f64()));
        let facts = Facts {
            settings: &Settings { paths_per_pixel: rendered.paths_per_pixel, ..settings.clone() },
            clouds,
            media: &media,
            camera: &shot.camera,
            camera_argument: &shot.argument,
            turned_degrees: shot.degrees,
            warnings: &scene.warnings,
            defects,
        };
        let write = Instant::now();
        let mut group = Group::default();
        if rendered.non_finite_count == 0 {
            write_image(arguments, shot, &facts, &rendered, (output, &path), &mut group)?;
        }
        seconds.0.push(("write", write.elapsed().as_secs_f64()));
        seconds.0.push(("total", start.elapsed().as_secs_f64()));
        if let Some(path) = &arguments.stats {
            let seconds = (!arguments.no_timings).then_some(&seconds);
            group.write(&shot.file(path), &facts.statistics(&rendered, seconds, common.thread_count()))?;
        }
        group.commit()?;
        finish(arguments, &facts, &rendered).map_err(|e| shot.failure(e))?;
        if let Some(warning) = outlook::warning(&rendered.counts, settings) {
            common.warn(shot.line(&warning));
        }
        (start, seconds) = (Instant::now(), Seconds::default());
    }
    Ok(())
}

/// Threads of work that is no pool's.
fn threads(arguments: &Arguments) -> NonZeroUsize {
    NonZeroUsize::new(arguments.common.thread_count()).unwrap_or(NonZeroUsize::MIN)
}

/// Refuses what cannot fit before any work is done: the image thrice. The cloud is mapped.
fn check_memory(settings: &Settings) -> Result<(), Failure> {
    let pixels = settings.part().pixels() as u64;
    // Sums, their copies while a pass is joined, the pixels and the channels, if all pixels are edges.
    let need = Need { held: pixels.saturating_mul(1280), mapped: 0 };
    cli::require_memory("this image", need, "make it smaller")
}

/// Prints each medium's lengths beside its object's.
fn show_scale(arguments: &Arguments, scene: &Scene, clouds: &[Cloud], media: &[Medium], model: Model) {
    for (slot, (material, medium)) in shards::materials(clouds).iter().zip(media).enumerate() {
        let (low, high) = bounds(scene, |m| m == material.index);
        let extent = low.abs().max(high.abs()).max_element();
        let object = media::Object {
            material: &material.name,
            diagonal: (high - low).length(),
            spacing: (material.area_m2 / shards::count(clouds, slot) as f64).sqrt(),
            drawn: shards::drawn(clouds),
            rounding: 0.5 * f64::from(f32::EPSILON) * extent,
        };
        let scale = media::scale(&object, medium, model.of(medium).transport());
        scale.lines.iter().for_each(|line| arguments.common.say(line));
        scale.warnings.iter().for_each(|warning| arguments.common.warn(warning));
        if let Some(errors) = model.poor_reflectance(medium) {
            let [r, g, b] = errors.map(|e| format!("{:+.0}", 100.0 * e));
            arguments.common.say(format_args!(
                "  {} reflects {r} {g} {b} % more than {} does (red, green, blue; docs/reports/accuracy.md)",
                model.name(),
                medium.name
            ));
        }
    }
}

/// The box around the triangles of the materials that are meant, m from the scene's origin.
fn bounds(scene: &Scene, meant: impl Fn(u16) -> bool) -> (DVec3, DVec3) {
    let mesh = &scene.mesh;
    let own = (0..mesh.triangles.len()).filter(|k| meant(mesh.triangles[*k].material));
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    own.flat_map(|k| mesh.corners(k)).fold(start, |(low, high), p| (low.min(p), high.max(p)))
}

fn middle((low, high): (DVec3, DVec3)) -> DVec3 {
    0.5 * (low + high)
}

fn write_image(
    arguments: &Arguments,
    shot: &Shot,
    facts: &Facts,
    rendered: &Rendered,
    (mut output, path): (Output, &Path),
    group: &mut Group,
) -> Result<(), Failure> {
    let (settings, part) = (facts.settings, facts.settings.part());
    let origin = facts.clouds[0].meta().exchange_origin_m().map(f64::from).into();
    let mut image = film::part(&rendered.pixels, part, [settings.width, settings.height], origin);
    image.attributes = facts.attributes(arguments);
    let bytes = image.encode_with(threads(arguments))?;
    output.write_all(&bytes).map_err(|source| formats::Error::write(path, source))?;
    group.add(output);
    if let Some(preview_path) = &arguments.preview {
        let png = preview::png(&rendered.pixels, part.width, part.height, arguments.exposure)?;
        group.write(&shot.file(preview_path), &png)?;
    }
    Ok(())
}

/// Says how good the image is; fails if it has a number that is not finite.
fn finish(arguments: &Arguments, facts: &Facts, rendered: &Rendered) -> Result<(), Failure> {
    if rendered.non_finite_count > 0 {
        let places: Vec<String> = rendered.non_finite.iter().map(|p| format!("{:?}", facts.pixel(*p))).collect();
        return Err(Failure::numerical(format!(
            "{} pixels are not finite, no image was written; the first are {}",
            count(rendered.non_finite_count),
            places.join(" ")
        )));
    }
    let counts = &rendered.counts;
    // No two paths differ: that tells nothing of what none of them met.
    let error = film::relative_error(&rendered.pixels).filter(|error| *error > 0.0);
    let error = error.map_or("unknown".into(), sums::confidence::percent);
    arguments.common.say(format_args!(
        "{} gathers, {} BSSRDF evaluations; relative error {error} ({})",
        count(counts.gathers),
        count(counts.evaluations),
        facts.covers()
    ));
    let share = |n: u64| 100.0 * n as f64 / counts.paths as f64;
    if counts.cut_by_depth > 0 {
        let limit = facts.settings.max_depth;
        let line =
            format!("of 100 paths {:.3} branches were cut off at --max-depth {limit}", share(counts.cut_by_depth));
        arguments.common.say(line);
    }
    if counts.escaped_inside > 0 {
        let line =
            format!("{:.3} % of the paths left a medium through a hole in its mesh", share(counts.escaped_inside));
        arguments.common.warn(line);
    }
    Ok(())
}

fn list_media() -> Result<(), Failure> {
    let mut text = format!("{:<28} {:>6}  {:<32} {:<32} source\n", "name", "eta", "sigma_a, 1/mm", "sigma_s, 1/mm");
    for name in built_in_names() {
        let medium = built_in(name)?;
        let three = |v: [f64; 3]| v.map(|x| format!("{:.4e}", x / 1000.0)).join(" ");
        let (absorbs, scatters) = (three(medium.map(|c| c.sigma_a)), three(medium.map(|c| c.sigma_s)));
        let source = medium.source.split(',').next().unwrap_or_default();
        let year = medium
            .source
            .split_whitespace()
            .map(|w| w.trim_end_matches(','))
            .find(|w| w.len() == 4 && w.parse::<u16>().is_ok());
        let year = year.unwrap_or_default();
        writeln!(text, "{name:<28} {:>6}  {absorbs:<32} {scatters:<32} {source} et al. {year}", medium.eta)?;
    }
    cli::print(&text)
}

fn list_scene(arguments: &Arguments) -> Result<(), Failure> {
    let scene = arguments.scene_args.import(scene_alone(arguments)?, &arguments.common)?;
    let mut text = String::new();
    if arguments.list_cameras {
        text += &camera_table(&scene);
    }
    if arguments.list_materials {
        text += &material_table(&scene)?;
    }
    cli::print(&text)
}

/// SCENE, where no cloud is needed.
fn scene_alone(arguments: &Arguments) -> Result<&Path, Failure> {
    let path = arguments.files.last().map(PathBuf::as_path);
    path.ok_or_else(|| Failure::usage("--list-cameras, --list-files, --list-materials: give SCENE"))
}

fn list_paths(paths: &[PathBuf]) -> Result<(), Failure> {
    let lines = paths.iter().map(|path| format!("{}\n", printable(&path.to_string_lossy())));
    cli::print(&lines.collect::<String>())
}

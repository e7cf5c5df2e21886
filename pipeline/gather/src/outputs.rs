//! The files of an image: the image, its preview, and its statistics.

use crate::{arguments::ExtraLayer, continuation, image_jobs::ImageJob, report::Facts, settings::Outputs, sums_file};
use cli::{Failure, Files, Seconds};
use formats::atomic::{Group, Output};
use gather::{film, preview};
use std::io::Write;

/// Refuses outputs that cannot be written, that would replace an input, or that are the same file, before any work is
/// done.
pub fn declare(files: &mut Files, outputs: &Outputs, jobs: &[ImageJob]) -> Result<(), Failure> {
    let image = [("--output", &outputs.image)].into_iter();
    let preview = outputs.preview.iter().map(|path| ("--preview", path));
    let stats = outputs.stats.iter().map(|path| ("--stats", path));
    for (option, path) in image.chain(preview).chain(stats) {
        jobs.iter().try_for_each(|job| files.writes(option, &job.file(path)))?;
    }
    if outputs.keeps_sums {
        let sums = |job: &ImageJob| sums_file::path_of(&job.file(&outputs.image));
        jobs.iter().try_for_each(|job| files.writes("--keep-sums", &sums(job)))?;
    }
    Ok(())
}

/// Writes the files of an image, all or none. If a value of the image is not finite, only its statistics are written.
pub fn write(facts: &Facts, output: Output, mut seconds: Seconds) -> Result<(), Failure> {
    let mut group = Group::default();
    seconds.time("write", || match facts.rendered.non_finite_count {
        0 => write_image(facts, output, &mut group),
        _ => Ok(()),
    })?;
    if let Some(path) = &facts.request.outputs.stats {
        group.write(&facts.job.file(path), &facts.statistics(&seconds))?;
    }
    Ok(group.commit()?)
}

fn write_image(facts: &Facts, mut output: Output, group: &mut Group) -> Result<(), Failure> {
    let (outputs, settings, part) = (&facts.request.outputs, &facts.settings, facts.settings.part());
    let origin = facts.inputs.clouds()[0].meta().exchange_origin_m().map(f64::from).into();
    let size = [settings.width, settings.height];
    let mut image = facts.request.common.in_pool(|| film::part(&facts.rendered.pixels, part, size, origin))?;
    let has = |layer: ExtraLayer| outputs.layers.contains(&layer);
    image.channels.extend(film::guides(&facts.rendered.pixels, has(ExtraLayer::Albedo), has(ExtraLayer::Id)));
    image.attributes = facts.attributes();
    let threads = facts.request.common.thread_count();
    let bytes = image.encode_with(threads)?;
    let path = facts.job.file(&outputs.image);
    output.write_all(&bytes).map_err(|source| formats::Error::write(&path, source))?;
    group.add(output);
    if let Some(state) = facts.state {
        let sums = sums_file::encode(state, &continuation::about(facts), part, &bytes, threads)?;
        group.write(&sums_file::path_of(&path), &sums)?;
    }
    if let Some(path) = &outputs.preview {
        let png = preview::png(&facts.rendered.pixels, part.width, part.height, facts.job.stops)?;
        group.write(&facts.job.file(path), &png)?;
    }
    Ok(())
}

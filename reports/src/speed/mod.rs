//! Time against error of the two programs: `speed.md`, its plots and `speed.csv`.

mod accuracy;
mod behavior;
mod clouds;
mod configuration;
mod cost;
mod document;
mod effort;
mod estimate;
mod everywhere;
mod exact;
mod findings;
mod frame;
mod growth;
mod harness;
mod made;
mod measure;
mod model;
mod peers;
mod picture;
mod plot;
mod race;
mod record;
mod reference;
mod scaling;
mod shot;
mod sizes;

pub use effort::Effort;

use crate::{error::Error, truth::Exact};
use configuration::{MARBLE, MEDIA, SKIM_MILK, Subjects};
use findings::Findings;
use harness::Harness;
use std::{fs, path::Path};

/// Measures, and writes the report into the folder `output`. The folder `meshes` should hold `bunny.glb` and
/// `dragon.glb`, and the folder `../peers` beside it the scenes that other renderers were measured with; `data` is
/// the folder of the repository, and exact images are kept in `truths`.
pub fn write(
    meshes: &Path,
    programs: &Path,
    data: &Path,
    truths: &Path,
    effort: Effort,
    output: &Path,
) -> Result<(), Error> {
    let subjects = Subjects::find(meshes, data);
    let mut harness = Harness::new(programs, effort, &subjects.main[0])?;
    let truths = Exact::new(programs, truths, harness.threads)?;
    let findings = measure_all(&mut harness, &subjects, &truths)?;
    let write = |name: &str, text: String| {
        let path = output.join(name);
        fs::write(&path, text).map_err(Error::file(&path))
    };
    for (name, plot) in findings.sections.iter().filter_map(|s| s.plot.as_ref()) {
        write(&format!("speed-{name}.svg"), plot.to_svg())?;
    }
    write("speed.csv", record::table(&harness.records))?;
    write("speed.md", document::document(&harness, &findings, &subjects.remarks))?;
    harness.say("written");
    Ok(())
}

/// All parts, in the order of the document.
fn measure_all(harness: &mut Harness, subjects: &Subjects, truths: &Exact) -> Result<Findings, Error> {
    let main = &subjects.main;
    let mut findings = exact::exact(harness, subjects, truths)?;
    let (raced, media) = match harness.effort {
        Effort::Full => (&main[..], &MEDIA[..]),
        _ => (&main[..1], &[MARBLE, SKIM_MILK][..]),
    };
    for subject in raced {
        for medium in media {
            findings.add(race::race(harness, subject, *medium)?);
        }
    }
    findings.add(sizes::sizes(harness, &main[0])?);
    findings.add(peers::peers(harness, subjects)?);
    findings.add(everywhere::everywhere(harness, main)?);
    findings.add(frame::frames(harness, [&main[main.len() - 1], &main[0]])?);
    findings.add(clouds::clouds(harness, subjects.bunny_of_peers.as_ref().unwrap_or(&main[0]))?);
    findings.add(growth::growth(harness, &main[0])?);
    findings.add(accuracy::accuracy(harness, main)?);
    findings.add(estimate::estimate(harness, main)?);
    findings.add(scaling::scaling(harness, &main[0])?);
    findings.add(cost::cost(harness, &main[0])?);
    Ok(findings)
}

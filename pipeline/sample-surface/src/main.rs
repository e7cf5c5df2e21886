//! `sample-surface SCENE -o CLOUD`: arguments and files; the phase itself is the library.

mod arguments;
mod draw;
mod inputs;
mod report;
mod search;
mod settings;
mod surfaces;

use arguments::Arguments;
use cli::{Failure, Seconds, bounds_line, material_table, media_line};
use formats::{atomic::Group, write_ply};
use inputs::Inputs;
use settings::{Request, Task};
use surfaces::sized;

fn main() {
    let arguments: Arguments = cli::parse();
    cli::run("sample-surface", || {
        match Task::of(arguments)? {
            Task::ListMaterials { scene, common } => {
                let scene = scene.sized_by_file()?.import(&common)?;
                cli::print(&(material_table(&scene)? + &bounds_line(&scene) + &media_line(&scene)))?;
            }
            Task::Sample(request) => sample(&sized(*request)?)?,
        }
        Ok(0)
    });
}

/// Makes the requested cloud, or keeps an up-to-date one, and writes its statistics and PLY file.
fn sample(request: &Request) -> Result<(), Failure> {
    let mut seconds = Seconds::start();
    let inputs = seconds.time("import", || Inputs::read(request))?;
    let mut files = Group::default();
    let made = draw::make_or_keep(request, &inputs, &mut seconds, &mut files)?;
    if let Some(path) = &request.ply {
        files.add(write_ply(path, &made.cloud)?);
    }
    if let Some(path) = &request.stats {
        files.write(path, &report::statistics(&made, &inputs, &seconds, &request.common))?;
    }
    files.commit()?;
    report::summarize(&made.cloud, &request.common);
    Ok(())
}

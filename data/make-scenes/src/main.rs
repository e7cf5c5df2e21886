//! `make-scenes DIR` writes `DIR/scenes/<scene>.glb`, `DIR/views/<scene>/<view>.json`,
//! `DIR/environments/sky.hdr` and `DIR/environments/studio.hdr`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const USAGE: &str = "usage: make-scenes DIR
Writes DIR/scenes/<scene>.glb, DIR/views/<scene>/<view>.json and DIR/environments/{sky,studio}.hdr, the same bytes on every run.";

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let [directory] = arguments.as_slice() else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    if directory == "--help" || directory == "-h" {
        println!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    if directory.to_string_lossy().starts_with('-') {
        eprintln!("make-scenes: unknown option {}\n{USAGE}", directory.display());
        return ExitCode::from(2);
    }
    match run(Path::new(directory)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("make-scenes: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(directory: &Path) -> Result<(), String> {
    for scene in make_scenes::all() {
        let path = directory.join("scenes").join(format!("{}.glb", scene.name));
        write(&path, &make_scenes::glb::encode(&scene))?;
        for view in &scene.views {
            let path = directory.join("views").join(scene.name).join(format!("{}.json", view.name));
            write(&path, view.to_json().as_bytes())?;
        }
    }
    let environments = directory.join("environments");
    write(&environments.join("sky.hdr"), &make_scenes::sky::encode())?;
    write(&environments.join("studio.hdr"), &make_scenes::soft_boxes::encode())
}

fn write(path: &PathBuf, bytes: &[u8]) -> Result<(), String> {
    let fault = |error| format!("cannot write {}: {error}", path.display());
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(fault)?;
    }
    fs::write(path, bytes).map_err(fault)?;
    println!("{} ({} bytes)", path.display(), bytes.len());
    Ok(())
}

//! Lists of what a scene holds, as the programs print them.

use crate::{Candidate, Failure, blended_media, printable, scene_medium};
use bssrdf::Medium;
use scene::{Camera, DVec3, Framing, Placed, Projection, Scene};

/// Rows of cells, the first of which are headers.
struct Table(Vec<Vec<String>>);

impl Table {
    fn new(header: &[&str]) -> Table {
        Table(vec![header.iter().map(|s| (*s).to_owned()).collect()])
    }

    /// The rows as lines with aligned columns.
    fn text(&self) -> String {
        let width = |c: usize| self.0.iter().map(|row| row[c].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.0[0].len()).map(width).collect();
        let mut text = String::new();
        for row in &self.0 {
            let cells = row.iter().zip(&widths).map(|(cell, width)| {
                let cell = printable(cell);
                format!("{cell:<width$}")
            });
            text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
            text.push('\n');
        }
        text
    }
}

/// The cameras of a scene, which `--camera` may name, with their fields of view and positions. If the file has none,
/// they are those that are made.
pub fn camera_table(scene: &Scene) -> String {
    let mut table = Table::new(&["index", "name", "kind", "field of view", "aspect", "position, m", "node"]);
    let made = if scene.cameras.is_empty() { made_cameras(scene) } else { Vec::new() };
    for (index, camera) in scene.cameras.iter().chain(&made).enumerate() {
        let (kind, view) = match camera.projection {
            Projection::Perspective { tangent } => {
                ("perspective", format!("yfov {:.2} degrees", 2.0 * tangent.atan().to_degrees()))
            }
            Projection::Orthographic { half_height } => ("orthographic", format!("height {:.4e} m", 2.0 * half_height)),
        };
        let aspect = camera.aspect.map_or("any".into(), |a| format!("{a:.3}"));
        let Camera { name, node, .. } = camera;
        table.0.push(vec![index.to_string(), name.clone(), kind.into(), view, aspect, position(camera), node.clone()]);
    }
    table.text()
}

/// The cameras that are made for a scene without one, for a square image.
fn made_cameras(scene: &Scene) -> Vec<Camera> {
    let surfaces = translucent(scene);
    let made = |placed: Placed| {
        let (_, camera) = surfaces.view(placed, 1.0, false)?;
        Some(Camera { node: "- (made)".into(), ..camera })
    };
    Placed::ALL.into_iter().filter_map(made).collect()
}

/// The surfaces that are translucent by the scene's file.
fn translucent(scene: &Scene) -> Framing<'_> {
    let materials = scene.translucent().map_or(Vec::new(), |(materials, _)| materials);
    Framing::new(scene, |material| materials.contains(&material))
}

/// The middle and the size of the box around the surfaces that are translucent by the scene's file; nothing if there
/// are none.
pub fn bounds_line(scene: &Scene) -> String {
    let surfaces = translucent(scene);
    let size = surfaces.size();
    if size.min_element() < 0.0 {
        return String::new();
    }
    let three = |v: DVec3| v.to_array().map(|x| format!("{x:.4e}"));
    format!("translucent surfaces: {} m around {}\n", three(size).join(" x "), three(surfaces.middle()).join(" "))
}

/// Whether the file gives its translucent materials media; nothing if there are none.
pub fn media_line(scene: &Scene) -> String {
    let (materials, _) = scene.translucent().unwrap_or_default();
    let of = |k: &u16| scene_medium(&scene.materials[usize::from(*k)]).ok().flatten();
    let given: Vec<Medium> = materials.iter().filter_map(of).collect();
    let scatters = given.iter().filter(|medium| medium.channels.iter().any(|channel| channel.scatters())).count();
    let (all, given) = (materials.len(), given.len());
    match all {
        0 => String::new(),
        _ if given == all && scatters > 0 => format!("media: the file's own, of which {scatters} of {all} scatter\n"),
        _ if given == 0 => "media: the file gives none; --medium does\n".into(),
        _ => format!("media: the file gives {given} of {all} translucent materials one; {scatters} of these scatter\n"),
    }
}

/// The cameras that are made for a scene without one as a word may mean them.
pub fn made_camera_names() -> Vec<Candidate<'static>> {
    let made = Placed::ALL.into_iter().enumerate();
    made.map(|(index, placed)| Candidate { index, names: vec![placed.name()], detail: String::new() }).collect()
}

fn position(camera: &Camera) -> String {
    camera.position.to_array().map(|x| format!("{x:.4}")).join(" ")
}

/// The cameras of a scene as a word may mean them: by their own name or their node's.
pub fn camera_names(scene: &Scene) -> Vec<Candidate<'_>> {
    let detail = |camera: &Camera| format!(" of node `{}` at {} m", camera.node, position(camera));
    let cameras = scene.cameras.iter().enumerate();
    cameras.map(|(index, c)| Candidate { index, names: vec![&c.name, &c.node], detail: detail(c) }).collect()
}

/// These materials of a scene as a word may mean them: by name, told apart by area.
pub fn material_names<'a>(scene: &'a Scene, materials: &[u16]) -> Vec<Candidate<'a>> {
    let areas = scene.area_of_materials();
    let detail = |index: usize| format!(", {:.4e} m2", areas[index]);
    let own = materials.iter().map(|material| usize::from(*material));
    own.map(|index| Candidate { index, names: vec![&scene.materials[index].name], detail: detail(index) }).collect()
}

/// The materials of a scene, which `--translucent` and `--medium` may name: what each is taken for without these
/// options, its triangles and area, and the medium that the file gives it.
pub fn material_table(scene: &Scene) -> Result<String, Failure> {
    let mut table =
        Table::new(&["index", "name", "kind", "triangles", "area, m2", "medium of the file: sigma_a, sigma_s (1/m)"]);
    let (mut counts, areas) = (vec![0u64; scene.materials.len()], scene.area_of_materials());
    scene.mesh.triangles.iter().for_each(|t| counts[usize::from(t.material)] += 1);
    let (lost, translucent) =
        (scene.lost_volumes(), scene.translucent().map_or(Vec::new(), |(materials, _)| materials));
    for (index, material) in scene.materials.iter().enumerate() {
        let is_in = |list: &[u16]| u16::try_from(index).is_ok_and(|k| list.contains(&k));
        let kind = match (is_in(&translucent), material.emits()) {
            _ if is_in(&lost) => "translucent, no triangle left",
            (_, _) if counts[index] == 0 => "unused",
            (false, false) if scene.is_pane(index as u16) => "pane",
            (false, false) if scene.is_wall(index as u16) => "thin wall",
            (true, true) => "translucent, emits",
            (true, false) => "translucent",
            (false, true) => "emits",
            (false, false) => "opaque",
        };
        let three = |v: [f64; 3]| v.map(|x| format!("{x:.4e}")).join(" ");
        let text = |m: Medium| {
            let (absorbs, scatters) = (three(m.map(|c| c.sigma_a)), three(m.map(|c| c.sigma_s)));
            format!("{absorbs}, {scatters}, g {}, eta {} ({})", m.channels[0].asymmetry, m.eta, m.name)
        };
        let medium = match blended_media(material).and_then(|two| Ok((two, scene_medium(material)?))) {
            Ok((Some(two), _)) => two.map(text).join(", blended with "),
            Ok((None, medium)) => medium.map_or_else(|| "-".into(), text),
            Err(fault) => fault.to_string(),
        };
        let (count, area) = (counts[index].to_string(), format!("{:.4e}", areas[index]));
        table.0.push(vec![index.to_string(), material.name.clone(), kind.into(), count, area, medium]);
    }
    Ok(table.text())
}

//! Small scenes around which the near part of a BSSRDF is put to the test, and exitant points in them.

use crate::{means::sun, objects::at};
use bssrdf::{Coefficients, Medium, Model};
use glam::{DQuat, DVec3};
use scene::{NormalKind, SurfacePoint};
use test_support::{
    meshes::{Light, Mesh, Part, World, quad, rectangle, slab, sphere, world},
    pipeline::medium,
};

/// A scene whose first material is that of the near part.
pub struct Place {
    pub name: &'static str,
    pub world: World,
    pub medium: Medium,
    pub model: Model,
    pub normals: NormalKind,
    pub exits: Vec<SurfacePoint>,
}

const MM: f64 = 1e-3;

/// Reduced mean free paths of 0.65, 0.33 and 1 mm, of which absorption leaves much, little and nearly all.
pub fn jelly(eta: f64) -> Medium {
    let channel = |sigma_a: f64, sigma_s: f64| Coefficients { sigma_a, sigma_s, asymmetry: 0.0 };
    medium([channel(30.0, 1500.0), channel(600.0, 2400.0), channel(5.0, 1000.0)], eta)
}

impl Place {
    /// The exitant points are the first that are met from places towards others, mm.
    fn new(name: &'static str, world: World, normals: NormalKind, views: &[[DVec3; 2]]) -> Place {
        let met = |[from, to]: &[DVec3; 2]| {
            let (origin, mesh) = (*from * MM - world.scene.origin, &world.scene.mesh);
            let hit = world.rays.closest(origin, (*to - *from).normalize(), None).expect("the view meets the surface");
            let point = mesh.point(hit.triangle, hit.weights, normals);
            assert_eq!(point.material, 0, "{name}: the view from {from} meets another material");
            point
        };
        let exits = views.iter().map(met).collect();
        Place { name, world, medium: jelly(1.3), model: Model::HalfSpace, normals, exits }
    }

    fn flat(name: &'static str, parts: &[Part], lights: &[Light], environment: DVec3, views: &[[DVec3; 2]]) -> Place {
        Place::new(name, world(parts, lights, environment), NormalKind::Geometric, views)
    }
}

fn mm(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Down onto a point from above.
fn onto(x: f64, y: f64) -> [DVec3; 2] {
    [mm(x, y, 10.0), mm(x, y, 0.0)]
}

/// Light from a direction.
fn from(towards: DVec3, irradiance: DVec3) -> Light {
    Light::Directional { towards: towards.normalize(), irradiance }
}

fn part(mesh: Mesh) -> Part {
    Part::translucent(mesh)
}

fn cube(x: f64, y: f64, z: f64) -> Mesh {
    slab(mm(x, y, z) * MM, 4)
}

fn joined(mut first: Mesh, second: Mesh) -> Mesh {
    let start = first.positions.len() as u32;
    first.positions.extend(second.positions);
    first.triangles.extend(second.triangles.iter().map(|t| t.map(|i| i + start)));
    first
}

/// A sphere of 32 triangles with smooth normals: lit, at the edge of the light, and dark.
pub fn smooth_sphere() -> Place {
    let mut world = world(&[part(sphere(MM, 1))], &[sun(DVec3::ONE)], DVec3::ZERO);
    let mesh = &mut world.scene.mesh;
    mesh.normals = mesh.positions.iter().map(|p| p.normalize()).collect();
    let views = [mm(0.48, 0.6, 0.64), mm(-0.1, 0.9, -0.6), mm(0.2, -0.4, 0.5), mm(-1.0, -0.3, 0.1)];
    let views = views.map(|from| [3.0 * from.normalize(), mm(0.01, 0.02, 0.03)]);
    Place::new("smooth sphere", world, NormalKind::Shading, &views)
}

/// A cube near its edges: on the lit sides, at a corner, and on a dark side.
pub fn cube_edge() -> Place {
    let beside = |y: f64, z: f64| [mm(10.0, y, z), mm(0.0, y, z)];
    let below = [mm(1.33, 0.2, -10.0), mm(1.33, 0.2, 0.0)];
    let views = [onto(1.4, 0.2), onto(1.1, -1.38), beside(0.3, 1.2), below];
    Place::flat("cube", &[part(cube(1.5, 1.5, 1.5))], &[sun(DVec3::ONE)], DVec3::ZERO, &views)
}

/// A valley of 70 degrees whose sides shade each other.
pub fn fold() -> Place {
    let side = |sign: f64| {
        let mut mesh = rectangle([0.0, 2.0 * MM], 2.0 * MM, 0.0, 3);
        let turn = DQuat::from_rotation_y(-55f64.to_radians()).as_quat();
        let mirror = DVec3::new(sign, sign, 1.0).as_vec3();
        mesh.positions.iter_mut().for_each(|p| *p = (turn * *p) * mirror);
        mesh
    };
    let lights = [from(mm(0.7, 0.2, 0.9), DVec3::ONE), from(mm(-0.1, 0.0, 1.0), mm(0.5, 0.2, 0.1))];
    let views = [onto(0.05, 0.1), onto(0.3, -0.3), onto(-0.06, 0.2), onto(-0.25, 0.0)];
    Place::flat("fold", &[part(joined(side(1.0), side(-1.0)))], &lights, DVec3::ZERO, &views)
}

/// A sheet a fifth of a millimetre thick, lit from both sides: at its middle, near its rim, on the rim and below.
pub fn sheet() -> Place {
    let lights = [from(mm(0.3, 0.2, 0.9), mm(1.0, 0.3, 0.5)), from(mm(-0.4, 0.3, -0.8), mm(0.2, 1.0, 2.0))];
    let rim = [mm(10.0, 0.1, 0.03), mm(0.0, 0.1, 0.03)];
    let views = [onto(0.1, 0.2), onto(1.42, -0.3), rim, [mm(0.3, 0.0, -10.0), mm(0.3, 0.0, 0.0)]];
    Place::flat("sheet", &[part(cube(1.5, 1.5, 0.1))], &lights, DVec3::ZERO, &views)
}

const GAP: [f64; 2] = [-0.95, 0.95];

fn gap_views() -> [[DVec3; 2]; 3] {
    [onto(-0.2, 0.1), onto(-0.5, -0.4), [mm(0.0, 0.1, 10.0), mm(-0.15, 0.1, 0.4)]]
}

/// Two bodies with a gap of 0.3 mm between them.
fn apart() -> [Mesh; 2] {
    GAP.map(|x| at(cube(0.8, 1.5, 0.6), DVec3::X * x * MM))
}

/// The bodies are of one material: light passes from one to the other as if there was no gap.
pub fn gap() -> Place {
    let [one, other] = apart();
    Place::flat("gap", &[part(joined(one, other))], &[sun(DVec3::ONE)], DVec3::ZERO, &gap_views())
}

/// The bodies are of different materials.
pub fn other_material() -> Place {
    let parts = apart().map(part);
    Place::flat("another material", &parts, &[sun(DVec3::ONE)], DVec3::ZERO, &gap_views())
}

/// A body that is smaller than the near part.
pub fn grain() -> Place {
    let views = [onto(0.0, 0.02), [mm(3.0, 1.0, 0.0), DVec3::ZERO], [mm(-1.0, -2.0, -1.0), DVec3::ZERO]];
    Place::flat("grain", &[part(sphere(0.2 * MM, 1))], &[sun(DVec3::ONE)], DVec3::ZERO, &views)
}

/// The edge of the shadow of a black sheet, at x = 0.3 mm. Light from behind counts for nothing.
pub fn shadow() -> Place {
    let cover = Part::opaque(rectangle([-5.0 * MM, 0.0], 5.0 * MM, 0.5 * MM, 1));
    let parts = [part(quad(2.0 * MM, 0.0, 3)), Part { color: DVec3::ZERO, ..cover }];
    // From below the sheet.
    let under = |x: f64| [mm(x, 0.1, 0.4), mm(x, 0.1, 0.0)];
    let lights = [from(mm(-0.3, 0.1, 0.5), DVec3::ONE), from(mm(0.2, -0.3, -0.7), DVec3::splat(0.4))];
    let views = [under(0.28), under(0.32), under(-0.1), under(0.7)];
    Place::flat("shadow", &parts, &lights, DVec3::ZERO, &views)
}

/// A body above a gray floor, under the sky and the sun: on top, beside, close to the floor, and below.
pub fn floor() -> Place {
    let floor = Part { color: mm(0.8, 0.6, 0.4), ..Part::opaque(quad(4.0 * MM, -0.8 * MM, 1)) };
    let below = [mm(0.2, 0.3, -0.75), mm(0.2, 0.3, 0.0)];
    let beside = [mm(-3.0, 0.1, -0.4), mm(0.0, 0.1, -0.4)];
    let views = [onto(0.5, 0.1), [mm(3.0, 0.0, 0.2), mm(0.0, 0.0, 0.2)], beside, below];
    let parts = [part(cube(0.6, 0.6, 0.6)), floor];
    Place::flat("floor", &parts, &[sun(DVec3::ONE)], DVec3::splat(0.2), &views)
}

/// A plane in the light of a warm lamp and a blue sky.
pub fn open_plane() -> Place {
    let sky = mm(0.05, 0.1, 0.3);
    Place::flat("open plane", &[part(quad(9.0 * MM, 0.0, 1))], &[sun(mm(1.0, 0.5, 0.1))], sky, &[onto(0.1, 0.2)])
}

/// A plane in grazing light, of an index at which it grazes below the surface too.
pub fn grazing() -> Place {
    let lights = [from(mm(0.8, 0.6, 0.05), DVec3::ONE)];
    let plane = Place::flat("grazing", &[part(quad(2.0 * MM, 0.0, 3))], &lights, DVec3::ZERO, &[onto(0.1, 0.2)]);
    Place { medium: jelly(1.0), model: Model::DirectionalDipole, ..plane }
}

/// Two bodies of different materials and heights above a floor, under the sky and the sun.
pub fn pair() -> World {
    let bodies = [(-1.1, 1.0), (1.1, 1.6)];
    let [one, other] = bodies.map(|(x, z)| part(at(cube(1.0, 1.5, z), mm(x, 0.0, z) * MM)));
    let floor = Part { color: mm(0.8, 0.6, 0.4), ..Part::opaque(quad(6.0 * MM, -0.2 * MM, 1)) };
    world(&[one, other, floor], &[sun(DVec3::ONE)], DVec3::splat(0.2))
}

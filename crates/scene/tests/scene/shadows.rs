//! Rays that start on the surface: no shadow of the triangle itself or its neighbors, none lost either.

use crate::meshes::{cube, direction, mesh, random, sphere};
use scene::{DVec3, Mesh, NormalKind, Rays, SurfacePoint, warp};

/// Convex, closed: a fine sphere, one of 32 triangles, and a cube, whose sides are two triangles in one plane.
fn convex_meshes() -> Vec<(Mesh, f64)> {
    let radii = [1e-3, 1.0, 1e3];
    radii.iter().flat_map(|r| [(sphere(6, *r), *r), (sphere(1, *r), *r), (cube(*r), *r)]).collect()
}

/// The k-th random point; every fourth is within 2e-10 of an edge or a corner.
fn point(mesh: &Mesh, k: u64) -> SurfacePoint {
    let item = random(k);
    let triangle = (item.bits(0) % mesh.triangles.len() as u64) as u32;
    let [u, v] = [item.uniform(1), item.uniform(2)];
    let [near, nearer] = [(1.0 + u) * 1e-10, (1.0 + v) * 1e-10];
    let mut weights = match k % 8 {
        0 => [near, u, 1.0 - u - near],
        4 => [near, nearer, 1.0 - near - nearer],
        _ => warp::triangle([u, v]),
    };
    weights.rotate_left((item.bits(3) % 3) as usize);
    mesh.point(triangle, weights, NormalKind::Geometric)
}

/// A direction with this cosine to the triangle's normal.
fn at_cosine(point: &SurfacePoint, k: u64, cosine: f64) -> DVec3 {
    let normal = point.geometric_normal;
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let (y, x) = (std::f64::consts::TAU * random(k).uniform(7)).sin_cos();
    let flat = (1.0 - cosine * cosine).sqrt();
    (tangent * (x * flat) + bitangent * (y * flat) + normal * cosine).normalize()
}

#[test]
fn a_convex_mesh_casts_no_shadow_on_itself() {
    for (mesh, radius) in convex_meshes() {
        let rays = Rays::new(&mesh);
        for k in 0..60_000 {
            let at = point(&mesh, k);
            let cosine = [1e-7, 1e-6, 1e-4, 1e-2, 0.5, 1.0][(k % 6) as usize];
            let towards = at_cosine(&at, k, cosine);
            let clear = rays.visible(at.position, towards, f64::INFINITY, Some(at.triangle));
            assert!(clear, "radius {radius}, cosine {cosine}, point {k} {}", at.position / radius);
            let hit = rays.closest(at.position, towards, Some(at.triangle));
            assert!(hit.is_none(), "radius {radius}, cosine {cosine}, point {k}: {hit:?}");
        }
    }
}

#[test]
fn a_ray_from_the_surface_inwards_always_meets_the_other_side() {
    for (mesh, radius) in convex_meshes() {
        let rays = Rays::new(&mesh);
        for k in 0..60_000 {
            let at = point(&mesh, k);
            let cosine = [-1e-5, -1e-3, -0.1, -0.5, -0.9, -1.0][(k % 6) as usize];
            // A flat ray so near to an edge is deeper inside by less than its start is rounded: it may pass outside.
            let cosine = if k % 4 == 0 { f64::min(cosine, -1e-2) } else { cosine };
            let towards = at_cosine(&at, k, cosine);
            let hit = rays.closest(at.position, towards, Some(at.triangle));
            assert!(hit.is_some(), "radius {radius}, cosine {cosine}, point {k} {}", at.position / radius);
            assert!(hit.is_some_and(|h| h.distance >= 0.0 && h.triangle != at.triangle));
            assert!(!rays.visible(at.position, towards, f64::INFINITY, Some(at.triangle)));
        }
    }
}

/// A square sheet of two triangles at each of these heights; the upper side faces up, the lower down.
fn sheets(size: f64, low: f64, high: f64) -> Mesh {
    let square = |z: f64| [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, z) * size);
    let points = [square(low), square(high)].concat();
    mesh(&points, &[[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]])
}

#[test]
fn a_thin_sheet_shadows_its_other_side() {
    for size in [1e-3, 1.0, 1e3] {
        let mesh = sheets(size, 0.0, 1e-6);
        let rays = Rays::new(&mesh);
        for k in 0..10_000 {
            let item = random(k);
            let upper = k % 2 == 0;
            let at = mesh.point(if upper { 2 } else { 0 }, warp::triangle([0.25, 0.5]), NormalKind::Geometric);
            let towards = direction(item, 3);
            let above = (towards.z > 0.0) == upper;
            // The ray that goes into the sheet leaves by the other layer, unless it is so flat that it leaves sideways.
            if towards.z.abs() > 1e-5 {
                let clear = rays.visible(at.position, towards, f64::INFINITY, Some(at.triangle));
                assert_eq!(clear, above, "size {size}, direction {towards}");
            }
        }
    }
}

/// A sheet modeled twice, back to back without thickness, is lit on both sides.
#[test]
fn a_sheet_without_thickness_does_not_shadow_itself() {
    for size in [1e-3, 1.0, 1e3] {
        let mesh = sheets(size, 0.3, 0.3);
        let rays = Rays::new(&mesh);
        for k in 0..10_000 {
            let at = point(&mesh, k);
            let towards = at_cosine(&at, k, [1e-6, 1e-3, 0.7][(k % 3) as usize]);
            assert!(rays.visible(at.position, towards, f64::INFINITY, Some(at.triangle)), "size {size}, point {k}");
        }
    }
}

/// In a notch, each side shadows low light from behind the other, up to the crease itself.
#[test]
fn a_notch_shadows_up_to_its_crease() {
    let points = [
        DVec3::new(0.0, 0.0, -1.0),
        DVec3::new(0.0, 0.0, 1.0),
        DVec3::new(1.0, 1e-3, 0.0),
        DVec3::new(-1.0, 1e-3, 0.0),
    ];
    let mesh = mesh(&points, &[[0, 1, 2], [1, 0, 3]]);
    let rays = Rays::new(&mesh);
    for (t, side) in [(0u32, -1.0), (1, 1.0)] {
        for from_crease in [0.1, 1e-3, 1e-6, 1e-9] {
            let w = 1.0 - from_crease;
            let at = mesh.point(t, [0.5 * w, 0.5 * w, from_crease], NormalKind::Geometric);
            assert!(at.geometric_normal.y > 0.9);
            let towards = |slope: f64| DVec3::new(side, slope, 0.0).normalize();
            let clear = |slope| rays.visible(at.position, towards(slope), f64::INFINITY, Some(at.triangle));
            assert!(!clear(-5e-4) && !clear(0.0), "over the crease at {from_crease}");
            assert!(clear(1.2e-3) && clear(1e-2), "above the other side at {from_crease}");
        }
    }
}

/// The way to a point on a surface is clear although the surface lies at its end.
#[test]
fn the_end_of_the_way_is_not_in_the_way() {
    let mesh = sphere(5, 1.0);
    let rays = Rays::new(&mesh);
    for k in 0..20_000 {
        let (from, to) = (point(&mesh, 2 * k + 1).position * 0.2, point(&mesh, 3 * k + 1));
        let way = to.position - from;
        let (distance, direction) = (way.length(), way.normalize());
        assert!(rays.visible(from, direction, distance, None), "point {k}");
        assert!(!rays.visible(from, direction, distance * (1.0 + 1e-7), None), "point {k}");
    }
}

//! Scenes: .glb and .gltf files.

use crate::{file::with_file, medium::check_medium, pipeline::check_pipeline, view::check_camera};
use scene::{
    DVec3, NormalKind, Rays, Scene,
    light::{LightTree, all_light_at},
};
use test_support::glb::OPTIONS;

/// Larger scenes are only read.
const MAX_TRIANGLES: usize = 1 << 12;
/// Number of triangles that are lit.
const LIT: usize = 64;

/// An accepted scene has triangles with area, normals, light that is finite and not negative, and cameras; its media
/// are valid or refused.
pub fn gltf(bytes: &[u8]) -> bool {
    let imported = with_file("scene.glb", bytes, |path| {
        Scene::import(path, &OPTIONS).inspect_err(|e| assert!(e.to_string().contains("scene.glb"), "{e}"))
    });
    let Ok(scene) = imported else { return false };
    assert!(!scene.mesh.triangles.is_empty() && scene.origin.is_finite());
    scene.cameras.iter().for_each(check_camera);
    for material in &scene.materials {
        cli::scene_medium(material).iter().flatten().for_each(check_medium);
    }
    if scene.mesh.triangles.len() <= MAX_TRIANGLES {
        check_surface(&scene);
    }
    true
}

fn check_surface(scene: &Scene) {
    let translucent = scene.translucent().map_or(Vec::new(), |(materials, _)| materials);
    scene.defects(|material| translucent.contains(&material));
    let rays = Rays::of_scene(scene, |material| translucent.contains(&material));
    let lights = LightTree::new(scene.lights());
    let count = scene.mesh.triangles.len();
    for k in (0..count).step_by(count.div_ceil(LIT)) {
        assert!(usize::from(scene.mesh.triangles[k].material) < scene.materials.len());
        let point = scene.mesh.point(k as u32, [0.2, 0.3, 0.5], NormalKind::Shading);
        assert!(scene.mesh.area(k) > 0.0 && point.position.is_finite());
        // Shading normals are rounded to float32 and interpolated.
        assert!((point.normal.length() - 1.0).abs() < 1e-6 && (point.geometric_normal.length() - 1.0).abs() < 1e-12);
        for light in scene.lights() {
            assert!(light.importance(&point) >= 0.0);
            if let Some(arriving) = light.illuminate(&point, [0.3, 0.6]) {
                assert!(arriving.irradiance.is_finite() && arriving.irradiance.min_element() >= 0.0);
                rays.visible(point.position, arriving.direction, arriving.distance, Some(k as u32));
            }
        }
        all_light_at(&lights, &rays, &point, || [0.3, 0.6], &mut 0);
    }
    for camera in &scene.cameras {
        let (origin, direction) = camera.ray([3.0; 2].into(), [8.0; 2].into());
        rays.closest(origin - scene.origin, direction, None);
    }
    assert!(rays.closest(DVec3::ZERO, DVec3::X, None).is_none_or(|hit| hit.distance >= 0.0));
    check_pipeline(scene, &rays);
}

//! Scenes through both phases: every result must be fit for a file.

use bssrdf::Medium;
use formats::cloud::Cloud;
use gather::{Rendered, Settings, counts::Counts, film};
use glam::DVec3;
use scene::Camera;
use test_support::{
    meshes::World,
    pipeline::{by_area, cloud, gray, input, orthographic},
};

/// The sky that clear objects show, which is no light to sample: powers of two, so that means of equal values are
/// exact.
pub const SKY: DVec3 = DVec3::new(1.0, 0.5, 4.0);

/// What is known of a path's light before it is traced may exceed it, so that a pixel at an edge may be negative
/// (docs/method.md 13.2), in images of a few coarse pixels by up to so much of the brightest one: 0.13 was seen.
const BELOW_ZERO: f32 = 0.2;

/// Renders, and fails if a number of the image is not finite or a radiance is negative that no edge explains.
pub fn render(world: &World, cloud: &Cloud, media: &[Medium], camera: &Camera, settings: &Settings) -> Rendered {
    let input = input(world, std::slice::from_ref(cloud), media, camera);
    let rendered = gather::render(&input, settings, |_| ());
    assert_eq!((rendered.non_finite_count, &rendered.non_finite), (0, &Vec::new()));
    let image = film::image(&rendered.pixels, settings.width, settings.height);
    for channel in &image.channels {
        let signed = ["N.", "P.", "Z"].iter().any(|prefix| channel.name.starts_with(prefix));
        let brightest = channel.samples.iter().fold(0.0f32, |max, x| max.max(*x));
        let corrected = ["R", "G", "B", "subsurface.", "specular."].iter().any(|name| channel.name.starts_with(name));
        let least = if corrected && rendered.counts.edge_pixels > 0 { -BELOW_ZERO * brightest } else { 0.0 };
        assert!(channel.samples.iter().all(|x| x.is_finite() && (signed || *x >= least)), "{}", channel.name);
    }
    rendered
}

/// A channel of the image.
pub fn channel(rendered: &Rendered, settings: &Settings, name: &str) -> Vec<f32> {
    let image = film::image(&rendered.pixels, settings.width, settings.height);
    image.channel(name).expect("the film has this channel").to_vec()
}

/// A scene under [`SKY`] with an arbitrary cloud of it, whose light does not leave a clear medium.
pub struct Clear {
    pub world: World,
    cloud: Cloud,
}

impl Clear {
    pub fn new(mut world: World) -> Clear {
        world.scene.environment = SKY.into();
        let cloud = cloud(&world, &by_area(16, 0));
        Clear { world, cloud }
    }

    /// Renders with clear media of these indices.
    pub fn render(&self, etas: &[f64], camera: &Camera, settings: &Settings) -> Rendered {
        let media: Vec<Medium> = etas.iter().map(|eta| gray(0.0, 0.0, 0.0, *eta)).collect();
        render(&self.world, &self.cloud, &media, camera, settings)
    }
}

/// Renders objects of clear media under [`SKY`] all around: every pixel must show that radiance, up to the rounding
/// of the two shares into which its first interface splits it, and no path may be lost.
pub fn assert_invisible(what: &str, clear: &Clear, etas: &[f64], camera: &Camera, settings: &Settings) -> Counts {
    let settings = Settings { max_depth: 256, ..settings.clone() };
    let rendered = clear.render(etas, camera, &settings);
    let counts = rendered.counts;
    let shows_sky = |p: &film::Pixel| (p.beauty() / SKY - 1.0).abs().max_element() < 1e-14;
    assert!(rendered.pixels.iter().all(shows_sky), "{what}: {counts:?}");
    assert_eq!((counts.cut_by_depth, counts.gathers), (0, 0), "{what}");
    counts
}

/// A camera whose central ray runs through `target` from the direction `towards`.
pub fn aimed_at(target: DVec3, towards: DVec3, half_height: f64) -> Camera {
    let camera = orthographic(towards, half_height);
    Camera { position: camera.position + target, ..camera }
}

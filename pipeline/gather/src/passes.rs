//! Pixels in parallel, paths in passes.

use crate::{
    Crop, Filter, Input, Rendered, Session, Settings, calibration,
    counts::Counts,
    edge::{self, Edge},
    estimator::{Calibration, Estimator, FalloffTables},
    film::{Errors, Pixel, PixelSum},
    path_state::{PathIndex, ThreadContext},
    renderer::{Method, Renderer, TranslucentObject},
    samples::LitSamples,
    shards::{self, DrawnCounts},
};
use bssrdf::{Medium, lanes::LaneModel};
use formats::cloud::Cloud;
use glam::DVec2;
use rayon::prelude::*;
use scene::{
    DVec3,
    light::LightTree,
    random::{Purpose, Stream},
    sequence::Sequence,
};
use std::ops::Range;

/// One task renders a square of so many pixels a side.
const TILE: usize = 8;

/// Share of the scene's diagonal that a ray skips when it passes a surface straight.
const CLEARANCE: f64 = 1e-9;

/// An image of one model on its way.
pub struct Passes<'a, M> {
    renderer: Renderer<'a, M>,
    settings: Settings,
    /// What is rendered: sums and edges are those of its pixels, by their places in it.
    part: Crop,
    sums: Vec<PixelSum>,
    /// Of the pixels that are one.
    edges: Vec<Option<Box<Edge>>>,
    /// Paths of each pixel so far.
    paths: u32,
    counts: Counts,
    pixel_stream: Stream,
    edge_stream: Stream,
}

/// Of one pixel, and what it has if it is an edge.
type Sums = (PixelSum, Option<Box<Edge>>);

impl<'a, M: LaneModel> Passes<'a, M> {
    pub fn new(input: &Input<'a>, settings: &Settings) -> Self {
        let mut renderer = Renderer {
            scene: input.scene,
            rays: input.rays,
            lights: LightTree::new(&input.scene.lights),
            camera: input.camera,
            objects: objects::<M>(input, settings),
            environment: settings.environment.clone(),
            normals: settings.normals,
            estimator: settings.estimator,
            drawn: DrawnCounts::of(input.clouds),
            paths_per_pixel: settings.paths_per_pixel,
            pass: 0..settings.paths_per_pixel,
            max_depth: settings.max_depth,
            clearance: CLEARANCE * input.scene.mesh.diagonal(),
            paths: Stream::new(settings.seed, Purpose::CameraPath),
            gathers: Stream::new(settings.seed, Purpose::Gather),
            shard_picks: Stream::new(settings.seed, Purpose::ShardPick),
        };
        calibration::calibrate(&mut renderer, size(settings), settings.seed);
        let mut passes = Passes {
            renderer,
            settings: settings.clone(),
            edges: vec![None; settings.part().pixels()],
            sums: vec![PixelSum::default(); settings.part().pixels()],
            part: settings.part(),
            paths: 0,
            counts: Counts::default(),
            pixel_stream: Stream::new(settings.seed, Purpose::Pixel),
            edge_stream: Stream::new(settings.seed, Purpose::Edge),
        };
        passes.find_edges();
        passes
    }

    /// Looks at the corners of all pixels for edges. One path a pixel has no second half to take a factor from, and all
    /// rays through pixel centres are alike.
    fn find_edges(&mut self) {
        if self.settings.paths_per_pixel == 1 || self.settings.filter == Filter::Point {
            return;
        }
        let Crop { x: left, y: upper, width, height } = self.part;
        let row = |y: usize| {
            let mut counts = Counts::default();
            let corner = |x: usize, counts: &mut Counts| {
                let (origin, direction) = self.ray_at(DVec2::new((left + x) as f64, (upper + y) as f64));
                self.renderer.through(origin, direction, counts)
            };
            ((0..=width).map(|x| corner(x, &mut counts)).collect::<Vec<f64>>(), counts)
        };
        let rows: Vec<(Vec<f64>, Counts)> = (0..=height).into_par_iter().map(row).collect();
        for place in 0..width * height {
            let (x, y) = (place % width, place / width);
            let corners = [rows[y].0[x], rows[y].0[x + 1], rows[y + 1].0[x], rows[y + 1].0[x + 1]];
            let spread = corners.into_iter().fold(0.0, f64::max) - corners.into_iter().fold(1.0, f64::min);
            self.edges[place] = (spread > edge::MIN_SPREAD).then(Box::default);
        }
        rows.iter().for_each(|(_, counts)| self.counts.add(counts));
        self.counts.edge_pixels = self.edges.iter().flatten().count() as u64;
    }

    /// The pixels of a tile, row by row.
    fn places(&self, tile: usize) -> impl Iterator<Item = usize> + use<M> {
        let Crop { width, height, .. } = self.part;
        let across = width.div_ceil(TILE);
        let (x, y) = (tile % across * TILE, tile / across * TILE);
        let (x_end, y_end) = ((x + TILE).min(width), (y + TILE).min(height));
        (y..y_end).flat_map(move |y| (x..x_end).map(move |x| y * width + x))
    }

    fn tiles(&self) -> usize {
        self.part.width.div_ceil(TILE) * self.part.height.div_ceil(TILE)
    }

    /// The ray through a point of a pixel, `offset` pixels from its corner.
    fn ray(&self, place: usize, offset: DVec2) -> (DVec3, DVec3) {
        let [x, y] = self.part.pixel(place);
        self.ray_at(DVec2::new(x as f64, y as f64) + offset)
    }

    /// The ray through a point of the image, pixels.
    fn ray_at(&self, point: DVec2) -> (DVec3, DVec3) {
        let (origin, direction) = self.renderer.camera.ray(point, size(&self.settings));
        (origin - self.renderer.scene.origin, direction)
    }

    fn add_paths(&self, place: usize, paths: Range<u32>, context: &mut ThreadContext) -> Sums {
        // The random numbers are those of the pixel in the whole image.
        let [x, y] = self.part.pixel(place);
        let pixel = (y * self.settings.width + x) as u64;
        // Even and odd paths are spread by a sequence each, so that they stay independent.
        let spread_by = |stream: Stream| [0, 1].map(|half| Sequence::new(stream.item(2 * pixel + half), stream));
        let spread = spread_by(self.pixel_stream);
        let mut edge = self.edges[place].clone().map(|edge| (edge, spread_by(self.edge_stream)));
        let alone = self.settings.paths_per_pixel == 1;
        let mut sum = self.sums[place];
        for path in paths {
            let offset = match self.settings.filter {
                Filter::Point => DVec2::splat(0.5),
                Filter::Box => {
                    let [x, y, ..] = spread[path as usize % 2].point(path / 2);
                    DVec2::new(x, y)
                }
            };
            let (origin, direction) = self.ray(place, offset);
            let light = self.renderer.trace(PathIndex { pixel, path }, origin, direction, context);
            sum.add(path, alone, &light);
            if let Some((edge, spread)) = &mut edge {
                let half = path as usize % 2;
                edge.add_path(half, &light);
                for ray in 0..edge::RAYS {
                    let [x, y, ..] = spread[half].point(path / 2 * edge::RAYS + ray);
                    let (origin, direction) = self.ray(place, DVec2::new(x, y));
                    edge.add_ray(half, self.renderer.through(origin, direction, &mut context.counts));
                }
            }
        }
        (sum, edge.map(|(edge, _)| edge))
    }

    fn pixel(&self, place: usize) -> Pixel {
        let (origin, direction) = self.ray(place, DVec2::splat(0.5));
        self.sums[place].pixel(self.edges[place].as_deref(), self.renderer.guide(origin, direction))
    }
}

impl<M: LaneModel> Session for Passes<'_, M> {
    fn pass(&mut self, paths: u32, progress: &(dyn Fn(u64) + Sync)) {
        let range = self.paths..self.paths.saturating_add(paths);
        self.renderer.paths_per_pixel = self.settings.paths_per_pixel.max(range.end);
        self.renderer.pass = range.clone();
        let tile = |tile: usize| {
            let mut context = ThreadContext::new(self.renderer.objects.len());
            let add = |place: usize| (place, self.add_paths(place, range.clone(), &mut context));
            let sums: Vec<(usize, Sums)> = self.places(tile).map(add).collect();
            progress(sums.len() as u64);
            (sums, context.counts)
        };
        let tiles: Vec<_> = (0..self.tiles()).into_par_iter().map(tile).collect();
        for (sums, counts) in tiles {
            self.counts.add(&counts);
            sums.into_iter().for_each(|(place, sum)| (self.sums[place], self.edges[place]) = sum);
        }
        self.paths = range.end;
    }

    fn errors(&self) -> Option<Errors> {
        Errors::of([self.part.width, self.part.height], self.sums.iter().zip(self.edges.iter().map(Option::as_deref)))
    }

    fn finish(self: Box<Self>) -> Rendered {
        let pixels: Vec<Pixel> = (0..self.sums.len()).into_par_iter().map(|place| self.pixel(place)).collect();
        let bad = || pixels.iter().enumerate().filter(|(_, p)| !p.is_finite()).map(|(k, _)| k);
        let (non_finite, non_finite_count) = (bad().take(8).collect(), bad().count() as u64);
        Rendered { pixels, paths_per_pixel: self.paths, counts: self.counts, non_finite, non_finite_count }
    }
}

/// Width and height of the whole image, pixels.
fn size(settings: &Settings) -> DVec2 {
    DVec2::new(settings.width as f64, settings.height as f64)
}

/// The samples of one sampled material in one cloud: its halves.
fn part<'a>(cloud: &'a Cloud, slot: usize, medium: &Medium) -> [LitSamples<'a>; 2] {
    cloud.meta().materials[slot].halves.map(|half| LitSamples::new(cloud, &half, medium.eta))
}

fn objects<'a, M: LaneModel>(input: &Input<'a>, settings: &Settings) -> Vec<Option<TranslucentObject<'a, M>>> {
    let mut objects: Vec<Option<TranslucentObject<M>>> = input.scene.materials.iter().map(|_| None).collect();
    for (slot, (sampled, medium)) in shards::materials(input.clouds).iter().zip(input.media).enumerate() {
        let model = settings.model.of(medium);
        let method = match settings.estimator {
            Estimator::Exhaustive => Method::Exhaustive,
            Estimator::Roulette(rule) => Method::Roulette(rule.rates(model.transport())),
            Estimator::Cut { .. } => Method::Cut(FalloffTables::new(medium, &*model, sampled.area_m2.sqrt())),
        };
        objects[sampled.index as usize] = Some(TranslucentObject {
            model: M::new(medium),
            unscattered: settings.model.unscattered_extinction(medium),
            method,
            calibration: Calibration::default(),
            parts: input.clouds.iter().map(|cloud| part(cloud, slot, medium)).collect(),
            medium: medium.clone(),
        });
    }
    objects
}

//! Renders pixels in parallel, and adds paths to all of them in passes.

use crate::{
    allotment::Allotment,
    counts::Counts,
    crop::Crop,
    cut_correction,
    edge::{self, Corner},
    errors::Errors,
    film::Pixel,
    highlights::Highlights,
    image::{Filter, Input, Rendered, Settings},
    known::Known,
    objects::objects,
    path_state::{PathIndex, ThreadContext},
    pixel_numbers::{NearNumbers, PixelNumbers, Streams, SurfaceNumbers, halves},
    pixel_sum::PixelSum,
    reference::{Walks, meets_light},
    renderer::{Renderer, TranslucentObject},
    state::State,
    watch::{Tile, Watch},
};
use glam::DVec2;
use near_field::Surroundings;
use rayon::prelude::*;
use scene::{
    DVec3,
    light::LightTree,
    random::{Purpose, Stream},
};
use std::ops::Range;
use sums::drawn::DrawnCounts;

/// Side of the square tile that a task renders, pixels.
pub(crate) const TILE: usize = 8;

/// A ray that crosses a surface undeflected continues at this distance beyond it, as a share of the scene's diagonal.
const CLEARANCE: f64 = 1e-9;

/// The middle of a lens, and places around its rim, by the numbers that choose them.
const ACROSS_THE_LENS: [Option<[f64; 2]>; 9] = [
    None,
    Some([0.0, 0.0]),
    Some([0.5, 0.0]),
    Some([1.0, 0.0]),
    Some([0.0, 0.5]),
    Some([1.0, 0.5]),
    Some([0.0, 1.0]),
    Some([0.5, 1.0]),
    Some([1.0, 1.0]),
];

/// An image to which paths are added in passes.
pub struct Passes<'a> {
    renderer: Renderer<'a>,
    /// The part of the image that is rendered. Its pixels are indexed row by row.
    part: Crop,
    sums: Vec<PixelSum>,
    /// Whether each pixel is an edge pixel.
    edges: Vec<bool>,
    /// Paths that each pixel has so far, or that all share for each.
    paths: u32,
    /// The shares of the pixels in the paths, once they are shared out.
    pub(crate) allotment: Option<Allotment>,
    counts: Counts,
    /// Random numbers of all pixels.
    streams: Streams,
    edge_stream: Stream,
}

impl<'a> Passes<'a> {
    /// Prepares an image; the cut is as accurate as `settings.paths_per_pixel` paths need, or as their noise deserves.
    pub fn new(input: &Input<'a>, settings: &Settings) -> Self {
        let objects = objects(input, settings);
        let is_near = objects.iter().flatten().any(|object| object.parts.iter().any(|part| part.near.is_some()));
        let translucent = |material: u16| objects[material as usize].is_some();
        let surroundings = || Surroundings::new(input.scene, input.rays, settings.normals, translucent);
        let surroundings = is_near.then(surroundings);
        let renderer = Renderer {
            input: *input,
            meets_light: meets_light(input, |material| objects[material as usize].is_none()),
            settings: settings.clone(),
            lights: LightTree::new(input.scene.lights()),
            surroundings,
            highlights: Highlights::default(),
            known: Known::new([settings.width, settings.height]),
            objects,
            drawn: DrawnCounts::of(input.clouds),
            paths_per_pixel: f64::from(settings.paths_per_pixel),
            pass: 0..settings.paths_per_pixel,
            clearance: CLEARANCE * input.scene.mesh.diagonal(),
            paths: Stream::new(settings.seed, Purpose::CameraPath),
            gathers: Stream::new(settings.seed, Purpose::Gather),
            shard_picks: Stream::new(settings.seed, Purpose::ShardPick),
            walk_starts: Stream::new(settings.seed, Purpose::WalkStart),
            near_points: Stream::new(settings.seed, Purpose::NearPoint),
        };
        let stream = |purpose: Purpose| Stream::new(settings.seed, purpose);
        let many_directions = |object: &Option<_>| object.as_ref().is_none_or(TranslucentObject::is_rough);
        let streams = Streams {
            places: stream(Purpose::Pixel),
            lens: input.camera.lens.map(|_| stream(Purpose::Lens)),
            walks: settings.reference.then_some(renderer.walk_starts),
            near: renderer.surroundings.is_some().then(|| [Purpose::NearField, Purpose::NearLight].map(stream)),
            surface: renderer.objects.iter().any(many_directions).then(|| stream(Purpose::FirstSurface)),
        };
        let mut passes = Passes {
            renderer,
            edges: vec![false; settings.part().pixels()],
            sums: vec![PixelSum::default(); settings.part().pixels()],
            part: settings.part(),
            paths: 0,
            allotment: None,
            counts: Counts::default(),
            streams,
            edge_stream: stream(Purpose::Edge),
        };
        let walks = passes.renderer.objects.iter().flatten().filter_map(|object| object.walks.as_ref());
        passes.counts.reflections_left_out = walks.map(Walks::incomplete).sum();
        if passes.streams.surface.is_some() {
            let pixels = (settings.width * settings.height) as u64;
            let (highlights, counts) = passes.renderer.find_highlights(pixels, stream(Purpose::Highlight));
            passes.renderer.highlights = highlights;
            passes.counts.add(&counts);
        }
        passes.find_edges();
        if settings.balances {
            passes.balance();
        }
        cut_correction::correct(&mut passes.renderer);
        passes.renderer.known = Known::new([settings.width, settings.height]);
        passes
    }

    /// The settings that the image is rendered with.
    pub fn settings(&self) -> &Settings {
        &self.renderer.settings
    }

    /// Sets the accuracy of the cut.
    pub(crate) fn set_accuracy(&mut self, accuracy: f64) {
        let settings = &mut self.renderer.settings;
        settings.estimator = settings.estimator.map_accuracy(|_| accuracy);
    }

    /// What `work` makes of the first `paths` of pixels, which are planned together, whose gathers take their random
    /// numbers from `gathers`.
    pub(crate) fn trying<T>(&mut self, paths: u32, gathers: Stream, work: impl FnOnce(&Self) -> T) -> T {
        let (planned, own) = (self.renderer.pass.clone(), self.renderer.gathers);
        (self.renderer.pass, self.renderer.gathers) = (0..paths, gathers);
        let made = work(self);
        (self.renderer.pass, self.renderer.gathers) = (planned, own);
        made
    }

    /// What the paths of the image share.
    pub(crate) fn renderer(&self) -> &Renderer<'a> {
        &self.renderer
    }

    /// Finds edge pixels by what is seen at the corners of all pixels, and across the lens if there is one. There are none
    /// with one path per pixel, whose image is that of its paths alone, nor with rays through pixel centers, which are all
    /// the same, nor for random walks, of which one tells little of the light nearby.
    fn find_edges(&mut self) {
        let settings = &self.renderer.settings;
        if settings.paths_per_pixel == 1 || settings.filter == Filter::Point || settings.reference {
            return;
        }
        let Crop { x: left, y: upper, width, height } = self.part;
        let row = |y: usize| {
            let mut counts = Counts::default();
            let corner = |x: usize, counts: &mut Counts| self.seen_at_corner([left + x, upper + y], counts);
            ((0..=width).map(|x| corner(x, &mut counts)).collect::<Vec<Corner>>(), counts)
        };
        let rows: Vec<(Vec<Corner>, Counts)> = (0..=height).into_par_iter().map(row).collect();
        for index in 0..width * height {
            let (x, y) = (index % width, index / width);
            let corners = [rows[y].0[x], rows[y].0[x + 1], rows[y + 1].0[x], rows[y + 1].0[x + 1]];
            self.edges[index] = edge::is_between(corners);
        }
        rows.iter().for_each(|(_, counts)| self.counts.add(counts));
        self.counts.edge_pixels = self.edges.iter().filter(|edge| **edge).count() as u64;
    }

    /// What is seen of scattered light at the upper left corner of a pixel, through all of the lens.
    pub(crate) fn seen_at_corner(&self, [x, y]: [usize; 2], counts: &mut Counts) -> Corner {
        let lens: &[Option<[f64; 2]>] = if self.streams.lens.is_some() { &ACROSS_THE_LENS } else { &[None] };
        let range = |mut corner: Corner, lens: &Option<[f64; 2]>| {
            let (origin, direction) = self.renderer.camera_ray(DVec2::new(x as f64, y as f64), *lens);
            for ([low, high], seen) in corner.iter_mut().zip(self.renderer.seen(origin, direction, counts)) {
                let share = seen.map_or(0.0, |(_, share)| share);
                (*low, *high) = (low.min(share), high.max(share));
            }
            corner
        };
        lens.iter().fold([[1.0, 0.0]; 2], range)
    }

    /// The indices of the pixels of a tile, row by row.
    fn pixels_of(&self, tile: usize) -> impl Iterator<Item = usize> + use<> {
        let Crop { width, height, .. } = self.part;
        let across = width.div_ceil(TILE);
        let (x, y) = (tile % across * TILE, tile / across * TILE);
        let (x_end, y_end) = ((x + TILE).min(width), (y + TILE).min(height));
        (y..y_end).flat_map(move |y| (x..x_end).map(move |x| y * width + x))
    }

    fn tiles(&self) -> usize {
        self.part.width.div_ceil(TILE) * self.part.height.div_ceil(TILE)
    }

    /// The ray through a point of a pixel, `offset` pixels from its corner, and through the place on the lens that
    /// `lens` chooses, or its middle.
    fn ray(&self, [x, y]: [usize; 2], offset: DVec2, lens: Option<[f64; 2]>) -> (DVec3, DVec3) {
        self.renderer.camera_ray(DVec2::new(x as f64, y as f64) + offset, lens)
    }

    /// The sums of a pixel of the part with more paths.
    fn add_paths(&self, index: usize, paths: Range<u32>, context: &mut ThreadContext) -> PixelSum {
        // The random numbers of a pixel do not depend on what part of the image is rendered.
        self.add_to(self.part.pixel(index), (self.sums[index], self.edges[index]), paths, context)
    }

    /// The sums of any pixel of the image, by its column and row, with more paths.
    pub(crate) fn add_to(
        &self,
        at: [usize; 2],
        (mut sum, edge): (PixelSum, bool),
        paths: Range<u32>,
        context: &mut ThreadContext,
    ) -> PixelSum {
        let settings = &self.renderer.settings;
        let pixel = (at[1] * settings.width + at[0]) as u64;
        let numbers = PixelNumbers::new(pixel, self.streams);
        let spread = edge.then(|| halves(self.edge_stream, pixel));
        let alone = settings.paths_per_pixel == 1;
        for path in paths {
            let offset = match settings.filter {
                Filter::Point => DVec2::splat(0.5),
                Filter::Box => DVec2::from_array(numbers.place(path)),
            };
            let (origin, direction) = self.ray(at, offset, numbers.lens(path));
            let path_index = PathIndex {
                pixel,
                path,
                edge,
                walks: numbers.walks(path),
                near: self.streams.near.map(|streams| NearNumbers::new(streams, pixel, path)),
                surface: self.streams.surface.map(|stream| SurfaceNumbers::new(stream, pixel, path)),
            };
            let mut light = self.renderer.trace(path_index, origin, direction, context);
            if let Some(spread) = &spread {
                let spread = &spread[path as usize % 2];
                let rays = (0..edge::RAYS).map(|ray| spread.point(path / 2 * edge::RAYS + ray));
                self.renderer.control(at, &mut light, rays, context);
            }
            sum.add(path, alone, &light);
        }
        sum
    }

    fn pixel(&self, index: usize) -> Pixel {
        let (origin, direction) = self.ray(self.part.pixel(index), DVec2::splat(0.5), None);
        self.sums[index].pixel(self.renderer.guide(origin, direction))
    }

    /// Paths that each pixel has, or that all share for each.
    pub fn paths(&self) -> u32 {
        self.paths
    }

    /// Says that the next `paths` of each pixel are planned together: shards are picked for all of them, and the cut is
    /// as accurate as they need. Before the first plan, all paths of the settings are.
    pub fn plan(&mut self, paths: u32) {
        self.renderer.pass = self.paths..self.paths.saturating_add(paths);
        let paths = self.renderer.settings.paths_per_pixel.max(self.renderer.pass.end);
        self.renderer.paths_per_pixel = self.effective_paths(paths);
    }

    /// Adds `paths` to each pixel, or to those that all share; the watch is told of the tiles. False if it stopped the
    /// pass: nothing is added then.
    pub fn pass(&mut self, paths: u32, watch: &impl Watch) -> bool {
        let end = self.paths.saturating_add(paths);
        if end > self.renderer.pass.end {
            self.plan(paths);
        }
        let tile = |tile: usize| {
            if watch.stops() {
                return None;
            }
            let mut context = ThreadContext::new(self.renderer.objects.len());
            let mut added = 0;
            let add = |index: usize| {
                let [before, after] = [self.paths, end].map(|level| self.paths_of(index, level));
                added += u64::from(after - before);
                (index, self.add_paths(index, before..after, &mut context))
            };
            let sums: Vec<(usize, PixelSum)> = self.pixels_of(tile).map(add).collect();
            watch.done(&Tile { part: self.part, sums: &sums, paths: added });
            context.counts.near_field(&context.near.work);
            Some((sums, context.counts))
        };
        // Tiles differ much in their work. A thread that has none left takes single ones from another; without a limit, rayon
        // makes a few pieces of many tiles, and a piece that a thread has begun stays with it.
        let tiles: Option<Vec<_>> = (0..self.tiles()).into_par_iter().with_max_len(1).map(tile).collect();
        let Some(tiles) = tiles else { return false };
        for (sums, counts) in tiles {
            self.counts.add(&counts);
            sums.into_iter().for_each(|(index, sum)| self.sums[index] = sum);
        }
        self.paths = end;
        true
    }

    /// The sums of a pixel of the part.
    pub(crate) fn sums(&self, index: usize) -> &PixelSum {
        &self.sums[index]
    }

    /// Whether a pixel of the part is an edge pixel.
    pub(crate) fn is_edge(&self, index: usize) -> bool {
        self.edges[index]
    }

    /// The sums so far, from which [`Passes::resume`] goes on.
    pub fn state(&self) -> State {
        State::of(self.paths, &self.sums, self.allotment.as_ref())
    }

    /// Goes on from the sums of an image of the same settings and part, as if its paths were those of this one. All paths
    /// of the settings that are left are planned together.
    pub fn resume(&mut self, state: &State) {
        self.allotment = state.allotment(self.rounding());
        let paths: Vec<u32> = (0..self.sums.len()).map(|index| self.paths_of(index, state.paths)).collect();
        state.restore(&paths, &mut self.sums);
        self.paths = state.paths;
        self.plan(self.renderer.settings.paths_per_pixel.saturating_sub(self.paths));
    }

    /// The counts of some of the first paths, which are added to no sum. Paths that are numbered one after another are
    /// spread over the whole image.
    pub fn first_paths(&self, numbers: Range<u64>) -> Counts {
        let pixels = self.part.pixels();
        let of_path = |number: u64| {
            // Multiples of the golden section leave no large part of the image out.
            let share = (number as f64 * 0.618_033_988_749_895).fract();
            let (pixel, path) = ((share * pixels as f64) as usize, (number / pixels as u64) as u32);
            let mut context = ThreadContext::new(self.renderer.objects.len());
            self.add_paths(pixel.min(pixels - 1), path..path + 1, &mut context);
            context.counts
        };
        let all: Vec<Counts> = numbers.into_par_iter().map(of_path).collect();
        all.iter().fold(Counts::default(), |mut sum, counts| {
            sum.add(counts);
            sum
        })
    }

    /// The errors of the image so far; none if it is black.
    pub fn errors(&self) -> Option<Errors> {
        Errors::of([self.part.width, self.part.height], self.sums.iter())
    }

    /// The image so far.
    pub fn image(&self) -> Rendered {
        let pixels: Vec<Pixel> = (0..self.sums.len()).into_par_iter().map(|index| self.pixel(index)).collect();
        let bad: Vec<usize> = (0..pixels.len()).into_par_iter().filter(|index| !pixels[*index].is_finite()).collect();
        let paths = || (0..self.sums.len()).map(|index| self.paths_of(index, self.paths));
        Rendered {
            pixels,
            paths_per_pixel: self.paths,
            fewest_and_most: [paths().min(), paths().max()].map(|paths| paths.unwrap_or(self.paths)),
            counts: self.counts,
            non_finite: bad.iter().take(8).copied().collect(),
            non_finite_count: bad.len() as u64,
        }
    }
}

/// Renders an image of `settings.paths_per_pixel` paths; `progress` is called with the number
/// of pixels that were completed since its last call.
pub fn render(input: &Input, settings: &Settings, progress: impl Fn(u64) + Sync) -> Rendered {
    let mut passes = Passes::new(input, settings);
    passes.pass(settings.paths_per_pixel, &progress);
    passes.image()
}

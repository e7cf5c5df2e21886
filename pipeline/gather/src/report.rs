//! The metadata of an image: the attributes of its header, and its statistics.

use crate::{
    Prepared,
    adaptive::{End, Outcome},
    arguments::ExtraLayer,
    image_jobs::ImageJob,
    settings::{Request, accuracy_of_gather},
};
use bssrdf::Medium;
use cli::{LitScene, Seconds};
use formats::{
    Attribute,
    calibration::{CalibratedMaterial, Calibration},
    cloud::{hex, shards},
};
use gather::{Rendered, Settings, State, film};
use std::collections::BTreeMap;
use sums::drawn::DrawnCounts;

/// A rendered image, and the facts that its files state.
pub struct Facts<'a> {
    pub request: &'a Request,
    pub inputs: &'a LitScene,
    pub calibration: Option<&'a Calibration>,
    /// The calibration of a file.
    pub kept: Option<&'a Calibration>,
    pub job: &'a ImageJob,
    /// The settings of the job, with the number of paths that were rendered.
    pub settings: Settings,
    pub rendered: &'a Rendered,
    pub end: End,
    /// The sums of the image, if they are kept.
    pub state: Option<&'a State>,
}

impl<'a> Facts<'a> {
    pub fn new(
        (request, prepared): (&'a Request, &'a Prepared),
        calibration: Option<&'a Calibration>,
        job: &'a ImageJob,
        outcome: &'a Outcome,
    ) -> Facts<'a> {
        let Outcome { rendered, estimator, end, state } = outcome;
        let (planned, paths) = (job.settings.paths_per_pixel, rendered.paths_per_pixel);
        let mut settings = Settings { paths_per_pixel: paths, estimator: *estimator, ..job.settings.clone() };
        if request.target_error.is_none() && paths != planned {
            // What the cut may add to a gather is that of the planned paths.
            let accuracy = accuracy_of_gather(*estimator, planned).map(|x| x / f64::from(paths).sqrt());
            settings.estimator = settings.estimator.map_accuracy(|own| accuracy.unwrap_or(own));
        }
        let (inputs, kept, state) = (&prepared.inputs, prepared.kept.as_ref(), state.as_ref());
        Facts { request, inputs, calibration, kept, job, settings, rendered, end: *end, state }
    }

    /// Attributes of the image's header. None depends on the machine or the threads, and only `capDate` on the time, by
    /// SOURCE_DATE_EPOCH.
    pub fn attributes(&self) -> BTreeMap<String, Attribute> {
        let clouds = self.inputs.clouds();
        let mut all = BTreeMap::new();
        let mut put = |name: &str, value: Attribute| {
            all.insert(name.to_owned(), value);
        };
        let text = |s: &str| Attribute::Text(s.to_owned());
        let version = env!("CARGO_PKG_VERSION");
        put("worldToCamera", Attribute::Matrix(self.job.camera.world_to_camera()));
        if let (Some(lens), scene::Projection::Perspective { tangent }) =
            (self.job.camera.lens, self.job.camera.projection)
        {
            put("aperture", Attribute::Float(lens.f_number(tangent) as f32));
            put("focus", Attribute::Float(lens.focus as f32));
        }
        put("comments", text("W/(m^2 sr), scene-linear; lengths in m"));
        put("software", Attribute::Text(format!("gather {version}")));
        // Rec. 709 primaries and D65.
        put("chromaticities", Attribute::Chromaticities([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329]));
        put("samplesPerPixel", Attribute::Int(self.settings.paths_per_pixel as i32));
        if let Some(date) = capture_date().filter(|_| self.request.outputs.timings) {
            put("capDate", Attribute::Text(date));
            put("utcOffset", Attribute::Float(0.0));
        }
        let first = clouds[0].meta();
        put("pcsss/cloud", Attribute::Text(hex(&shards::identity(clouds))));
        put("pcsss/scene", Attribute::Text(hex(&first.geometry)));
        put("pcsss/samplesDrawn", Attribute::Double(shards::drawn(clouds) as f64));
        match clouds {
            [_] => put("pcsss/cloudSeed", Attribute::Text(first.options.seed.to_string())),
            _ => put("pcsss/clouds", Attribute::Texts(shards::describe(clouds))),
        }
        put("pcsss/metresPerUnit", Attribute::Double(first.options.metres_per_unit));
        put("pcsss/lightUnit", Attribute::Text(first.options.light_unit.to_string()));
        put("pcsss/emissionUnit", Attribute::Text(first.options.emission_unit.to_string()));
        if !first.options.pose.is_empty() {
            put("pcsss/pose", text(&first.options.pose));
        }
        put("pcsss/originM", Attribute::Vector(first.exchange_origin_m()));
        put("pcsss/seed", Attribute::Text(self.settings.seed.to_string()));
        put("pcsss/bssrdf", text(self.model()));
        if let Some(calibration) = self.calibration {
            put("pcsss/calibration", Attribute::Text(hex(&calibration.content)));
            put("pcsss/modelError", Attribute::Texts(calibration.materials.iter().map(model_error).collect()));
        }
        put("pcsss/estimator", Attribute::Text(self.estimator()));
        put("pcsss/version", text(version));
        put("pcsss/arguments", Attribute::Text(self.arguments()));
        put("pcsss/varianceCovers", text(self.covers()));
        let media = shards::materials(clouds).iter().zip(&self.inputs.media);
        put("pcsss/media", Attribute::Texts(media.map(|(m, medium)| describe(&m.name, medium)).collect()));
        if self.request.outputs.layers.contains(&ExtraLayer::Id) {
            let names = self.inputs.scene.materials.iter().enumerate();
            put(
                "pcsss/ids",
                Attribute::Texts(names.map(|(k, material)| format!("{} {}", k + 1, material.name)).collect()),
            );
        }
        if !self.inputs.scene.warnings.is_empty() {
            put("pcsss/warnings", Attribute::Texts(self.inputs.scene.warnings.clone()));
        }
        all
    }

    /// The arguments that change values, in a fixed order; neither paths of files, nor threads, nor the crop.
    fn arguments(&self) -> String {
        let Settings { width, height, paths_per_pixel: paths, max_depth: depth, seed, .. } = &self.settings;
        let filter = self.settings.filter.name();
        let how = match (self.settings.reference, self.settings.model.name(), self.settings.estimator) {
            (true, ..) => "--reference".to_owned(),
            (false, model, estimator) => format!("--bssrdf {model} --estimator {estimator}"),
        };
        let (camera, environment) = (&self.job.argument, self.inputs.scene.environment.identity());
        let turned = match self.job.degrees {
            0.0 => String::new(),
            degrees => format!(" turned by {degrees} degrees"),
        };
        format!(
            "{camera}{turned} --width {width} --height {height} {how} --spp {paths} --filter {filter} --max-depth {depth} --seed {seed} --environment {environment} --normals {}",
            self.request.scene.how.normals
        )
    }

    /// Statistics as JSON.
    pub fn statistics(&self, seconds: &Seconds) -> Vec<u8> {
        let (rendered, clouds) = (self.rendered, self.inputs.clouds());
        let counts = &rendered.counts;
        let mut value = serde_json::json!({
            "schema": 1,
            "threads": self.request.common.thread_count(),
            "pixels": rendered.pixels.len(),
            "paths": counts.paths,
            "paths_per_pixel": rendered.paths_per_pixel,
            "ended_by": self.end.name(),
            "gathers": counts.gathers,
            "near_points": counts.near_points,
            "near_rays": counts.near_rays,
            "bssrdf_evaluations": counts.evaluations,
            "nodes_visited": counts.nodes,
            "rays": counts.rays,
            "shadow_rays": counts.shadow_rays,
            "paths_from_outside": counts.from_outside,
            "paths_from_inside": counts.from_inside,
            "paths_cut_by_depth": counts.cut_by_depth,
            "paths_escaped_inside": counts.escaped_inside,
            "nested_surfaces_passed": counts.nested,
            "geometric_normals_taken": counts.geometric_normals,
            "edge_pixels": counts.edge_pixels,
            "edge_rays": counts.edge_rays,
            "walks": counts.walks,
            "collisions": counts.collisions,
            "connections": counts.connections,
            "reflections_left_out": counts.reflections_left_out,
            "walks_escaped": counts.walks_escaped,
            "walks_trapped": counts.walks_trapped,
            "walks_absorbed_by_opaque_surfaces": counts.walks_absorbed_inside,
            "estimated_relative_error": film::relative_error(&rendered.pixels),
            "estimated_relative_error_covers": self.covers(),
            "negative_pixels": film::negative_count(&rendered.pixels),
            "mesh": self.inputs.defects.counts().into_iter().collect::<BTreeMap<_, _>>(),
            "non_finite": rendered.non_finite_count,
            "non_finite_pixels": rendered.non_finite.iter().map(|p| self.pixel(*p)).collect::<Vec<_>>(),
            "cloud": hex(&shards::identity(clouds)),
            "clouds": clouds.len(),
            "samples_drawn": shards::drawn(clouds),
            "estimator": self.estimator(),
            "bssrdf": self.model(),
            "calibration": self.calibration.map(|c| hex(&c.content)),
            "model_error_relmse": self.calibration.map(|c| {
                c.materials.iter().map(|m| (m.name.clone(), m.errors.map(|e| e.after))).collect::<BTreeMap<_, _>>()
            }),
        });
        let [fewest, most] = rendered.fewest_and_most;
        (value["fewest_paths_of_a_pixel"], value["most_paths_of_a_pixel"]) = (fewest.into(), most.into());
        value["preview_stops"] = self.request.outputs.preview.as_ref().map(|_| self.job.stops).into();
        if self.request.outputs.timings {
            let rate = seconds.of("render").map(|s| counts.evaluations as f64 / s.max(1e-9));
            value["seconds"] = serde_json::json!(seconds.table());
            value["bssrdf_evaluations_per_second"] = rate.into();
            value["peak_memory_bytes"] = cli::peak_memory_bytes().into();
        }
        format!("{value:#}\n").into_bytes()
    }

    /// The sources of error that the variance and the estimated error include.
    pub fn covers(&self) -> &'static str {
        if self.settings.reference {
            return film::covers_of_walks(self.settings.paths_per_pixel);
        }
        film::covers(self.settings.paths_per_pixel, DrawnCounts::of(self.inputs.clouds()).half(1))
    }

    fn model(&self) -> &'static str {
        if self.settings.reference { "none" } else { self.settings.model.name() }
    }

    fn estimator(&self) -> String {
        if self.settings.reference { "random walks".into() } else { self.settings.estimator.to_string() }
    }

    /// Column and row of a pixel in the whole image.
    pub fn pixel(&self, index: usize) -> [usize; 2] {
        self.settings.part().pixel(index)
    }
}

/// What a calibration says of the error of the model that is left, in one line.
fn model_error(material: &CalibratedMaterial) -> String {
    let [r, g, b] = material.errors.map(|e| format!("{:.1e} +- {:.0e}", e.after, e.uncertainty));
    format!("{}: relMSE of the model about {r}, {g}, {b}", material.name)
}

/// A medium and its material in one line.
pub fn describe(material: &str, medium: &Medium) -> String {
    let three = |[r, g, b]: [f64; 3]| format!("{r},{g},{b}");
    let [absorption, scattering, g] =
        [medium.map(|c| c.sigma_a), medium.map(|c| c.sigma_s), medium.map(|c| c.asymmetry)].map(three);
    format!("{material}={}: sigma_a {absorption} sigma_s {scattering} 1/m, g {g}, eta {}", medium.name, medium.eta)
}

/// `YYYY:MM:DD hh:mm:ss` of SOURCE_DATE_EPOCH, UTC.
fn capture_date() -> Option<String> {
    let seconds: u64 = std::env::var("SOURCE_DATE_EPOCH").ok()?.parse().ok().filter(|s| *s < 1 << 40)?;
    let (days, time) = (seconds / 86_400, seconds % 86_400);
    // Civil date from days since 1970 in the proleptic Gregorian calendar: years begin in March here.
    let shifted = days + 719_468;
    let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (time / 3_600, time / 60 % 60, time % 60);
    Some(format!("{year:04}:{month:02}:{day:02} {hour:02}:{minute:02}:{second:02}"))
}

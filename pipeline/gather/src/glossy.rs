//! What surfaces mirror that have roughness: lights are sampled, and paths follow a direction that the BSDF draws; each of
//! the two counts for the share of its density (balance heuristic, Veach 1997; docs/method.md 18.5).

use crate::{
    counts::Counts,
    meeting::Meeting,
    path_state::{Drawn, Layer, PathLight, PathState},
    renderer::Renderer,
};
use bsdf::{Bsdf, Gloss, Lobe, Side, Stated, Surface};
use scene::{
    DVec3, SurfacePoint,
    light::{Illumination, Reflected, all_lights_at},
};

/// The least probability with which a path goes on that has had an event already.
const MIN_SURVIVAL: f64 = 0.05;

impl Renderer<'_> {
    /// Adds the light that an opaque surface reflects diffusely, and what it mirrors of sampled lights; sends the path on
    /// in a mirrored direction. After its first event, a path goes on by chance, as likely as light is mirrored.
    pub(crate) fn meet_gloss(
        &self,
        state: &mut PathState,
        point: &SurfacePoint,
        side: Side,
        stated: &Stated,
        light: &mut PathLight,
        counts: &mut Counts,
    ) -> bool {
        let gloss = Gloss::new(stated);
        let meeting = Meeting::new(point, Surface::Gloss(gloss), side, -state.direction, counts);
        let tries = self.add_lights(state, &meeting, Some(&gloss), light, counts);
        if state.layer.is_some() {
            let mirrored = gloss.albedo(meeting.view.normal.dot(meeting.view.direction)).max_element();
            let survival = mirrored.clamp(MIN_SURVIVAL, 1.0);
            if state.uniform() >= survival {
                return false;
            }
            state.throughput /= survival;
        }
        self.mirror(&meeting, tries, state, light, counts)
    }

    /// Follows the reflection lobe of a translucent surface, whose share the path has accounted for.
    pub(crate) fn reflect(
        &self,
        state: &mut PathState,
        meeting: &Meeting,
        light: &mut PathLight,
        counts: &mut Counts,
    ) -> bool {
        let tries = if meeting.bsdf.is_specular() { 0 } else { self.add_lights(state, meeting, None, light, counts) };
        self.mirror(meeting, tries, state, light, counts)
    }

    /// Adds the light of sampled lights: what a surface mirrors, and what its base reflects. Returns the number of
    /// directions towards each.
    fn add_lights(
        &self,
        state: &mut PathState,
        meeting: &Meeting,
        base: Option<&Gloss>,
        light: &mut PathLight,
        counts: &mut Counts,
    ) -> usize {
        let (view, bsdf) = (&meeting.view, &meeting.bsdf);
        let at = SurfacePoint { normal: view.normal, ..*meeting.point };
        let share = 1.0 - meeting.transmittance();
        let (tries, xi) = state.light_numbers();
        let reflect = |arriving: &Illumination| {
            let left = match arriving.density * tries as f64 {
                0.0 => 1.0,
                density => density / (density + bsdf.density(view, arriving.direction)),
            };
            let diffuse = base.map_or(DVec3::ZERO, |base| base.base(view, arriving.direction));
            Reflected {
                mirrored: bsdf.evaluate(view, arriving.direction) * arriving.irradiance * (left / share),
                diffuse: diffuse * arriving.irradiance,
            }
        };
        let rays = self.input.rays;
        let reflected = all_lights_at(&self.lights, rays, &at, (tries, xi), &mut counts.shadow_rays, reflect);
        light.add(state, Layer::Diffuse, reflected.diffuse);
        light.add(state, Layer::Specular, reflected.mirrored * state.mirrored_share);
        tries
    }

    /// The share of the light of an emitting surface that is left to a ray which meets it.
    pub(crate) fn share_of(&self, state: &PathState, material: u16) -> f64 {
        let of_lights = state
            .drawn
            .as_ref()
            .map_or(1.0, |drawn| self.lights.share_of_surface(material, &drawn.at, state.direction, drawn.density));
        of_lights * state.emitted_share
    }

    /// Sends the path on in a mirrored direction; false if there is none. Each light was sampled in `tries` directions. One
    /// more ray looks for highlights if this is the first surface that mirrors, and rough.
    fn mirror(
        &self,
        meeting: &Meeting,
        tries: usize,
        state: &mut PathState,
        light: &mut PathLight,
        counts: &mut Counts,
    ) -> bool {
        let (view, bsdf) = (&meeting.view, &meeting.bsdf);
        let looks = state.layer.is_none() && state.inside.is_none() && !bsdf.is_specular();
        // The highlight is seen by the third ray of a path.
        let looks = looks && self.settings.max_depth > 2;
        let lobes = looks.then(|| self.highlights.lobes(meeting.point.position, bsdf, view)).flatten();
        if let Some(lobes) = &lobes {
            self.look_for_highlights(lobes, state, meeting, light, counts);
        }
        let left = state.mirrored_share;
        if !meeting.scatter(state, Lobe::Reflection, Layer::Specular, counts) {
            return false;
        }
        state.emitted_share = left;
        if !bsdf.is_specular() {
            let at = SurfacePoint { normal: view.normal, ..*meeting.point };
            let density = bsdf.density(view, state.direction);
            state.drawn = Some(Drawn { at, density: density / tries as f64 });
            state.mirrored_share = lobes.map_or(1.0, |lobes| density / (density + lobes.density(state.direction)));
        }
        true
    }
}

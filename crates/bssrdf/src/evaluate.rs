//! The BSSRDF at one pair of points, in float64.

use bsdf::fresnel;
use glam::DVec3;

/// Where light enters: position (m), outward unit normal, unit direction towards the light.
#[derive(Clone, Copy, Debug)]
pub struct Incident {
    pub position: DVec3,
    pub normal: DVec3,
    pub direction: DVec3,
}

/// Where light leaves: position (m), outward unit normal, unit direction towards the viewer.
#[derive(Clone, Copy, Debug)]
pub struct Exitant {
    pub position: DVec3,
    pub normal: DVec3,
    pub direction: DVec3,
}

/// The arguments of `S_bare`: the two points after refraction.
#[derive(Clone, Copy, Debug)]
pub struct Separation {
    /// `x = x_o − x_i`, m.
    pub offset: DVec3,
    /// `n_i`, outward unit normal where light enters.
    pub normal_in: DVec3,
    /// `ω12`, unit direction of the refracted light, into the medium.
    pub refracted: DVec3,
    /// `n_o`, outward unit normal where light leaves.
    pub normal_out: DVec3,
}

/// A BSSRDF of one medium, in float64: the reference that evaluations in float32 are tested against.
pub trait Bssrdf: Sync {
    /// `S_bare` of one color channel, 1/(m² sr): finite and never negative.
    fn bare(&self, channel: usize, separation: &Separation) -> f64;

    /// `σ_tr` of the three channels as this model defines it, 1/m; the rules of the roulette are functions of it.
    fn transport(&self) -> [f64; 3];
}

/// The values of the BSSRDF at one pair of points, one channel (docs/method.md 1.1, 1.2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Values {
    /// `S`, with the transmittances of entry and exit, 1/(m² sr).
    pub full: f64,
    /// `S_gather`, with that of the entry, 1/(m² sr).
    pub gather: f64,
    /// `S_bare`, with neither, 1/(m² sr).
    pub bare: f64,
}

/// `S`, `S_gather` and `S_bare` of one channel; all zero where no light can enter (docs/method.md 1.3).
pub fn evaluate(model: &dyn Bssrdf, eta: f64, channel: usize, incident: &Incident, exitant: &Exitant) -> Values {
    let Some(entry) = fresnel::enter(incident.normal, incident.direction, eta) else {
        return Values::default();
    };
    let separation = Separation {
        offset: exitant.position - incident.position,
        normal_in: incident.normal,
        refracted: entry.direction,
        normal_out: exitant.normal,
    };
    let bare = model.bare(channel, &separation);
    let gather = entry.transmittance * bare;
    let exit = fresnel::transmittance(exitant.normal.dot(exitant.direction), eta);
    Values { full: exit * gather, gather, bare }
}

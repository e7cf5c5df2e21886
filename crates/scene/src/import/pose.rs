//! The pose of the nodes: as the file has them, or at a time of one of its animations.

use super::{
    accessor::CheckedAccessor,
    container::Document,
    fault::{Refusal, Result, get},
    options::Pose,
    text::{Animation, Channel},
    transform::NodeTransform,
};
use crate::unhonoured::{first_of, quoted};
use glam::{DQuat, DVec4};
use gltf::json::{
    accessor::Type,
    animation::{Interpolation, Sampler},
    validation::Checked,
};
use std::collections::BTreeMap;

/// Number of animations that a message names.
const NAMED: usize = 3;

/// The nodes in a pose.
pub(super) struct Posed {
    /// The transform of each node.
    pub transforms: Vec<NodeTransform>,
    /// Weights of the morph targets of a node, where an animation sets them.
    pub weights: BTreeMap<usize, Vec<f32>>,
    /// The pose for comparisons; empty at rest.
    pub name: String,
}

/// Poses the nodes.
pub(super) fn of(document: &Document, pose: Option<&Pose>, warnings: &mut Vec<String>) -> Result<Posed, Refusal> {
    let transforms = document.transforms.clone();
    let mut posed = Posed { transforms, weights: BTreeMap::new(), name: String::new() };
    let names: Vec<String> = document.animations.iter().enumerate().map(|(k, a)| name_of(k, a)).collect();
    let Some(pose) = pose else {
        if !names.is_empty() {
            warnings.push(format!("everything is at rest; the file has animations: {}", listed(&names)));
        }
        return Ok(posed);
    };
    let chosen = choose(&names, pose.animation.as_deref()).map_err(Refusal::NoPose)?;
    let (animation, name) = (&document.animations[chosen], &names[chosen]);
    let mut longest = 0.0f64;
    for (k, channel) in animation.channels.iter().enumerate() {
        let fault = |what| format!("animation {}, channel {k}: {what}", quoted(name));
        longest = longest.max(posed.apply(document, animation, channel, pose.seconds).map_err(fault)?);
    }
    if pose.seconds > longest {
        warnings.push(format!("the animation {} ends at {longest} s, where everything stays", quoted(name)));
    }
    // The time in full, so that no two poses have one name.
    posed.name = format!("{name} at {} s", pose.seconds);
    Ok(posed)
}

fn listed(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { first_of(names.iter().map(|name| quoted(name)), NAMED) }
}

/// Index of the animation of a name, or of the only one.
fn choose(names: &[String], wanted: Option<&str>) -> Result<usize> {
    let chosen = match wanted {
        Some(wanted) => names.iter().position(|name| name == wanted),
        None if names.len() > 1 => return Err(format!("the file has several animations: {}", listed(names))),
        None => (!names.is_empty()).then_some(0),
    };
    let name = || wanted.map_or_else(String::new, |name| format!(" {}", quoted(name)));
    chosen.ok_or_else(|| format!("there is no animation{}; the file has {}", name(), listed(names)))
}

fn name_of(index: usize, animation: &Animation) -> String {
    animation.name.clone().unwrap_or_else(|| format!("animation{index}"))
}

impl Posed {
    /// Moves a property of a node to a time. Returns the time of the last key, s.
    fn apply(&mut self, document: &Document, animation: &Animation, channel: &Channel, seconds: f64) -> Result<f64> {
        // glTF says that a channel without a node is ignored.
        let Some(node) = channel.target.node.as_ref().map(|n| n.value()) else { return Ok(0.0) };
        let Some(transform) = self.transforms.get_mut(node) else {
            return Err(format!("node index {node} is out of range, there are {}", self.transforms.len()));
        };
        let sampler = get(&animation.samplers, &channel.sampler, "sampler")?;
        let shape = match channel.target.path.as_str() {
            "translation" | "scale" => Type::Vec3,
            "rotation" => Type::Vec4,
            "weights" => Type::Scalar,
            // Those of extensions move no mesh.
            _ => return Ok(0.0),
        };
        let keys = Keys::new(document, sampler, shape)?;
        let last = keys.time(keys.times.len() - 1)?;
        match channel.target.path.as_str() {
            "translation" => transform.set_translation(keys.value(seconds)?.truncate().to_array())?,
            "scale" => transform.set_scale(keys.value(seconds)?.truncate().to_array())?,
            "rotation" => transform.set_rotation(keys.rotation(seconds)?.to_array())?,
            _ => _ = self.weights.insert(node, keys.weights(seconds)?),
        }
        Ok(last)
    }
}

/// The keys of a sampler. Single ones are read, because many channels may share them.
struct Keys<'a> {
    times: CheckedAccessor<'a>,
    values: CheckedAccessor<'a>,
    interpolation: Interpolation,
    /// Elements to a key, not counting tangents.
    width: usize,
}

/// Where a time lies among keys.
struct Place {
    key: usize,
    /// From 0 at the key to 1 at the next.
    fraction: f64,
    /// Seconds between the two.
    step: f64,
}

impl<'a> Keys<'a> {
    fn new(document: &'a Document, sampler: &Sampler, shape: Type) -> Result<Self> {
        let times = CheckedAccessor::animated(document, &sampler.input, "input".into(), Type::Scalar)?;
        let values = CheckedAccessor::animated(document, &sampler.output, "output".into(), shape)?;
        let Checked::Valid(interpolation) = sampler.interpolation else {
            return Err("unknown interpolation".into());
        };
        let per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let elements = times.len() * per_key;
        let width = values.len().checked_div(elements).unwrap_or(0);
        if width == 0 || values.len() != elements * width || width > 1 && shape != Type::Scalar {
            let (values, times) = (values.len(), times.len());
            return Err(format!("{values} elements of output do not fit {times} of input"));
        }
        Ok(Keys { times, values, interpolation, width })
    }

    fn time(&self, key: usize) -> Result<f64> {
        self.times.real::<1>(key).map(|[t]| f64::from(t))
    }

    /// The last key whose time has come, by bisection.
    fn place(&self, seconds: f64) -> Result<Place> {
        let (mut key, mut end) = (0, self.times.len());
        while end - key > 1 {
            let middle = key + (end - key) / 2;
            if self.time(middle)? <= seconds {
                key = middle;
            } else {
                end = middle;
            }
        }
        let start = self.time(key)?;
        let step = if end < self.times.len() { self.time(end)? - start } else { 0.0 };
        let fraction = if step > 0.0 { ((seconds - start) / step).clamp(0.0, 1.0) } else { 0.0 };
        Ok(Place { key, fraction, step })
    }

    /// An element of a key: its value or, of splines, the tangent before (0), the value (1) or the tangent behind (2).
    fn element(&self, key: usize, part: usize, k: usize) -> Result<DVec4> {
        let index = match self.interpolation {
            Interpolation::CubicSpline => (3 * key + part) * self.width + k,
            _ => key * self.width + k,
        };
        self.values.real::<4>(index).map(|v| DVec4::from_array(v.map(f64::from)))
    }

    /// The value of element `k` between two keys.
    fn between(&self, place: &Place, k: usize) -> Result<DVec4> {
        let (key, t) = (place.key, place.fraction);
        let value = self.element(key, 1, k)?;
        if t == 0.0 || self.interpolation == Interpolation::Step {
            return Ok(value);
        }
        let next = self.element(key + 1, 1, k)?;
        if self.interpolation == Interpolation::Linear {
            return Ok(value.lerp(next, t));
        }
        let tangents = [self.element(key, 2, k)?, self.element(key + 1, 0, k)?].map(|tangent| tangent * place.step);
        let (t2, t3) = (t * t, t * t * t);
        Ok(value * (2.0 * t3 - 3.0 * t2 + 1.0)
            + tangents[0] * (t3 - 2.0 * t2 + t)
            + next * (3.0 * t2 - 2.0 * t3)
            + tangents[1] * (t3 - t2))
    }

    fn value(&self, seconds: f64) -> Result<DVec4> {
        self.between(&self.place(seconds)?, 0)
    }

    /// Along the shorter arc, as glTF says.
    fn rotation(&self, seconds: f64) -> Result<DQuat> {
        let place = self.place(seconds)?;
        if self.interpolation != Interpolation::Linear || place.fraction == 0.0 {
            return self.between(&place, 0).map(DQuat::from_vec4);
        }
        let quaternion = |key| {
            let q = DQuat::from_vec4(self.element(key, 1, 0)?);
            let length = q.length();
            if length > 0.0 { Ok(q / length) } else { Err("a rotation is no unit quaternion".to_owned()) }
        };
        Ok(quaternion(place.key)?.slerp(quaternion(place.key + 1)?, place.fraction))
    }

    fn weights(&self, seconds: f64) -> Result<Vec<f32>> {
        let place = self.place(seconds)?;
        (0..self.width).map(|k| Ok(self.between(&place, k)?.x as f32)).collect()
    }
}

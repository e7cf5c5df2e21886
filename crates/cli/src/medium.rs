//! Media as a command line names them, or as a scene's file describes them.

use crate::quoted;
use bssrdf::{Medium, MediumError, MediumFile, Optics, Unit, built_in, single_scattering_albedo};
use scene::{Material, StatedMedium};
use serde_json::{Map, Value};
use std::{borrow::Cow, fs, io};

/// Why a medium cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadMediumError {
    #[error("{0}")]
    Name(MediumError),
    #[error("{path}: {source}")]
    File { path: String, source: MediumError },
    #[error("{path}: cannot read: {source}")]
    Read { path: String, source: std::io::Error },
    #[error("material `{material}` of SCENE (eta is its KHR_materials_ior): {source}; give --medium {}", quoted(&format!("{material}=NAME")))]
    Scene { material: String, source: MediumError },
    #[error("material `{material}` of SCENE: extras.{field}: {source}; or give --medium {}", quoted(&format!("{material}=NAME")))]
    Stated { material: String, field: &'static str, source: MediumError },
    #[error(
        "material `{material}` of SCENE: extras.medium_blend: a medium of index {second}, and that of extras.medium has \
         {first}: they have one surface, so give both one eta, or give --medium {}",
        quoted(&format!("{material}=NAME"))
    )]
    Indices { material: String, first: f64, second: f64 },
}

/// Whether the name of a medium is a path: it ends in `.json` or contains a slash.
pub fn is_file(name: &str) -> bool {
    name.ends_with(".json") || name.contains('/')
}

/// Reads a medium, built in by name or from a file.
pub fn read_medium(name: &str) -> Result<Medium, ReadMediumError> {
    if !is_file(name) {
        return built_in(name).map_err(ReadMediumError::Name);
    }
    let text = read_text(name).map_err(|source| ReadMediumError::Read { path: name.into(), source })?;
    Medium::from_json(&text).map_err(|source| ReadMediumError::File { path: name.into(), source })
}

/// Reads a regular file: a pipe might never begin, and a device never end.
fn read_text(name: &str) -> io::Result<String> {
    if !fs::metadata(name)?.is_file() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file"));
    }
    fs::read_to_string(name)
}

/// The medium that the scene's file gives a material, or none if it gives no coefficients. What its extras state takes
/// precedence; a name there is that of a built-in medium and never a path.
pub fn scene_medium(material: &Material) -> Result<Option<Medium>, ReadMediumError> {
    if let Some(stated) = &material.stated {
        return read_stated(material, stated, "medium").map(Some);
    }
    let Some(volume) = &material.medium else { return Ok(None) };
    let scatter = volume.scatter.as_ref();
    let asymmetry = scatter.map_or(0.0, |s| s.asymmetry);
    let (extension, albedo) = match scatter {
        None => ("KHR_materials_volume", [0.0; 3]),
        Some(s) => {
            let albedo = |color| single_scattering_albedo(color, s.asymmetry_of_color());
            (s.draft.extension(), s.color.to_array().map(albedo))
        }
    };
    let extinction = volume.extinction.to_array();
    let share = |of: fn(f64) -> f64| [0, 1, 2].map(|c| extinction[c] * of(albedo[c]));
    let file = MediumFile {
        name: extension.into(),
        unit: Unit::Metre,
        optics: Optics::Coefficients { sigma_a: share(|albedo| 1.0 - albedo), sigma_s: share(|albedo| albedo) },
        g: [asymmetry; 3],
        eta: volume.ior,
        source: "the scene's file".into(),
    };
    let fault = |source| ReadMediumError::Scene { material: material.name.clone(), source };
    Medium::new(file).map(Some).map_err(fault)
}

/// The two media that the alpha of a material's texture blends, if its extras state two: the first is where alpha is 1.
pub fn blended_media(material: &Material) -> Result<Option<[Medium; 2]>, ReadMediumError> {
    let (Some(first), Some(second)) = (&material.stated, &material.blend) else { return Ok(None) };
    let [first, second] =
        [(first, "medium"), (second, "medium_blend")].map(|(m, field)| read_stated(material, m, field));
    let (first, second) = (first?, second?);
    if first.eta != second.eta {
        let (material, first, second) = (material.name.clone(), first.eta, second.eta);
        return Err(ReadMediumError::Indices { material, first, second });
    }
    Ok(Some([first, second]))
}

fn read_stated(material: &Material, stated: &StatedMedium, field: &'static str) -> Result<Medium, ReadMediumError> {
    let medium = match stated {
        StatedMedium::Name(name) => built_in(name),
        StatedMedium::Json(text) => Medium::from_json(&with_name(text, &material.name)),
    };
    medium.map_err(|source| ReadMediumError::Stated { material: material.name.clone(), field, source })
}

/// The JSON of a medium; one without a name has that of its material.
fn with_name<'a>(text: &'a str, material: &str) -> Cow<'a, str> {
    match serde_json::from_str::<Map<String, Value>>(text) {
        Ok(mut fields) if !fields.contains_key("name") => {
            fields.insert("name".into(), material.into());
            Value::Object(fields).to_string().into()
        }
        _ => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{Alpha, DVec3, DVec4, Volume};

    /// Seen to catch: the kind of the file not looked at, so that a device takes all memory.
    #[test]
    fn a_device_is_refused() {
        let message = read_medium("/dev/zero").expect_err("refused").to_string();
        assert!(message.contains("/dev/zero: cannot read: not a regular file"), "{message}");
    }

    /// A name or JSON in the extras of a material; a name is never a path, and JSON without one has the material's.
    ///
    /// Seen to catch: the extensions of the material taken before its extras, a name required of JSON.
    #[test]
    fn extras_of_a_material_state_its_medium() {
        let volume = Volume { extinction: DVec3::ONE, ior: 1.3, scatter: None };
        let medium = |stated: StatedMedium| {
            let material = Material {
                name: "wax".into(),
                base_color: DVec4::ONE,
                base_texture: None,
                normal_map: None,
                alpha: Alpha::Ignored,
                emission: DVec3::ZERO,
                emission_texture: None,
                gloss: None,
                volume: true,
                thin: false,
                wall: None,
                stated: Some(stated),
                blend: None,
                medium: Some(volume.clone()),
                scatter_texture: None,
                double_sided: false,
            };
            scene_medium(&material).map_err(|e| e.to_string())
        };
        let (name, json) = (|name: &str| StatedMedium::Name(name.into()), |text: &str| StatedMedium::Json(text.into()));
        let marble = built_in("marble").expect("it is built in");
        assert_eq!(medium(name("marble")), Ok(Some(marble)));
        let own = r#"{"name":"own","unit":"1/m","sigma_a":[1,1,1],"sigma_s":[9,9,9]}"#;
        assert_eq!(medium(json(own)), Ok(Some(Medium::from_json(own).expect("a medium"))));
        let nameless = own.replace(r#""name":"own","#, "");
        let of_material = own.replace("own", "wax");
        assert_eq!(medium(json(&nameless)), Ok(Some(Medium::from_json(&of_material).expect("a medium"))));
        for wrong in [name("marbel"), name("/etc/passwd"), name("data/media/marble.json"), json("{")] {
            let message = medium(wrong).expect_err("it is no medium");
            assert!(message.contains("`wax` of SCENE: extras.medium") && message.contains("--medium"), "{message}");
        }
    }
}

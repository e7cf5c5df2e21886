//! A scene with its clouds and media: what every stage after sampling starts from.

use crate::{AssignError, Blended, CloudFiles, Common, Failure, Files, SceneSettings, assign_media, is_file};
use bssrdf::Medium;
use formats::cloud::{Cloud, shards};
use scene::{Framing, MeshDefects, Rays, Scene};
use std::path::{Path, PathBuf};

/// A scene with its clouds and media.
pub struct LitScene {
    pub cloud_files: CloudFiles,
    pub scene: Scene,
    /// The medium of each sampled material, in their order.
    pub media: Vec<Medium>,
    /// Defects of the sampled surfaces.
    pub defects: MeshDefects,
}

/// The media of the sampled materials.
pub enum Media<'a> {
    /// As arguments `[MATERIAL=]NAME|FILE.json`; materials without one have the medium of the scene.
    Named(&'a [String]),
    /// One for each sampled material.
    Known(Vec<Medium>),
}

impl LitScene {
    /// Reads clouds and their scene, but no samples, and the media; refuses inputs that do
    /// not fit each other. The files that the scene's file names are declared as they become known. What the file and its
    /// mesh are warned of was said when the clouds were sampled, and is said again only if this `repeats` it.
    pub fn read(
        clouds: &[PathBuf],
        settings: &SceneSettings,
        media: Media,
        common: &Common,
        files: &mut Files,
        repeats: bool,
    ) -> Result<LitScene, Failure> {
        let cloud_files = CloudFiles::open(clouds)?;
        let about_scene = Common { quiet: common.quiet || !repeats, ..common.clone() };
        let settings = settings.with_units_of(&cloud_files.clouds[0].meta().options);
        let settings = &sized(&settings, &cloud_files)?;
        let mut scene = import(settings, &about_scene)?;
        scene.files.iter().try_for_each(|path| files.reads("a file that SCENE names", path))?;
        cloud_files.check_fit(&scene, settings, common)?;
        let (sampled, defects) = (shards::materials(&cloud_files.clouds), cloud_files.defects());
        let is_sampled = |material| sampled.iter().any(|m| m.index == material);
        settings.check_mesh(&mut scene, is_sampled, defects, &about_scene)?;
        let media = match media {
            Media::Named(arguments) => assign_media(arguments, sampled, &scene)?,
            Media::Known(media) => media,
        };
        Ok(LitScene { cloud_files, scene, media, defects })
    }

    pub fn clouds(&self) -> &[Cloud] {
        &self.cloud_files.clouds
    }

    /// The triangles of the scene, prepared for rays.
    pub fn rays(&self) -> Rays<'_> {
        Rays::of_scene(&self.scene, |material| self.is_sampled(material))
    }

    /// Warns of surfaces of two media, of which `walks` take the mean.
    pub fn warn_of_blends(&self, walks: &str, common: &Common) -> Result<(), Failure> {
        for (material, medium) in shards::materials(self.clouds()).iter().zip(&self.media) {
            if self.blend(material.index, medium)?.is_some() {
                let path = self.scene.files.first().map(|p| p.display().to_string()).unwrap_or_default();
                let name = &material.name;
                common.warn(format_args!("{path}: material `{name}`: {walks} takes the mean of its two media"));
            }
        }
        Ok(())
    }

    /// The two media of a material, if the file states two and `medium`, which it has here, is their mean: another one
    /// was asked for otherwise.
    pub fn blend(&self, material: u16, medium: &Medium) -> Result<Option<Blended>, Failure> {
        let blended = Blended::of(&self.scene, material).map_err(AssignError::Scene)?;
        Ok(blended.filter(|blended| blended.mean.channels == medium.channels && blended.mean.eta == medium.eta))
    }

    fn is_sampled(&self, material: u16) -> bool {
        shards::materials(self.clouds()).iter().any(|m| m.index == material)
    }

    /// The translucent surfaces as cameras frame them.
    pub fn framing(&self) -> Framing<'_> {
        Framing::new(&self.scene, |material| self.is_sampled(material))
    }
}

/// The settings with the `--size` of the surfaces that the clouds sampled.
fn sized(settings: &SceneSettings, clouds: &CloudFiles) -> Result<SceneSettings, Failure> {
    let materials = shards::materials(&clouds.clouds).iter().map(|m| m.index).collect();
    settings.sized(|_| Ok(materials)).map_err(|failure| instead_of_cloud(settings, failure))
}

/// Reads SCENE. If the last argument is another cloud instead, the message says that SCENE is missing.
fn import(settings: &SceneSettings, common: &Common) -> Result<Scene, Failure> {
    settings.import(common).map_err(|failure| instead_of_cloud(settings, failure))
}

fn instead_of_cloud(settings: &SceneSettings, failure: Failure) -> Failure {
    let path: &Path = &settings.path;
    match Cloud::open(path) {
        Ok(_) => Failure::usage(format!("{}: this is a cloud; give SCENE after all clouds", path.display())),
        Err(_) => failure,
    }
}

/// Declares the clouds, the scene and the files of media that a run reads, as far as the arguments name them.
pub fn declare_inputs(clouds: &[PathBuf], settings: &SceneSettings, media: &[String]) -> Result<Files, Failure> {
    let mut files = Files::default();
    clouds.iter().try_for_each(|path| files.reads("CLOUD", path))?;
    settings.declare(&mut files)?;
    // The name of a material may contain an equals sign: the text after any of them may be the file.
    let after = |argument: &'_ str| -> Vec<PathBuf> {
        let starts = argument.match_indices('=').map(|(k, _)| k + 1);
        starts.chain([0]).map(|start| &argument[start..]).filter(|name| is_file(name)).map(PathBuf::from).collect()
    };
    for path in media.iter().flat_map(|argument| after(argument)) {
        files.reads("--medium", &path)?;
    }
    Ok(files)
}

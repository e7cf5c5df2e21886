//! `IMAGE.sums`: the sums of an image beside it, to the last bit. The file is OpenEXR, whose samples of 32 bits are
//! halves of float64: no picture to look at, but packed, checked and read as one.

use cli::Failure;
use formats::{Attribute, Channel, Image};
use gather::{Crop, State};
use std::{
    collections::BTreeMap,
    fs,
    num::NonZeroUsize,
    path::{Path, PathBuf},
};

/// What a file of sums says of its image.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// The settings of the image, each with its name.
    pub settings: Vec<String>,
    /// The relative error that the cut may add to one gather; 0 without a cut.
    pub accuracy: f64,
}

const IMAGE: &str = "pcsss/image";
const PATHS: &str = "pcsss/paths";
/// The same, and paths of each pixel before they were shared, where pixels share them. They are absent elsewhere, so that a
/// program that knows of no shares finds no paths, and refuses the file.
const SHARED_PATHS: &str = "pcsss/sharedPaths";
const BASE: &str = "pcsss/pathsBeforeSharing";
const SETTINGS: &str = "pcsss/settings";
const ACCURACY: &str = "pcsss/gatherAccuracy";

/// The file of an image.
pub fn path_of(image: &Path) -> PathBuf {
    image.with_extension("sums")
}

/// The file's bytes, for an image file of these bytes.
pub fn encode(
    state: &State,
    about: &About,
    part: Crop,
    image: &[u8],
    threads: NonZeroUsize,
) -> Result<Vec<u8>, Failure> {
    let channels = state.planes.iter().enumerate().flat_map(|(k, plane)| {
        [0, 1].map(|word| Channel { name: name(k, word), samples: plane.iter().map(|x| half(*x, word)).collect() })
    });
    let attributes = [
        (IMAGE, Attribute::Text(digest(image))),
        (if state.base.is_some() { SHARED_PATHS } else { PATHS }, Attribute::Int(state.paths as i32)),
        (SETTINGS, Attribute::Texts(about.settings.clone())),
        (ACCURACY, Attribute::Double(about.accuracy)),
    ];
    let base = state.base.map(|base| (BASE, Attribute::Int(base as i32)));
    let file = Image {
        width: part.width,
        height: part.height,
        channels: channels.collect(),
        attributes: attributes.into_iter().chain(base).map(|(name, value)| (name.to_owned(), value)).collect(),
        ..Image::default()
    };
    Ok(file.encode_with(threads)?)
}

/// Reads the sums of an image, and refuses those of another.
pub fn read(image: &Path, threads: NonZeroUsize) -> Result<(State, About), Failure> {
    let sums = path_of(image);
    let fail = |what: String| Failure::usage(format!("--continue: {what}"));
    let bytes = |path: &Path| {
        let is_file = fs::metadata(path)?.is_file();
        if is_file { fs::read(path) } else { Err(std::io::Error::other("not a regular file")) }
    };
    let of_image = bytes(image).map_err(|e| fail(format!("{}: cannot read: {e}", image.display())))?;
    let file = bytes(&sums).map_err(|e| {
        fail(format!("{}: cannot read: {e}; render the image that is continued with --keep-sums", sums.display()))
    })?;
    let file = Image::decode_with(&file, threads).map_err(|e| fail(format!("{}: {e}", sums.display())))?;
    let kept = parse(&file).ok_or_else(|| {
        fail(format!(
            "{}: these are no sums of an image, or those of another version of gather; render the image that is \
                                                         continued again with --keep-sums",
            sums.display()
        ))
    })?;
    match file.attributes.get(IMAGE) {
        Some(Attribute::Text(text)) if *text == digest(&of_image) => Ok(kept),
        _ => Err(fail(format!("{}: these are the sums of another image than {}", sums.display(), image.display()))),
    }
}

fn parse(file: &Image) -> Option<(State, About)> {
    let attributes: &BTreeMap<String, Attribute> = &file.attributes;
    let paths = attributes.get(if attributes.contains_key(BASE) { SHARED_PATHS } else { PATHS })?;
    let (Attribute::Int(paths), Attribute::Texts(settings), Attribute::Double(accuracy)) =
        (paths, attributes.get(SETTINGS)?, attributes.get(ACCURACY)?)
    else {
        return None;
    };
    let plane = |k: usize| {
        let [high, low] = [file.channel(&name(k, 0))?, file.channel(&name(k, 1))?];
        let join =
            |(high, low): (&f32, &f32)| f64::from_bits(u64::from(high.to_bits()) << 32 | u64::from(low.to_bits()));
        Some(high.iter().zip(low).map(join).collect())
    };
    let paths = u32::try_from(*paths).ok().filter(|paths| *paths > 1)?;
    let base = match attributes.get(BASE) {
        None => None,
        Some(Attribute::Int(base)) => Some(u32::try_from(*base).ok().filter(|base| (1..=paths).contains(base))?),
        Some(_) => return None,
    };
    // Versions that keep other sums have files of another number of channels.
    let count = State::PLANES + usize::from(base.is_some());
    if file.channels.len() != 2 * count {
        return None;
    }
    let planes: Vec<Vec<f64>> = (0..count).map(plane).collect::<Option<_>>()?;
    // Shares are 1 on average, or less, and edge pixels may have 1 more.
    let shares = || planes[State::PLANES..].iter().flatten();
    let most = (2 * file.width * file.height) as f64;
    if !shares().all(|share| *share >= 0.0) || shares().sum::<f64>() > most {
        return None;
    }
    let accuracy = Some(*accuracy).filter(|x| x.is_finite() && *x >= 0.0)?;
    Some((State { paths, base, planes }, About { settings: settings.clone(), accuracy }))
}

/// The name of the channel of one half of a plane.
fn name(plane: usize, word: usize) -> String {
    format!("{plane:02}.{}", ["high", "low"][word])
}

/// The upper or the lower 32 bits of a number.
fn half(x: f64, word: usize) -> f32 {
    let bits = x.to_bits();
    f32::from_bits(if word == 0 { (bits >> 32) as u32 } else { bits as u32 })
}

fn digest(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sums of a file with these contents.
    fn returned(state: &State) -> Result<(State, About), Failure> {
        let about = About { settings: vec!["--seed 0".into()], accuracy: 0.02 };
        let part = Crop { x: 5, y: 0, width: 3, height: 2 };
        let folder = tempfile::tempdir().expect("a folder");
        let image = folder.path().join("a.exr");
        fs::write(&image, b"image").expect("writes");
        fs::write(path_of(&image), encode(state, &about, part, b"image", NonZeroUsize::MIN).expect("encodes"))
            .expect("writes");
        read(&image, NonZeroUsize::MIN)
    }

    /// Shares are kept to the last bit, and files whose shares are missing or would never end are refused.
    ///
    /// Seen to catch: the last plane read as that of a sum; shares that are not checked, or are not missed; the first planes
    /// of a file that has more.
    #[test]
    fn shares_return_or_are_refused() {
        let planes: Vec<Vec<f64>> = (0..State::PLANES).map(|k| vec![k as f64; 6]).collect();
        let shared =
            |shares: &[f64]| State { paths: 9, base: Some(4), planes: [&planes[..], &[shares.to_vec()]].concat() };
        let good = shared(&[0.1, 1.0 / 3.0, 0.7, 0.0, 4.0, 1e-300]);
        assert_eq!(returned(&good).expect("reads").0, good);
        let (plain, _) = returned(&State { paths: 9, base: None, planes: planes.clone() }).expect("reads");
        assert_eq!((plain.base, plain.planes.len()), (None, State::PLANES));
        let of = |share: f64| shared(&[1.0, 1.0, share, 1.0, 1.0, 1.0]);
        let none = State { planes: planes.clone(), ..of(1.0) };
        let others = [&planes[..], &planes[..]].concat();
        let of_other_version = [None, Some(4)].map(|base| State { paths: 9, base, planes: others.clone() });
        let bad = [of(f64::NAN), of(-0.5), of(7.5), State { base: Some(10), ..of(1.0) }, none].into_iter();
        let bad = bad.chain(of_other_version);
        for state in bad {
            let message = returned(&state).expect_err("refused").message;
            assert!(message.contains("no sums of an image"), "{message}");
        }
    }

    /// Words that are no numbers as float32, signaling ones included, stay as they are.
    #[test]
    fn every_bit_returns() {
        let bits =
            [0u64, 1, 0x7f80_0001_ff80_0001, 0xffff_ffff_7fa0_0000, 0x8000_0000_8000_0000, 0x3ff5_5555_5555_5555];
        let plane = |k: usize| bits.iter().map(|b| f64::from_bits(b.rotate_left(k as u32))).collect();
        let planes: Vec<Vec<f64>> = (0..State::PLANES).map(plane).collect();
        let state = State { paths: 7, base: None, planes };
        let about = About { settings: vec!["--seed 0".into()], accuracy: 0.02 };
        let part = Crop { x: 5, y: 0, width: 3, height: 2 };
        let folder = tempfile::tempdir().expect("a folder");
        let image = folder.path().join("a.exr");
        fs::write(&image, b"image").expect("writes");
        let bytes = encode(&state, &about, part, b"image", NonZeroUsize::MIN).expect("encodes");
        fs::write(path_of(&image), bytes).expect("writes");
        let (back, of) = read(&image, NonZeroUsize::MIN).expect("reads");
        let all = |state: &State| state.planes.concat().into_iter().map(f64::to_bits).collect::<Vec<_>>();
        assert_eq!((all(&back), back.paths, of), (all(&state), 7, about));
        fs::write(&image, b"other").expect("writes");
        let message = read(&image, NonZeroUsize::MIN).expect_err("refused").message;
        assert!(message.contains("another image"), "{message}");
    }
}

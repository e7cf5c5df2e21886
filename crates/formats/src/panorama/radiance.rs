//! Decodes Radiance HDR (Ward 1991, "Real pixels", Graphics Gems II; and the picture format in the Radiance reference
//! manual). The bytes are not trusted.

use super::{
    color,
    pixels::{PIXEL_BYTES, Panorama, PanoramaSize, black, check_size},
};
use glam::DMat3;

/// Widths of scan lines with run-length coding.
const CODED_WIDTHS: std::ops::Range<usize> = 8..32768;

/// A byte codes at most this many pixels: four runs of two bytes code 127.
const PIXELS_PER_BYTE: u64 = 16;

pub(super) fn decode(bytes: &[u8]) -> Result<Panorama, String> {
    let mut reader = Reader { rest: bytes };
    let (Header { gain, matrix }, [width, height]) = start(&mut reader, bytes.len() as u64)?;
    let mut pixels = black(width, height)?;
    let mut line = Vec::new();
    for row in pixels.chunks_exact_mut(width) {
        reader.scan_line(width, &mut line)?;
        row.iter_mut().zip(&line).for_each(|(pixel, rgbe)| *pixel = radiance(*rgbe, gain));
    }
    let mut picture = Panorama { width, height, pixels, warnings: Vec::new() };
    if let Some(matrix) = matrix {
        color::convert(&mut picture, matrix);
    }
    Ok(picture)
}

/// The size of the picture in a file of this length that begins with `bytes`.
pub(super) fn size(bytes: &[u8], length: u64) -> Result<PanoramaSize, String> {
    let (_, [width, height]) = start(&mut Reader { rest: bytes }, length)?;
    let pixels = (width as u64).saturating_mul(height as u64).saturating_mul(PIXEL_BYTES);
    Ok(PanoramaSize { width, height, reading_bytes: length.saturating_add(pixels) })
}

/// Reads all that comes before the first row: header, columns and rows.
fn start(reader: &mut Reader, length: u64) -> Result<(Header, [usize; 2]), String> {
    let whole = reader.rest.len() as u64;
    let header = header(reader)?;
    let size @ [width, height] = resolution(reader.line()?)?;
    let left = length.saturating_sub(whole - reader.rest.len() as u64);
    let limit = left.saturating_mul(PIXELS_PER_BYTE);
    if width.checked_mul(height).is_none_or(|pixels| pixels as u64 > limit) {
        return Err(format!("{width} x {height} pixels are more than a file of {length} bytes can hold"));
    }
    check_size(size)?;
    Ok((header, size))
}

/// Scene-linear color of three mantissas with one exponent.
fn radiance([r, g, b, exponent]: [u8; 4], gain: [f64; 3]) -> [f32; 3] {
    if exponent == 0 {
        return [0.0; 3];
    }
    let unit = f64::from(i32::from(exponent) - (128 + 8)).exp2();
    let [r, g, b] = [r, g, b].map(f64::from);
    [r * gain[0], g * gain[1], b * gain[2]].map(|x| (x * unit) as f32)
}

/// The facts of a header about the pixels.
struct Header {
    /// Factors that undo all exposures and color corrections.
    gain: [f64; 3],
    /// Conversion to Rec. 709 from other primaries.
    matrix: Option<DMat3>,
}

/// Reads the lines before the resolution. A line that begins with a space or tab describes a picture from which this
/// one was made, and is skipped.
fn header(reader: &mut Reader) -> Result<Header, String> {
    let mut header = Header { gain: [1.0; 3], matrix: None };
    loop {
        let line = reader.line()?;
        if line.is_empty() {
            return Ok(header);
        }
        let Some((name, value)) = line.split_once('=').filter(|_| !line.starts_with([' ', '\t'])) else {
            continue;
        };
        let (name, value) = (name.trim(), value.trim());
        let bad = || format!("{name}: `{value}` is not understood; save the picture again");
        let numbers = || value.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>().map_err(|_| bad());
        let factors = match name {
            "FORMAT" if value == "32-bit_rle_rgbe" => continue,
            "FORMAT" => {
                return Err(format!("FORMAT: {value} is not supported, 32-bit_rle_rgbe is; `ra_xyze -r` makes it"));
            }
            "GAMMA" if numbers()? != [1.0] => {
                return Err(format!("GAMMA: {value}: its numbers are not linear; save the picture with GAMMA 1"));
            }
            "PRIMARIES" => {
                let stated: [f64; 8] = numbers()?.try_into().map_err(|_| bad())?;
                // Some programs write zeros for unknown primaries.
                let known = stated != [0.0; 8];
                header.matrix =
                    if known { color::to_rec_709(stated).map_err(|e| format!("{name}: {e}"))? } else { None };
                continue;
            }
            "EXPOSURE" => value.parse().map(|x| vec![x; 3]).map_err(|_| bad())?,
            "COLORCORR" => numbers()?,
            _ => continue,
        };
        if factors.len() != 3 || !factors.iter().all(|x| *x > 0.0 && x.is_finite()) {
            return Err(bad());
        }
        header.gain.iter_mut().zip(factors).for_each(|(gain, factor)| *gain /= factor);
    }
}

/// Reads the size. Only rows from the top and columns from the left are supported, the one order that programs write.
fn resolution(line: &str) -> Result<[usize; 2], String> {
    let unknown = || format!("`{line}`: the line `-Y height +X width` is needed; save the picture again");
    let words: Vec<&str> = line.split_whitespace().collect();
    let ["-Y", height, "+X", width] = words[..] else {
        return Err(unknown());
    };
    let number = |word: &str| word.parse().ok().filter(|n: &usize| *n > 0).ok_or_else(unknown);
    Ok([number(width)?, number(height)?])
}

/// The rest of the file.
struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (head, rest) = self.rest.split_first_chunk().ok_or("the file ends early; make it again")?;
        self.rest = rest;
        Ok(*head)
    }

    /// A line of text without its end.
    fn line(&mut self) -> Result<&'a str, String> {
        let end = self.rest.iter().position(|b| *b == b'\n').ok_or("the header has no end; make the file again")?;
        let line = &self.rest[..end];
        self.rest = &self.rest[end + 1..];
        std::str::from_utf8(line).map(str::trim_end).map_err(|_| "the header is no text; make the file again".into())
    }

    /// Reads one row of mantissas and exponents, run by run or pixel by pixel.
    fn scan_line(&mut self, width: usize, line: &mut Vec<[u8; 4]>) -> Result<(), String> {
        line.clear();
        let coded = self.rest.first_chunk().is_some_and(|[a, b, c, _]| *a == 2 && *b == 2 && *c < 128);
        if coded && CODED_WIDTHS.contains(&width) {
            let [_, _, high, low] = self.take()?;
            if usize::from(high) << 8 | usize::from(low) != width {
                return Err(format!("a scan line of another width than {width}; make the file again"));
            }
            line.resize(width, [0; 4]);
            return (0..4).try_for_each(|component| self.runs(line, component));
        }
        for _ in 0..width {
            let pixel = self.take()?;
            if pixel[..3] == [1; 3] {
                return Err("its runs have the coding of before 1991; save the picture again".into());
            }
            line.push(pixel);
        }
        Ok(())
    }

    /// Reads one component of a row: runs of one value, and single values.
    fn runs(&mut self, line: &mut [[u8; 4]], component: usize) -> Result<(), String> {
        let mut at = 0;
        while at < line.len() {
            let [count] = self.take()?;
            let (length, run) = if count > 128 { (count - 128, true) } else { (count, false) };
            let end = at + usize::from(length);
            let part = line.get_mut(at..end).filter(|part| !part.is_empty());
            let part = part.ok_or("a run that does not fit its scan line; make the file again")?;
            let mut value = if run { self.take::<1>()?[0] } else { 0 };
            for pixel in part {
                if !run {
                    [value] = self.take()?;
                }
                pixel[component] = value;
            }
            at = end;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "#?RADIANCE\n# a comment\nFORMAT=32-bit_rle_rgbe\n";

    fn file(head: &str, resolution: &str, body: &[u8]) -> Vec<u8> {
        [format!("{head}\n{resolution}\n").as_bytes(), body].concat()
    }

    /// Ten pixels: a run of seven reds and three single ones, runs of the other components.
    const CODED: [u8; 18] = [2, 2, 0, 10, 135, 64, 3, 1, 2, 3, 138, 128, 138, 0, 133, 129, 133, 130];

    /// Seen to catch: a run taken as single values, the exponent's offset one off, rows of runs one short.
    #[test]
    fn runs_and_single_values() {
        let picture = decode(&file(HEAD, "-Y 1 +X 10", &CODED)).expect("a picture");
        assert_eq!((picture.width, picture.height), (10, 1));
        assert_eq!(picture.pixels[0], [0.5, 1.0, 0.0]);
        assert_eq!(picture.pixels[7], [4.0 * 1.0 / 256.0, 2.0, 0.0]);
        assert_eq!(picture.pixels[9], [4.0 * 3.0 / 256.0, 2.0, 0.0]);
        let flat = decode(&file(HEAD, "-Y 2 +X 1", &[128, 0, 0, 129, 2, 2, 9, 0])).expect("a picture");
        assert_eq!(flat.pixels, [[1.0, 0.0, 0.0], [0.0; 3]]);
    }

    /// Seen to catch: pixels multiplied by the exposure.
    #[test]
    fn exposure_and_color_correction_are_undone() {
        let head = format!("{HEAD}EXPOSURE= 2\nEXPOSURE=4\nCOLORCORR=1 0.5 1\nSOFTWARE=x=y\n");
        let picture = decode(&file(&head, "-Y 1 +X 1", &[128, 128, 64, 131])).expect("a picture");
        assert_eq!(picture.pixels, [[0.5, 1.0, 0.25]]);
        for line in ["EXPOSURE=0", "EXPOSURE=nan", "COLORCORR=1 1", "FORMAT=32-bit_rle_xyze"] {
            let message = decode(&file(&format!("{HEAD}{line}\n"), "-Y 1 +X 1", &[0; 4])).expect_err("refused");
            assert!(message.contains(line.split_once('=').expect("a name").0), "{message}");
        }
    }

    /// Seen to catch: all primaries taken for Rec. 709; exposures of earlier pictures undone; gamma ignored.
    #[test]
    fn primaries_are_converted_and_history_is_not_read() {
        let with = |line: &str| decode(&file(&format!("{HEAD}{line}\n"), "-Y 1 +X 1", &[128, 128, 128, 129]));
        let pixel = |line: &str| with(line).expect("a picture").pixels[0];
        // White is white, whatever its primaries; Radiance's own have another green and an equal-energy white.
        let radiance = pixel("PRIMARIES= 0.640 0.330 0.290 0.600 0.150 0.060 0.333 0.333");
        assert!(radiance.iter().all(|x| (x - 1.0).abs() < 1e-6), "{radiance:?}");
        for same in ["PRIMARIES=0.6400 0.3300 0.3000 0.6000 0.1500 0.0600 0.3127 0.3290", "PRIMARIES=0 0 0 0 0 0 0 0"] {
            assert_eq!(pixel(same), [1.0; 3], "{same}");
        }
        for history in ["\tEXPOSURE=4", " PRIMARIES=1 2 3", "GAMMA=1", "VIEW= -vtv -vh 45", "PIXASPECT= 0.5"] {
            assert_eq!(pixel(history), [1.0; 3], "{history}");
        }
        let green = file(
            &format!("{HEAD}PRIMARIES=.713 .293 .165 .83 .128 .044 .32168 .33767\n"),
            "-Y 1 +X 1",
            &[0, 128, 0, 129],
        );
        let picture = decode(&green).expect("a picture");
        let [r, g, b] = picture.pixels[0];
        assert!(r == 0.0 && (g - 1.1408).abs() < 1e-4 && b == 0.0 && picture.warnings.len() == 1, "{picture:?}");
        for bad in ["PRIMARIES=1 2 3", "PRIMARIES=0.1 0.1 0.2 0.2 0.3 0.3 0.3 0.3", "GAMMA=2.2", "GAMMA=x"] {
            let message = with(bad).expect_err("refused");
            assert!(message.starts_with(bad.split_once('=').expect("a name").0), "{message}");
        }
        for order in ["+Y 1 +X 1", "-Y 1 -X 1", "+X 1 -Y 1"] {
            let message = decode(&file(HEAD, order, &[128; 4])).expect_err("refused");
            assert!(message.contains("-Y height +X width"), "{message}");
        }
    }

    #[test]
    fn damaged_files_and_bombs_are_refused() {
        let good = file(HEAD, "-Y 1 +X 10", &CODED);
        for length in 0..good.len() {
            assert!(decode(&good[..length]).is_err(), "{length}");
        }
        let sizes = ["-Y 100000 +X 30000", "-Y 18446744073709551615 +X 18446744073709551615", "-Y 0 +X 9", "+X 1 -Y 1"];
        for resolution in sizes {
            assert!(decode(&file(HEAD, resolution, &CODED)).is_err(), "{resolution}");
        }
        let bad: [&[u8]; 4] = [
            &[2, 2, 0, 11, 139, 64],                // another width
            &[2, 2, 0, 10, 139, 64, 0, 0],          // a run beyond the end
            &[2, 2, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0], // runs of nothing
            &[9, 9, 9, 130, 1, 1, 1, 9],            // runs of the old kind
        ];
        for body in bad {
            assert!(decode(&file(HEAD, "-Y 1 +X 10", body)).is_err(), "{body:?}");
        }
    }
}

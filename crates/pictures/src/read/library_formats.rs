//! Reads formats that only a linked library supports: DPX, JPEG 2000, HEIC and many more.
//!
//! The color encoding that a file states is trusted. For files that state none:
//! floating point is linear, Cineon files are logarithmic, and the integers of FITS are linear counts of light. Integers of a DPX file can
//! be anything and are refused; all other integers are taken as sRGB.

use super::encoding::Encoding;
use super::header::Header;
use super::linear_picture::{
    FileProblem, LinearPicture, MAX_PIXELS, MAX_SIDE, OPAQUE, ReadOptions, finite, mend, over_black, positive,
};
use super::orientation;
use crate::library::{self, FilePicture, PictureLimits};
use spectra_color::Transfer;
use spectra_core::resources::FoundFile;

/// File extensions, separated by spaces, that the library reads in addition to those that are read without it.
pub const ENDINGS: &str = "tx env sm vsm cin dds dcm dpx fits gif heic heif heics avif ico iff z jp2 j2k \
    j2c ppm pgm pbm pnm pfm psd pdd psb bay bmq cr2 cr3 crw cs1 dc2 dcr dng erf fff k25 kdc mdc mos mrw nef orf pef pxn \
    raf raw rdc sr2 srf x3f arw 3fr cine ia kc2 mef nrw qtk rw2 sti rwl srw drf dsc ptx cap iiq rwz rla sgi rgb rgba bw \
    int inta pic tga tpic";

/// Extension of a file name in lower case, without the dot.
fn ending(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    last.rsplit_once('.').map_or(String::new(), |(_, ending)| ending.to_ascii_lowercase())
}

/// Reads a file with the linked library, as linear light. `said` replaces the encoding that the file states.
pub(super) fn decode(
    found: &FoundFile,
    choice: ReadOptions<'_>,
    said: Option<Encoding>,
) -> Result<LinearPicture, FileProblem> {
    let (picture, encoding) = read(found, choice.name, said, true)?;
    let linear = linear(picture, encoding);
    if choice.alpha {
        return Ok(linear);
    }
    let cover = linear.alpha.as_deref().unwrap_or_default();
    let mut doubts = linear.warnings;
    doubts.extend(over_black(cover.iter().filter(|cover| **cover < OPAQUE).count(), cover.len()));
    Ok(LinearPicture { alpha: None, warnings: doubts, ..linear })
}

/// Reads the header of a file with the linked library, without pixels.
pub(super) fn header(
    found: &FoundFile,
    choice: ReadOptions<'_>,
    said: Option<Encoding>,
) -> Result<Header, FileProblem> {
    let (picture, encoding) = read(found, choice.name, said, false)?;
    let ([width, height], pixel_aspect) = seen(&picture);
    Ok(Header {
        width,
        height,
        overscan: [0; 2],
        pixel_aspect,
        clips: picture.integers,
        is_for_display: picture.integers && encoding.is_for_display(),
        is_jpeg: false,
        warnings: Vec::new(),
    })
}

fn read(
    found: &FoundFile,
    name: &str,
    said: Option<Encoding>,
    pixels: bool,
) -> Result<(FilePicture, Encoding), FileProblem> {
    let ending = ending(name);
    let known = ENDINGS.split(' ').any(|own| own == ending);
    let Some(own) = library::library() else {
        return Err(if known {
            FileProblem::file(format!("`.{ending}` files can be read only with OpenImageIO"))
                .hint(format!("save it as PNG, TIFF or JPEG; {}", library::WITHOUT))
        } else {
            FileProblem::file("this is not an OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR file")
                .hint("save it in one of these formats; changing only the file extension is not enough")
        });
    };
    if ending.is_empty() {
        let text =
            "this is not an OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR file, and the name has no extension";
        return Err(FileProblem::file(text).hint("other formats are recognized by the extension"));
    }
    let limits = PictureLimits { side_px: MAX_SIDE, pixels: MAX_PIXELS };
    let read = if pixels { own.read(&ending, found, limits) } else { own.header(&ending, found, limits) };
    let picture = read.map_err(|cause| {
        let trouble = FileProblem::file(format!("{cause} (read as `.{ending}` by {})", own.name()));
        trouble.hint("is the file complete, and does its extension match its content?")
    })?;
    let encoding = encoding(&picture, said)?;
    Ok((picture, encoding))
}

/// Combines the reason why a file of a known kind is not read here with the library's error; without a library, says how to get one.
pub(super) fn also(why: &str, trouble: FileProblem) -> FileProblem {
    if library::library().is_none() {
        return FileProblem::file(why).hint(library::WITHOUT);
    }
    FileProblem { text: format!("{why}; {}", trouble.text), ..trouble }
}

fn encoding(picture: &FilePicture, said: Option<Encoding>) -> Result<Encoding, FileProblem> {
    if let Some(said) = said {
        return Ok(said);
    }
    let silent = match (picture.format.as_str(), picture.integers) {
        ("cineon", _) => Some(Encoding::Cineon),
        ("fits", _) | (_, false) => Some(Encoding::Curve(Transfer::Linear)),
        ("dpx", true) => None,
        (_, true) => Some(Encoding::Curve(Transfer::Srgb)),
    };
    let found = match &picture.color_space {
        None => silent,
        Some(words) => Encoding::of_color_space(words),
    };
    found.ok_or_else(|| {
        let words = picture.color_space.as_deref().unwrap_or("nothing");
        let text = format!("the file states its encoding as `{words}`, which defines no curve");
        FileProblem::file(text)
            .hint("state the encoding: `transfer: srgb`, `linear`, `rec709`, or `cineon` for the log encoding of a scanned negative")
    })
}

fn linear(mut picture: FilePicture, encoding: Encoding) -> LinearPicture {
    if let Some(alpha) = &mut picture.alpha {
        for cover in alpha {
            *cover = positive(*cover).min(1.0);
        }
    }
    // Alpha multiplied into linear code values is already multiplied into light. If the codes have a curve, alpha must be divided out
    // first.
    let is_light = encoding == Encoding::Curve(Transfer::Linear);
    if let Some(alpha) = picture.alpha.as_ref().filter(|_| picture.multiplied && !is_light) {
        for (pixel, cover) in picture.rgb.iter_mut().zip(alpha) {
            if *cover > 0.0 {
                *pixel = pixel.map(|v| v / cover);
            }
        }
    }
    let mut doubts = Vec::new();
    if picture.integers {
        // A table of 16 bits serves 8-bit codes too: they are every 257th entry.
        let table = encoding.table(65_536);
        for value in picture.rgb.iter_mut().flatten() {
            *value = table[(positive(*value) * 65_535.0 + 0.5).min(65_535.0) as usize];
        }
    } else {
        for value in picture.rgb.iter_mut().flatten() {
            *value = if is_light { *value } else { encoding.light(f64::from(*value)) };
        }
        doubts.extend(mend(&mut picture.rgb));
        picture.rgb.iter_mut().flatten().for_each(|value| *value = finite(*value));
    }
    if let Some(alpha) = picture.alpha.as_ref().filter(|_| !(picture.multiplied && is_light)) {
        for (pixel, cover) in picture.rgb.iter_mut().zip(alpha) {
            *pixel = pixel.map(|v| v * cover);
        }
    }
    let ([width, height], pixel_aspect) = seen(&picture);
    let (size, orientation) = ([picture.width_px as usize, picture.height_px as usize], picture.orientation);
    orientation::upright(&mut picture.rgb, size, orientation);
    if let Some(alpha) = &mut picture.alpha {
        orientation::upright(alpha.as_chunks_mut::<1>().0, size, orientation);
    }
    LinearPicture {
        width,
        height,
        pixel_aspect,
        rgb: picture.rgb,
        alpha: picture.alpha,
        depth: None,
        clipped_at: picture.integers.then(|| encoding.clipped_at()),
        warnings: doubts,
    }
}

/// Returns width and height in pixels, and width over height of a pixel, as the picture is seen.
fn seen(picture: &FilePicture) -> ([u32; 2], f64) {
    if orientation::is_on_its_side(picture.orientation) {
        ([picture.height_px, picture.width_px], 1.0 / picture.pixel_aspect)
    } else {
        ([picture.width_px, picture.height_px], picture.pixel_aspect)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file_picture(code: f32, cover: f32, multiplied: bool, integers: bool) -> FilePicture {
        FilePicture {
            width_px: 1,
            height_px: 1,
            pixel_aspect: 1.0,
            rgb: vec![[code; 3]],
            alpha: Some(vec![cover]),
            multiplied,
            integers,
            color_space: None,
            orientation: 1,
            format: "tiff".into(),
        }
    }

    /// Alpha 0.5 over sRGB code 0.8, light 0.60383 (IEC 61966-2-1), gives light 0.30191, whether the file multiplies by alpha or not.
    #[test]
    fn cover_is_multiplied_into_light_once() {
        let curve = Encoding::Curve(Transfer::Srgb);
        for (code, multiplied) in [(0.8, false), (0.4, true)] {
            let light = linear(file_picture(code, 0.5, multiplied, true), curve.clone()).rgb[0][0];
            assert!((light - 0.301_91).abs() < 2e-5, "{light}");
        }
        let straight = linear(file_picture(0.8, 0.5, false, false), Encoding::Curve(Transfer::Linear));
        let multiplied = linear(file_picture(0.4, 0.5, true, false), Encoding::Curve(Transfer::Linear));
        assert_eq!((straight.rgb, multiplied.rgb), (vec![[0.4; 3]], vec![[0.4; 3]]));
    }
}

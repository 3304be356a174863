//! Formats that are read by a library, where the program was built with one: DPX, JPEG 2000, HEIC and many more.
//!
//! What a file says of its encoding is believed. Where it is silent, floating point is linear, a Cineon file is
//! what the name says, the integers of FITS are counts of light, those of a DPX file can be anything and are refused, and
//! all others are taken as sRGB.

use super::encoding::Encoding;
use super::header::Header;
use super::linear::{Choice, Linear, MAX_PIXELS, MAX_SIDE, OPAQUE, Trouble, finite, mend, over_black, positive};
use super::turn;
use crate::library::{self, FilePicture, PictureLimits};
use spectra_color::Transfer;
use spectra_core::resources::Found;

/// Endings of files that the library reads, beyond those that are read without it.
pub const ENDINGS: &str = "tx env sm vsm cin dds dcm dpx fits gif heic heif heics avif ico iff z jp2 j2k \
    j2c ppm pgm pbm pnm pfm psd pdd psb bay bmq cr2 cr3 crw cs1 dc2 dcr dng erf fff k25 kdc mdc mos mrw nef orf pef pxn \
    raf raw rdc sr2 srf x3f arw 3fr cine ia kc2 mef nrw qtk rw2 sti rwl srw drf dsc ptx cap iiq rwz rla sgi rgb rgba bw \
    int inta pic tga tpic";

/// The ending of a name, in lower case, without the dot.
fn ending(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    last.rsplit_once('.').map_or(String::new(), |(_, ending)| ending.to_ascii_lowercase())
}

/// Reads by the library.
pub(super) fn decode(found: &Found, choice: Choice<'_>, said: Option<Encoding>) -> Result<Linear, Trouble> {
    let (picture, encoding) = read(found, choice.name, said, true)?;
    let linear = linear(picture, encoding);
    if choice.cover {
        return Ok(linear);
    }
    let cover = linear.alpha.as_deref().unwrap_or_default();
    let mut doubts = linear.doubts;
    doubts.extend(over_black(cover.iter().filter(|cover| **cover < OPAQUE).count(), cover.len()));
    Ok(Linear { alpha: None, doubts, ..linear })
}

/// What the library says of a file before it reads its pixels.
pub(super) fn header(found: &Found, choice: Choice<'_>, said: Option<Encoding>) -> Result<Header, Trouble> {
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
        doubts: Vec::new(),
    })
}

fn read(found: &Found, name: &str, said: Option<Encoding>, pixels: bool) -> Result<(FilePicture, Encoding), Trouble> {
    let ending = ending(name);
    let known = ENDINGS.split(' ').any(|own| own == ending);
    let Some(own) = library::library() else {
        return Err(if known {
            Trouble::file(format!("`.{ending}` files are read by OpenImageIO only"))
                .hint(format!("save it as PNG, TIFF or JPEG; {}", library::WITHOUT))
        } else {
            Trouble::file("this is not an OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR file")
                .hint("save it in one of these formats; changing only the file extension is not enough")
        });
    };
    if ending.is_empty() {
        let text =
            "this is not an OpenEXR, PNG, JPEG, TIFF, WebP, BMP or Radiance HDR file, and the name has no extension";
        return Err(Trouble::file(text).hint("other formats are recognized by the extension"));
    }
    let limits = PictureLimits { side_px: MAX_SIDE, pixels: MAX_PIXELS };
    let read = if pixels { own.read(&ending, found, limits) } else { own.header(&ending, found, limits) };
    let picture = read.map_err(|cause| {
        let trouble = Trouble::file(format!("{cause} (read as `.{ending}` by {})", own.name()));
        trouble.hint("is the file whole, and does its extension match its content?")
    })?;
    let encoding = encoding(&picture, said)?;
    Ok((picture, encoding))
}

/// What the library says, where a file of a known kind is of a variant that only it may know.
pub(super) fn also(why: &str, trouble: Trouble) -> Trouble {
    if library::library().is_none() {
        return Trouble::file(why).hint(library::WITHOUT);
    }
    Trouble { text: format!("{why}; {}", trouble.text), ..trouble }
}

fn encoding(picture: &FilePicture, said: Option<Encoding>) -> Result<Encoding, Trouble> {
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
        Trouble::file(text)
            .hint("state it: `transfer: srgb`, linear, rec709, or cineon for the log of a scanned negative")
    })
}

fn linear(mut picture: FilePicture, encoding: Encoding) -> Linear {
    if let Some(alpha) = &mut picture.alpha {
        for cover in alpha {
            *cover = positive(*cover).min(1.0);
        }
    }
    // Cover multiplied into code values of light is multiplied into light; into those of a curve it must be taken out first.
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
        // Of 16 bits at most: those of 8 lie on every 257th.
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
    turn::upright(&mut picture.rgb, size, orientation);
    if let Some(alpha) = &mut picture.alpha {
        turn::upright(alpha.as_chunks_mut::<1>().0, size, orientation);
    }
    Linear {
        width,
        height,
        pixel_aspect,
        rgb: picture.rgb,
        alpha: picture.alpha,
        depth: None,
        clipped_at: picture.integers.then(|| encoding.clipped_at()),
        doubts,
    }
}

/// Pixels across and down, and width over height of one, as the picture is seen.
fn seen(picture: &FilePicture) -> ([u32; 2], f64) {
    if turn::is_on_its_side(picture.orientation) {
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

    /// Half a cover over code 0.8 of sRGB, light 0.60383 (IEC 61966-2-1), is light 0.30191, however the file keeps it.
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

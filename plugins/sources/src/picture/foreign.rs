//! Formats that are read by a library, where the program was built with one: DPX, JPEG 2000, WebP and many more.
//!
//! What a file says of its encoding is believed. Where it is silent, floating point is linear, a Cineon file is
//! what the name says, the integers of FITS are counts of light, those of a DPX file can be anything and are refused, and
//! all others are taken as sRGB.

use super::encoding::Encoding;
use super::linear::{Linear, MAX_PIXELS, MAX_SIDE, Trouble, clean};
use spectra_core::picture_file::{self, FilePicture, PictureLimits};
use spectra_spectrum::Transfer;

/// Endings of files that the library reads, beyond those that are read without it.
pub(super) const ENDINGS: &str = "tx env sm vsm bmp dib cin dds dcm dpx fits gif heic heif heics avif ico iff z jp2 j2k \
    j2c ppm pgm pbm pnm pfm psd pdd psb bay bmq cr2 cr3 crw cs1 dc2 dcr dng erf fff k25 kdc mdc mos mrw nef orf pef pxn \
    raf raw rdc sr2 srf x3f arw 3fr cine ia kc2 mef nrw qtk rw2 sti rwl srw drf dsc ptx cap iiq rwz rla sgi rgb rgba bw \
    int inta pic tga tpic webp";

/// The ending of a name, in lower case, without the dot.
fn ending(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    last.rsplit_once('.').map_or(String::new(), |(_, ending)| ending.to_ascii_lowercase())
}

/// Reads by the library.
pub(super) fn decode(bytes: &[u8], name: &str, said: Option<Encoding>) -> Result<Linear, Trouble> {
    let ending = ending(name);
    let known = ENDINGS.split(' ').any(|own| own == ending);
    let Some(library) = picture_file::library() else {
        return Err(if known {
            Trouble::file(format!("`.{ending}` files are read by OpenImageIO only")).hint(picture_file::WITHOUT)
        } else {
            Trouble::file("this is not an OpenEXR, PNG, JPEG, TIFF or Radiance HDR file")
                .hint("the content counts, not the file extension: save it as one of these")
        });
    };
    if ending.is_empty() {
        let text = "this is not an OpenEXR, PNG, JPEG, TIFF or Radiance HDR file, and the name has no extension";
        return Err(Trouble::file(text).hint("other formats are recognized by the extension"));
    }
    let limits = PictureLimits { side_px: MAX_SIDE, pixels: MAX_PIXELS };
    let picture = library.read(&ending, bytes, limits).map_err(|cause| {
        let trouble = Trouble::file(format!("{cause} (read as `.{ending}` by {})", library.name()));
        trouble.hint("is the file whole, and does its extension match its content?")
    })?;
    let encoding = encoding(&picture, said)?;
    Ok(linear(picture, encoding))
}

/// What the library says, where a file of a known kind is of a variant that only it may know.
pub(super) fn also(why: &str, trouble: Trouble) -> Trouble {
    if picture_file::library().is_none() {
        return Trouble::file(why).hint(picture_file::WITHOUT);
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
            *cover = clean(*cover).min(1.0);
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
    if picture.integers {
        // Of 16 bits at most: those of 8 lie on every 257th.
        let table = encoding.table(65_536);
        for value in picture.rgb.iter_mut().flatten() {
            *value = table[(clean(*value) * 65_535.0 + 0.5).min(65_535.0) as usize];
        }
    } else {
        for value in picture.rgb.iter_mut().flatten() {
            *value = clean(if is_light { *value } else { encoding.decode(f64::from(*value)) as f32 });
        }
    }
    if let Some(alpha) = picture.alpha.as_ref().filter(|_| !(picture.multiplied && is_light)) {
        for (pixel, cover) in picture.rgb.iter_mut().zip(alpha) {
            *pixel = pixel.map(|v| v * cover);
        }
    }
    let (size, orientation) = ([picture.width_px as usize, picture.height_px as usize], picture.orientation);
    let turned = (5..=8).contains(&orientation);
    Linear {
        width: if turned { picture.height_px } else { picture.width_px },
        height: if turned { picture.width_px } else { picture.height_px },
        pixel_aspect: if turned { 1.0 / picture.pixel_aspect } else { picture.pixel_aspect },
        rgb: upright(picture.rgb, size, orientation),
        alpha: picture.alpha.map(|alpha| upright(alpha, size, orientation)),
        depth: None,
        clipped_at: picture.integers.then(|| encoding.clipped_at()),
    }
}

/// The pixels as they are seen. TIFF 6.0, `Orientation`: which sides of the picture the first row and the first column
/// stored are: 1 top left, 2 top right, 3 bottom right, 4 bottom left, 5 left top, 6 right top, 7 right bottom, 8 left bottom.
fn upright<T: Copy>(stored: Vec<T>, [width, height]: [usize; 2], orientation: u8) -> Vec<T> {
    if orientation == 1 {
        return stored;
    }
    (0..stored.len()).map(|i| stored[self::stored(i, [width, height], orientation)]).collect()
}

/// Where a pixel of the upright picture is stored, both row by row.
pub(super) fn stored(i: usize, [width, height]: [usize; 2], orientation: u8) -> usize {
    let columns = if (5..=8).contains(&orientation) { height } else { width };
    let (last_column, last_row) = (width - 1, height - 1);
    let (x, y) = (i % columns, i / columns);
    let [column, row] = match orientation {
        2 => [last_column - x, y],
        3 => [last_column - x, last_row - y],
        4 => [x, last_row - y],
        5 => [y, x],
        6 => [y, last_row - x],
        7 => [last_column - y, last_row - x],
        8 => [last_column - y, x],
        _ => [x, y],
    };
    row * width + column
}

#[cfg(test)]
mod tests {
    use super::*;

    /// TIFF 6.0, page 36: where the corner stored first is seen, and in which direction the row goes on from there.
    #[test]
    fn corners_come_to_lie_where_tiff_says() {
        let stored: Vec<u8> = vec![1, 2, 3, 4, 5, 6]; // three columns, two rows
        for (orientation, want) in [
            (1, [1, 2, 3, 4, 5, 6]),
            (2, [3, 2, 1, 6, 5, 4]),
            (3, [6, 5, 4, 3, 2, 1]),
            (4, [4, 5, 6, 1, 2, 3]),
            (5, [1, 4, 2, 5, 3, 6]),
            (6, [4, 1, 5, 2, 6, 3]),
            (7, [6, 3, 5, 2, 4, 1]),
            (8, [3, 6, 2, 5, 1, 4]),
        ] {
            assert_eq!(upright(stored.clone(), [3, 2], orientation), want, "{orientation}");
        }
    }

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
            let light = linear(file_picture(code, 0.5, multiplied, true), curve).rgb[0][0];
            assert!((light - 0.301_91).abs() < 2e-5, "{light}");
        }
        let straight = linear(file_picture(0.8, 0.5, false, false), Encoding::Curve(Transfer::Linear));
        let multiplied = linear(file_picture(0.4, 0.5, true, false), Encoding::Curve(Transfer::Linear));
        assert_eq!((straight.rgb, multiplied.rgb), (vec![[0.4; 3]], vec![[0.4; 3]]));
    }
}

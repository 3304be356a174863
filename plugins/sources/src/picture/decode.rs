//! From the bytes of a picture file to linear light, hostile files included.

use super::encoding::Encoding;
use super::linear::{Choice, Linear, MAX_SIDE, Trouble, check_size, clean};
use super::{exr, foreign};
use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader, Limits};
use spectra_spectrum::Transfer;
use std::io::Cursor;

/// No picture format packs more pixels into a byte: deflate ends near 1 032 to 1, at one byte a pixel or less.
const MAX_PIXELS_PER_BYTE: u64 = 1_100 * 8;

/// Decodes an OpenEXR, PNG, JPEG, TIFF or Radiance HDR file, told by its content, or whatever else OpenImageIO reads,
/// told by the ending of its name. Where neither the file nor the choice says otherwise, integers are taken as
/// sRGB-encoded (8 bits: 255 is 1), floating point as linear. Alpha of integers is taken as straight, of
/// floating point as multiplied in (as OpenEXR has it), unless the file says which.
///
/// # Errors
/// What is wrong with the file.
pub(crate) fn decode(bytes: &[u8], choice: Choice<'_>) -> Result<Linear, Trouble> {
    if bytes.is_empty() {
        return Err(Trouble::file("the file is empty")
            .hint("is the file complete? Save it again as OpenEXR, PNG, JPEG, TIFF or HDR"));
    }
    let said = choice.transfer.map(Encoding::named).transpose()?;
    if bytes.starts_with(&exr::MAGIC) {
        if said.is_some() {
            return Err(Trouble::at("transfer", "an OpenEXR file holds linear light").hint("leave `transfer` out"));
        }
        return exr::decode(bytes, choice, true);
    }
    if choice.layer.is_some() {
        return Err(Trouble::at("layer", "only an OpenEXR file has layers").hint("leave `layer` out"));
    }
    if choice.depth.is_some() {
        return Err(Trouble::at("depth", "only an OpenEXR file has a depth channel")
            .hint("name a file that has it: `depth: {file: ..., channel: Z}`"));
    }
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let reader = reader.map_err(|e| Trouble::file(e.to_string()))?;
    if !reader.format().is_some_and(|format| format.reading_enabled()) {
        return foreign::decode(bytes, choice.name, said);
    }
    match native(reader, bytes.len() as u64) {
        Ok((picture, orientation)) => Ok(linear(picture, orientation, said)),
        Err(NotRead::Trouble(trouble)) => Err(trouble),
        Err(NotRead::Unsupported(why)) => {
            foreign::decode(bytes, choice.name, said).map_err(|trouble| foreign::also(&why, trouble))
        }
    }
}

/// Why a file of a known kind is not read.
enum NotRead {
    Trouble(Trouble),
    /// A variant of the kind that is sound but not known here.
    Unsupported(String),
}

impl From<Trouble> for NotRead {
    fn from(trouble: Trouble) -> Self {
        Self::Trouble(trouble)
    }
}

impl From<ImageError> for NotRead {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::Unsupported(why) => Self::Unsupported(why.to_string()),
            other => Self::Trouble(Trouble::file(other.to_string())),
        }
    }
}

fn native(reader: ImageReader<Cursor<&[u8]>>, bytes: u64) -> Result<(DynamicImage, Orientation), NotRead> {
    let mut decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    check_size(u64::from(width), u64::from(height))?;
    if u64::from(width) * u64::from(height) > bytes * MAX_PIXELS_PER_BYTE {
        let text = format!("the header says {width} x {height} pixels, which {bytes} bytes cannot hold");
        return Err(Trouble::file(text).into());
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    // As much as the picture needs, twice over, and something for the decoder.
    limits.max_alloc = Some(decoder.total_bytes().saturating_mul(2).saturating_add(64 << 20));
    decoder.set_limits(limits)?;
    // A file that says nothing sound of it lies as it is.
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    Ok((DynamicImage::from_decoder(decoder)?, orientation))
}

/// The depth channel alone of an OpenEXR file, which need not hold light.
///
/// # Errors
/// What is wrong with the file.
pub(crate) fn depth(bytes: &[u8], choice: Choice<'_>) -> Result<Linear, Trouble> {
    if !bytes.starts_with(&exr::MAGIC) {
        return Err(Trouble::file("only an OpenEXR file has a depth channel"));
    }
    exr::decode(bytes, choice, false)
}

fn linear(mut picture: DynamicImage, orientation: Orientation, said: Option<Encoding>) -> Linear {
    picture.apply_orientation(orientation);
    let of_integers = said.unwrap_or(Encoding::Curve(Transfer::Srgb));
    let of_floats = |v: f32| clean(said.map_or(v, |encoding| encoding.decode(f64::from(v)) as f32));
    let has_alpha = picture.color().has_alpha();
    let mut alpha = Vec::new();
    let (rgb, clipped_at): (Vec<[f32; 3]>, _) = match &picture {
        DynamicImage::ImageRgb32F(_) => (picture.to_rgb32f().pixels().map(|p| p.0.map(of_floats)).collect(), None),
        DynamicImage::ImageRgba32F(rgba) => {
            alpha.extend(rgba.pixels().map(|p| clean(p.0[3]).min(1.0)));
            (rgba.pixels().map(|p| [0, 1, 2].map(|c| of_floats(p.0[c]))).collect(), None)
        }
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let table = of_integers.table(65_536);
            if has_alpha {
                alpha.extend(picture.to_rgba16().pixels().map(|p| f32::from(p.0[3]) / 65_535.0));
            }
            let rgb = picture.to_rgb16().pixels().map(|p| p.0.map(|v| table[usize::from(v)])).collect();
            (rgb, Some(of_integers.clipped_at()))
        }
        _ => {
            let table = of_integers.table(256);
            if has_alpha {
                alpha.extend(picture.to_rgba8().pixels().map(|p| f32::from(p.0[3]) / 255.0));
            }
            let rgb = picture.to_rgb8().pixels().map(|p| p.0.map(|v| table[usize::from(v)])).collect();
            (rgb, Some(of_integers.clipped_at()))
        }
    };
    let mut rgb = rgb;
    if clipped_at.is_some() {
        for (pixel, cover) in rgb.iter_mut().zip(&alpha) {
            *pixel = pixel.map(|v| v * cover);
        }
    }
    Linear {
        width: picture.width(),
        height: picture.height(),
        pixel_aspect: 1.0,
        rgb,
        alpha: (!alpha.is_empty()).then_some(alpha),
        depth: None,
        clipped_at,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageFormat, Rgb, RgbImage};

    fn png(picture: &RgbImage) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn white_of_eight_bits_is_one_and_rows_start_at_the_top() {
        let mut picture = RgbImage::new(3, 2);
        picture.put_pixel(2, 0, Rgb([255, 255, 255]));
        picture.put_pixel(0, 1, Rgb([188, 0, 0]));
        let linear = decode(&png(&picture), Choice::default()).unwrap();
        assert_eq!((linear.width, linear.height), (3, 2));
        assert_eq!(linear.rgb[2], [1.0, 1.0, 1.0]);
        // IEC 61966-2-1: ((188/255 + 0.055) / 1.055)^2.4 = 0.50289.
        assert!((linear.rgb[3][0] - 0.502_89).abs() < 1e-5);
    }

    #[test]
    fn broken_and_hostile_files_are_refused() {
        let good = png(&RgbImage::new(64, 64));
        for cut in [0, 1, 7, 8, 20, 33, 50, good.len() - 13] {
            assert!(decode(&good[..cut], Choice::default()).is_err(), "cut at {cut}");
        }
        // A header that claims 60 000 x 60 000 pixels, and one that claims 2^31 a side.
        for side in [60_000_u32, 0x7fff_ffff] {
            let mut bad = good.clone();
            bad[16..20].copy_from_slice(&side.to_be_bytes());
            bad[20..24].copy_from_slice(&side.to_be_bytes());
            assert!(decode(&bad, Choice::default()).is_err());
        }
        assert!(decode(b"GIF89a not read", Choice::default()).is_err());
    }

    #[test]
    fn the_encoding_that_is_said_is_taken() {
        let bytes = png(&RgbImage::from_pixel(2, 1, Rgb([0, 51, 255])));
        let said = |transfer| decode(&bytes, Choice { transfer: Some(transfer), ..Choice::default() });
        assert_eq!(said("linear").unwrap().rgb[0], [0.0, 0.2, 1.0]);
        // ITU-R BT.709: ((0.2 + 0.099) / 1.099)^(1/0.45) = 0.05543.
        assert!((said("rec709").unwrap().rgb[0][1] - 0.055_43).abs() < 1e-4);
        let trouble = said("srbg").err().expect("not known");
        assert_eq!((trouble.key, trouble.hint.is_some()), ("transfer", true));
        let exr = exr::MAGIC.to_vec();
        assert_eq!(decode(&exr, Choice { transfer: Some("srgb"), ..Choice::default() }).err().unwrap().key, "transfer");
    }

    /// TIFF 6.0, `Orientation`: 6 says that the first row stored is the right side of the picture.
    #[test]
    fn a_picture_lies_as_its_orientation_says() {
        let mut stored = RgbImage::new(3, 2);
        stored.put_pixel(0, 0, Rgb([255, 0, 0]));
        stored.put_pixel(2, 0, Rgb([0, 255, 0]));
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100);
        // TIFF header, one entry: tag 274, short, 6.
        let exif = b"MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0".to_vec();
        image::ImageEncoder::set_exif_metadata(&mut encoder, exif).unwrap();
        let stored = image::imageops::resize(&stored, 48, 32, image::imageops::FilterType::Nearest);
        encoder.encode_image(&stored).unwrap();
        let upright = decode(&bytes.into_inner(), Choice::default()).unwrap();
        assert_eq!((upright.width, upright.height), (32, 48));
        let at = |column: usize, row: usize| upright.rgb[row * 32 + column];
        assert!(at(28, 4)[0] > 0.9 && at(28, 4)[1] < 0.05, "the first pixel is at the top right");
        assert!(at(28, 44)[1] > 0.9 && at(4, 4)[0] < 0.05);
    }

    #[test]
    fn without_a_library_other_formats_say_how_to_get_it() {
        if spectra_core::picture_file::library().is_some() {
            return;
        }
        for (bytes, name) in [(&b"SDPX"[..], "scan.DPX"), (b"GIF89a\0\0\0\0", "dance.gif")] {
            let trouble = decode(bytes, Choice { name, ..Choice::default() }).err().expect("not read");
            assert!(trouble.hint.is_some_and(|hint| hint.contains("--features oiio")), "{name}: {}", trouble.text);
        }
        // What no library reads, or what is broken, is not to be had by one.
        for name in ["notes.txt", "broken.png", "nothing"] {
            let trouble = decode(b"some text", Choice { name, ..Choice::default() }).err().expect("not read");
            assert!(trouble.hint.is_none_or(|hint| !hint.contains("oiio")), "{name}");
        }
    }
}

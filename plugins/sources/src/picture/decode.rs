//! From the bytes of a picture file to linear light, hostile files included.

use super::exr;
use super::linear::{Choice, Linear, MAX_SIDE, Trouble, check_size, clean};
use image::{DynamicImage, ImageDecoder, ImageReader, Limits};
use spectra_spectrum::Transfer;
use std::io::Cursor;

/// No picture format packs more pixels into a byte: deflate ends near 1 032 to 1, at one byte a pixel or less.
const MAX_PIXELS_PER_BYTE: u64 = 1_100 * 8;

/// Decodes an OpenEXR, PNG, JPEG, TIFF or Radiance HDR file; the kind is told by its content. Integers are
/// taken as sRGB-encoded (8 bits: 255 is 1), floating point as linear. Alpha of integers is taken as straight, of
/// floating point as multiplied in (as OpenEXR has it).
///
/// # Errors
/// What is wrong with the file.
pub(crate) fn decode(bytes: &[u8], choice: Choice<'_>) -> Result<Linear, Trouble> {
    if bytes.starts_with(&exr::MAGIC) {
        return exr::decode(bytes, choice, true);
    }
    if choice.layer.is_some() {
        return Err(Trouble::at("layer", "only an OpenEXR file has layers").hint("leave `layer` out"));
    }
    if choice.depth.is_some() {
        return Err(Trouble::at("depth", "only an OpenEXR file has a depth channel")
            .hint("name a file that has it: `depth: {file: ..., channel: Z}`"));
    }
    let said = |e: image::ImageError| Trouble::file(e.to_string());
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let reader = reader.map_err(|e| Trouble::file(e.to_string()))?;
    if reader.format().is_none() {
        return Err(Trouble::file("this is no OpenEXR, PNG, JPEG, TIFF or Radiance HDR file"));
    }
    let mut decoder = reader.into_decoder().map_err(said)?;
    let (width, height) = decoder.dimensions();
    check_size(u64::from(width), u64::from(height))?;
    if u64::from(width) * u64::from(height) > bytes.len() as u64 * MAX_PIXELS_PER_BYTE {
        let text = format!("the header says {width} x {height} pixels, which {} bytes cannot hold", bytes.len());
        return Err(Trouble::file(text));
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    // As much as the picture needs, twice over, and something for the decoder.
    limits.max_alloc = Some(decoder.total_bytes().saturating_mul(2).saturating_add(64 << 20));
    decoder.set_limits(limits).map_err(said)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(said)?;
    Ok(linear(&picture))
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

fn linear(picture: &DynamicImage) -> Linear {
    let table = |levels: usize| -> Vec<f32> {
        (0..levels).map(|i| Transfer::Srgb.decode(i as f64 / (levels - 1) as f64) as f32).collect()
    };
    let has_alpha = picture.color().has_alpha();
    let mut alpha = Vec::new();
    let (rgb, clipped_at): (Vec<[f32; 3]>, _) = match picture {
        DynamicImage::ImageRgb32F(_) => (picture.to_rgb32f().pixels().map(|p| p.0.map(clean)).collect(), None),
        DynamicImage::ImageRgba32F(rgba) => {
            alpha.extend(rgba.pixels().map(|p| clean(p.0[3]).min(1.0)));
            (rgba.pixels().map(|p| [0, 1, 2].map(|c| clean(p.0[c]))).collect(), None)
        }
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let table = table(65_536);
            if has_alpha {
                alpha.extend(picture.to_rgba16().pixels().map(|p| f32::from(p.0[3]) / 65_535.0));
            }
            (picture.to_rgb16().pixels().map(|p| p.0.map(|v| table[usize::from(v)])).collect(), Some(1.0))
        }
        _ => {
            let table = table(256);
            if has_alpha {
                alpha.extend(picture.to_rgba8().pixels().map(|p| f32::from(p.0[3]) / 255.0));
            }
            (picture.to_rgb8().pixels().map(|p| p.0.map(|v| table[usize::from(v)])).collect(), Some(1.0))
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
}

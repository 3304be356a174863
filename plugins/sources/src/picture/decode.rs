//! From the bytes of a picture file to linear light, hostile files included.

use image::{DynamicImage, ImageDecoder, ImageReader, Limits};
use spectra_spectrum::Transfer;
use std::io::Cursor;

/// Largest side of a picture, pixels.
const MAX_SIDE: u32 = 65_535;
/// Largest picture, pixels: as linear light it takes 12 bytes each.
const MAX_PIXELS: u64 = 120_000_000;
/// No picture format packs more pixels into a byte: deflate ends near 1 032 to 1, at one byte a pixel or less.
const MAX_PIXELS_PER_BYTE: u64 = 1_100 * 8;

/// A picture in linear light, sRGB primaries, upright, row by row from the top.
pub(super) struct Linear {
    pub width: u32,
    pub height: u32,
    pub rgb: Vec<[f32; 3]>,
}

/// Decodes a PNG, JPEG, TIFF or Radiance HDR file; the kind is told by its content. Integers are
/// taken as sRGB-encoded (8 bits: 255 is 1), floating point as linear.
///
/// # Errors
/// A text: what is wrong with the file.
pub(super) fn decode(bytes: &[u8]) -> Result<Linear, String> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    if reader.format().is_none() {
        return Err("this is no PNG, JPEG, TIFF or Radiance HDR file".to_owned());
    }
    let mut decoder = reader.into_decoder().map_err(|e| e.to_string())?;
    let (width, height) = decoder.dimensions();
    let pixels = u64::from(width) * u64::from(height);
    if width == 0 || height == 0 {
        return Err("the picture has no pixels".to_owned());
    }
    if width > MAX_SIDE || height > MAX_SIDE || pixels > MAX_PIXELS {
        return Err(format!("{width} x {height} pixels; at most {MAX_PIXELS} in all and {MAX_SIDE} a side are read"));
    }
    if pixels > bytes.len() as u64 * MAX_PIXELS_PER_BYTE {
        return Err(format!("the header says {width} x {height} pixels, which {} bytes cannot hold", bytes.len()));
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    // As much as the picture needs, twice over, and something for the decoder.
    limits.max_alloc = Some(decoder.total_bytes().saturating_mul(2).saturating_add(64 << 20));
    decoder.set_limits(limits).map_err(|e| e.to_string())?;
    let picture = DynamicImage::from_decoder(decoder).map_err(|e| e.to_string())?;
    Ok(Linear { width, height, rgb: linear(&picture) })
}

fn linear(picture: &DynamicImage) -> Vec<[f32; 3]> {
    let table = |levels: usize| -> Vec<f32> {
        (0..levels).map(|i| Transfer::Srgb.decode(i as f64 / (levels - 1) as f64) as f32).collect()
    };
    match picture {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            let clean = |v: f32| if v.is_finite() { v.max(0.0) } else { 0.0 };
            picture.to_rgb32f().pixels().map(|p| p.0.map(clean)).collect()
        }
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let table = table(65_536);
            picture.to_rgb16().pixels().map(|p| p.0.map(|v| table[usize::from(v)])).collect()
        }
        _ => {
            let table = table(256);
            picture.to_rgb8().pixels().map(|p| p.0.map(|v| table[usize::from(v)])).collect()
        }
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
        let linear = decode(&png(&picture)).unwrap();
        assert_eq!((linear.width, linear.height), (3, 2));
        assert_eq!(linear.rgb[2], [1.0, 1.0, 1.0]);
        // IEC 61966-2-1: ((188/255 + 0.055) / 1.055)^2.4 = 0.50289.
        assert!((linear.rgb[3][0] - 0.502_89).abs() < 1e-5);
    }

    #[test]
    fn broken_and_hostile_files_are_refused() {
        let good = png(&RgbImage::new(64, 64));
        for cut in [0, 1, 7, 8, 20, 33, 50, good.len() - 13] {
            assert!(decode(&good[..cut]).is_err(), "cut at {cut}");
        }
        // A header that claims 60 000 x 60 000 pixels, and one that claims 2^31 a side.
        for side in [60_000_u32, 0x7fff_ffff] {
            let mut bad = good.clone();
            bad[16..20].copy_from_slice(&side.to_be_bytes());
            bad[20..24].copy_from_slice(&side.to_be_bytes());
            assert!(decode(&bad).is_err());
        }
        assert!(decode(b"GIF89a not read").is_err());
    }
}

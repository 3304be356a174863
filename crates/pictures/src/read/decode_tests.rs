//! Tests of [`super::decode`], with files made in memory.

use super::decode::decode_bytes as decode;
use super::{ReadOptions, exr};
use image::{ImageFormat, Rgb, RgbImage};
use spectra_color::matrix::apply;
use spectra_core::resources::FoundFile;
use std::io::Cursor;

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
    let linear = decode(&png(&picture), ReadOptions::default()).unwrap();
    assert_eq!((linear.width, linear.height), (3, 2));
    assert_eq!(linear.rgb[2], [1.0, 1.0, 1.0]);
    // IEC 61966-2-1: ((188/255 + 0.055) / 1.055)^2.4 = 0.50289.
    assert!((linear.rgb[3][0] - 0.502_89).abs() < 1e-5);
}

/// BMP and lossless WebP give the same picture as PNG, including alpha.
#[test]
fn bmp_and_webp_are_read() {
    let picture = image::RgbaImage::from_fn(5, 4, |x, y| {
        image::Rgba([(x * 50) as u8, (y * 60) as u8, 128, if x == 3 { 100 } else { 255 }])
    });
    let opaque = image::DynamicImage::ImageRgba8(picture.clone()).to_rgb8();
    let of = |format, alpha: bool| {
        let mut bytes = Cursor::new(Vec::new());
        let written = if alpha { picture.write_to(&mut bytes, format) } else { opaque.write_to(&mut bytes, format) };
        written.expect("written");
        let found = FoundFile::bytes("picture".to_owned(), bytes.into_inner().into());
        crate::read::decode(&found, ReadOptions { alpha: true, ..ReadOptions::default() }).expect("a picture")
    };
    for alpha in [false, true] {
        let png = of(ImageFormat::Png, alpha);
        assert_eq!(png.alpha.is_some(), alpha);
        for format in [ImageFormat::WebP, ImageFormat::Bmp] {
            assert_eq!(of(format, alpha), png, "{format:?}");
        }
    }
}

/// A lossy WebP of a smooth picture differs from its original PNG (`xtask/picture_samples.py`) by less than 2 in CIELAB on average.
#[test]
fn lossy_webp_is_near_its_original() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/");
    let [lossy, plain] = ["lossy.webp", "lossy.png"].map(|name| {
        let bytes = std::fs::read(format!("{folder}{name}")).expect("a sample");
        decode(&bytes, ReadOptions::default()).expect("a picture")
    });
    assert_eq!((lossy.width, lossy.height), (plain.width, plain.height));
    let lab = |light: &[f32; 3]| {
        let space = spectra_color::RgbSpace::srgb();
        let xyz = apply(&space.xyz_from_rgb, light.map(f64::from));
        spectra_color::lab(xyz, space.white_xyz())
    };
    let differences = lossy.rgb.iter().zip(&plain.rgb).map(|(a, b)| {
        let [a, b] = [lab(a), lab(b)];
        (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>().sqrt()
    });
    let mean = differences.sum::<f64>() / lossy.rgb.len() as f64;
    assert!(mean < 2.0 && mean > 0.0, "{mean}");
}

/// Builds a TIFF of 20 x 19 pixels whose sample c of pixel (x, y) is `of(c, x, y)`. It has a plane for each channel or interleaved
/// pixels, in strips of 6 rows or tiles of 16 x 16.
fn tiff_of(channels: usize, is_planar: bool, is_tiled: bool, of: impl Fn(usize, usize, usize) -> f32) -> Vec<u8> {
    use ::tiff::{encoder::TiffEncoder, tags::Tag};
    const SIZE: [usize; 2] = [20, 19];
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut picture = encoder.image_directory().unwrap();
    let chunk = if is_tiled { [16, 16] } else { [SIZE[0], 6] };
    let (mut offsets, mut counts) = (Vec::new(), Vec::new());
    let planes: Vec<_> =
        if is_planar { (0..channels).map(|c| c..c + 1).collect() } else { std::iter::once(0..channels).collect() };
    for plane in planes {
        for y0 in (0..SIZE[1]).step_by(chunk[1]) {
            let rows = if is_tiled { 16 } else { chunk[1].min(SIZE[1] - y0) };
            for x0 in (0..SIZE[0]).step_by(chunk[0]) {
                let mut samples = Vec::new();
                for (y, x) in (y0..y0 + rows).flat_map(|y| (x0..x0 + chunk[0]).map(move |x| (y, x))) {
                    samples.extend(plane.clone().map(|c| of(c, x, y)));
                }
                offsets.push(picture.write_data(&samples[..]).unwrap() as u32);
                counts.push(4 * samples.len() as u32);
            }
        }
    }
    let all = |value: u16| vec![value; channels];
    picture.write_tag(Tag::ImageWidth, SIZE[0] as u32).unwrap();
    picture.write_tag(Tag::ImageLength, SIZE[1] as u32).unwrap();
    picture.write_tag(Tag::BitsPerSample, &all(32)[..]).unwrap();
    picture.write_tag(Tag::Compression, 1_u16).unwrap();
    picture.write_tag(Tag::PhotometricInterpretation, 2_u16).unwrap();
    picture.write_tag(Tag::SamplesPerPixel, channels as u16).unwrap();
    picture.write_tag(Tag::PlanarConfiguration, if is_planar { 2_u16 } else { 1 }).unwrap();
    if channels == 4 {
        picture.write_tag(Tag::ExtraSamples, 1_u16).unwrap(); // associated
    }
    picture.write_tag(Tag::SampleFormat, &all(3)[..]).unwrap();
    let [at, size] = if is_tiled {
        picture.write_tag(Tag::TileWidth, 16_u32).unwrap();
        picture.write_tag(Tag::TileLength, 16_u32).unwrap();
        [Tag::TileOffsets, Tag::TileByteCounts]
    } else {
        picture.write_tag(Tag::RowsPerStrip, chunk[1] as u32).unwrap();
        [Tag::StripOffsets, Tag::StripByteCounts]
    };
    picture.write_tag(at, &offsets[..]).unwrap();
    picture.write_tag(size, &counts[..]).unwrap();
    picture.finish().unwrap();
    bytes.into_inner()
}

#[test]
fn planes_are_read_as_pixels_are() {
    let of = |c: usize, x: usize, y: usize| (1 + c) as f32 / 8.0 + x as f32 / 64.0 + y as f32;
    for (channels, is_tiled) in [(3, false), (4, false), (3, true), (4, true)] {
        let [planes, pixels] = [true, false].map(|is_planar| {
            let cover = |c, x, y| if c == 3 { x as f32 / 20.0 } else { of(c, x, y) };
            let choice = ReadOptions { alpha: true, ..ReadOptions::default() };
            decode(&tiff_of(channels, is_planar, is_tiled, cover), choice).unwrap()
        });
        assert_eq!((planes.width, planes.height), (20, 19));
        assert!(planes.rgb == pixels.rgb && planes.alpha == pixels.alpha, "{channels} {is_tiled}");
        assert_eq!(planes.rgb[18 * 20 + 7], [0, 1, 2].map(|c| of(c, 7, 18)), "{channels} {is_tiled}");
        assert_eq!(planes.alpha.map(|cover| cover[18 * 20 + 7]), (channels == 4).then_some(7.0 / 20.0));
    }
}

/// A picture with clear and half-clear pixels gives a warning if alpha is not wanted. An opaque picture gives none.
#[test]
fn cover_that_is_lost_is_said() {
    for side in [2, 300] {
        let of = |x: u32, y: u32| [200, 100, 50, if y > 0 { 255 } else { [0, 128][x as usize % 2] }];
        let picture = image::RgbaImage::from_fn(side, side, |x, y| image::Rgba(of(x, y)));
        let mut bytes = Cursor::new(Vec::new());
        picture.write_to(&mut bytes, ImageFormat::Png).unwrap();
        let read = decode(bytes.get_ref(), ReadOptions::default()).unwrap();
        let [doubt] = &read.warnings[..] else { panic!("{:?}", read.warnings) };
        assert!(doubt.text.contains(&format!("{side} of its {} pixels", side * side)), "{}", doubt.text);
        let covered = decode(bytes.get_ref(), ReadOptions { alpha: true, ..ReadOptions::default() }).unwrap();
        assert!(covered.warnings.is_empty() && covered.alpha.is_some());
    }
    let mut bytes = Cursor::new(Vec::new());
    image::RgbaImage::from_pixel(3, 2, image::Rgba([9, 9, 9, 255])).write_to(&mut bytes, ImageFormat::Png).unwrap();
    assert!(decode(bytes.get_ref(), ReadOptions::default()).unwrap().warnings.is_empty());
}

#[test]
fn broken_and_hostile_files_are_refused() {
    let good = png(&RgbImage::new(64, 64));
    for cut in [0, 1, 7, 8, 20, 33, 50, good.len() - 13] {
        assert!(decode(&good[..cut], ReadOptions::default()).is_err(), "cut at {cut}");
    }
    // A header that claims 60 000 x 60 000 pixels, and one that claims 2^31 per side.
    for side in [60_000_u32, 0x7fff_ffff] {
        let mut bad = good.clone();
        bad[16..20].copy_from_slice(&side.to_be_bytes());
        bad[20..24].copy_from_slice(&side.to_be_bytes());
        assert!(decode(&bad, ReadOptions::default()).is_err());
    }
    assert!(decode(b"GIF89a not read", ReadOptions::default()).is_err());
}

#[test]
fn the_encoding_that_is_said_is_taken() {
    let bytes = png(&RgbImage::from_pixel(2, 1, Rgb([0, 51, 255])));
    let said = |transfer| decode(&bytes, ReadOptions { transfer: Some(transfer), ..ReadOptions::default() });
    assert_eq!(said("linear").unwrap().rgb[0], [0.0, 0.2, 1.0]);
    // ITU-R BT.709: ((0.2 + 0.099) / 1.099)^(1/0.45) = 0.05543.
    assert!((said("rec709").unwrap().rgb[0][1] - 0.055_43).abs() < 1e-4);
    let trouble = said("srbg").expect_err("not known");
    assert_eq!((trouble.key, trouble.hint.is_some()), ("transfer", true));
    let exr = exr::MAGIC.to_vec();
    assert_eq!(
        decode(&exr, ReadOptions { transfer: Some("srgb"), ..ReadOptions::default() }).err().unwrap().key,
        "transfer"
    );
}

/// TIFF 6.0, `Orientation`: 6 means that the first stored row is the right side of the picture.
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
    let upright = decode(&bytes.into_inner(), ReadOptions::default()).unwrap();
    assert_eq!((upright.width, upright.height), (32, 48));
    let at = |column: usize, row: usize| upright.rgb[row * 32 + column];
    assert!(at(28, 4)[0] > 0.9 && at(28, 4)[1] < 0.05, "the first pixel is at the top right");
    assert!(at(28, 44)[1] > 0.9 && at(4, 4)[0] < 0.05);
}

#[test]
fn without_a_library_other_formats_say_how_to_get_it() {
    if crate::library::library().is_some() {
        return;
    }
    for (bytes, name) in [(&b"SDPX"[..], "scan.DPX"), (b"GIF89a\0\0\0\0", "dance.gif")] {
        let trouble = decode(bytes, ReadOptions { name, ..ReadOptions::default() }).expect_err("not read");
        assert!(trouble.hint.is_some_and(|hint| hint.contains("--features oiio")), "{name}: {}", trouble.text);
    }
    // The message does not suggest a library for unknown or broken files.
    for name in ["notes.txt", "broken.png", "nothing"] {
        let trouble = decode(b"some text", ReadOptions { name, ..ReadOptions::default() }).expect_err("not read");
        assert!(trouble.hint.is_none_or(|hint| !hint.contains("oiio")), "{name}");
    }
}

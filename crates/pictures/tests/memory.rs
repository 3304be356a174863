//! Measures the memory that reading a picture takes: the peak of a separate process that reads it, as the system counts it.

#![cfg(target_os = "linux")]

mod cost;

use cost::{Case, HEIGHT, WIDTH, ramp};
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::fs::File;
use std::path::Path;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

fn tiff<C: colortype::ColorType>(path: &Path, orientation: u16, values: &[C::Inner])
where
    [C::Inner]: tiff::encoder::TiffValue,
{
    let mut encoder = TiffEncoder::new(File::create(path).expect("a file")).expect("a file");
    let mut picture = encoder.new_image::<C>(WIDTH, HEIGHT).expect("a picture");
    picture.encoder().write_tag(Tag::Orientation, orientation).expect("a tag");
    picture.write_data(values).expect("written");
}

/// Writes a TIFF with a plane for each channel, one after the other, in strips of 8 rows.
fn planar(path: &Path, channels: u16) {
    const ROWS: u32 = 8;
    let mut encoder = TiffEncoder::new(File::create(path).expect("a file")).expect("a file");
    let mut picture = encoder.image_directory().expect("a picture");
    let plane = ramp(1, |i| i as f32);
    let (mut offsets, mut counts) = (Vec::new(), Vec::new());
    for _ in 0..channels {
        for strip in plane.chunks((WIDTH * ROWS) as usize) {
            offsets.push(picture.write_data(strip).expect("written") as u32);
            counts.push(4 * strip.len() as u32);
        }
    }
    let each = vec![32_u16; usize::from(channels)];
    picture.write_tag(Tag::ImageWidth, WIDTH).expect("a tag");
    picture.write_tag(Tag::ImageLength, HEIGHT).expect("a tag");
    picture.write_tag(Tag::BitsPerSample, &each[..]).expect("a tag");
    picture.write_tag(Tag::Compression, 1_u16).expect("a tag");
    picture.write_tag(Tag::PhotometricInterpretation, 2_u16).expect("a tag");
    picture.write_tag(Tag::StripOffsets, &offsets[..]).expect("a tag");
    picture.write_tag(Tag::SamplesPerPixel, channels).expect("a tag");
    picture.write_tag(Tag::RowsPerStrip, ROWS).expect("a tag");
    picture.write_tag(Tag::StripByteCounts, &counts[..]).expect("a tag");
    picture.write_tag(Tag::PlanarConfiguration, 2_u16).expect("a tag");
    if channels == 4 {
        picture.write_tag(Tag::ExtraSamples, 2_u16).expect("a tag");
    }
    picture.write_tag(Tag::SampleFormat, &vec![3_u16; usize::from(channels)][..]).expect("a tag");
    picture.finish().expect("written");
}

fn photograph(path: &Path) {
    let mut encoder = JpegEncoder::new(File::create(path).expect("a file"));
    // TIFF header, one entry: tag 274, short, 6.
    encoder
        .set_exif_metadata(b"MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0".to_vec())
        .expect("EXIF");
    encoder.encode(&ramp(3, |i| i as u8), WIDTH, HEIGHT, ExtendedColorType::Rgb8).expect("written");
}

fn png(path: &Path) {
    let mut writer = std::io::BufWriter::new(File::create(path).expect("a file"));
    let encoder = image::codecs::png::PngEncoder::new(&mut writer);
    encoder.write_image(&ramp(4, |i| i as u8), WIDTH, HEIGHT, ExtendedColorType::Rgba8).expect("written");
}

fn exr(path: &Path) {
    let of = |x: usize, _: usize| (x as f32, 0.5_f32, 0.25_f32, 1.0_f32);
    exr::prelude::write_rgba_file(path, WIDTH as usize, HEIGHT as usize, of).expect("written");
}

#[test]
fn a_picture_costs_twelve_bytes_a_pixel_and_its_header_none() {
    let cases: &[Case] = &[
        ("float.tif", |path| tiff::<colortype::RGB32Float>(path, 1, &ramp(3, |i| i as f32))),
        ("float-with-cover.tif", |path| tiff::<colortype::RGBA32Float>(path, 1, &ramp(4, |i| i as f32))),
        ("float-on-its-side.tif", |path| tiff::<colortype::RGB32Float>(path, 6, &ramp(3, |i| i as f32))),
        ("float-by-planes.tif", |path| planar(path, 3)),
        ("float-by-planes-with-cover.tif", |path| planar(path, 4)),
        ("scan-on-its-side.tif", |path| tiff::<colortype::RGB16>(path, 8, &ramp(3, |i| i as u16))),
        ("scan-with-cover-on-its-side.tif", |path| tiff::<colortype::RGBA16>(path, 5, &ramp(4, |i| i as u16))),
        ("on-its-side.jpg", photograph),
        ("with-cover.png", png),
        ("float.exr", exr),
    ];
    cost::holds(cases);
}

//! What a picture costs: the peak of a process of its own that reads it, as the system counts it.

#![cfg(target_os = "linux")]

use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageEncoder};
use spectra_core::resources::Found;
use spectra_pictures::read::{Choice, decode, header};
use std::fs::File;
use std::path::Path;
use std::process::Command;
use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

const WIDTH: u32 = 2896;
const HEIGHT: u32 = 1930;
const PIXELS: f64 = (WIDTH * HEIGHT) as f64;
/// For decoders and what they unpack at a time.
const SPARE_BYTES: f64 = (12 << 20) as f64;

/// Largest memory of this process so far, bytes (proc(5), `VmHWM`).
fn peak_bytes() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux says it");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a line of it");
    line.trim().trim_end_matches("kB").trim().parse::<f64>().expect("a number") * 1024.0
}

/// Reads the file that the test below names, and prints what that cost.
#[test]
#[ignore = "started by the test below, in a process of its own"]
fn reader() {
    let Some(path) = std::env::var_os("SPECTRA_TEST_PICTURE") else { return };
    let found = Found::on_disk("a file".to_owned(), path.clone().into());
    let name = path.to_string_lossy();
    let choice = Choice { name: &name, transfer: name.ends_with(".dpx").then_some("srgb"), ..Choice::default() };
    let before = peak_bytes();
    let header = header(&found, choice).unwrap_or_else(|trouble| panic!("{name}: {}", trouble.text));
    let of_header = peak_bytes() - before;
    let read = decode(&found, choice).unwrap_or_else(|trouble| panic!("{name}: {}", trouble.text));
    println!("cost {} {}", of_header, peak_bytes() - before);
    assert_eq!((read.width, read.height), (header.width, header.height), "{name}");
    assert_eq!(read.clipped_at.is_some(), header.clips, "{name}");
}

fn ramp<T: Copy>(channels: u32, of: impl Fn(u32) -> T) -> Vec<T> {
    let row: Vec<T> = (0..WIDTH * channels).map(|i| of(i / channels / 16)).collect();
    row.repeat(HEIGHT as usize)
}

fn tiff<C: colortype::ColorType>(path: &Path, orientation: u16, values: &[C::Inner])
where
    [C::Inner]: tiff::encoder::TiffValue,
{
    let mut encoder = TiffEncoder::new(File::create(path).expect("a file")).expect("a file");
    let mut picture = encoder.new_image::<C>(WIDTH, HEIGHT).expect("a picture");
    picture.encoder().write_tag(Tag::Orientation, orientation).expect("a tag");
    picture.write_data(values).expect("written");
}

/// A plane for each channel, one after the other, in strips of 8 rows.
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

/// A file, and the pixels that it holds.
type Case = (&'static str, fn(&Path));

#[test]
fn a_picture_costs_twelve_bytes_a_pixel_and_its_header_none() {
    let folder = tempfile::tempdir().expect("a folder");
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
        #[cfg(feature = "oiio")]
        ("film.dpx", foreign),
        #[cfg(feature = "oiio")]
        ("tiles.tx", texture),
    ];
    for (name, write) in cases {
        let path = folder.path().join(name);
        write(&path);
        let own = std::env::current_exe().expect("this program");
        let mut reader = Command::new(own);
        reader.args(["--exact", "reader", "--ignored", "--nocapture", "--test-threads", "1"]);
        let output = reader.env("SPECTRA_TEST_PICTURE", &path).output().expect("it runs");
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{name}: {text}{}", String::from_utf8_lossy(&output.stderr));
        let said = text.split("cost ").nth(1).expect("what it cost").lines().next().expect("a line");
        let cost: Vec<f64> = said.split(' ').map(|word| word.parse().expect("a number")).collect();
        println!("{name}: {:.2} B a pixel, {:.2} of them for the header", cost[1] / PIXELS, cost[0] / PIXELS);
        assert!(cost[0] < SPARE_BYTES, "{name}: the header took {} bytes", cost[0]);
        assert!(cost[1] < 12.0 * PIXELS + SPARE_BYTES, "{name}: {:.2} B a pixel", cost[1] / PIXELS);
        std::fs::remove_file(&path).expect("it was there");
    }
}

#[cfg(feature = "oiio")]
fn planes<T>(samples: spectra_plugin_oiio::Samples, then: impl FnOnce(&spectra_plugin_oiio::Written<'_>) -> T) -> T {
    let plane = ramp(1, |i| i as f32 / 256.0);
    then(&spectra_plugin_oiio::Written {
        format: "dpx",
        ending: "dpx",
        width_px: WIDTH,
        height_px: HEIGHT,
        pixel_aspect: None,
        samples,
        tile_px: None,
        channels: &[("R", &plane), ("G", &plane), ("B", &plane)],
        texts: &[],
        integers: &[],
    })
}

#[cfg(feature = "oiio")]
fn foreign(path: &Path) {
    let mut file = File::options().read(true).write(true).create_new(true).open(path).expect("a file");
    planes(spectra_plugin_oiio::Samples::U16, |picture| spectra_plugin_oiio::write(&mut file, picture))
        .expect("written");
}

/// Half a float a sample is what is read by OpenImageIO alone.
#[cfg(feature = "oiio")]
fn texture(path: &Path) {
    planes(spectra_plugin_oiio::Samples::F16, |picture| spectra_plugin_oiio::make_texture(path, picture))
        .expect("written");
}

//! Cases that tests of the picture sources and the program do not alpha: full disks, repeated writes, limits.

/// The unit test of `stated.rs` runs with the tests of this file.
#[path = "../../src/header_size.rs"]
mod stated;

use spectra_core::resources::FoundFile;
use spectra_core::sink::WriteFault;
use spectra_pictures::library::{FilePicture, PictureLibrary, PictureLimits, TiledExr, library};
use spectra_plugin_oiio::{OpenImageIo, Samples, Written, write};
use std::fs::File;
use std::io::{Read, Seek};

const LIMITS: PictureLimits = PictureLimits { side_px: 65_535, pixels: 120_000_000 };

fn file_of(bytes: &[u8]) -> FoundFile {
    FoundFile::bytes("a file".to_owned(), bytes.to_vec().into())
}

fn ramp(pixels: u32) -> Vec<f32> {
    (0..pixels).map(|i| (i * 7919 % 1013) as f32 / 1013.0).collect()
}

fn tiled(to: &mut File, size: [u32; 2], values: &[f32]) -> Result<(), WriteFault> {
    let attributes = [("spectra:scene".to_owned(), "a: \"\u{3bb}\"\n  b: [1, 2]\n".to_owned())];
    let picture = TiledExr {
        width_px: size[0],
        height_px: size[1],
        pixel_aspect: 1.5,
        tile_px: 64,
        channels: &[("X", values), ("Z", values), ("Y", values)],
        attributes: &attributes,
    };
    OpenImageIo.write_tiled_exr(to, &picture)
}

#[test]
fn the_library_is_registered_under_its_name_and_version() {
    let name = library().expect("linked").name();
    let version = name.strip_prefix("OpenImageIO ").expect("its name");
    let numbers: Vec<u32> = version.split('.').map_while(|part| part.parse().ok()).collect();
    assert!(numbers.len() >= 3 && numbers[..2] >= [2, 4][..], "{name}");
}

#[test]
fn the_same_picture_gives_the_same_bytes() {
    let size = [700, 333];
    let values = ramp(700 * 333);
    let once = || {
        let mut file = tempfile::tempfile().expect("a file");
        tiled(&mut file, size, &values).expect("written");
        let mut bytes = Vec::new();
        file.rewind().expect("a file");
        file.read_to_end(&mut bytes).expect("read");
        bytes
    };
    let first = once();
    assert!((0..4).all(|_| once() == first));
    let date = first.windows(8).position(|bytes| bytes == b"capDate\0").expect("written in any case");
    assert_eq!(first[date + 8..][..11], *b"string\0\0\0\0\0", "no time of day");
    // The library reads back what it wrote.
    let read = OpenImageIo.read("exr", &file_of(&first), LIMITS);
    assert!(read.is_err_and(|cause| cause.to_string().contains("`X`")), "X, Y and Z are no red, green and blue");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_the_systems_word() {
    let mut full = File::options().write(true).open("/dev/full").expect("a device");
    let cause = tiled(&mut full, [700, 333], &ramp(700 * 333)).expect_err("no room").to_string();
    assert!(cause.contains("No space left"), "{cause}");
}

#[test]
fn pictures_that_are_none_are_refused_before_the_library_is_asked() {
    let mut file = tempfile::tempfile().expect("a file");
    assert!(tiled(&mut file, [700, 333], &ramp(5)).is_err());
    assert!(tiled(&mut file, [0, 333], &[]).is_err());
    assert!(tiled(&mut file, [u32::MAX, 1], &ramp(5)).is_err());
    let none = Written {
        format: "no-such-format",
        ending: "xyz",
        width_px: 1,
        height_px: 1,
        pixel_aspect: None,
        samples: Samples::U8,
        tile_px: None,
        channels: &[("R", &[0.5])],
        texts: &[],
        integers: &[],
    };
    assert!(write(&mut file, &none).is_err());
    assert_eq!(file.metadata().expect("a file").len(), 0);
}

#[test]
fn limits_are_the_askers() {
    let bytes = b"P6\n4 3\n255\n\
        abcdefghijklabcdefghijklabcdefghijkl";
    let read = |limits| OpenImageIo.read("ppm", &file_of(bytes), limits);
    let picture = read(LIMITS).expect("read");
    assert_eq!((picture.width_px, picture.height_px, picture.format.as_str()), (4, 3, "pnm"));
    assert_eq!(picture.rgb[0].map(|v| (v * 255.0).round() as u8), *b"abc");
    let header = OpenImageIo.header("ppm", &file_of(bytes), LIMITS).expect("read");
    assert_eq!(header, FilePicture { rgb: Vec::new(), ..picture });
    assert!(read(PictureLimits { side_px: 3, ..LIMITS }).is_err_and(|cause| cause.to_string().contains("4 x 3")));
    assert!(read(PictureLimits { pixels: 11, ..LIMITS }).is_err_and(|cause| cause.to_string().contains("at most 11")));
}

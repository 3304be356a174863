//! Compares files of other formats, written by OpenImageIO and by hand, with what was written.

use spectra_core::resources::FoundFile;
use spectra_pictures::read::{self, ENDINGS, FileProblem, LinearPicture, ReadOptions};
use spectra_plugin_oiio::{OpenImageIo, Samples, Written, make_texture, write};
use std::io::{Read, Seek};

const WIDTH: u32 = 70;
const HEIGHT: u32 = 50;

/// Code values of three channels: ramps in both directions and their product, including 0 and 1. They come in whole steps of one over
/// `levels`, unless that is 0.
fn ramps(levels: u32) -> [Vec<f32>; 3] {
    let at = |c: usize, i: usize| {
        let (x, y) =
            ((i % WIDTH as usize) as f32 / (WIDTH - 1) as f32, (i / WIDTH as usize) as f32 / (HEIGHT - 1) as f32);
        let code = [x, y, x * y][c];
        if levels > 0 { (code * levels as f32).round() / levels as f32 } else { code }
    };
    [0, 1, 2].map(|c| (0..(WIDTH * HEIGHT) as usize).map(|i| at(c, i)).collect())
}

struct File<'a> {
    format: &'a str,
    ending: &'a str,
    /// Number of steps from 0 to 1; 0 leaves the codes as they are.
    levels: u32,
    samples: Samples,
    texts: Vec<(&'a str, &'a str)>,
    integers: Vec<(&'a str, i32)>,
    alpha: Option<Vec<f32>>,
}

fn levels(samples: Samples) -> u32 {
    match samples {
        Samples::U8 => 255,
        Samples::U16 => 65_535,
        Samples::F16 | Samples::F32 => 0,
    }
}

impl<'a> File<'a> {
    fn new(format: &'a str, samples: Samples) -> Self {
        Self {
            format,
            ending: format,
            levels: levels(samples),
            samples,
            texts: Vec::new(),
            integers: Vec::new(),
            alpha: None,
        }
    }

    fn text(mut self, name: &'a str, text: &'a str) -> Self {
        self.texts.push((name, text));
        self
    }

    fn integer(mut self, name: &'a str, value: i32) -> Self {
        self.integers.push((name, value));
        self
    }

    /// Uses whole steps of this many bits, because the library truncates to them instead of rounding.
    fn bits(mut self, bits: u32) -> Self {
        self.levels = (1 << bits) - 1;
        self.integer("oiio:BitsPerSample", bits as i32)
    }

    fn with<T>(&self, then: impl FnOnce(&Written<'_>) -> T) -> T {
        let ramps = ramps(self.levels);
        let mut channels: Vec<(&str, &[f32])> = vec![("R", &ramps[0]), ("G", &ramps[1]), ("B", &ramps[2])];
        channels.extend(self.alpha.as_ref().map(|alpha| ("A", alpha.as_slice())));
        let texts: Vec<_> = self.texts.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        let integers: Vec<_> = self.integers.iter().map(|(a, b)| ((*a).to_owned(), *b)).collect();
        then(&Written {
            format: self.format,
            ending: self.ending,
            width_px: WIDTH,
            height_px: HEIGHT,
            pixel_aspect: None,
            samples: self.samples,
            tile_px: None,
            channels: &channels,
            texts: &texts,
            integers: &integers,
        })
    }

    fn bytes(&self) -> Vec<u8> {
        let mut file = tempfile::tempfile().expect("a file");
        self.with(|picture| write(&mut file, picture)).expect("written");
        let mut bytes = Vec::new();
        file.rewind().expect("a file");
        file.read_to_end(&mut bytes).expect("read");
        bytes
    }
}

fn decode(bytes: &[u8], choice: ReadOptions<'_>) -> Result<LinearPicture, FileProblem> {
    read::decode(&FoundFile::bytes("a file".to_owned(), bytes.to_vec().into()), choice)
}

fn jpeg_2000() -> Vec<u8> {
    File { ending: "jp2", ..File::new("jpeg2000", Samples::U8) }.bytes()
}

fn read(bytes: &[u8], name: &str) -> Result<LinearPicture, FileProblem> {
    decode(bytes, ReadOptions { name, alpha: true, ..ReadOptions::default() })
}

/// Returns the largest difference between the light and that of the ramps by `curve`, where a code value may be off by `step`.
/// The unit is the difference that `step` and single precision explain: 1 is the limit.
fn worst(found: &LinearPicture, levels: u32, curve: impl Fn(f64) -> f64, step: f64) -> f64 {
    assert_eq!((found.width, found.height), (WIDTH, HEIGHT));
    let ramps = ramps(levels);
    let mut worst = 0.0_f64;
    for (i, pixel) in found.rgb.iter().enumerate() {
        for c in 0..3 {
            let code = f64::from(ramps[c][i]);
            // There is no light below black.
            let light = |code: f64| curve(code).max(0.0);
            let (low, high) = (light((code - step).max(0.0)), light(code + step));
            let (want, light) = (light(code), f64::from(pixel[c]));
            let slack = 2e-7 * want.max(1.0);
            let off = if light > want {
                (light - want) / (high - want + slack)
            } else {
                (want - light) / (want - low + slack)
            };
            worst = worst.max(off);
        }
    }
    worst
}

fn srgb(code: f64) -> f64 {
    if code <= 0.040_45 { code / 12.92 } else { ((code + 0.055) / 1.055).powf(2.4) }
}

/// 8 and 16 bits come back unchanged; 10 and 12 bits arrive in 16 bits, within one step of those.
#[test]
fn dpx_comes_back_in_whole_steps_of_its_bits() {
    for bits in [8, 10, 12, 16] {
        let samples = if bits == 8 { Samples::U8 } else { Samples::U16 };
        let levels = (1 << bits) - 1;
        let step = if bits % 8 == 0 { 1e-7 } else { 1.0 / 65_535.0 };
        let file = |space| File::new("dpx", samples).bits(bits).text("oiio:ColorSpace", space);
        let linear = read(&file("Linear").bytes(), "a.dpx").unwrap();
        assert_eq!(linear.clipped_at, Some(1.0));
        let log = read(&file("KodakLog").bytes(), "a.dpx").unwrap();
        assert!(log.clipped_at.is_some_and(|light| (light - 13.52).abs() < 0.01));
        let black = 10_f64.powf((95.0 - 685.0) / 300.0);
        let cineon = |v: f64| (10_f64.powf((1023.0 * v - 685.0) / 300.0) - black) / (1.0 - black);
        let video = read(&file("Rec709").bytes(), "a.dpx").unwrap();
        let rec709 = |v: f64| if v < 0.081 { v / 4.5 } else { ((v + 0.099) / 1.099).powf(1.0 / 0.45) };
        let off = [
            worst(&linear, levels, |v| v, step),
            worst(&log, levels, cineon, step),
            // The curve has three digits in BT.709 and all digits here: they differ by 4e-4 of a code.
            worst(&video, levels, rec709, step + 4e-4),
        ];
        println!("{bits} bits: {off:.3?} of {step:.1e}");
        assert!(off.iter().all(|off| *off <= 1.0), "{bits} bits: {off:?}");
    }
    let float = read(&File::new("dpx", Samples::F32).text("oiio:ColorSpace", "Linear").bytes(), "a.dpx").unwrap();
    assert!(worst(&float, 0, |v| v, 0.0) <= 1.0 && float.clipped_at.is_none());
}

#[test]
fn a_dpx_file_that_says_nothing_is_not_guessed() {
    let bytes = File::new("dpx", Samples::U16).bits(10).text("oiio:ColorSpace", "").bytes();
    let trouble = read(&bytes, "a.dpx").expect_err("refused");
    assert!(trouble.text.contains("Undefined") && trouble.hint.is_some_and(|h| h.contains("transfer: srgb")));
    let said = decode(&bytes, ReadOptions { name: "a.dpx", transfer: Some("srgb"), ..ReadOptions::default() }).unwrap();
    assert!(worst(&said, 1023, srgb, 1.0 / 65_535.0) <= 1.0);
    // Film scanners write transfer characteristic 1 of SMPTE 268M, byte 801 of the file.
    let mut density = bytes;
    density[801] = 1;
    let log = read(&density, "a.dpx").unwrap();
    assert!(log.clipped_at.is_some_and(|light| (light - 13.52).abs() < 0.01));
}

#[test]
fn jpeg_2000_webp_and_others_come_back() {
    for (format, name, samples, step) in [
        // Lossless wavelets, at both depths.
        ("jpeg2000", "a.jp2", Samples::U8, 1e-7),
        ("jpeg2000", "a.j2k", Samples::U16, 1e-7),
        ("targa", "a.tga", Samples::U8, 1e-7),
        ("bmp", "a.bmp", Samples::U8, 1e-7),
        // Lossy, with color at half the resolution: several steps.
        ("webp", "a.webp", Samples::U8, 12.0 / 255.0),
    ] {
        let bytes = File { ending: &name[2..], ..File::new(format, samples) }.bytes();
        let found = read(&bytes, name).unwrap_or_else(|e| panic!("{name}: {}", e.text));
        let off = worst(&found, levels(samples), srgb, step);
        println!("{name}: {off:.3} of {step:.1e}, {} bytes", bytes.len());
        assert!(off <= 1.0, "{name}: {off}");
        assert_eq!(found.clipped_at, Some(1.0));
    }
}

#[test]
fn textures_are_read_at_full_size() {
    let folder = tempfile::tempdir().expect("a folder");
    for (samples, curve, step) in [
        (Samples::U8, srgb as fn(f64) -> f64, 1e-7),
        (Samples::U16, srgb, 1e-7),
        // Half a step of eleven binary digits below 1.
        (Samples::F16, |v| v, 1.0 / 4096.0),
        (Samples::F32, |v| v, 0.0),
    ] {
        let path = folder.path().join("a.tx");
        File::new("tiff", samples).with(|picture| make_texture(&path, picture)).expect("written");
        let found = read(&std::fs::read(&path).expect("there"), "a.tx").unwrap();
        let off = worst(&found, levels(samples), curve, step);
        println!("{samples:?}: {off}");
        assert!(off <= 1.0, "{samples:?}: {off}");
        assert_eq!(found.clipped_at.is_none(), matches!(samples, Samples::F16 | Samples::F32));
    }
    // An OpenEXR texture is read without the library.
    let path = folder.path().join("b.exr");
    File::new("openexr", Samples::F32).with(|picture| make_texture(&path, picture)).expect("written");
    assert!(worst(&read(&std::fs::read(&path).expect("there"), "b.tx").unwrap(), 0, |v| v, 0.0) <= 1.0);
}

/// Builds a Cineon file by hand (Kodak, "Cineon Image File Format Draft", 1995): header of 1024 bytes, three channels of 10 bits packed
/// into 32.
fn cineon(codes: [[u32; 3]; 2]) -> Vec<u8> {
    let mut bytes = vec![0xff; 2048];
    let mut put = |at: usize, value: &[u8]| bytes[at..at + value.len()].copy_from_slice(value);
    put(0, &0x802a_5fd7_u32.to_be_bytes());
    put(4, &2048_u32.to_be_bytes()); // where the pixels begin
    put(8, &1024_u32.to_be_bytes());
    put(12, &1024_u32.to_be_bytes());
    put(16, &0_u32.to_be_bytes());
    put(20, &2056_u32.to_be_bytes()); // of the file
    put(24, b"V4.5\0\0\0\0");
    put(192, &[0, 3]); // upright, three channels
    for channel in 0..3 {
        let at = 196 + 28 * channel;
        put(at, &[0, channel as u8 + 1, 10, 0]);
        put(at + 4, &2_u32.to_be_bytes());
        put(at + 8, &1_u32.to_be_bytes());
        for (k, value) in [0.0_f32, 0.0, 1023.0, 2.046].into_iter().enumerate() {
            put(at + 12 + 4 * k, &value.to_be_bytes());
        }
    }
    // Interleaved pixels; 5: packed into 32 bits from the left; positive; no padding at the ends of lines.
    put(680, &[0, 5, 0, 0]);
    put(684, &0_u32.to_be_bytes());
    put(688, &0_u32.to_be_bytes());
    for [r, g, b] in codes {
        bytes.extend((r << 22 | g << 12 | b << 2).to_be_bytes());
    }
    bytes
}

#[test]
fn a_cineon_file_is_log() {
    let found = read(&cineon([[95, 685, 1023], [445, 0, 685]]), "a.cin").unwrap();
    assert_eq!((found.width, found.height), (2, 1));
    let black = 10_f64.powf(-590.0 / 300.0);
    let light = |code: f64| ((10_f64.powf((code - 685.0) / 300.0) - black) / (1.0 - black)).max(0.0);
    for (pixel, codes) in found.rgb.iter().zip([[95.0, 685.0, 1023.0], [445.0, 0.0, 685.0]]) {
        for (found, code) in pixel.iter().zip(codes) {
            // The tolerance is a 64th of a step, because ten bits arrive in sixteen.
            let slack = light(code + 1.0 / 64.0) - light(code) + 1e-6;
            assert!((f64::from(*found) - light(code)).abs() < slack, "{code}: {found}");
        }
    }
}

#[test]
fn orientation_and_cover_are_heeded() {
    // SMPTE 268M, bytes 768 and 769: 3 runs from right to left and from the bottom up, 5 runs down and then to the left.
    let mut bytes = File::new("dpx", Samples::U8).text("oiio:ColorSpace", "Linear").bytes();
    let upright = read(&bytes, "a.dpx").unwrap().rgb;
    assert!(bytes.starts_with(b"XPDS"), "the byte of low worth comes first");
    bytes[768] = 3;
    assert!(read(&bytes, "a.dpx").unwrap().rgb.iter().eq(upright.iter().rev()), "turned by half");
    bytes[768] = 5;
    assert!(read(&bytes, "a.dpx").err().is_some_and(|trouble| trouble.text.contains("column by column")));
    // Targa stores straight alpha: code values are unchanged, light is multiplied.
    let mut file = File::new("targa", Samples::U8).integer("oiio:UnassociatedAlpha", 1);
    file.alpha = Some(vec![0.2; (WIDTH * HEIGHT) as usize]);
    let found = read(&file.bytes(), "a.tga").unwrap();
    assert!(found.alpha.as_ref().is_some_and(|alpha| alpha.iter().all(|a| (a - 0.2).abs() < 1e-6)));
    assert!((found.rgb[WIDTH as usize - 1][0] - 0.2).abs() < 1e-6, "{:?}", found.rgb[WIDTH as usize - 1]);
}

#[test]
fn broken_and_hostile_files_are_errors() {
    let files = [
        ("a.dpx", File::new("dpx", Samples::U16).text("oiio:ColorSpace", "Linear").bytes()),
        ("a.jp2", jpeg_2000()),
        ("a.tga", File::new("targa", Samples::U8).bytes()),
        ("a.cin", cineon([[95, 685, 1023], [445, 0, 685]])),
    ];
    for (name, good) in &files {
        assert!(read(good, name).is_ok(), "{name}");
        let mut kept = Vec::new();
        for cut in [0, 1, 4, 20, 40, 200, 800, good.len() / 2, good.len() - 5] {
            if let Err(trouble) = read(&good[..cut.min(good.len() - 1)], name) {
                assert!(trouble.hint.is_some() && !trouble.text.contains('\n'), "{name} {cut}: {}", trouble.text);
            } else {
                kept.push(cut);
            }
        }
        // Some readers accept a file cut near its end, but none accepts a cut header.
        assert!(kept.iter().all(|cut| *cut > 800), "{name}: {kept:?}");
        let text = read(b"This is no picture at all, but some text of two lines.\nThis is the second.\n", name);
        assert!(text.err().is_some_and(|trouble| trouble.hint.is_some()), "{name}: a text");
    }
}

#[test]
fn huge_sizes_in_headers_are_refused_before_anything_is_unpacked() {
    let dpx = File::new("dpx", Samples::U8).text("oiio:ColorSpace", "Linear").bytes();
    let jp2 = jpeg_2000();
    let tga = File::new("targa", Samples::U8).bytes();
    let siz = jp2.windows(4).position(|w| w == [0xff, 0x4f, 0xff, 0x51]).expect("a codestream");
    // Positions of width and height, their size in bytes, and the byte order.
    for (name, good, at, size, big) in [
        ("a.dpx", &dpx, [772, 776], 4, false),
        ("a.jp2", &jp2, [siz + 8, siz + 12], 4, true),
        ("a.tga", &tga, [12, 14], 2, false),
    ] {
        for side in [0xffff_u32, 0x0010_0000, 0x7fff_ffff, 0xffff_fff0] {
            let mut bad = good.clone();
            for at in at {
                if big {
                    bad[at..at + size].copy_from_slice(&side.to_be_bytes()[4 - size..]);
                } else {
                    bad[at..at + size].copy_from_slice(&side.to_le_bytes()[..size]);
                }
            }
            let Some(trouble) = read(&bad, name).err() else { panic!("{name} {side}: read") };
            println!("{name} {side:#x}: {}", trouble.text);
            assert!(trouble.hint.is_some());
        }
    }
    let gif = b"GIF89a\xff\xff\xff\xff\x80\0\0\0\0\0\xff\xff\xff,\0\0\0\0\xff\xff\xff\xff\0\x02\x02D\x01\0;";
    assert!(read(gif, "a.gif").is_err());
    assert!(read(b"P6\n60000 60000\n255\nabc", "a.ppm").is_err());
    assert!(read(b"P6\n1000000000 1000000000\n255\nabc", "a.ppm").is_err());
}

#[test]
fn the_endings_are_those_of_the_library() {
    let own = [
        "png", "jpg", "jpe", "jpeg", "jif", "jfif", "jfi", "tif", "tiff", "exr", "sxr", "mxr", "hdr", "rgbe", "webp",
        "bmp", "dib",
    ];
    let library = OpenImageIo::endings();
    for ending in ENDINGS.split(' ') {
        assert!(library.iter().any(|known| known == ending), "{ending} is not read");
    }
    for ending in &library {
        let listed = ENDINGS.split(' ').any(|known| known == ending) || own.contains(&ending.as_str());
        assert!(listed, "{ending} is read, too");
    }
    for name in ["a.null", "a.mov", "a.xyz", "a"] {
        let trouble = read(b"some bytes", name).expect_err("refused");
        assert!(trouble.hint.is_some(), "{name}: {}", trouble.text);
    }
}

//! Writes raw frames as DNG, which raw converters open.

use super::tiff::{
    Field, bytes, directory, doubles, exposure, length, longs, rationals, shorts, signed_rationals, text, undefined,
};
use spectra_core::frame::RawFrame;
use spectra_core::sink::Out;
use spectra_files::WriteFault;
use std::io::{BufWriter, Write};

/// Description of the lens for a raw file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawLens {
    /// Name of the lens.
    pub model: Option<String>,
    /// Maker of the lens.
    pub maker: Option<String>,
    /// Focal length, mm.
    pub focal_length_mm: Option<f64>,
    /// The f-number to which the lens is set.
    pub f_number: Option<f64>,
}

/// Writes the frame as DNG: one uncompressed strip of 16 bits per pixel, little-endian.
///
/// The tags hold the filter pattern, black and white level, the color matrices for each light, the neutral color, the noise, the exposure
/// and the lens.
/// Sources: Adobe Systems, Digital Negative Specification 1.4.0.0; Exif 2.31. No date is written: the same frame gives the same bytes.
///
/// # Errors
/// [`WriteFault`]: the system refuses, the number of values does not match the size, or the file would exceed 4 GB.
pub fn dng(out: &mut dyn Out, frame: &RawFrame, lens: &RawLens) -> Result<(), WriteFault> {
    let mut to = BufWriter::new(out);
    to.write_all(&head(frame, lens)?)?;
    for row in frame.values.chunks(frame.width_px.max(1) as usize) {
        let bytes: Vec<u8> = row.iter().flat_map(|v| v.to_le_bytes()).collect();
        to.write_all(&bytes)?;
    }
    Ok(to.flush()?)
}

const STRIP_OFFSETS: u16 = 273;
const EXIF_DIRECTORY: u16 = 34_665;
/// Position of the first directory, bytes.
const START: usize = 8;

/// Builds everything before the pixels.
fn head(frame: &RawFrame, lens: &RawLens) -> Result<Vec<u8>, WriteFault> {
    let (width, height, found) = (frame.width_px, frame.height_px, frame.values.len());
    let size = found as u64 * 2;
    if found == 0 || found as u64 != u64::from(width) * u64::from(height) || size > u64::from(u32::MAX) - 65_536 {
        return Err(WriteFault::Format(format!(
            "a raw frame of {width} x {height} pixels with {found} values cannot be written"
        )));
    }
    let exif = exif(frame, lens);
    let mut main = picture(frame, size as u32);
    main.extend(color(frame));
    main.extend([longs(STRIP_OFFSETS, &[0]), longs(EXIF_DIRECTORY, &[0])]);
    let exif_at = START + length(&main);
    let strip_at = (exif_at + length(&exif)).next_multiple_of(16);
    for field in &mut main {
        match field.tag {
            STRIP_OFFSETS => *field = longs(STRIP_OFFSETS, &[strip_at as u32]),
            EXIF_DIRECTORY => *field = longs(EXIF_DIRECTORY, &[exif_at as u32]),
            _ => {}
        }
    }
    let mut out = b"II*\0".to_vec();
    out.extend((START as u32).to_le_bytes());
    out.extend(directory(&main, START));
    out.extend(directory(&exif, exif_at));
    out.resize(strip_at, 0);
    Ok(out)
}

/// Fields that describe the numbers of the frame.
fn picture(frame: &RawFrame, size: u32) -> Vec<Field> {
    const COLOR_FILTER_ARRAY: u16 = 32_803;
    const LINEAR_RAW: u16 = 34_892;
    let (width, height) = (frame.width_px, frame.height_px);
    let interpretation = if frame.pattern.is_some() { COLOR_FILTER_ARRAY } else { LINEAR_RAW };
    let [across, down] = frame.pixel_mm;
    // Scales that keep the number of pixels about the same if they are not square.
    let side = (across * down).sqrt();
    let mut fields = vec![
        longs(254, &[0]), // NewSubfileType: the picture in full
        longs(256, &[width]),
        longs(257, &[height]),
        shorts(258, &[16]),             // BitsPerSample
        shorts(259, &[1]),              // Compression: none
        shorts(262, &[interpretation]), // PhotometricInterpretation
        text(271, &frame.maker),
        text(272, &frame.model),
        shorts(274, &[1]),     // Orientation: upright
        shorts(277, &[1]),     // SamplesPerPixel
        longs(278, &[height]), // RowsPerStrip
        longs(279, &[size]),
        shorts(284, &[1]), // PlanarConfiguration
        text(305, concat!("spectra ", env!("CARGO_PKG_VERSION"))),
        bytes(50_706, &[1, 4, 0, 0]), // DNGVersion
        bytes(50_707, &[1, 1, 0, 0]), // DNGBackwardVersion
        text(50_708, &frame.unique_model),
        shorts(50_714, &[frame.black_level]),
        longs(50_717, &[u32::from(frame.white_level)]),
        rationals(50_718, &[across / side, down / side]), // DefaultScale
        longs(50_719, &[0, 0]),                           // DefaultCropOrigin
        longs(50_720, &[width, height]),                  // DefaultCropSize
        signed_rationals(50_730, &[frame.baseline_exposure_stops]),
        longs(50_829, &[0, 0, height, width]), // ActiveArea: top, left, bottom, right
    ];
    if let Some(noise) = frame.noise {
        fields.push(doubles(51_041, &[noise.scale, noise.offset])); // NoiseProfile, of all colors
    }
    if let Some(pattern) = frame.pattern {
        fields.extend([
            shorts(33_421, &[2, 2]),   // CFARepeatPatternDim
            bytes(33_422, &pattern),   // CFAPattern
            bytes(50_710, &[0, 1, 2]), // CFAPlaneColor
            shorts(50_711, &[1]),      // CFALayout: rectangular
        ]);
    }
    fields
}

/// Fields that describe the colors of the frame.
fn color(frame: &RawFrame) -> Vec<Field> {
    const COLOR_MATRIX: u16 = 50_721;
    const CALIBRATION_ILLUMINANT: u16 = 50_778;
    const FORWARD_MATRIX: u16 = 50_964;
    if frame.pattern.is_none() {
        return Vec::new();
    }
    let mut fields = vec![rationals(50_728, &frame.neutral)]; // AsShotNeutral
    for (at, color) in (0..).zip(frame.colors.iter().take(2)) {
        let values = |rows: [[f64; 3]; 3]| rows.concat();
        fields.extend([
            signed_rationals(COLOR_MATRIX + at, &values(color.camera_from_xyz)),
            shorts(CALIBRATION_ILLUMINANT + at, &[color.illuminant]),
            signed_rationals(FORWARD_MATRIX + at, &values(color.d50_from_balanced)),
        ]);
    }
    fields
}

/// Exif fields that describe how the picture was taken.
fn exif(frame: &RawFrame, lens: &RawLens) -> Vec<Field> {
    const RECOMMENDED_EXPOSURE_INDEX: u16 = 2;
    const PER_CENTIMETER: u16 = 3;
    const MM_PER_CM: f64 = 10.0;
    let iso = frame.iso.round();
    let mut fields = vec![
        exposure(33_434, frame.exposure_time_s),
        // This tag ends at 65535; the next ones hold more.
        shorts(34_855, &[iso as u16]),                       // PhotographicSensitivity
        shorts(34_864, &[RECOMMENDED_EXPOSURE_INDEX]),       // SensitivityType
        longs(34_866, &[iso as u32]),                        // RecommendedExposureIndex
        undefined(36_864, b"0231"),                          // ExifVersion
        shorts(37_384, &[frame.illuminant]),                 // LightSource
        rationals(41_486, &[MM_PER_CM / frame.pixel_mm[0]]), // FocalPlaneXResolution
        rationals(41_487, &[MM_PER_CM / frame.pixel_mm[1]]), // FocalPlaneYResolution
        shorts(41_488, &[PER_CENTIMETER]),                   // FocalPlaneResolutionUnit
    ];
    let positive = |value: Option<f64>| value.filter(|v| *v > 0.0 && v.is_finite());
    fields.extend(positive(lens.f_number).map(|n| rationals(33_437, &[n])));
    fields.extend(positive(lens.focal_length_mm).map(|f| rationals(37_386, &[f])));
    fields.extend(lens.maker.as_deref().map(|maker| text(42_035, maker)));
    fields.extend(lens.model.as_deref().map(|model| text(42_036, model)));
    fields
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_core::frame::{RawColor, RawNoise};
    use std::io::Cursor;

    fn frame() -> RawFrame {
        RawFrame {
            width_px: 6,
            height_px: 4,
            values: (0..24).map(|i| 512 + i * 601).collect(),
            pattern: Some([0, 1, 1, 2]),
            black_level: 512,
            white_level: 16_383,
            colors: vec![
                RawColor {
                    illuminant: 17,
                    camera_from_xyz: [[0.8, -0.2, -0.1], [-0.5, 1.3, 0.2], [-0.1, 0.3, 0.5]],
                    d50_from_balanced: [[0.6, 0.2, 0.1], [0.2, 0.9, -0.1], [0.1, -0.2, 1.0]],
                },
                RawColor {
                    illuminant: 21,
                    camera_from_xyz: [[0.9, -0.3, -0.1], [-0.4, 1.2, 0.2], [-0.1, 0.3, 0.6]],
                    d50_from_balanced: [[0.7, 0.2, 0.1], [0.2, 0.8, -0.1], [0.1, -0.2, 0.9]],
                },
            ],
            neutral: [0.5, 1.0, 0.7],
            illuminant: 21,
            noise: Some(RawNoise { scale: 3e-5, offset: 1e-8 }),
            baseline_exposure_stops: -0.25,
            pixel_mm: [0.01, 0.0025],
            maker: "spectra".into(),
            model: "test".into(),
            unique_model: "spectra test".into(),
            exposure_time_s: 0.008,
            iso: 100_000.0,
        }
    }

    fn lens() -> RawLens {
        RawLens { model: Some("Biotar".into()), maker: None, focal_length_mm: Some(49.784), f_number: Some(2.8) }
    }

    /// Reads the file back by hand as TIFF 6.0 says: directories are sorted, values are where they say, and the strip holds the numbers.
    #[test]
    fn everything_is_where_the_directories_say() {
        let mut file = Cursor::new(Vec::new());
        dng(&mut file, &frame(), &lens()).expect("written");
        let bytes = file.into_inner();
        let short = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let long = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        assert_eq!((&bytes[..4], long(4)), (&b"II*\0"[..], 8));
        let entries = |at: usize| -> Vec<usize> { (0..usize::from(short(at))).map(|i| at + 2 + 12 * i).collect() };
        let find = |at: usize, tag: u16| {
            let tags: Vec<u16> = entries(at).iter().map(|at| short(*at)).collect();
            assert!(tags.windows(2).all(|w| w[0] < w[1]), "{tags:?}");
            entries(at)[tags.iter().position(|t| *t == tag).unwrap_or_else(|| panic!("no {tag}"))]
        };
        let main = |tag: u16| find(8, tag);
        let strip = long(main(273) + 8) as usize;
        assert_eq!(bytes.len(), strip + 48);
        let values: Vec<u16> = (0..24).map(|i| short(strip + 2 * i)).collect();
        assert_eq!(values, frame().values);
        let ratio = |entry: usize, i: usize| {
            let at = long(entry + 8) as usize + 8 * i;
            f64::from(long(at) as i32) / f64::from(long(at + 4))
        };
        // Both lights, warm first, with their matrices.
        assert_eq!([main(50_778), main(50_779)].map(|e| short(e + 8)), [17, 21]);
        assert_eq!([ratio(main(50_721), 1), ratio(main(50_722), 1)], [-0.2, -0.3]);
        assert_eq!([ratio(main(50_964), 8), ratio(main(50_965), 8)], [1.0, 0.9]);
        assert_eq!([ratio(main(50_728), 0), ratio(main(50_730), 0)], [0.5, -0.25]);
        // Pixels are four times as wide as high.
        assert_eq!([ratio(main(50_718), 0), ratio(main(50_718), 1)], [2.0, 0.5]);
        let noise = long(main(51_041) + 8) as usize;
        let double = |at: usize| f64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight"));
        assert_eq!((short(main(51_041) + 2), double(noise), double(noise + 8)), (12, 3e-5, 1e-8));
        let area = long(main(50_829) + 8) as usize;
        assert_eq!([0, 4, 8, 12].map(|i| long(area + i)), [0, 0, 4, 6]);
        assert_eq!(bytes[main(33_422) + 8..][..4], [0, 1, 1, 2]);
        let exif = |tag: u16| find(long(main(34_665) + 8) as usize, tag);
        let time = long(exif(33_434) + 8) as usize;
        assert_eq!((long(time), long(time + 4)), (1, 125));
        assert_eq!([ratio(exif(33_437), 0), ratio(exif(37_386), 0), ratio(exif(41_486), 0)], [2.8, 49.784, 1000.0]);
        assert_eq!((short(exif(34_855) + 8), long(exif(34_866) + 8), short(exif(37_384) + 8)), (65_535, 100_000, 21));
        assert_eq!(&bytes[long(exif(42_036) + 8) as usize..][..7], b"Biotar\0");
        assert!(entries(8).iter().all(|e| short(*e) != 306), "a date would change from run to run");
    }

    #[test]
    fn frames_of_another_size_are_refused() {
        let mut short = frame();
        short.values.pop();
        assert!(matches!(dng(&mut Cursor::new(Vec::new()), &short, &lens()), Err(WriteFault::Format(_))));
    }
}

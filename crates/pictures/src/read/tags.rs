//! Reads the color encoding of a PNG, TIFF, JPEG or Radiance file: code points of ITU-T H.273, a color profile, or a power and primaries.
//!
//! In a PNG the first of cICP, iCCP, sRGB, and gAMA with cHRM counts (PNG, third edition, 4.3).

use super::encoding::Encoding;
use super::linear_picture::FileProblem;
use super::primaries::to_srgb;
use super::profile::{self, Stated};
use super::{cmyk, exif, radiance, tiff};
use image::{ImageDecoder, ImageFormat};
use spectra_color::matrix::Matrix;
use spectra_color::{RgbSpace, Transfer};
use spectra_core::resources::FoundFile;
use std::io::{self, BufRead, Read, Seek, SeekFrom};

/// Color encoding and pixel format that a file states.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tags {
    /// Transfer curve; `None` if the file states none.
    pub encoding: Option<Encoding>,
    /// Matrix from the file's primaries to those of sRGB, linear, white to white; `None` if they are the same.
    pub to_srgb: Option<Matrix>,
    /// Warning about a stated encoding that cannot be used.
    pub warning: Option<FileProblem>,
    /// Width over height of a stored pixel, if the file states it.
    pub pixel_aspect: Option<f64>,
    /// Whether samples of 32 bits are integers.
    pub is_long: bool,
    /// Whether color is multiplied by alpha, if the file states it.
    pub is_multiplied: Option<bool>,
}

impl Tags {
    /// Reads the tags of a file whose decoder has read its header.
    pub(super) fn of(found: &FoundFile, format: ImageFormat, decoder: &mut impl ImageDecoder) -> Self {
        let chunks = if format == ImageFormat::Png { found.open().ok().map(Chunks::of) } else { None };
        let chunks = chunks.unwrap_or_default();
        let is_long = format == ImageFormat::Tiff && found.open().is_ok_and(tiff::has_long_integers);
        let is_tiff = format == ImageFormat::Tiff;
        let is_multiplied = if is_tiff { found.open().ok().and_then(tiff::is_multiplied) } else { None };
        Self {
            pixel_aspect: chunks.pixel_aspect,
            is_long,
            is_multiplied,
            ..Self::colors(chunks, found, format, decoder)
        }
    }

    fn colors(chunks: Chunks, found: &FoundFile, format: ImageFormat, decoder: &mut impl ImageDecoder) -> Self {
        if let Some(points) = chunks.cicp {
            return Self::stated(of_code_points(points), || {
                let [primaries, transfer, matrix, range] = points;
                format!("code points {primaries}, {transfer}, {matrix}, {range} (cICP)")
            });
        }
        if decoder.original_color_type() == cmyk::KIND {
            return Self::stated(Some((Encoding::Curve(Transfer::Srgb), to_srgb(cmyk::space()))), String::new);
        }
        let profile = match format {
            ImageFormat::Tiff => found.open().ok().and_then(tiff::profile),
            _ => decoder.icc_profile().ok().flatten(),
        };
        if let Some(bytes) = profile {
            return Self::stated(profile::read(&bytes), || "a color profile of an unsupported kind".to_owned());
        }
        if cmyk::is_one(found, format) {
            return Self { warning: Some(cmyk::without_profile()), ..Self::default() };
        }
        if format == ImageFormat::Jpeg
            && let Some(space) = decoder.exif_metadata().ok().flatten().and_then(|bytes| exif::stated(&bytes))
        {
            return Self::stated(Some(space), String::new);
        }
        if format == ImageFormat::Hdr {
            let to_srgb = found.open().ok().and_then(radiance::to_light);
            return Self { to_srgb, ..Self::default() };
        }
        if chunks.is_aces_cct {
            return Self::stated(Some((Encoding::AcesCct, to_srgb(RgbSpace::aces_cg()))), String::new);
        }
        if chunks.is_srgb {
            return Self { encoding: Some(Encoding::Curve(Transfer::Srgb)), ..Self::default() };
        }
        let to_srgb = chunks.chromaticities.and_then(|[white, r, g, b]| {
            let space = RgbSpace::new("cHRM", [r, g, b], white, Transfer::Linear);
            to_srgb(&space).filter(|m| m.as_flattened().iter().all(|v| v.abs() < 100.0))
        });
        Self { encoding: chunks.gamma.and_then(of_gamma), to_srgb, ..Self::default() }
    }

    fn stated(stated: Option<Stated>, what: impl Fn() -> String) -> Self {
        match stated {
            Some((encoding, to_srgb)) => Self { encoding: Some(encoding), to_srgb, ..Self::default() },
            None => {
                let text = format!("it states its colors by {}, which cannot be used: they are taken as sRGB", what());
                let hint = "save it as sRGB, Display P3 or Rec. 2020; `transfer: srgb` if sRGB is right";
                Self { warning: Some(FileProblem::file(text).hint(hint)), ..Self::default() }
            }
        }
    }
}

/// Interprets the H.273 code points: primaries, transfer, matrix and range.
fn of_code_points([primaries, transfer, matrix, range]: [u8; 4]) -> Option<Stated> {
    let space = match primaries {
        1 => RgbSpace::srgb(),
        9 => RgbSpace::rec2020(),
        12 => RgbSpace::display_p3(),
        _ => return None,
    };
    let encoding = match transfer {
        // ITU-R BT.709, BT.601 and BT.2020 all have this curve.
        1 | 6 | 14 | 15 => Encoding::Curve(Transfer::Rec2020),
        4 => Encoding::Gamma(2.2),
        5 => Encoding::Gamma(2.8),
        8 => Encoding::Curve(Transfer::Linear),
        13 => Encoding::Curve(Transfer::Srgb),
        16 => Encoding::Pq,
        _ => return None,
    };
    // Only RGB in full range is supported.
    ((matrix, range) == (0, 1)).then(|| (encoding, to_srgb(space)))
}

/// Interprets the power from light to code value, in hundred thousandths.
fn of_gamma(stated: u32) -> Option<Encoding> {
    let power = f64::from(stated) / 1e5;
    Some(match power {
        // The value that a PNG in sRGB states.
        p if (p - 1.0 / 2.2).abs() < 1e-3 => Encoding::Curve(Transfer::Srgb),
        p if (p - 1.0).abs() < 1e-3 => Encoding::Curve(Transfer::Linear),
        p if (0.2..=5.0).contains(&p) => Encoding::Gamma(1.0 / p),
        _ => return None,
    })
}

/// Chunks before the pixels of a PNG.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Chunks {
    cicp: Option<[u8; 4]>,
    is_srgb: bool,
    gamma: Option<u32>,
    /// Chromaticities x, y of white, red, green and blue.
    chromaticities: Option<[[f64; 2]; 4]>,
    /// Whether the text that this program writes for ACEScct is there, because no chunk can say it.
    is_aces_cct: bool,
    /// Width over height of a pixel.
    pixel_aspect: Option<f64>,
}

impl Chunks {
    /// Reads the chunks as far as possible; the decoder reports what is wrong with the file.
    fn of(mut reader: impl BufRead + Seek) -> Self {
        let mut all = Self::default();
        let _ = all.read(&mut reader);
        all
    }

    fn read(&mut self, reader: &mut (impl BufRead + Seek)) -> io::Result<()> {
        const LONGEST: u64 = 64;
        reader.seek(SeekFrom::Start(8))?;
        loop {
            let mut head = [0; 8];
            reader.read_exact(&mut head)?;
            let [a, b, c, d, name @ ..] = head;
            let length = u64::from(u32::from_be_bytes([a, b, c, d]));
            if matches!(&name, b"IDAT" | b"IEND") {
                return Ok(());
            }
            let is_wanted =
                matches!(&name, b"cICP" | b"gAMA" | b"cHRM" | b"sRGB" | b"tEXt" | b"pHYs") && length <= LONGEST;
            let mut data = Vec::new();
            if is_wanted {
                reader.by_ref().take(length).read_to_end(&mut data)?;
            }
            // The checksum follows the data.
            reader.seek(SeekFrom::Current((length - data.len() as u64 + 4) as i64))?;
            self.take(&name, &data);
        }
    }

    fn take(&mut self, name: &[u8; 4], data: &[u8]) {
        let long = |i: usize| {
            data.get(4 * i..4 * i + 4).map(|bytes| u32::from_be_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
        };
        match name {
            b"cICP" => self.cicp = data.try_into().ok(),
            b"sRGB" => self.is_srgb = true,
            b"gAMA" => self.gamma = long(0),
            b"cHRM" => {
                let one = |i: usize| long(i).map(|v| f64::from(v) / 1e5);
                let pair = |i: usize| Some([one(2 * i)?, one(2 * i + 1).filter(|y| *y > 1e-4)?]);
                self.chromaticities = match [0, 1, 2, 3].map(pair) {
                    [Some(white), Some(red), Some(green), Some(blue)] => Some([white, red, green, blue]),
                    _ => None,
                };
            }
            b"pHYs" => {
                // Pixels per unit, across and down: the direction with fewer has longer pixels.
                let aspect = long(0).zip(long(1)).map(|(across, down)| f64::from(down) / f64::from(across));
                self.pixel_aspect = aspect.filter(|aspect| (0.05..=20.0).contains(aspect));
            }
            b"tEXt" => self.is_aces_cct |= data == b"Color space\0ACEScct",
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::read::decode::decode_bytes;
    use crate::read::linear_picture::{LinearPicture, ReadOptions};
    use crate::write::{PictureSpace, chunk, png16, tiff16};
    use spectra_color::{RgbSpace, Transfer, to_u8};
    use spectra_core::frame::DisplayPicture;

    fn read(bytes: &[u8]) -> LinearPicture {
        decode_bytes(bytes, ReadOptions::default()).unwrap()
    }

    /// Builds a PNG of one pixel with these chunks.
    fn png(code: [u8; 3], chunks: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image::RgbImage::from_pixel(1, 1, image::Rgb(code)).write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let bytes = bytes.into_inner();
        // After the signature and IHDR.
        [&bytes[..33], &chunks.concat(), &bytes[33..]].concat()
    }

    fn close(got: [f32; 3], want: [f64; 3], tolerance: f64) {
        assert!(got.iter().zip(want).all(|(a, b)| (f64::from(*a) - b).abs() < tolerance), "{got:?} {want:?}");
    }

    /// A picture reads back the same, in whatever space its file is written.
    #[test]
    fn what_is_written_is_read() {
        let colors = vec![[0.18, 0.18, 0.18], [0.6, 0.1, 0.05], [0.05, 0.4, 0.3], [1.0, 1.0, 1.0]];
        let picture = DisplayPicture { width_px: 2, height_px: 2, rgb: colors.clone() };
        let spaces = [PictureSpace::Srgb, PictureSpace::DisplayP3, PictureSpace::Rec2020, PictureSpace::AcesCct];
        for space in spaces {
            let [mut png, mut tiff] = [std::io::Cursor::new(Vec::new()), std::io::Cursor::new(Vec::new())];
            png16(&mut png, &picture, space, 1.0).unwrap();
            tiff16(&mut tiff, &picture, space).unwrap();
            // A TIFF cannot say that it is in ACEScct.
            let files = if space == PictureSpace::AcesCct { vec![png] } else { vec![png, tiff] };
            for bytes in files {
                let linear = read(bytes.get_ref());
                assert!(linear.warnings.is_empty(), "{space:?} {:?}", linear.warnings);
                for (got, want) in linear.rgb.iter().zip(&colors) {
                    close(*got, want.map(f64::from), 5e-4);
                }
            }
        }
    }

    /// Checks primaries of Display P3, linear code values, a power, and the curves of SMPTE ST 2084 and ITU-R BT.709.
    #[test]
    fn code_points_and_powers_are_followed() {
        let p3 = read(&png([188, 188, 188], &[chunk(b"cICP", &[12, 13, 0, 1])])).rgb[0];
        close(p3, [Transfer::Srgb.decode(188.0 / 255.0); 3], 1e-6);
        // Pure red in Display P3, by the matrices of CSS Color Module Level 4: 1.2249, -0.0421, -0.0196 times its light.
        let red = read(&png([255, 0, 0], &[chunk(b"cICP", &[12, 13, 0, 1])])).rgb[0];
        close(red, [1.2249, -0.0421, -0.0196], 2e-4);
        let linear = read(&png([51, 51, 51], &[chunk(b"gAMA", &100_000_u32.to_be_bytes())])).rgb[0];
        close(linear, [0.2; 3], 1e-6);
        let power = read(&png([51, 51, 51], &[chunk(b"gAMA", &50_000_u32.to_be_bytes())])).rgb[0];
        close(power, [0.04; 3], 1e-6);
        // ST 2084: code 0.58 is 202.7 cd/m2 (ITU-R BT.2408 has 58 % for the reference white of 203).
        let pq = read(&png([148, 148, 148], &[chunk(b"cICP", &[9, 16, 0, 1])])).rgb[0];
        close(pq, [1.0; 3], 0.02);
        let rec709 = read(&png([128, 128, 128], &[chunk(b"cICP", &[1, 1, 0, 1])])).rgb[0];
        close(rec709, [Transfer::Rec2020.decode(128.0 / 255.0); 3], 1e-6);
    }

    /// Checks an anamorphic picture as this program writes it, and a file that is stored on its side: an Exif orientation of 6.
    #[test]
    fn pixels_are_as_wide_as_the_file_says() {
        let picture = DisplayPicture { width_px: 2, height_px: 1, rgb: vec![[0.18; 3]; 2] };
        for aspect in [2.0, 1.0, 0.5] {
            let mut bytes = std::io::Cursor::new(Vec::new());
            png16(&mut bytes, &picture, PictureSpace::Srgb, aspect).unwrap();
            let bytes = bytes.into_inner();
            let found = spectra_core::resources::FoundFile::bytes("a file".to_owned(), bytes.clone().into());
            for got in
                [crate::read::header(&found, ReadOptions::default()).unwrap().pixel_aspect, read(&bytes).pixel_aspect]
            {
                assert!((got / aspect - 1.0).abs() < 1e-3, "{got} {aspect}");
            }
        }
        let phys = chunk(b"pHYs", &[0, 0, 3, 232, 0, 0, 7, 208, 0]);
        let exif = chunk(b"eXIf", b"MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0");
        assert_eq!(read(&png([9; 3], std::slice::from_ref(&phys))).pixel_aspect, 2.0);
        assert_eq!(read(&png([9; 3], &[phys, exif])).pixel_aspect, 0.5);
        let none = chunk(b"pHYs", &[0; 9]);
        assert_eq!(read(&png([9; 3], &[none])).pixel_aspect, 1.0);
    }

    #[test]
    fn what_the_scene_says_of_the_curve_wins() {
        let bytes = png([51, 51, 51], &[chunk(b"gAMA", &100_000_u32.to_be_bytes())]);
        let said = decode_bytes(&bytes, ReadOptions { transfer: Some("srgb"), ..ReadOptions::default() }).unwrap();
        close(said.rgb[0], [Transfer::Srgb.decode(0.2); 3], 1e-6);
    }

    /// HLG is not supported, nor is a range that begins at 16.
    #[test]
    fn what_cannot_be_followed_is_said() {
        for points in [[9, 18, 0, 1], [1, 13, 0, 0], [22, 13, 0, 1]] {
            let bytes = png([51, 51, 51], &[chunk(b"cICP", &points)]);
            let found = spectra_core::resources::FoundFile::bytes("a file".to_owned(), bytes.clone().into());
            let header = crate::read::header(&found, ReadOptions::default()).unwrap();
            let [doubt] = &header.warnings[..] else { panic!("{:?}", header.warnings) };
            assert!(doubt.text.contains("taken as sRGB") && doubt.hint.is_some(), "{doubt:?}");
            let said = ReadOptions { transfer: Some("srgb"), ..ReadOptions::default() };
            assert!(crate::read::header(&found, said).unwrap().warnings.is_empty());
            close(read(&bytes).rgb[0], [Transfer::Srgb.decode(0.2); 3], 1e-6);
        }
    }

    /// Follows the chunk that states primaries as numbers, here those of Rec. 2020.
    #[test]
    fn primaries_in_numbers_are_followed() {
        let space = RgbSpace::rec2020();
        let [r, g, b] = space.primaries_xy;
        let numbers = [space.white_xy, r, g, b].concat();
        let data: Vec<u8> = numbers.iter().flat_map(|v| ((v * 1e5).round() as u32).to_be_bytes()).collect();
        let light = [0.3, 0.2, 0.25];
        let code = space.from_xyz(RgbSpace::srgb().to_xyz(light)).map(|v| to_u8(Transfer::Srgb.encode(v)));
        close(read(&png(code, &[chunk(b"cHRM", &data)])).rgb[0], light, 8e-3);
    }
}

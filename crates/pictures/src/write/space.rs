//! Color spaces in which a picture is written, and how a file states them.

use super::icc::display_profile;
use spectra_color::matrix::{Matrix, apply, product};
use spectra_color::{Adaptation, Gamut, RgbSpace, Transfer, aces_cct, into_gamut};

/// Color space of a picture file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureSpace {
    /// sRGB (IEC 61966-2-1).
    #[default]
    Srgb,
    /// Display P3: primaries of digital cinema, curve of sRGB.
    DisplayP3,
    /// Primaries of ITU-R BT.2020 with the curve of sRGB, which all programs read alike. For BT.2020's own curve, some programs apply its
    /// inverse and others a display curve.
    Rec2020,
    /// ACEScct: primaries AP1, logarithmic.
    AcesCct,
    /// Values that are not colors, for example densities. They are written with the curve of sRGB, as a picture is, but are not tagged.
    Values,
}

impl PictureSpace {
    fn space(self) -> &'static RgbSpace {
        match self {
            Self::Srgb | Self::Values => RgbSpace::srgb(),
            Self::DisplayP3 => RgbSpace::display_p3(),
            Self::Rec2020 => RgbSpace::rec2020(),
            Self::AcesCct => RgbSpace::aces_cg(),
        }
    }

    /// Name of the space, as a color profile states it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Srgb => "sRGB",
            Self::DisplayP3 => "Display P3",
            Self::Rec2020 => "Rec. 2020 primaries, sRGB curve",
            Self::AcesCct => "ACEScct",
            Self::Values => "values",
        }
    }

    /// Whether pictures for a screen are already in this space.
    #[must_use]
    pub fn is_srgb(self) -> bool {
        matches!(self, Self::Srgb | Self::Values)
    }

    /// Returns a function from linear sRGB to code values of this space.
    pub(super) fn encoder(self) -> impl Fn([f32; 3]) -> [f64; 3] + Sync {
        let (space, matrix) = (self.space(), from_srgb(self.space()));
        move |rgb| {
            let rgb = rgb.map(f64::from);
            match self {
                Self::Srgb | Self::Values => rgb.map(|v| Transfer::Srgb.encode(v)),
                Self::DisplayP3 | Self::Rec2020 => {
                    into_gamut(apply(&matrix, rgb), space, Gamut::Desaturate).map(|v| Transfer::Srgb.encode(v))
                }
                Self::AcesCct => apply(&matrix, rgb).map(aces_cct),
            }
        }
    }

    /// Color primaries and curve by ITU-T H.273, with RGB in full range; `None` if it has no numbers for them.
    fn code_points(self) -> Option<[u8; 4]> {
        match self {
            Self::Srgb => Some([1, 13, 0, 1]),
            Self::DisplayP3 => Some([12, 13, 0, 1]),
            Self::Rec2020 => Some([9, 13, 0, 1]),
            Self::AcesCct | Self::Values => None,
        }
    }

    /// Returns a color profile of the space; `None` if a profile cannot describe it.
    #[must_use]
    pub fn profile(self) -> Option<Vec<u8>> {
        match self {
            Self::Srgb | Self::DisplayP3 | Self::Rec2020 => {
                Some(display_profile(self.space(), self.name(), Transfer::Srgb))
            }
            Self::AcesCct | Self::Values => None,
        }
    }

    /// Returns the PNG chunks that state the space (third edition, 11.3.2), which come before the pixels: cICP, and for older programs sRGB
    /// with gAMA and cHRM, or iCCP.
    pub(super) fn chunks(self) -> Vec<u8> {
        let mut all = Vec::new();
        if let Some(code_points) = self.code_points() {
            all.extend(chunk(b"cICP", &code_points));
        }
        match (self, self.profile()) {
            (Self::Srgb, _) => {
                all.extend(chunk(b"sRGB", &[1]));
                all.extend(chunk(b"gAMA", &45_455_u32.to_be_bytes()));
                let space = self.space();
                let [r, g, b] = space.primaries_xy;
                let numbers = [space.white_xy, r, g, b].concat();
                let hundred_thousandths = numbers.iter().flat_map(|v| ((v * 1e5).round() as u32).to_be_bytes());
                all.extend(chunk(b"cHRM", &hundred_thousandths.collect::<Vec<u8>>()));
            }
            (_, Some(profile)) => {
                let name = [self.name().as_bytes(), b"\0\0"].concat();
                all.extend(chunk(b"iCCP", &[name, zlib(&profile)].concat()));
            }
            (Self::AcesCct, None) => all.extend(chunk(b"tEXt", b"Color space\0ACEScct")),
            (_, None) => {}
        }
        all
    }
}

/// Returns the matrix from linear sRGB to a space, white to white (CAT02).
pub(crate) fn from_srgb(space: &RgbSpace) -> Matrix {
    let srgb = RgbSpace::srgb();
    let adapted = Adaptation::Cat02.matrix(srgb.white_xyz(), space.white_xyz());
    product(&space.rgb_from_xyz, &product(&adapted, &srgb.xyz_from_rgb))
}

/// Builds a chunk of a PNG.
pub(crate) fn chunk(name: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let mut chunk = (data.len() as u32).to_be_bytes().to_vec();
    chunk.extend(name);
    chunk.extend(data);
    let check = crc32(&chunk[4..]);
    chunk.extend(check.to_be_bytes());
    chunk
}

/// Computes the checksum of a chunk (PNG, third edition, annex D).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}

/// Wraps at most 65 535 bytes, uncompressed, as a zlib stream (RFC 1950, RFC 1951). Profiles are short enough.
fn zlib(bytes: &[u8]) -> Vec<u8> {
    const MODULUS: u32 = 65_521;
    let length = bytes.len() as u16;
    let mut out = vec![0x78, 0x01, 0x01];
    out.extend(length.to_le_bytes());
    out.extend((!length).to_le_bytes());
    out.extend(bytes);
    let (a, b) = bytes.iter().fold((1_u32, 0_u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % MODULUS;
        (a, (b + a) % MODULUS)
    });
    out.extend((b << 16 | a).to_be_bytes());
    out
}

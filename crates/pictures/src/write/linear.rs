//! Writes a finished picture as OpenEXR, for compositing.

use super::exposure::{Colors, write};
use super::space::from_srgb;
use exr::prelude::FlatSamples;
use rayon::prelude::*;
use spectra_color::RgbSpace;
use spectra_color::matrix::{Matrix, apply};
use spectra_core::frame::{DisplayPicture, ExposureChannel, ExposureFrame, FrameSize, ImageState};
use spectra_core::sink::Out;
use spectra_files::WriteFault;

/// Linear color space of an OpenEXR file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearSpace {
    /// Primaries of sRGB (ITU-R BT.709).
    #[default]
    Srgb,
    /// Primaries of ITU-R BT.2020.
    Rec2020,
    /// Primaries of digital cinema, white D65.
    P3D65,
    /// Primaries AP1 with the white of ACES (ACEScg).
    AcesCg,
    /// CIE XYZ, white D65, where white has Y = 1: X in R, Y in G, Z in B.
    Xyz,
}

impl LinearSpace {
    /// Returns the name of the space in configurations of OpenColorIO (OpenColorIO-Config-ACES, `cg-config-v1.0.0` and later).
    /// For some spaces the name depends on `state`, which tells light of the scene from light of a display.
    #[must_use]
    pub fn ocio_name(self, state: ImageState) -> &'static str {
        match (self, state) {
            (_, ImageState::Data) => "Raw",
            (Self::Srgb, _) => "Linear Rec.709 (sRGB)",
            (Self::Rec2020, _) => "Linear Rec.2020",
            (Self::P3D65, _) => "Linear P3-D65",
            (Self::AcesCg, _) => "ACEScg",
            (Self::Xyz, ImageState::SceneReferred) => "CIE XYZ-D65 - Scene-referred",
            (Self::Xyz, ImageState::DisplayReferred) => "CIE XYZ-D65 - Display-referred",
        }
    }

    /// Returns the identifier of the space by the Color Interop Forum (recommendations for texture assets, 2024, and display
    /// color spaces, 2026). OpenEXR 3.4 has an attribute for it. `None` if the forum has none for this space and `state`.
    #[must_use]
    pub fn interop_id(self, state: ImageState) -> Option<&'static str> {
        Some(match (self, state) {
            (_, ImageState::Data) => "data",
            (Self::Srgb, ImageState::SceneReferred) => "lin_rec709_scene",
            (Self::Rec2020, ImageState::SceneReferred) => "lin_rec2020_scene",
            (Self::P3D65, ImageState::SceneReferred) => "lin_p3d65_scene",
            (Self::AcesCg, ImageState::SceneReferred) => "lin_ap1_scene",
            (Self::Xyz, ImageState::SceneReferred) => "lin_ciexyzd65_scene",
            (Self::Srgb, ImageState::DisplayReferred) => "lin_rec709_display",
            (Self::Rec2020, ImageState::DisplayReferred) => "lin_rec2020_display",
            (Self::P3D65, ImageState::DisplayReferred) => "lin_p3d65_display",
            (Self::AcesCg | Self::Xyz, ImageState::DisplayReferred) => return None,
        })
    }

    /// Returns the matrix from linear sRGB to this space, white to white (CAT02).
    #[must_use]
    pub fn from_srgb(self) -> Matrix {
        match self {
            Self::Srgb => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Self::Rec2020 => from_srgb(RgbSpace::rec2020()),
            Self::P3D65 => from_srgb(RgbSpace::display_p3()),
            Self::AcesCg => from_srgb(RgbSpace::aces_cg()),
            Self::Xyz => RgbSpace::srgb().xyz_from_rgb,
        }
    }

    /// Chromaticity x, y of the neutral color.
    fn neutral(self) -> [f64; 2] {
        if self == Self::AcesCg { RgbSpace::aces_cg().white_xy } else { RgbSpace::srgb().white_xy }
    }

    /// Chromaticities of red, green, blue and white. Those of XYZ follow the documentation of OpenEXR.
    fn chromaticities(self) -> [[f64; 2]; 4] {
        let of = |space: &RgbSpace| {
            let [r, g, b] = space.primaries_xy;
            [r, g, b, space.white_xy]
        };
        match self {
            Self::Srgb => of(RgbSpace::srgb()),
            Self::Rec2020 => of(RgbSpace::rec2020()),
            Self::P3D65 => of(RgbSpace::display_p3()),
            Self::AcesCg => of(RgbSpace::aces_cg()),
            Self::Xyz => [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0, 1.0 / 3.0]],
        }
    }
}

/// Writes a finished picture, linear sRGB without gamut limits, as OpenEXR: R, G and B in `space`, and `layers` as further channels under
/// their own names.
///
/// Values are 32-bit floats; with `half`, R, G and B have 16 bits.
/// The header holds `chromaticities` and `adoptedNeutral`, the name of the space for OpenColorIO (`oiio:ColorSpace`) and the Color Interop
/// Forum (`colorInteropID`), whether the picture is scene- or display-referred (`spectra:image state`), and `attributes`.
///
/// # Errors
/// The errors of [`super::exr()`].
pub fn picture_exr(
    out: &mut dyn Out,
    picture: &DisplayPicture,
    layers: &[ExposureChannel],
    (space, state): (LinearSpace, ImageState),
    half: bool,
    pixel_aspect: f64,
    attributes: &[(String, String)],
) -> Result<(), WriteFault> {
    let matrix = space.from_srgb();
    let is_as_it_is = space == LinearSpace::Srgb || state == ImageState::Data;
    let plane = |i: usize| -> Vec<f32> {
        let value = |rgb: &[f32; 3]| if is_as_it_is { rgb[i] } else { apply(&matrix, rgb.map(f64::from))[i] as f32 };
        picture.rgb.par_iter().with_min_len(1 << 14).map(value).collect()
    };
    let color = |(i, name): (usize, &str)| ExposureChannel { name: name.into(), unit: String::new(), values: plane(i) };
    let mut channels: Vec<ExposureChannel> = ["R", "G", "B"].into_iter().enumerate().map(color).collect();
    channels.extend(layers.iter().cloned());
    let (width_px, height_px) = (picture.width_px, picture.height_px);
    let size = FrameSize { width_px, height_px, width_mm: f64::from(width_px), height_mm: f64::from(height_px) };
    let frame = ExposureFrame { size, channels };
    let mut said = vec![
        ("oiio:ColorSpace".to_owned(), space.ocio_name(state).to_owned()),
        ("spectra:image state".to_owned(), state.name().to_owned()),
    ];
    said.extend(space.interop_id(state).map(|id| ("colorInteropID".to_owned(), id.to_owned())));
    said.extend(attributes.iter().cloned());
    let chromaticities = (state != ImageState::Data).then(|| (space.chromaticities(), space.neutral()));
    let colors = Colors { chromaticities, pixel_aspect };
    // Layers keep full precision: exposures exceed the range of 16 bits.
    write(out, &frame, &said, &colors, &|at, values| {
        if half && at < 3 {
            FlatSamples::F16(values.iter().map(|v| exr::prelude::f16::from_f32(*v)).collect())
        } else {
            FlatSamples::F32(values.to_vec())
        }
    })
}

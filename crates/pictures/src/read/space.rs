//! Interprets the name of the color space in an OpenEXR file, as OpenImageIO, OpenColorIO and the Color Interop Forum call it.
//!
//! The numbers in `chromaticities` have priority over any name. Without them, the names of linear spaces count.

use super::linear_picture::FileProblem;
use exr::meta::attribute::Chromaticities;
use exr::prelude::Vec2;
use spectra_color::RgbSpace;

/// Names of linear spaces, in lower case. A role, for example `scene_linear`, is unknown outside its OpenColorIO configuration.
const LINEAR: [(&str, Primaries); 27] = [
    ("lin_ap0_scene", Primaries::Ap0),
    ("lin_ap0", Primaries::Ap0),
    ("aces2065-1", Primaries::Ap0),
    ("aces - aces2065-1", Primaries::Ap0),
    ("lin_ap1_scene", Primaries::Ap1),
    ("lin_ap1", Primaries::Ap1),
    ("acescg", Primaries::Ap1),
    ("aces - acescg", Primaries::Ap1),
    ("lin_rec709_scene", Primaries::Rec709),
    ("lin_rec709_display", Primaries::Rec709),
    ("lin_rec709", Primaries::Rec709),
    ("lin_srgb", Primaries::Rec709),
    ("linear", Primaries::Rec709),
    ("linear rec.709 (srgb)", Primaries::Rec709),
    ("utility - linear - srgb", Primaries::Rec709),
    ("lin_rec2020_scene", Primaries::Rec2020),
    ("lin_rec2020_display", Primaries::Rec2020),
    ("lin_rec2020", Primaries::Rec2020),
    ("linear rec.2020", Primaries::Rec2020),
    ("utility - linear - rec.2020", Primaries::Rec2020),
    ("lin_p3d65_scene", Primaries::P3D65),
    ("lin_p3d65_display", Primaries::P3D65),
    ("lin_p3d65", Primaries::P3D65),
    ("linear p3-d65", Primaries::P3D65),
    ("lin_ciexyzd65_scene", Primaries::Xyz),
    ("cie xyz-d65 - scene-referred", Primaries::Xyz),
    ("cie xyz-d65 - display-referred", Primaries::Xyz),
];
/// Names that do not define a color space.
const SILENT: [&str; 6] = ["", "data", "raw", "unknown", "scene_linear", "undefined"];
/// Parts of the names of spaces that are not linear.
const ENCODED: [&str; 12] =
    ["log", "srgb", "acescc", "gamma", "g22", "g24", "rec709", "rec.709", "texture", "pq", "hlg", "adobe"];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Primaries {
    Ap0,
    Ap1,
    Rec709,
    Rec2020,
    P3D65,
    Xyz,
}

impl Primaries {
    fn chromaticities(self) -> Chromaticities {
        let of = |space: &RgbSpace| {
            let [r, g, b] = space.primaries_xy;
            [r, g, b, space.white_xy]
        };
        let [red, green, blue, white] = match self {
            // SMPTE ST 2065-1.
            Self::Ap0 => [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077], RgbSpace::aces_cg().white_xy],
            Self::Ap1 => of(RgbSpace::aces_cg()),
            Self::Rec709 => of(RgbSpace::srgb()),
            Self::Rec2020 => of(RgbSpace::rec2020()),
            Self::P3D65 => of(RgbSpace::display_p3()),
            Self::Xyz => [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [1.0 / 3.0; 2]],
        }
        .map(|[x, y]| Vec2(x as f32, y as f32));
        Chromaticities { red, green, blue, white }
    }
}

/// Returns the chromaticities to use, and a warning if the colors are doubtful. `texts` are those of the header.
pub(super) fn of(
    stated: Option<Chromaticities>,
    texts: &[(String, String)],
) -> (Option<Chromaticities>, Option<FileProblem>) {
    let text = |key: &str| texts.iter().find(|(own, _)| own == key).map(|(_, text)| text.trim());
    let Some(name) = text("colorInteropID").or_else(|| text("oiio:ColorSpace")) else { return (stated, None) };
    let lower = name.to_ascii_lowercase();
    if SILENT.contains(&lower.as_str()) {
        return (stated, None);
    }
    if let Some((_, primaries)) = LINEAR.iter().find(|(own, _)| *own == lower) {
        let named = primaries.chromaticities();
        return match stated {
            Some(own) if !are_near(own, named) => {
                let text =
                    format!("it names its color space `{name}`, but its `chromaticities` differ; these are used");
                (stated, Some(FileProblem::file(text).hint("remove whichever of the two is wrong from the file")))
            }
            Some(_) => (stated, None),
            None => (Some(named), None),
        };
    }
    let is_encoded = !lower.contains("lin") && ENCODED.iter().any(|part| lower.contains(part));
    if stated.is_some() && !is_encoded {
        return (stated, None);
    }
    let of = if stated.is_some() { "with its `chromaticities`" } else { "with the primaries of Rec. 709" };
    let text =
        format!("it names its color space `{name}`, which is not supported: its values are taken as linear light {of}");
    (stated, Some(FileProblem::file(text).hint("convert it to linear light first: ACEScg, or linear Rec. 709")))
}

fn are_near(a: Chromaticities, b: Chromaticities) -> bool {
    let all = |c: Chromaticities| [c.red, c.green, c.blue, c.white];
    all(a).iter().zip(all(b)).all(|(a, b)| (a.0 - b.0).abs() < 2e-3 && (a.1 - b.1).abs() < 2e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(key: &str, name: &str) -> Vec<(String, String)> {
        vec![(key.to_owned(), name.to_owned())]
    }

    #[test]
    fn linear_names_count_where_no_numbers_do() {
        for (key, name, red) in [
            ("colorInteropID", "lin_ap1_scene", 0.713),
            ("oiio:ColorSpace", "ACEScg", 0.713),
            ("colorInteropID", "lin_ap0_scene", 0.7347),
            ("oiio:ColorSpace", "Linear Rec.2020", 0.708),
            ("colorInteropID", "lin_p3d65_display", 0.68),
            ("colorInteropID", "lin_rec709_scene", 0.64),
        ] {
            let (chromaticities, doubt) = of(None, &named(key, name));
            assert_eq!((chromaticities.map(|c| c.red.0), doubt), (Some(red), None), "{name}");
        }
        for name in ["data", "Raw", "scene_linear", "unknown"] {
            assert_eq!(of(None, &named("oiio:ColorSpace", name)), (None, None), "{name}");
        }
    }

    #[test]
    fn names_that_are_not_followed_are_said() {
        let rec709 = Primaries::Rec709.chromaticities();
        let encoded = ["srgb_tx", "sRGB - Texture", "ARRI LogC3 (EI800)", "ACEScct"];
        for name in encoded {
            for stated in [None, Some(rec709)] {
                let (chromaticities, doubt) = of(stated, &named("oiio:ColorSpace", name));
                assert_eq!(chromaticities, stated);
                assert!(doubt.is_some_and(|d| d.text.contains(name) && d.text.contains("linear")), "{name}");
            }
        }
        let (_, doubt) = of(None, &named("colorInteropID", "lin_myshow_scene"));
        assert!(doubt.is_some_and(|d| d.text.contains("Rec. 709")));
        assert_eq!(of(Some(rec709), &named("colorInteropID", "lin_myshow_scene")), (Some(rec709), None));
    }

    #[test]
    fn numbers_count_before_names() {
        let ap1 = Primaries::Ap1.chromaticities();
        let (chromaticities, doubt) = of(Some(ap1), &named("oiio:ColorSpace", "Linear Rec.709 (sRGB)"));
        assert_eq!(chromaticities, Some(ap1));
        assert!(doubt.is_some_and(|d| d.text.contains("chromaticities")));
        assert_eq!(of(Some(ap1), &named("colorInteropID", "lin_ap1_scene")), (Some(ap1), None));
    }
}

//! Sizes of image frames, by the names that photographers use.

/// A named frame size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Format {
    /// Name in a scene.
    pub name: &'static str,
    /// Width, mm.
    pub width_mm: f64,
    /// Height, mm.
    pub height_mm: f64,
    /// Where the size comes from.
    pub source: &'static str,
}

const fn format(name: &'static str, width_mm: f64, height_mm: f64, source: &'static str) -> Format {
    Format { name, width_mm, height_mm, source }
}

const STILL_135: &str = "ISO 1007, 135-size film: nominal image size";
const ROLL: &str = "ISO 732, 120- and 220-size film: nominal image size";
const SHEET: &str = "ISO 1012, films in sheets: nominal size, of which a holder masks some 3 mm a side";
const CINE_35: &str = "SMPTE ST 59, 35-mm motion-picture film: camera aperture";

/// All formats.
pub const FORMATS: [Format; 15] = [
    format("135", 36.0, 24.0, STILL_135),
    format("135-half-frame", 24.0, 18.0, STILL_135),
    format("6x4.5", 56.0, 41.5, ROLL),
    format("6x6", 56.0, 56.0, ROLL),
    format("6x7", 70.0, 56.0, ROLL),
    format("6x9", 84.0, 56.0, ROLL),
    format("4x5", 127.0, 101.6, SHEET),
    format("5x7", 177.8, 127.0, SHEET),
    format("8x10", 254.0, 203.2, SHEET),
    format("super-35", 24.89, 18.67, CINE_35),
    format("academy", 22.0, 16.0, CINE_35),
    format("super-16", 12.52, 7.41, "SMPTE ST 201, 16-mm film, type W: camera aperture"),
    format("16mm", 10.26, 7.49, "SMPTE ST 7, 16-mm film: camera aperture"),
    format("super-8", 5.79, 4.01, "SMPTE ST 157, 8-mm type S film: camera aperture"),
    format("micro-four-thirds", 17.3, 13.0, "Micro Four Thirds System standard: image area"),
];

/// The format called `name`; `120 6x6` is `6x6`, `35mm` and `full-frame` are `135`; case does not matter.
#[must_use]
pub fn format_named(name: &str) -> Option<&'static Format> {
    let name = name.trim().to_ascii_lowercase().replace([' ', '_'], "-");
    let name = name.strip_prefix("120-").unwrap_or(&name);
    let name = match name {
        "35mm" | "full-frame" | "24x36" => "135",
        other => other,
    };
    FORMATS.iter().find(|f| f.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_found_as_people_write_them() {
        for (written, width, height) in
            [("135", 36.0, 24.0), ("Full Frame", 36.0, 24.0), ("120 6x6", 56.0, 56.0), ("super_35", 24.89, 18.67)]
        {
            let found = format_named(written).expect(written);
            assert_eq!((found.width_mm, found.height_mm), (width, height));
        }
        assert!(format_named("110").is_none() && format_named("").is_none());
    }

    #[test]
    fn names_are_unique_and_sizes_are_landscape() {
        for (i, f) in FORMATS.iter().enumerate() {
            assert!(f.width_mm >= f.height_mm && f.height_mm > 0.0 && !f.source.is_empty(), "{}", f.name);
            assert!(FORMATS[..i].iter().all(|g| g.name != f.name), "{}", f.name);
        }
    }
}

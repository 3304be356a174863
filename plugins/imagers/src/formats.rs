//! Sizes of image frames, under the names that photographers use.

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Deserializer};

/// A frame size with a name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Format {
    /// Name of the format in a scene.
    pub name: &'static str,
    /// Width of the frame, mm.
    pub width_mm: f64,
    /// Height of the frame, mm.
    pub height_mm: f64,
    /// Standard or other source of the size.
    pub source: &'static str,
}

const fn format(name: &'static str, width_mm: f64, height_mm: f64, source: &'static str) -> Format {
    Format { name, width_mm, height_mm, source }
}

const STILL_135: &str = "ISO 1007, 135-size film: nominal image size";
const ROLL: &str = "ISO 732, 120- and 220-size film: nominal image size";
const ROLL_CAMERA: &str = "120-size film: the gate as cameras of this name have it";
const SHEET: &str = "ISO 1012, films in sheets: nominal size, of which a holder masks some 3 mm a side";
const CINE_35: &str = "SMPTE ST 59, 35-mm motion-picture film: camera aperture";
const CINE_65: &str = "SMPTE ST 215, 65-mm motion-picture film: camera aperture";

/// All named frame formats.
pub const FORMATS: [Format; 30] = [
    format("135", 36.0, 24.0, STILL_135),
    format("135-half-frame", 24.0, 18.0, STILL_135),
    format("135-panorama", 65.0, 24.0, "135-size film: the gate of the Hasselblad XPan and Fujifilm TX-1"),
    format("110", 17.0, 13.0, "ISO 1755, 110-size film: nominal image size"),
    format("126", 28.0, 28.0, "ISO 1755, 126-size film: nominal image size"),
    format("aps-h", 30.2, 16.7, "Advanced Photo System: exposed image, H"),
    format("aps-c", 23.5, 15.6, "sensors of that name: 23.4 to 23.7 mm by 15.5 to 15.7 mm, Canon's 22.3 x 14.9 mm"),
    format("minox", 11.0, 8.0, "Minox subminiature film: nominal image size"),
    format("6x4.5", 56.0, 41.5, ROLL),
    format("6x6", 56.0, 56.0, ROLL),
    format("6x7", 69.5, 56.0, ROLL_CAMERA),
    format("6x9", 84.0, 56.0, ROLL_CAMERA),
    format("6x12", 112.0, 56.0, ROLL_CAMERA),
    format("6x17", 168.0, 56.0, ROLL_CAMERA),
    format("9x12", 120.0, 90.0, SHEET),
    format("13x18", 180.0, 130.0, SHEET),
    format("4x5", 127.0, 101.6, SHEET),
    format("5x7", 177.8, 127.0, SHEET),
    format("8x10", 254.0, 203.2, SHEET),
    format("super-35", 24.89, 18.67, CINE_35),
    format("academy", 22.0, 16.0, CINE_35),
    format("anamorphic-35", 22.0, 18.59, CINE_35),
    format("vistavision", 37.72, 24.92, "SMPTE ST 59, 35-mm film run sideways, 8 perforations: camera aperture"),
    format("65mm", 52.48, 23.01, CINE_65),
    format("imax", 70.41, 52.63, "65-mm film run sideways, 15 perforations: camera aperture"),
    format("super-16", 12.52, 7.41, "SMPTE ST 201, 16-mm film, type W: camera aperture"),
    format("16mm", 10.26, 7.49, "SMPTE ST 7, 16-mm film: camera aperture"),
    format("super-8", 6.22, 4.22, "SMPTE ST 157, 8-mm type S film: camera aperture"),
    format("micro-four-thirds", 17.3, 13.0, "Micro Four Thirds System standard: image area"),
    format("1-inch", 13.2, 8.8, "sensors of that name: image area"),
];

/// The name of a format as written in a scene; `135` is a name, too.
#[derive(Clone, Debug)]
pub(crate) struct FormatName(pub(crate) String);

impl<'de> Deserialize<'de> for FormatName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Written {
            Number(u64),
            Text(String),
        }
        Written::deserialize(deserializer).map(|written| match written {
            Written::Number(number) => Self(number.to_string()),
            Written::Text(text) => Self(text),
        })
    }
}

impl JsonSchema for FormatName {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "FormatName".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        String::json_schema(generator)
    }
}

/// Returns all formats as JSON for the schema of an imager: name, size in mm, source.
pub fn listed() -> serde_json::Value {
    let of = |f: &Format| serde_json::json!({ "name": f.name, "width_mm": f.width_mm, "height_mm": f.height_mm, "source": f.source });
    FORMATS.iter().map(of).collect()
}

/// Finds the format called `name`, in upper or lower case. `120 6x6` means `6x6`; `35mm`, `full-frame` and `24x36` mean `135`.
/// `None` for an unknown name.
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
        assert!(format_named("111").is_none() && format_named("").is_none());
    }

    #[test]
    fn names_are_unique_and_sizes_are_landscape() {
        for (i, f) in FORMATS.iter().enumerate() {
            assert!(f.width_mm >= f.height_mm && f.height_mm > 0.0 && !f.source.is_empty(), "{}", f.name);
            assert!(FORMATS[..i].iter().all(|g| g.name != f.name), "{}", f.name);
        }
    }
}

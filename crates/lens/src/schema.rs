//! JSON Schemas of the parts of a lens file, for editors.

use crate::aperture::ApertureKeys;
use crate::coating::CoatingKeys;
use crate::prism::PrismParams;
use crate::surface_file::{BREAK, BreakParams, SurfaceKeys};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::json;
use spectra_core::params::Kinds;
use std::borrow::Cow;

/// Returns the schema of a map with the keys that every surface may have in addition to the parameters of its kind.
#[must_use]
pub fn surface_keys(generator: &mut SchemaGenerator) -> Schema {
    SurfaceKeys::json_schema(generator)
}

/// Returns the schema of a map with the keys that every coating may have in addition to the parameters of its kind.
#[must_use]
pub fn coating_keys(generator: &mut SchemaGenerator) -> Schema {
    CoatingKeys::json_schema(generator)
}

/// Returns the schema of a map with the keys that every aperture may have in addition to the parameters of its shape.
#[must_use]
pub fn aperture_keys(generator: &mut SchemaGenerator) -> Schema {
    ApertureKeys::json_schema(generator)
}

/// The schema of an item of `surfaces`: a surface, a prism, or a bend of the axis.
pub(crate) struct SurfaceOrBreak;

impl JsonSchema for SurfaceOrBreak {
    fn schema_name() -> Cow<'static, str> {
        "SurfaceOrBreak".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let bend = Kinds {
            key: "kind",
            kinds: vec![(BREAK, BreakParams::json_schema(generator))],
            default: None,
            shared: None,
            by_name: true,
        };
        let is = |kind: &str| json!({ "properties": { "kind": { "const": kind } }, "required": ["kind"] });
        let is_bend = is(BREAK);
        let place = SurfaceKeys::json_schema(generator);
        let prism = Kinds {
            key: "kind",
            kinds: vec![(crate::prism::PRISM, PrismParams::json_schema(generator))],
            default: None,
            shared: Some(&place),
            by_name: false,
        };
        let surface = json!({ "$ref": "#/$defs/surface" });
        json_schema!({
            "x-words": "a surface, a prism, or a coordinate-break",
            "if": { "type": "object", "allOf": [is_bend] },
            "then": bend.schema(),
            "else": {
                "if": { "type": "object", "allOf": [is(crate::prism::PRISM)] },
                "then": prism.schema(),
                "else": surface,
            },
        })
    }
}

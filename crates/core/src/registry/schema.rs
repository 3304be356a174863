//! JSON Schema of what can stand where a stage is wanted.

use super::Stage;
use crate::params::Kinds;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use std::borrow::Cow;
use std::marker::PhantomData;

/// The schema of any registered stage of a kind: a name, or a map with `kind` and that stage's own parameters. For nested
/// stages, kept as a [`Part`](crate::params::Part):
///
/// ```
/// # use {schemars::JsonSchema, spectra_core::{params::Part, registry::StageOf, stage::ColorModel}};
/// #[derive(JsonSchema)]
/// struct LampParams {
///     /// How the lamp's color becomes a spectrum.
///     color: Option<Part<StageOf<dyn ColorModel>>>,
/// }
/// ```
///
/// It refers to a definition that [`definitions`] writes.
pub struct StageOf<S: ?Sized>(PhantomData<S>);

impl<S: Stage + ?Sized> JsonSchema for StageOf<S> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        S::NAME.into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "$ref": format!("#/$defs/{}", S::NAME) })
    }
}

/// Writes one definition a kind of stage (`source`, `surface`, ...) into a generator, with everything that is registered.
/// `shared` are keys that all stages of a kind take beside their own: a schema of a map, by kind.
pub fn definitions(generator: &mut SchemaGenerator, shared: &[(&str, Schema)]) {
    let all = super::list();
    for entries in all.chunk_by(|a, b| a.stage == b.stage) {
        let stage = entries[0].stage;
        let kinds = Kinds {
            key: "kind",
            kinds: entries.iter().map(|entry| (entry.name, (entry.schema)(generator))).collect(),
            default: entries.iter().find(|e| e.default).map(|e| e.name),
            shared: shared.iter().find(|(name, _)| *name == stage).map(|(_, schema)| schema),
            by_name: true,
        };
        generator.definitions_mut().insert(stage.to_owned(), kinds.schema().to_value());
    }
}

//! JSON Schema of the values that may stand for a stage.

use super::{Listed, Stage};
use crate::params::Kinds;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer};
use std::borrow::Cow;
use std::marker::PhantomData;

/// The schema of any registered stage of a kind: a name, or a map with `kind` and that stage's own parameters. For nested
/// stages, kept as a [`Deferred`](crate::params::Deferred):
///
/// ```
/// # use {schemars::JsonSchema, spectra_core::{params::Deferred, registry::StageOf, stage::ColorModel}};
/// #[derive(JsonSchema)]
/// struct LampParams {
///     /// How the lamp's color becomes a spectrum.
///     color: Option<Deferred<StageOf<dyn ColorModel>>>,
/// }
/// ```
///
/// The schema refers to a definition that [`definitions`] writes.
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

/// The name of a registered stage of a kind, for files that write it beside other keys. The allowed words are the registered names.
#[derive(Clone, Debug)]
pub struct NameOf<S: ?Sized>(String, PhantomData<fn() -> Box<S>>);

impl<S: ?Sized> NameOf<S> {
    /// Returns the name of the stage.
    #[must_use]
    pub fn get(&self) -> &str {
        &self.0
    }
}

impl<'de, S: ?Sized> Deserialize<'de> for NameOf<S> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        String::deserialize(deserializer).map(|name| Self(name, PhantomData))
    }
}

impl<S: Stage + ?Sized> JsonSchema for NameOf<S> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        format!("{}-name", S::NAME).into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let names: Vec<&str> = super::list().into_iter().filter(|l| l.stage == S::NAME).map(|l| l.name).collect();
        json_schema!({ "enum": names })
    }
}

/// Returns the schema of a map that holds one of the registered stages of the kind `S`. `shared` is the schema of the keys that
/// all of them take in addition to their own; `by_name` says whether a stage's name alone stands for it.
pub fn kinds<S: Stage + ?Sized>(generator: &mut SchemaGenerator, shared: Option<&Schema>, by_name: bool) -> Schema {
    let all: Vec<Listed> = super::list().into_iter().filter(|l| l.stage == S::NAME).collect();
    of_listed(&all, generator, shared, by_name)
}

fn of_listed(all: &[Listed], generator: &mut SchemaGenerator, shared: Option<&Schema>, by_name: bool) -> Schema {
    let kinds = Kinds {
        key: all.first().map_or("kind", |listed| listed.key),
        kinds: all.iter().map(|listed| (listed.name, (listed.schema)(generator))).collect(),
        default: all.iter().find(|listed| listed.default).map(|listed| listed.name),
        shared,
        by_name,
    };
    kinds.schema()
}

/// Adds one definition per kind of stage (`source`, `surface`, ...) to `generator`, with everything that is registered. `shared`
/// pairs a kind of stage with the schema of the keys that all its stages take in addition to their own.
pub fn definitions(generator: &mut SchemaGenerator, shared: &[(&str, Schema)]) {
    for all in super::list().chunk_by(|a, b| a.stage == b.stage) {
        let stage = all[0].stage;
        let shared = shared.iter().find(|(name, _)| *name == stage).map(|(_, schema)| schema);
        let schema = of_listed(all, generator, shared, true);
        generator.definitions_mut().insert(stage.to_owned(), schema.to_value());
    }
}

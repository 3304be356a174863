//! The film of a scene, or several films side by side that record the same light.

use crate::SceneFilm;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde_json::json;
use spectra_core::params::{Faults, Node, Params, keys_of};
use spectra_core::registry::{self, Context};
use spectra_core::spectral::Channel;
use spectra_core::stage::Film;
use std::borrow::Cow;
use std::sync::Arc;

/// The forms in which the `film` section can be written: a film, or a list of films.
pub(crate) struct FilmForm;

impl JsonSchema for FilmForm {
    fn schema_name() -> Cow<'static, str> {
        "FilmOrFilms".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let film = json!({ "$ref": "#/$defs/film" });
        json_schema!({ "x-words": "a film, or a list of films", "if": { "type": "array" }, "then": { "items": film, "minItems": 1, "maxItems": MAX_FILMS }, "else": film })
    }
}

/// The keys of each film in a list of films.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct FilmKeys {
    /// In a list of films: the name of its pictures.
    name: Option<String>,
}

/// Largest number of films side by side.
const MAX_FILMS: usize = 16;

/// Wraps a single film.
pub(crate) fn one(film: Box<dyn Film>) -> Vec<SceneFilm> {
    let channels = 0..film.channels().len();
    vec![SceneFilm { name: None, film: film.into(), channels }]
}

/// Builds the films of a list. Each has a name for its pictures: its key `name`, or the name of its stock or kind.
pub(crate) fn several(items: &[Node], params: &Params, context: &Context<'_>) -> Result<Vec<SceneFilm>, Faults> {
    let mut faults = Faults::new();
    if items.is_empty() || items.len() > MAX_FILMS {
        let fault = params.fault("film", format!("`film` lists {} films", items.len()));
        return Err(fault.hint(format!("write 1 to {MAX_FILMS} films")).into());
    }
    let mut films: Vec<SceneFilm> = Vec::new();
    for (at, item) in items.iter().enumerate() {
        let Some(stage) = faults.take(Params::stage(item.clone(), &format!("film[{at}]"))) else { continue };
        let (named, own) = stage.split(&keys_of::<FilmKeys>());
        let name = faults.take(name(&named, &own, &films));
        let film = faults.take(registry::build::<dyn Film>(&own, context));
        if let (Some(name), Some(film)) = (name, film) {
            let first = films.last().map_or(0, |f| f.channels.end);
            let channels = first..first + film.channels().len();
            films.push(SceneFilm { name: Some(name), film: film.into(), channels });
        }
    }
    faults.into_result(films)
}

/// Returns the name of a film: short, valid as part of a file name, and different from those of the other films.
fn name(named: &Params, own: &Params, others: &[SceneFilm]) -> Result<String, Faults> {
    let taken = |name: &str| others.iter().any(|f| f.name.as_deref() == Some(name));
    let Some(name) = named.parse::<FilmKeys>()?.name else {
        let stock =
            own.get("stock").and_then(|n| n.as_str()).map(|path| path.rsplit(['/', '\\']).next().unwrap_or(path));
        let stock = stock.map(|file| file.trim_end_matches(".yaml").trim_end_matches(".yml"));
        let base = stock.or(own.kind()).unwrap_or("film").to_owned();
        let numbered = (2..).map(|n| format!("{base}-{n}"));
        return Ok(std::iter::once(base.clone()).chain(numbered).find(|n| !taken(n)).unwrap_or(base));
    };
    let fault = |text: String| named.fault("name", text);
    let good = |c: char| c.is_alphanumeric() || "-_+".contains(c);
    if name.is_empty() || name.len() > 64 || !name.chars().all(good) {
        return Err(fault(format!("`{name}` cannot be part of a file's name"))
            .hint("use letters, digits, - and _")
            .into());
    }
    if taken(&name) {
        return Err(fault(format!("two films are called `{name}`")).hint("give each film a name of its own").into());
    }
    Ok(name)
}

/// Returns the channels of all films, in order. With several films, the film's name precedes each channel name, and the responses
/// include the ratio of the film's exposure time to that of the first film.
pub(crate) fn channels(films: &[SceneFilm]) -> Vec<Channel> {
    let time = |film: &SceneFilm| film.film.exposure_time_s();
    let Some(first_s) = films.first().map(time) else { return Vec::new() };
    let mut all = Vec::new();
    for film in films {
        let longer = time(film) / first_s;
        for channel in film.film.channels() {
            let Some(name) = &film.name else {
                all.push(channel);
                continue;
            };
            let response = channel.response.iter().map(|r| r * longer).collect();
            all.push(Channel { name: format!("{name}.{}", channel.name), unit: channel.unit, response });
        }
    }
    all
}

/// Returns the warnings of the films. A warning of several films is given once, with the names of those films.
pub(crate) fn warnings(films: &[SceneFilm]) -> Vec<String> {
    let mut said: Vec<(String, Vec<&str>)> = Vec::new();
    for film in films {
        for text in film.film.warnings() {
            let name = film.name.as_deref();
            match said.iter_mut().find(|(known, _)| *known == text) {
                Some((_, names)) => names.extend(name),
                None => said.push((text, name.into_iter().collect())),
            }
        }
    }
    let named = |(text, names): (String, Vec<&str>)| {
        if names.is_empty() { text } else { format!("{}: {text}", names.join(", ")) }
    };
    said.into_iter().map(named).collect()
}

/// Returns the channels that make pictures, without those of meters; all channels of an imager that records by itself.
pub(crate) fn pictured(films: &[SceneFilm], channels: &[Channel]) -> Arc<[Channel]> {
    if films.is_empty() {
        return channels.into();
    }
    let own = |f: &SceneFilm| f.channels.start..f.channels.start + f.film.picture_channels();
    films.iter().flat_map(|f| channels.get(own(f)).unwrap_or_default()).cloned().collect()
}

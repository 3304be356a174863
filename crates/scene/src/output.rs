//! The `output` section: the files that a scene asks for. Each output is a stage of its own.

use crate::light_layer::LightKind;
use crate::{FileResources, Scene, SceneFilm, Shot};
use spectra_core::frame::ExtraRequest;
use spectra_core::params::{Deferred, Fault, Faults, Node, Params, Value};
use spectra_core::registry::{self, Context, StageOf};
use spectra_core::sink::{Out, WriteFault};
use spectra_core::stage::{Film, Imager};
use std::path::Path;
use std::sync::Arc;

/// A kind of file that is written for a picture.
pub trait Output: Send + Sync {
    /// Returns the name of this output in a scene.
    fn kind(&self) -> &'static str;

    /// Returns the two parts of its file names that follow the name of the picture (and of the film, if there are several). They
    /// are a middle part, mostly empty, and the extension, such as `["-rays", ".svg"]`.
    fn ending(&self) -> [&'static str; 2];

    /// Returns what its files hold.
    fn content(&self) -> FileContent;

    /// Checks that the output can be made from what such an imager records.
    ///
    /// # Errors
    /// The reason why not, and what to write instead.
    fn check(&self, _imager: &dyn Imager) -> Result<(), [String; 2]> {
        Ok(())
    }

    /// Checks that the output can be made from the picture of a film on the imager.
    ///
    /// # Errors
    /// The reason why not, and what to write instead.
    fn check_film(&self, _film: &dyn Film) -> Result<(), [String; 2]> {
        Ok(())
    }

    /// Returns what this output needs of a picture in addition to what a screen shows.
    fn extra_request(&self) -> ExtraRequest {
        ExtraRequest::default()
    }

    /// Returns the kinds of light for which this output holds separate layers.
    fn lights(&self) -> &[LightKind] {
        &[]
    }

    /// Returns how many of the strongest ghost paths get layers of their own; 0 for none. One more layer holds all others. If
    /// outputs ask for different numbers, all get the layers of the largest number.
    fn ghost_paths(&self) -> usize {
        0
    }

    /// Writes the file of this output to `out`. `film` is the index of the film whose picture is written if several films lie
    /// side by side.
    ///
    /// # Errors
    /// Errors of `out`; [`WriteFault::Format`] if the picture has nothing to write.
    fn write(&self, shot: &Shot<'_>, film: usize, out: &mut dyn Out) -> Result<(), WriteFault>;

    /// Returns whether this output also writes one file for a whole sweep or animation: `SCENE-series` with its extension.
    fn is_of_series(&self) -> bool {
        false
    }

    /// Writes the file of a whole sweep or animation.
    ///
    /// # Errors
    /// Errors of the output stream; [`WriteFault::Format`] if this kind makes no such file.
    fn write_series(&self, _: &SeriesSummary<'_>, _: &mut dyn Out) -> Result<(), WriteFault> {
        Err(WriteFault::Format(format!("{} cannot hold several pictures", self.kind())))
    }
}

/// Facts about a finished sweep or animation.
#[derive(Clone, Copy, Debug)]
pub struct SeriesSummary<'a> {
    /// Name of the series.
    pub name: &'a str,
    /// Text of the scene file.
    pub text: &'a str,
    /// Content of `SCENE-series.json`.
    pub report: &'a serde_json::Value,
    /// Contact sheets as PNG files: names and bytes.
    pub contact_sheets: &'a [(String, Vec<u8>)],
}

/// Kinds of content of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileContent {
    /// All recorded light: a picture with such a file loses nothing.
    Light,
    /// The picture to look at, one file for each film.
    Picture,
    /// Other data computed from the recorded numbers.
    Numbers,
    /// A drawing of the scene.
    Figure,
}

spectra_core::declare!(OutputEntry, dyn Output, "output", "A registered output.");

/// Outputs of a scene that names none.
const USUAL: [&str; 2] = ["exr", "png"];

/// Builds the output of a kind without parameters.
fn of_kind(kind: &str, params: &Params, context: &Context<'_>) -> Result<Arc<dyn Output>, Faults> {
    let name = Node { value: Value::String(kind.to_owned()), ..params.node().clone() };
    registry::build::<dyn Output>(&Params::stage(name, "output")?, context).map(Arc::from)
}

/// Reads the section `output`. If it is absent, the outputs are EXR and PNG.
pub(crate) fn read(
    items: Option<&[Deferred<StageOf<dyn Output>>]>,
    params: &Params,
    context: &Context<'_>,
) -> Result<Vec<Arc<dyn Output>>, Faults> {
    let Some(items) = items else { return USUAL.iter().map(|kind| of_kind(kind, params, context)).collect() };
    let mut faults = Faults::new();
    let mut found: Vec<(Arc<dyn Output>, bool)> = Vec::new();
    for item in items {
        let Some(own) = faults.take(item.params()) else { continue };
        let Some(output) = faults.take(registry::build::<dyn Output>(&own, context)) else { continue };
        let is_plain = matches!(&own.node().value, Value::Map(keys) if keys.is_empty());
        let [part, ending] = output.ending();
        match found.iter().find(|(other, _)| other.ending() == [part, ending]) {
            // The same output, named twice.
            Some((_, true)) if is_plain => {}
            Some(_) => {
                let fault = item.fault(format!("two outputs write `SCENE{part}{ending}`"));
                faults.push(fault.hint("leave one of them out"));
            }
            None => found.push((output.into(), is_plain)),
        }
    }
    faults.into_result(found.into_iter().map(|(output, _)| output).collect())
}

/// Returns the faults of outputs that cannot be made from what the imager records, each at its place.
pub(crate) fn check(
    outputs: &[Arc<dyn Output>],
    imager: &dyn Imager,
    films: &[SceneFilm],
    params: &Params,
) -> Vec<Fault> {
    let items = match params.get("output").map(|node| &node.value) {
        Some(Value::Seq(items)) => &items[..],
        _ => &[],
    };
    let fault = |output: &Arc<dyn Output>| {
        let films = || films.iter().try_for_each(|film| output.check_film(&*film.film));
        let [text, hint] = output.check(imager).and_then(|()| films()).err()?;
        let at = items.iter().position(|item| item.get("kind").unwrap_or(item).as_str() == Some(output.kind()));
        let key = at.map_or_else(|| "output".to_owned(), |at| format!("output[{at}]"));
        Some(params.fault(&key, text).hint(hint))
    };
    outputs.iter().filter_map(fault).collect()
}

impl Scene {
    /// Returns whether the scene names an output that holds the light itself, as opposed to outputs that are written without being
    /// named.
    #[must_use]
    pub fn names_light_output(&self) -> bool {
        self.params.get("output").is_some() && self.output.iter().any(|output| output.content() == FileContent::Light)
    }

    /// Returns the kinds of light for which an output holds layers.
    #[must_use]
    pub fn light_layers(&self) -> Vec<LightKind> {
        LightKind::ALL
            .into_iter()
            .filter(|kind| self.output.iter().any(|output| output.lights().contains(kind)))
            .collect()
    }

    /// Returns how many of the strongest ghost paths get layers of their own: the largest number that any output asks for.
    #[must_use]
    pub fn ghost_paths(&self) -> usize {
        self.output.iter().map(|output| output.ghost_paths()).max().unwrap_or(0)
    }

    /// Returns the output whose file has this extension (`.png`) directly after the picture's name. It is one of the scene's own
    /// outputs, or a finished picture of the scene with this extension, or a registered output.
    #[must_use]
    pub fn output_of(&self, ending: &str) -> Option<Arc<dyn Output>> {
        let is_it = |output: &Arc<dyn Output>| output.ending() == ["", ending];
        // A finished picture in linear light normally has a name of its own beside the exposure.
        let is_picture =
            |output: &&Arc<dyn Output>| output.content() == FileContent::Picture && output.ending()[1] == ending;
        let own = self.output.iter().find(|output| is_it(output)).or_else(|| self.output.iter().find(is_picture));
        own.cloned().or_else(|| {
            let resources = FileResources::beside(Path::new(""));
            let context = Context::new(&resources, self.grid);
            let kinds = registry::list().into_iter().filter(|listed| listed.stage == "output");
            kinds.filter_map(|listed| of_kind(listed.name, &self.params, &context).ok()).find(is_it)
        })
    }
}

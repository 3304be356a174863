//! The `output` section: what a scene wants written. Each output is a stage of its own.

use crate::light_layer::LightKind;
use crate::{FileResources, Scene, SceneFilm, Shot};
use spectra_core::frame::Wanted;
use spectra_core::params::{Fault, Faults, Node, Params, Part, Value};
use spectra_core::registry::{self, Context, StageOf};
use spectra_core::sink::{Out, WriteFault};
use spectra_core::stage::{Film, Imager};
use std::path::Path;
use std::sync::Arc;

/// A kind of file that is written of a picture.
pub trait Output: Send + Sync {
    /// Its name in a scene.
    fn kind(&self) -> &'static str;

    /// How its files are called: what stands between the name of the picture (of films side by side, with the film's) and the
    /// ending, mostly nothing, and the ending: `["-rays", ".svg"]`.
    fn ending(&self) -> [&'static str; 2];

    /// What it holds.
    fn holds(&self) -> Holds;

    /// Looks whether it can be had of what such an imager records.
    ///
    /// # Errors
    /// Why not, and what to write instead.
    fn check(&self, _imager: &dyn Imager) -> Result<(), [String; 2]> {
        Ok(())
    }

    /// The same of a film on the imager.
    ///
    /// # Errors
    /// Why not, and what to write instead.
    fn check_film(&self, _film: &dyn Film) -> Result<(), [String; 2]> {
        Ok(())
    }

    /// What it needs of a picture beside what a screen shows.
    fn wanted(&self) -> Wanted {
        Wanted::default()
    }

    /// Kinds of light of which it holds layers of their own.
    fn lights(&self) -> &[LightKind] {
        &[]
    }

    /// Of how many paths of ghosts, the strongest, it holds layers of their own, with one for all others; 0 for none. Where outputs
    /// ask for different numbers, all get the layers of the largest.
    fn ghost_paths(&self) -> usize {
        0
    }

    /// Writes a file; of films side by side, that of the film at a place.
    ///
    /// # Errors
    /// What the place that it goes to has; [`WriteFault::Format`] where the picture has nothing to write.
    fn write(&self, shot: &Shot<'_>, film: usize, out: &mut dyn Out) -> Result<(), WriteFault>;

    /// Whether it also makes one file of a whole sweep or animation, `SCENE-series` with its ending.
    fn is_of_series(&self) -> bool {
        false
    }

    /// Writes that file.
    ///
    /// # Errors
    /// What the place that it goes to has.
    fn write_series(&self, _: &Told<'_>, _: &mut dyn Out) -> Result<(), WriteFault> {
        Err(WriteFault::Format(format!("{} makes no file of several pictures", self.kind())))
    }
}

/// What there is to say of a sweep or an animation.
#[derive(Clone, Copy, Debug)]
pub struct Told<'a> {
    /// Its name.
    pub name: &'a str,
    /// The scene, as its file has it.
    pub text: &'a str,
    /// The content of `SCENE-series.json`.
    pub report: &'a serde_json::Value,
    /// Contact sheets as PNG files: their names, and their bytes.
    pub contact_sheets: &'a [(String, Vec<u8>)],
}

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// All the light that was recorded: nothing is lost with a picture that has it.
    Light,
    /// What a person looks at, a file for each film.
    Picture,
    /// What is made of the recorded numbers otherwise.
    Numbers,
    /// What is drawn of the scene.
    Figure,
}

spectra_core::declare!(OutputEntry, dyn Output, "output", "A registered output.");

/// Outputs where a scene names none.
const USUAL: [&str; 2] = ["exr", "png"];

/// The output of a kind, as it is without parameters.
fn of_kind(kind: &str, params: &Params, context: &Context<'_>) -> Result<Arc<dyn Output>, Faults> {
    let name = Node { value: Value::String(kind.to_owned()), ..params.node().clone() };
    registry::build::<dyn Output>(&Params::stage(name, "output")?, context).map(Arc::from)
}

/// Reads the section; EXR and PNG where it is absent.
pub(crate) fn read(
    items: Option<&[Part<StageOf<dyn Output>>]>,
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
            // The same, said twice.
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

/// Faults of outputs that cannot be had of what the imager records, each at its place.
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
    /// Kinds of light of which an output holds layers.
    #[must_use]
    pub fn light_layers(&self) -> Vec<LightKind> {
        LightKind::ALL
            .into_iter()
            .filter(|kind| self.output.iter().any(|output| output.lights().contains(kind)))
            .collect()
    }

    /// Of how many paths of ghosts, the strongest, an output holds layers.
    #[must_use]
    pub fn ghost_paths(&self) -> usize {
        self.output.iter().map(|output| output.ghost_paths()).max().unwrap_or(0)
    }

    /// The output whose file has this ending (`.png`), and nothing before it but the picture's name: one of the scene's own, a
    /// finished picture of the scene's that has the ending, or else what is registered.
    #[must_use]
    pub fn output_of(&self, ending: &str) -> Option<Arc<dyn Output>> {
        let is_it = |output: &Arc<dyn Output>| output.ending() == ["", ending];
        // A finished picture in light, which stands beside the exposure under a name of its own.
        let is_picture = |output: &&Arc<dyn Output>| output.holds() == Holds::Picture && output.ending()[1] == ending;
        let own = self.output.iter().find(|output| is_it(output)).or_else(|| self.output.iter().find(is_picture));
        own.cloned().or_else(|| {
            let resources = FileResources::beside(Path::new(""));
            let context = Context::new(&resources, self.grid);
            let kinds = registry::list().into_iter().filter(|listed| listed.stage == "output");
            kinds.filter_map(|listed| of_kind(listed.name, &self.params, &context).ok()).find(is_it)
        })
    }
}

//! A scene file as a series of pictures: one picture, the members of a sweep, or the frames of an animation.

use super::animation::Animation;
use super::include::{self, INCLUDE};
use super::picture_values::{ANIMATION, PictureValues, SWEEP};
use super::sweep::{Axis, Sweep};
use super::variables::{self, VARIABLES, Variables};
use super::yaml_writer;
use crate::assemble::{assemble, read, record};
use crate::cached_resources::{BUNDLED, CachedResources};
use crate::frame_view::ViewSearch;
use crate::lens_section::is_too_fast;
use crate::metering;
use crate::reuse::ReusableStages;
use crate::{FileResources, NO_LENS, Scene, yaml};
use spectra_core::params::{Fault, Faults, Key, Node, Number, Params, SourceFile, Step, Value, Warning, steps};
use spectra_core::resources::Resources;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Kinds of series that a scene file stands for.
#[derive(Clone, Debug, PartialEq)]
pub enum SeriesKind {
    /// A single picture.
    Single,
    /// A sweep: pictures that differ in named values.
    Sweep {
        /// The swept paths, each with its values, in order: the pictures are all combinations. Empty if the sweep sets its values
        /// together.
        axes: Vec<SweptAxis>,
    },
    /// An animation: a sequence of frames.
    Animation {
        /// Number of the first frame.
        first: u32,
        /// Frames per second.
        rate: f64,
    },
}

/// A path of a sweep's product, with its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SweptAxis {
    /// The path, such as `lens.f-number`.
    pub path: String,
    /// Values set at the path, one after another, as written.
    pub values: Vec<String>,
}

/// One picture of a series.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Number in the sweep, from 1, or number of the frame.
    pub number: u32,
    /// Paths and values of this picture, as written.
    pub values: Vec<(String, String)>,
    /// Name of the scene.
    base: String,
    /// Part of the file names that differs between pictures: `-001` or `.0001`; empty for a single picture.
    mark: String,
    is_frame: bool,
}

impl Member {
    /// Returns the name of the picture's files without extension: the name of the scene, the number of the picture, and `part`.
    /// `part` distinguishes several files of one picture, such as by the name of a film. For a frame of an animation, the number
    /// comes last.
    #[must_use]
    pub fn stem(&self, part: &str) -> String {
        let Self { base, mark, .. } = self;
        if self.is_frame { format!("{base}{part}{mark}") } else { format!("{base}{mark}{part}") }
    }

    /// Formats the values on one line: `lens.f-number = f/2, film.stock = kodak-tri-x-400`.
    #[must_use]
    pub fn words(&self) -> String {
        self.values.iter().map(|(path, value)| format!("{path} = {value}")).collect::<Vec<_>>().join(", ")
    }
}

/// A scene file that was read with all of its includes; no stage is built yet.
#[derive(Clone)]
pub struct Series {
    written: ParsedScene,
    /// Texts `path=value` that are set on top of the file.
    overrides: Vec<String>,
    /// The tree, with its variables.
    root: Node,
    /// Complete record of a scene that uses none of the scene language.
    plain: Option<String>,
    going: SeriesSpec,
    warnings: Vec<Warning>,
}

#[derive(Clone, Debug)]
enum SeriesSpec {
    Single,
    Sweep { axes: Vec<Axis>, settings: Vec<PictureValues> },
    Animation(Animation),
}

/// Reads and assembles a scene that is one picture. `overrides` are texts `path=value`, as given by `--set`.
///
/// # Errors
/// Every fault of the scene, each with its place; a scene that stands for several pictures.
pub fn load(path: &Path, overrides: &[String]) -> Result<Scene, Faults> {
    let series = load_series(path, overrides)?;
    if let Some(key) = series.key() {
        let fault =
            series.root.fault(format!("this scene makes {} pictures, but one is expected here", series.count()));
        return Err(fault.path(key).hint(format!("remove the series with `--set {key}=null`")).into());
    }
    series.scene(0)
}

/// Reads a scene file with its includes, and determines the pictures that it stands for. `overrides` are texts `path=value`, as
/// given by `--set`.
///
/// # Errors
/// Every fault of files, `--set`, `include`, `sweep` and `animation`. Faults of a picture are reported by [`Series::scene`].
pub fn load_series(path: &Path, overrides: &[String]) -> Result<Series, Faults> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let root = read(path)?;
    // A bundled scene gets its full name, whatever part of it was given.
    let called = match root.file.name.strip_prefix("bundled:") {
        Some(bundled) => Path::new(bundled),
        None => path,
    };
    let name = called.file_stem().map_or_else(|| "scene".to_owned(), |s| s.to_string_lossy().into_owned());
    let beside =
        |folders: &[PathBuf]| -> Arc<dyn Resources> { Arc::new(FileResources::beside(folder).and_beside(folders)) };
    ParsedScene::read(name, root, overrides, beside)?.set(overrides)
}

/// Reads a series from the text of a scene file called `name`. `overrides` are texts `path=value`. The stages of the scene get
/// their files from `resources`.
///
/// # Errors
/// The errors of [`load_series`].
pub fn series_of_text(
    name: &str,
    text: &str,
    overrides: &[String],
    resources: Arc<dyn Resources>,
) -> Result<Series, Faults> {
    let root = yaml::parse(SourceFile::new(name, text))?;
    series_of_tree(name, root, overrides, resources)
}

/// Reads a series from the tree `root` of a scene called `name`, for example one made by a program. `overrides` are texts
/// `path=value`. The stages of the scene get their files from `resources`.
///
/// # Errors
/// The errors of [`load_series`].
pub fn series_of_tree(
    name: &str,
    root: Node,
    overrides: &[String],
    resources: Arc<dyn Resources>,
) -> Result<Series, Faults> {
    let stem = Path::new(name).file_stem().map_or_else(|| name.to_owned(), |s| s.to_string_lossy().into_owned());
    ParsedScene::read(stem, root, overrides, |_| resources)?.set(overrides)
}

/// A scene as written, with all of its includes, before any value is set.
#[derive(Clone)]
struct ParsedScene {
    name: String,
    root: Node,
    /// The scene file, for the record.
    text: Arc<SourceFile>,
    resources: Arc<CachedResources>,
    /// Names of the files that the scene is made of.
    files: Vec<String>,
    /// Variables that any of the files refers to.
    references: BTreeSet<String>,
    /// Whether the scene uses none of the scene language.
    is_plain: bool,
}

/// Returns whether a text `path=value` sets `include`.
fn is_include(text: &str) -> bool {
    text.split_once('=').is_some_and(|(path, _)| path.trim() == INCLUDE)
}

impl ParsedScene {
    fn read(
        name: String,
        mut root: Node,
        overrides: &[String],
        resources: impl FnOnce(&[PathBuf]) -> Arc<dyn Resources>,
    ) -> Result<Self, Faults> {
        let text = Arc::clone(&root.file);
        let mut faults = Faults::new();
        for text in overrides.iter().filter(|text| is_include(text)) {
            faults.take(yaml::parse_override(text).and_then(|o| o.apply(&mut root).map_err(Faults::from)));
        }
        faults.into_result(())?;
        let is_plain = [INCLUDE, VARIABLES, SWEEP, ANIMATION].iter().all(|key| root.get(key).is_none());
        let files = vec![root.file.name.clone()];
        let include::Included { root, files: included, folders, references } = include::resolve(root)?;
        let resources = Arc::new(CachedResources::new(resources(&folders)));
        Ok(Self { name, root, text, resources, files: [files, included].concat(), references, is_plain })
    }

    /// Returns the series with these texts `path=value` on top.
    fn set(self, overrides: &[String]) -> Result<Series, Faults> {
        let (mut root, mut references) = (self.root.clone(), self.references.clone());
        let mut faults = Faults::new();
        let mut set = Vec::new();
        for text in overrides.iter().filter(|text| !is_include(text)) {
            let Some(over) = faults.take(yaml::parse_override(text)) else { continue };
            variables::references(&over.node, &mut references);
            variables::open(&mut root, &over.path);
            set.push(over.path.clone());
            // `null` removes a key, as in a file that includes another.
            if matches!(over.node.value, Value::Null) && take_away(&mut root, &over.path) {
                continue;
            }
            faults.take(over.apply(&mut root));
        }
        faults.into_result(())?;
        // `--set` may have added scene language.
        let is_plain = self.is_plain && [VARIABLES, SWEEP, ANIMATION].iter().all(|key| root.get(key).is_none());
        let plain = is_plain.then(|| record(&self.text.text, overrides));
        let overrides = overrides.to_vec();
        let series = Series { written: self, overrides, root, plain, going: SeriesSpec::Single, warnings: Vec::new() };
        if is_plain { Ok(series) } else { series.unfolded(&set, &references) }
    }
}

/// Removes the key at a path; returns whether it existed.
fn take_away(root: &mut Node, path: &str) -> bool {
    let Ok(steps) = steps(path) else { return false };
    let Some((Step::Key(last), through)) = steps.split_last() else { return false };
    let parent = through.iter().try_fold(root, |node, step| match (step, &mut node.value) {
        (Step::Key(key), Value::Map(entries)) => entries.iter_mut().find(|(k, _)| k.text == *key).map(|(_, node)| node),
        (Step::Index(index), Value::Seq(entries)) => entries.get_mut(*index),
        _ => None,
    });
    let Some(Node { value: Value::Map(entries), .. }) = parent else { return false };
    let at = entries.iter().position(|(key, _)| key.text == *last);
    at.map(|at| entries.remove(at)).is_some()
}

impl Series {
    /// Returns the text of the scene file, followed by comments with the values that are set on top.
    #[must_use]
    pub fn text(&self) -> String {
        record(&self.written.text.text, &self.overrides)
    }

    /// The text of the scene file as written.
    #[must_use]
    pub fn written(&self) -> &str {
        &self.written.text.text
    }

    /// Removes `sweep` and `animation` from the tree, and reads them.
    fn unfolded(mut self, set: &[String], references: &std::collections::BTreeSet<String>) -> Result<Self, Faults> {
        let mut faults = Faults::new();
        let variables = faults.take(Variables::of(self.root.get(VARIABLES)));
        let mut take = |key: &str| {
            let Value::Map(entries) = &mut self.root.value else { return None };
            let at = entries.iter().position(|(k, _)| k.text == key)?;
            let (key, node) = entries.remove(at);
            (!matches!(node.value, Value::Null)).then_some((key, node))
        };
        let (sweep, animation) = (take(SWEEP), take(ANIMATION));
        let Some(variables) = variables else { return Err(faults) };
        if let (Some((_, sweep)), Some((key, node))) = (&sweep, &animation) {
            let fault =
                Fault::new("a scene can have a sweep or an animation, not both").at(Arc::clone(&node.file), key.span);
            let place = sweep.fault("").place_text().unwrap_or_default();
            faults.push(fault.path(ANIMATION).hint(format!(
                "the sweep is at {place}; render the animation once for each value, with `--set sweep=null --set lens.f-number=f/4`"
            )));
        }
        // Unused variables are checked for circles, too, because setting another variable may use them.
        faults.take(variables.check_circles());
        self.warnings = variables.unused(references);
        let mut own: Vec<String> = Vec::new();
        if let Some((_, node)) = sweep
            && let Some(sweep) = faults.take(Sweep::read(&node, &variables))
        {
            let settings = sweep.settings();
            own = settings.iter().flatten().map(|(path, _)| path.clone()).collect();
            let axes = if let Sweep::Product(axes) = sweep { axes } else { Vec::new() };
            self.going = SeriesSpec::Sweep { axes, settings };
        }
        if let Some((_, node)) = animation
            && let Some(animation) = faults.take(Animation::read(&node, &variables))
        {
            self.warnings.extend(animation.warnings.iter().cloned());
            own = animation.setting(animation.first).into_iter().map(|(path, _)| path).collect();
            self.going = SeriesSpec::Animation(animation);
        }
        let below = |set: &str, own: &str| {
            set.strip_prefix(own).is_some_and(|rest| rest.is_empty() || rest.starts_with(['.', '[']))
        };
        for set in set.iter().filter(|set| own.iter().any(|own| below(set, own))) {
            let key = self.key().unwrap_or_default();
            let text = format!("`--set {set}` has no effect: the {key} sets it for each picture");
            self.warnings.push(text.into());
        }
        faults.into_result(self)
    }

    /// Returns the key of the section that makes several pictures.
    fn key(&self) -> Option<&'static str> {
        match self.going {
            SeriesSpec::Single => None,
            SeriesSpec::Sweep { .. } => Some(SWEEP),
            SeriesSpec::Animation(_) => Some(ANIMATION),
        }
    }

    /// Returns the series with one more value set by a text `path=value`, as `--set` does. No file is read again, except includes
    /// if `include` is set.
    ///
    /// # Errors
    /// The errors of [`load_series`].
    pub fn with(&self, text: &str) -> Result<Self, Faults> {
        self.with_all(std::slice::from_ref(&text))
    }

    /// Returns the series with several more values set, each by a text `path=value`.
    ///
    /// # Errors
    /// The errors of [`load_series`].
    pub fn with_all(&self, texts: &[impl AsRef<str>]) -> Result<Self, Faults> {
        let path = |text: &str| text.split_once('=').map(|(path, _)| path.trim().to_owned());
        let mut overrides = self.overrides.clone();
        for text in texts.iter().map(AsRef::as_ref) {
            overrides.retain(|other| path(other) != path(text));
            overrides.push(text.to_owned());
        }
        self.written.clone().set(&overrides)
    }

    /// Returns the series with fixed exposure times instead of metered ones. Each of `times` is the index of a film in the
    /// scene's list, and its time in s.
    ///
    /// # Errors
    /// A film that is not a section of the scene.
    pub fn exposed_for(&self, times: &[(usize, f64)]) -> Result<Self, Faults> {
        let mut series = self.clone();
        variables::open(&mut series.root, "film.exposure");
        let is_list = matches!(series.root.get("film").map(|node| &node.value), Some(Value::Seq(_)));
        for (index, time_s) in times {
            let film = if is_list { format!("film[{index}]") } else { "film".to_owned() };
            let path = format!("{film}.exposure");
            variables::open(&mut series.root, &path);
            for key in metering::KEYS {
                take_away(&mut series.root, &format!("{film}.{key}"));
            }
            let place = series.root.at_path(&film).unwrap_or(&series.root).clone();
            series.root.set_path(&path, Node { value: Value::String(format!("{time_s} s")), ..place })?;
        }
        Ok(series)
    }

    /// Returns whether the series changes something from picture to picture that affects the exposure of its films. Each picture
    /// is then metered by itself.
    #[must_use]
    pub fn sets_exposures(&self) -> bool {
        let used = |path: &str| match path.strip_prefix("variables.") {
            Some(name) => {
                let name = name.split(['.', '[']).next().unwrap_or(name);
                self.uses_of_variable(name).into_iter().map(|(path, _)| path).collect()
            }
            None => vec![path.to_owned()],
        };
        self.setting(0).iter().flat_map(|(path, _)| used(path)).any(|path| metering::is_of_meter(&path))
    }

    /// Texts `path=value` that are set on top of the scene as written.
    #[must_use]
    pub fn overrides(&self) -> &[String] {
        &self.overrides
    }

    /// Name of the scene: the file's name without its extension.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.written.name
    }

    /// Returns the kind of the series.
    #[must_use]
    pub fn kind(&self) -> SeriesKind {
        match &self.going {
            SeriesSpec::Single => SeriesKind::Single,
            SeriesSpec::Sweep { axes, .. } => {
                let shown = |a: &Axis| SweptAxis {
                    path: a.path.clone(),
                    values: a.values.iter().map(yaml_writer::one_line).collect(),
                };
                SeriesKind::Sweep { axes: axes.iter().map(shown).collect() }
            }
            SeriesSpec::Animation(animation) => SeriesKind::Animation { first: animation.first, rate: animation.rate },
        }
    }

    /// Returns whether the scene's lens is [`NO_LENS`]: the picture's own pixels expose the film.
    #[must_use]
    pub fn is_without_lens(&self) -> bool {
        let file = self.root.get("lens").and_then(|lens| lens.get("file"));
        file.and_then(Node::as_str) == Some(NO_LENS)
    }

    /// Number of pictures in the series.
    #[must_use]
    pub fn count(&self) -> usize {
        match &self.going {
            SeriesSpec::Single => 1,
            SeriesSpec::Sweep { settings, .. } => settings.len(),
            SeriesSpec::Animation(animation) => animation.frames as usize,
        }
    }

    /// Warnings about unused variables and about values that have no effect.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Names of the files that the scene is made of: the scene, then its includes.
    #[must_use]
    pub fn files(&self) -> &[String] {
        &self.written.files
    }

    /// Returns all files on disk that the series depends on: its own, and those that its stages have read so far.
    #[must_use]
    pub fn files_on_disk(&self) -> Vec<PathBuf> {
        let own = self.files().iter().filter(|name| !name.starts_with(BUNDLED)).map(PathBuf::from);
        own.chain(self.written.resources.on_disk()).collect()
    }

    /// Returns where a variable is used: paths and texts of the values, such as `source.distance` and `$far`.
    #[must_use]
    pub fn uses_of_variable(&self, name: &str) -> Vec<(String, String)> {
        fn search(node: &Node, path: &str, wanted: &[String; 2], found: &mut Vec<(String, String)>) {
            match &node.value {
                Value::Map(entries) => {
                    for (key, item) in entries {
                        let inner = if path.is_empty() { key.text.clone() } else { format!("{path}.{}", key.text) };
                        search(item, &inner, wanted, found);
                    }
                }
                Value::Seq(items) => items.iter().for_each(|item| search(item, path, wanted, found)),
                Value::String(text) if *text == wanted[0] || text.contains(&wanted[1]) => {
                    found.push((path.to_owned(), text.clone()));
                }
                Value::String(_) | Value::Null | Value::Bool(_) | Value::Number(_) => {}
            }
        }
        let mut found = Vec::new();
        search(&self.root, "", &[format!("${name}"), format!("${{{name}}}")], &mut found);
        found
    }

    fn setting(&self, index: usize) -> PictureValues {
        match &self.going {
            SeriesSpec::Single => PictureValues::new(),
            SeriesSpec::Sweep { settings, .. } => settings.get(index).cloned().unwrap_or_default(),
            SeriesSpec::Animation(animation) => animation.setting(animation.first + index as u32),
        }
    }

    /// Returns a picture by its index in the series, from 0.
    #[must_use]
    pub fn member(&self, index: usize) -> Member {
        let values =
            self.setting(index).iter().map(|(path, node)| (path.clone(), yaml_writer::one_line(node))).collect();
        let (number, mark) = match &self.going {
            SeriesSpec::Single => (1, String::new()),
            SeriesSpec::Sweep { settings, .. } => {
                let digits = settings.len().to_string().len().max(3);
                (index as u32 + 1, format!("-{:0digits$}", index + 1))
            }
            SeriesSpec::Animation(animation) => {
                let frame = animation.first + index as u32;
                let digits = (animation.first + animation.frames - 1).to_string().len().max(4);
                (frame, format!(".{frame:0digits$}"))
            }
        };
        let is_frame = matches!(self.going, SeriesSpec::Animation(_));
        Member { number, values, base: self.written.name.clone(), mark, is_frame }
    }

    /// Assembles a picture by its index in the series, from 0.
    ///
    /// # Errors
    /// Every fault of the picture, each with its place. Faults of a value that came through a variable name both places.
    pub fn scene(&self, index: usize) -> Result<Scene, Faults> {
        self.assembled(index, ReusableStages::default())
    }

    /// Assembles a picture by its index, and takes over what it can from scenes that were assembled before.
    ///
    /// Stages of `other` whose sections are unchanged are reused; `other` is consumed. The lens of `lens_of` is reused if both
    /// scenes focus it alike. `search` controls the search for what the frame sees.
    ///
    /// # Errors
    /// The errors of [`Series::scene`]; an error if the workers are told to stop.
    pub fn scene_between(
        &self,
        index: usize,
        other: Option<Arc<Scene>>,
        lens_of: Option<&Scene>,
        search: ViewSearch<'_>,
    ) -> Result<Scene, Faults> {
        self.assembled(index, ReusableStages::of(other, false).and_lens_of(lens_of).by(search))
    }

    /// Assembles a picture by its index only to check it: its noise and grain may be those of another picture. All stages of
    /// `other`, another picture assembled for a check, can therefore be reused if their sections are unchanged.
    ///
    /// # Errors
    /// The errors of [`Series::scene`].
    pub fn looked_at(&self, index: usize, other: Option<Arc<Scene>>) -> Result<Scene, Faults> {
        self.assembled(index, ReusableStages::of(other, true))
    }

    fn assembled(&self, index: usize, earlier: ReusableStages<'_>) -> Result<Scene, Faults> {
        let member = self.member(index);
        let name = member.stem("");
        if let Some(text) = &self.plain {
            return assemble(
                &name,
                text.clone(),
                &Params::section(self.root.clone(), "")?,
                &*self.written.resources,
                earlier,
            );
        }
        let mut root = self.root.clone();
        let mut faults = Faults::new();
        for (path, node) in self.setting(index) {
            variables::open(&mut root, &path);
            faults.take(root.set_path(&path, node));
        }
        if let SeriesSpec::Animation(animation) = &self.going
            && animation.is_alive
        {
            let number = Value::Number(Number { value: f64::from(member.number), text: member.number.to_string() });
            variables::open(&mut root, "render.frame");
            faults.take(root.set_path("render.frame", Node { value: number, ..self.root.clone() }));
        }
        let variables = faults.take(Variables::of(root.get(VARIABLES)));
        faults.into_result(())?;
        drop(without(&mut root, VARIABLES));
        let mut uses = Vec::new();
        let root = variables.unwrap_or_default().put_into(&root, &mut uses)?;
        let text = self.record(&member, &root);
        let (is_check, search) = (earlier.is_check, earlier.search);
        let built = |root: &Node, text: &str, earlier: ReusableStages<'_>| {
            Params::section(root.clone(), "")
                .and_then(|params| assemble(&name, text.to_owned(), &params, &*self.written.resources, earlier))
        };
        let scene =
            built(&root, &text, earlier).or_else(|faults| match self.wide_open_instead(index, &root, &faults) {
                Some((open, warning)) => {
                    built(&open, &self.record(&member, &open), ReusableStages::of(None, is_check).by(search)).map(
                        |mut scene| {
                            scene.warnings.push(warning.into());
                            scene
                        },
                    )
                }
                None => Err(faults),
            });
        scene.map_err(|faults| variables::with_variable_places(faults, &uses))
    }

    /// Handles a sweep over lenses in which the only fault is that a lens cannot reach the f-number. Returns the scene without
    /// the f-number, and a warning.
    fn wide_open_instead(&self, index: usize, root: &Node, faults: &Faults) -> Option<(Node, String)> {
        let is_sweep = matches!(self.going, SeriesSpec::Sweep { .. });
        let lens = self.setting(index).iter().any(|(path, _)| path == "lens.file" || path == "lens");
        let [fault] = &faults.0[..] else { return None };
        if !(is_sweep && lens && fault.path == "lens.f-number") {
            return None;
        }
        let params = Params::section(root.clone(), "").and_then(|params| params.stage_at("lens")).ok()??;
        if !is_too_fast(&params, &*self.written.resources) {
            return None;
        }
        let mut open = root.clone();
        let Value::Map(entries) = &mut open.value else { return None };
        let (_, lens) = entries.iter_mut().find(|(key, _)| key.text == "lens")?;
        without(lens, "f-number")?;
        Some((open, format!("picture {} is taken wide open: {}", index + 1, fault.message)))
    }

    /// Returns the record of one picture as a scene of its own.
    fn record(&self, member: &Member, root: &Node) -> String {
        let mut root = root.clone();
        // Settings that do not change the picture do not change the record in its file.
        if let Value::Map(entries) = &mut root.value
            && let Some((_, render)) = entries.iter_mut().find(|(key, _)| key.text == "render")
        {
            drop(without(render, "batch"));
        }
        let file =
            |name: &String| Path::new(name).file_name().map_or(name.clone(), |n| n.to_string_lossy().into_owned());
        let files: Vec<String> = self.written.files.iter().map(file).collect();
        let what = match &self.going {
            SeriesSpec::Single => String::new(),
            SeriesSpec::Sweep { settings, .. } => {
                format!("# picture {} of {}: {}\n", member.number, settings.len(), member.words())
            }
            SeriesSpec::Animation(_) => format!("# frame {}: {}\n", member.number, member.words()),
        };
        let what: String = what.chars().map(|c| if c.is_control() && c != '\n' { ' ' } else { c }).collect();
        format!("# made of {}\n{what}{}", files.join(", "), yaml_writer::document(&root))
    }
}

/// Removes a key from a map.
fn without(node: &mut Node, key: &str) -> Option<(Key, Node)> {
    let Value::Map(entries) = &mut node.value else { return None };
    let at = entries.iter().position(|(k, _)| k.text == key)?;
    Some(entries.remove(at))
}

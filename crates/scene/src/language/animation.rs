//! The `animation` section: one scene, and a sequence of frames over which values change.

use super::law::{Law, Track};
use super::picture_values::{ANIMATION, PictureValues, check_path};
use super::variables::Variables;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{Deferred, Fault, Faults, Key, Node, StageNode, Value, Warning, Whole};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Largest number of frames of an animation: 400 s of film at 25 frames per second.
const MAX_FRAMES: u64 = 10_000;
/// Largest number of a frame: seven digits.
const LAST: u64 = 9_999_999;
/// Largest number of a first frame.
const LAST_FIRST: u64 = LAST - MAX_FRAMES;
/// The key among keyframes that names their interpolation.
const INTERPOLATION: &str = "interpolation";

/// The `animation` section as written.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub(crate) struct Section {
    /// Number of frames.
    frames: Whole<1, MAX_FRAMES>,
    /// Number of the first frame; 1 if left out.
    first: Option<Whole<0, LAST_FIRST>>,
    /// Frames per second; 24 if left out.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1e6))]
    rate: Option<f64>,
    /// `each`: every frame has its own noise and grain; `fixed`: all have the same.
    #[serde(default)]
    seed: FrameSeed,
    /// Paths as for `--set`, each with its keyframes: frame numbers with values, and optionally `interpolation`: `linear`,
    /// `smooth`, `hold`, `logarithmic` or `reciprocal`.
    animate: Option<Deferred<BTreeMap<String, BTreeMap<String, StageNode>>>>,
}

/// Whether every frame has noise and grain of its own.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum FrameSeed {
    #[default]
    Each,
    Fixed,
}

/// The frames of an animation, and the values that change over them.
#[derive(Clone, Debug)]
pub(super) struct Animation {
    /// Number of the first frame.
    pub first: u32,
    /// Number of frames.
    pub frames: u32,
    /// Frames per second.
    pub rate: f64,
    /// Whether every frame has random numbers of its own.
    pub is_alive: bool,
    tracks: Vec<(String, Track)>,
    /// Warnings about keyframes outside the frames.
    pub warnings: Vec<Warning>,
}

impl Animation {
    /// Reads the section. `$name` in it stands for the scene's own variables.
    ///
    /// # Errors
    /// Every fault of the section.
    pub(super) fn read(section: &Node, variables: &Variables) -> Result<Self, Faults> {
        let filled = variables.put_into_part(section)?;
        let node = StageNode::new(filled, ANIMATION);
        let read: Section = node.parse()?;
        let mut faults = Faults::new();
        let frames = read.frames.get_u32();
        let first = read.first.map_or(1, Whole::get_u32);
        let rate = read.rate.unwrap_or(24.0);
        let is_alive = read.seed == FrameSeed::Each;
        let (mut tracks, mut warnings) = (Vec::new(), Vec::new());
        let last = f64::from(first) + f64::from(frames) - 1.0;
        if let Some(animate) = &read.animate {
            let Value::Map(entries) = &animate.node().value else {
                let fault = animate.fault("`animate` must be a map from paths to keyframes");
                faults.push(fault.hint("such as `animate: {lens.focus: {1: 2 m, 48: 0.6 m}}`"));
                return Err(faults);
            };
            for (key, node) in entries {
                faults.take(check_path(key, node, "animation.animate"));
                let Some((track, at)) = faults.take(track(key, node)) else { continue };
                if let Some(beyond) = at.iter().find(|at| !(f64::from(first)..=last).contains(at)) {
                    let words = format!("keyframe {beyond} of `{}` is outside the frames {first} to {last}", key.text);
                    warnings.push(node.fault(words).into());
                }
                tracks.push((key.text.clone(), track));
            }
        }
        faults.into_result(Self { first, frames, rate, is_alive, tracks, warnings })
    }

    /// Returns the paths and values that are set for a frame.
    pub(super) fn setting(&self, frame: u32) -> PictureValues {
        self.tracks.iter().map(|(path, track)| (path.clone(), track.value_at(f64::from(frame)))).collect()
    }
}

/// Returns the keyframes of one path as a track, and their frame numbers.
fn track(key: &Key, node: &Node) -> Result<(Track, Vec<f64>), Faults> {
    let path = format!("{ANIMATION}.animate.{}", key.text);
    let example = "such as `{1: 2 m, 48: 0.6 m, interpolation: smooth}`";
    let Value::Map(entries) = &node.value else {
        return Err(node.fault("keyframes must be a map from frame numbers to values").path(path).hint(example).into());
    };
    let mut faults = Faults::new();
    let mut law = Law::default();
    let mut keyframes: Vec<(f64, Node)> = Vec::new();
    for (key, value) in entries {
        if key.text == INTERPOLATION {
            let named = StageNode::new(value.clone(), format!("{path}.{INTERPOLATION}"));
            law = faults.take(named.parse()).unwrap_or(law);
            continue;
        }
        let frame = key.text.parse::<u32>().ok().filter(|frame| u64::from(*frame) <= LAST);
        let Some(frame) = frame else {
            let fault =
                Fault::new(format!("`{}` is not a frame number", key.text.chars().take(48).collect::<String>()));
            faults.push(fault.at(Arc::clone(&value.file), key.span).path(&path).hint(example));
            continue;
        };
        if keyframes.iter().any(|(at, _)| *at == f64::from(frame)) {
            let fault = Fault::new(format!("frame {frame} comes twice"));
            faults.push(fault.at(Arc::clone(&value.file), key.span).path(&path));
        }
        keyframes.push((f64::from(frame), value.clone()));
    }
    if keyframes.is_empty() && faults.is_empty() {
        faults.push(node.fault("there is no keyframe").path(&path).hint(example));
    }
    faults.into_result(())?;
    keyframes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (at, nodes): (Vec<f64>, Vec<Node>) = keyframes.into_iter().unzip();
    let track = Track::new(&at, &nodes, law).map_err(|fault| fault.path(path))?;
    Ok((track, at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language::yaml_writer::one_line;
    use crate::yaml::parse;
    use spectra_core::params::SourceFile;

    fn animation(text: &str) -> Result<Animation, String> {
        let root = parse(SourceFile::new("t.yaml", text)).unwrap_or_else(|faults| panic!("{faults}\n{text}"));
        let variables = Variables::of(root.get("variables")).expect("variables");
        Animation::read(root.get(ANIMATION).expect("an animation"), &variables).map_err(|faults| faults.to_string())
    }

    fn at(animation: &Animation, frame: u32) -> String {
        let words = animation
            .setting(frame)
            .iter()
            .map(|(path, node)| format!("{path}={}", one_line(node)))
            .collect::<Vec<_>>();
        words.join(" ")
    }

    #[test]
    fn values_lie_between_keyframes_whatever_their_order() {
        let text = "variables: {near: 50 cm}\nanimation:\n  frames: 5\n  first: 0\n  animate:\n    lens.focus: {4: $near, 0: inf, interpolation: reciprocal}\n    a: {2: x, 1: y, interpolation: hold}\n    b: {1: 5}\n";
        let found = animation(text).expect("good");
        assert_eq!((found.first, found.frames, found.rate, found.is_alive), (0, 5, 24.0, true));
        let all: Vec<String> = (0..5).map(|frame| at(&found, frame)).collect();
        assert_eq!(
            all,
            [
                "lens.focus=inf a=y b=5",
                "lens.focus=200 cm a=y b=5",
                "lens.focus=100 cm a=x b=5",
                "lens.focus=66.66666666666667 cm a=x b=5",
                "lens.focus=50 cm a=x b=5",
            ]
        );
        assert!(found.warnings.is_empty());
    }

    #[test]
    fn keyframes_beyond_the_frames_are_warned_of() {
        let found = animation("animation: {frames: 48, seed: fixed, animate: {a: {1: 1, 480: 2}}}").expect("good");
        assert!(!found.is_alive);
        assert_eq!(found.warnings[0].to_string(), "t.yaml:1:51: keyframe 480 of `a` is outside the frames 1 to 48");
    }

    #[test]
    fn what_is_wrong_is_told_at_its_place() {
        for (text, said) in [
            ("{}", "missing key `frames`"),
            ("{frames: 0}", "t.yaml:1:21: found 0, which is out of range (a whole number from 1 to 10000)"),
            ("{frames: 1e12}", "found 1e12, which is out of range"),
            ("{frames: 2.5}", "found the number 2.5, expected a whole number"),
            ("{frames: 2, first: -1}", "found -1, which is out of range (a whole number from 0"),
            ("{frames: 2, rate: 0}", "found 0, which is out of range"),
            ("{frames: 2, seed: 3}", "unknown value `3` for `seed`"),
            ("{frames: 2, animate: [1]}", "`animate` must be a map"),
            ("{frames: 2, animate: {a: 3}}", "keyframes must be a map"),
            ("{frames: 2, animate: {a: {}}}", "there is no keyframe"),
            ("{frames: 2, animate: {a: {x: 3}}}", "t.yaml:1:38: `x` is not a frame number"),
            ("{frames: 2, animate: {a: {1: 3, 01: 4}}}", "frame 1 comes twice"),
            (
                "{frames: 2, animate: {a: {1: 3, interpolation: linar}}}",
                "unknown value `linar` for `interpolation` (did you mean `linear`?",
            ),
            ("{frames: 2, animate: {a: {1: x, 2: y}}}", "the text `x` cannot be interpolated"),
            ("{frames: 2, animate: {a: {1: 2 m, 2: 1 s}}}", "`1 s` and `2 m` are of different kinds"),
            ("{frames: 2, animate: {sweep.a: {1: 2 m}}}", "`sweep` cannot change from picture to picture"),
            ("{frames: 2, animate: {a: {1: $q}}}", "no variable is called `q`"),
        ] {
            let error = animation(&format!("animation: {text}\n")).map(|_| ()).expect_err(said);
            assert!(error.contains(said), "{error}");
        }
    }
}

//! A control of the page: its kind, its value, and the text that it sets in the scene.

use crate::declared::TILES;
use serde_json::{Value, json};

/// The kind of a control's value, and how it is written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Kind {
    /// A number from `least` to `most`, with a text before it and a unit behind it.
    Number { before: &'static str, unit: String, least: Option<f64>, most: Option<f64>, whole: bool },
    /// A list of two numbers with the same unit and range.
    Pair { unit: String, least: Option<f64>, most: Option<f64> },
    /// One of these words.
    Choice(Vec<String>),
    /// A value that is true or false.
    Switch,
}

/// A control of the page: one value of the scene that can be changed.
#[derive(Clone, Debug)]
pub(crate) struct Control {
    pub(crate) path: String,
    pub(crate) kind: Kind,
    /// Value in the scene; null if the scene leaves it out.
    pub(crate) value: Value,
    pub(crate) help: String,
    /// Whether the control is shown at once, because the scene sets it or most people look for it.
    pub(crate) is_in_front: bool,
    /// Text before and behind the number, if the number alone is not the value.
    pub(crate) within: Option<[&'static str; 2]>,
    /// Whether the control selects a picture of a sweep, or a frame of an animation, and changes none of them.
    pub(crate) picks: bool,
    /// Reason why the control cannot be changed; `None` if it can.
    pub(crate) fixed: Option<String>,
    /// Start of the control's scale, if it differs from the range: a lens cannot be opened beyond its own f-number.
    pub(crate) from: Option<f64>,
}

/// Describes a range in words, for a message.
fn range_said(least: Option<f64>, most: Option<f64>, unit: &str) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    match (least, most) {
        (Some(least), Some(most)) => format!("it goes from {least} to {most}{unit}"),
        (Some(least), None) => format!("it is at least {least}{unit}"),
        (None, Some(most)) => format!("it is at most {most}{unit}"),
        (None, None) => "any number".to_owned(),
    }
}

impl Control {
    /// Path of the control's value in the scene.
    pub(crate) fn path(&self) -> &str {
        &self.path
    }

    /// Unit of the control's numbers; empty if they have none.
    fn unit(&self) -> &str {
        match &self.kind {
            Kind::Number { unit, .. } | Kind::Pair { unit, .. } => unit,
            Kind::Choice(_) | Kind::Switch => "",
        }
    }

    /// Returns the control as JSON for the page.
    pub(crate) fn to_json(&self) -> Value {
        let kind = match &self.kind {
            Kind::Number { before, unit, least, most, whole } => {
                json!({"is": "number", "before": before, "unit": unit, "least": least, "most": most, "whole": whole})
            }
            Kind::Pair { unit, least, most } => json!({"is": "pair", "unit": unit, "least": least, "most": most}),
            Kind::Choice(words) if self.path == "film.stock" && !self.picks => {
                json!({"is": "choice", "words": words, "tiles": *TILES})
            }
            Kind::Choice(words) => json!({"is": "choice", "words": words}),
            Kind::Switch => json!({"is": "switch"}),
        };
        json!({
            "path": self.path,
            "kind": kind,
            "value": self.value,
            "help": self.help,
            "front": self.is_in_front,
            "fixed": self.fixed,
            "from": self.from,
        })
    }

    /// Returns the word for `value` that selects a picture of the series; `None` if the control selects none.
    pub(crate) fn picked(&self, value: &Value) -> Option<String> {
        let word = || value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        self.picks.then(word)
    }

    /// Returns the text `path=value` for a value that a page sent.
    ///
    /// # Errors
    /// The reason why this control cannot have the value.
    pub(crate) fn text(&self, value: &Value) -> Result<String, String> {
        if let Some(why) = &self.fixed {
            return Err(why.clone());
        }
        let bounded = |value: &Value, least: Option<f64>, most: Option<f64>| match value.as_f64() {
            Some(number) if !number.is_finite() => Err("not a finite number".to_owned()),
            Some(number) if least.is_some_and(|least| number < least) || most.is_some_and(|most| number > most) => {
                Err(format!("{number} is out of range: {}", range_said(least, most, self.unit())))
            }
            Some(number) => Ok(number),
            None => Err("not a number".to_owned()),
        };
        let with_unit = |unit: &str| if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let written = match &self.kind {
            Kind::Number { before, unit, least, most, whole } => {
                let number = bounded(value, *least, *most)?;
                if *whole && number.fract() != 0.0 {
                    return Err("not a whole number".to_owned());
                }
                format!("{before}{number}{}", with_unit(unit))
            }
            Kind::Pair { unit, least, most } => match value.as_array().map(Vec::as_slice) {
                Some([a, b]) => {
                    let (a, b, unit) = (bounded(a, *least, *most)?, bounded(b, *least, *most)?, with_unit(unit));
                    format!("[{a}{unit}, {b}{unit}]")
                }
                _ => return Err("not two numbers".to_owned()),
            },
            Kind::Choice(words) => match value.as_str() {
                Some(word) if words.iter().any(|known| known == word) => word.to_owned(),
                _ => return Err("not one of the choices".to_owned()),
            },
            Kind::Switch => value.as_bool().ok_or("neither true nor false")?.to_string(),
        };
        let [before, behind] = self.within.unwrap_or(["", ""]);
        Ok(format!("{}={before}{written}{behind}", self.path))
    }
}

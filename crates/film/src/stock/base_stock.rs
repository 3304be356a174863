//! Stocks that are based on another one, except for what their file states: `like: kodak-tri-x-400`.
//!
//! Keys of the file take precedence over those of the other stock. In `layers`, a layer of the same name is changed key by key, and one of
//! a new name is added.
//! `name`, `maker` and `year` are not inherited. `source` says from what the stock was made, unless the file states it.

use spectra_core::params::{Fault, Faults, Key, Node, Params, Value};
use spectra_core::resources::{Resources, beside};

/// Longest chain of stocks that are based on each other.
const DEEPEST: usize = 8;

/// Returns the complete stock of a file, including what it takes from the one that it is based on.
pub(super) fn inherited(params: &Params, resources: &dyn Resources) -> Result<Params, Faults> {
    follow(params, resources, DEEPEST)
}

fn follow(params: &Params, resources: &dyn Resources, left: usize) -> Result<Params, Faults> {
    let Some(like) = params.get("like") else { return Ok(params.clone()) };
    let Some(name) = like.as_str() else {
        return Err(like
            .fault("the name of a stock is expected here")
            .path("like")
            .hint("`like: kodak-tri-x-400`")
            .into());
    };
    if left == 0 {
        let fault =
            like.fault(format!("more than {DEEPEST} stocks build on each other by `like`, or one builds on itself"));
        return Err(fault.path("like").into());
    }
    let mut faults = Faults::new();
    if params.get("name").is_none() {
        faults.push(params.fault_here("the stock needs a name of its own").hint(format!("`name: {name}, my way`")));
    }
    let other = resources.document(&beside(like, name), &[super::FOLDER], &[".yaml", ".yml"]);
    let other = faults.take(other.map_err(|faults| params.place_at("like", faults)));
    let other = other.and_then(|other| faults.take(follow(&other, resources, left - 1)));
    faults.extend(other.iter().flat_map(|other| strange_layers(params, other, name)));
    let Some(other) = faults.into_result(other)? else { return Err(Faults::new()) };
    Params::section(merged(params.node(), other.node()), params.path())
}

/// Merges two maps: `own`, and the keys that only `other` has.
fn merged(own: &Node, other: &Node) -> Node {
    let (Value::Map(mine), Value::Map(theirs)) = (&own.value, &other.value) else { return own.clone() };
    let mut entries: Vec<(Key, Node)> = Vec::new();
    for (key, value) in theirs {
        let value = match (key.text.as_str(), own.get(&key.text)) {
            ("source", None) => made_from(own, value),
            // Maker and year of the other stock do not apply to this one.
            ("maker" | "year", None) => continue,
            (_, None) => value.clone(),
            ("layers", Some(layers)) => layers_of(layers, value),
            (_, Some(stated)) => stated.clone(),
        };
        entries.push((key.clone(), value));
    }
    let new = mine.iter().filter(|(key, _)| key.text != "like" && other.get(&key.text).is_none());
    entries.extend(new.cloned());
    Node { value: Value::Map(entries), ..own.clone() }
}

/// Faults for incomplete layers that the other stock does not have: their names are probably misspelled.
fn strange_layers(own: &Params, other: &Params, like: &str) -> Vec<Fault> {
    let layers = |of: &Params| match of.get("layers").map(|node| node.value.clone()) {
        Some(Value::Seq(layers)) => layers,
        _ => Vec::new(),
    };
    let name = |layer: &Node| layer.get("name").and_then(Node::as_str).map(str::to_owned);
    let known: Vec<String> = layers(other).iter().filter_map(name).collect();
    let strange = |(i, layer): (usize, &Node)| {
        let name = name(layer).filter(|name| !known.contains(name))?;
        let is_whole = ["sensitivity", "curves"].iter().all(|key| layer.get(key).is_some());
        (!is_whole).then(|| {
            let fault = own.fault(&format!("layers[{i}].name"), format!("`{like}` has no layer `{name}`"));
            let s = if known.len() == 1 { "its layer is" } else { "its layers are" };
            fault.hint(format!("{s} `{}`; a new layer needs `sensitivity` and `curves`", known.join("`, `")))
        })
    };
    layers(own).iter().enumerate().filter_map(strange).collect()
}

/// Source of the figures, with a list of the changed ones.
fn made_from(own: &Node, source: &Node) -> Node {
    let Value::Map(mine) = &own.value else { return source.clone() };
    let changed = mine.iter().map(|(key, _)| key.text.as_str());
    let changed: Vec<&str> = changed.filter(|key| !["like", "name", "spectra", "remark"].contains(key)).collect();
    let Some(text) = source.as_str() else { return source.clone() };
    let text = if changed.is_empty() { text.to_owned() } else { format!("{text}; changed: {}", changed.join(", ")) };
    Node { value: Value::String(text), ..source.clone() }
}

/// Layers of the other stock, changed by those of the same name, followed by the new ones.
fn layers_of(own: &Node, other: &Node) -> Node {
    let (Value::Seq(mine), Value::Seq(theirs)) = (&own.value, &other.value) else { return own.clone() };
    let name = |node: &Node| node.get("name").and_then(Node::as_str).map(str::to_owned);
    let same = |layer: &Node, of: &[Node]| of.iter().find(|n| name(n).is_some() && name(n) == name(layer)).cloned();
    let changed = |layer: &Node| same(layer, mine).map_or_else(|| layer.clone(), |new| merged(&new, layer));
    let mut layers: Vec<Node> = theirs.iter().map(changed).collect();
    layers.extend(mine.iter().filter(|layer| same(layer, theirs).is_none()).cloned());
    Node { value: Value::Seq(layers), ..own.clone() }
}

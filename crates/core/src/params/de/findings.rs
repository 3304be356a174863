//! What is remembered from walk to walk.

use super::super::fault::{Fault, Faults};
use super::super::node::{Key, Node, Value};
use super::super::path::{Step, joined};
use super::super::text::{hint_for, nearest, shown};
use super::error::{Cause, NodeError};
use super::placeholder::LEVELS;
use std::cell::{Cell, RefCell};
use std::collections::{HashMap, HashSet};

/// Most faults that one map reports.
const MOST_FAULTS: usize = 100;
/// Most nodes that are visited, over all walks: a hostile file ends in a second.
const MOST_VISITS: usize = 10_000_000;

/// How a failed or missing value is replaced on the next walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standin {
    /// By a placeholder of this form.
    Placeholder(usize),
    /// It is left out: no placeholder went through.
    Left,
}

impl Standin {
    const FIRST: Self = Self::Placeholder(0);

    fn next(self) -> Self {
        match self {
            Self::Placeholder(level) if level + 1 < LEVELS => Self::Placeholder(level + 1),
            _ => Self::Left,
        }
    }
}

/// What a key that cannot be one was meant to be: a decimal comma within braces, an `=` in place of the colon.
fn slip(key: &Key, value: &Node, fields: &[&'static str]) -> Option<String> {
    if !matches!(value.value, Value::Null) {
        return None;
    }
    if let Some((name, given)) = key.text.split_once('=')
        && let Some(near) = nearest(name.trim(), fields.iter().copied())
    {
        return Some(format!("write `{near}: {}`, with a colon", shown(given.trim())));
    }
    let is_fraction = key.text.starts_with(|c: char| c.is_ascii_digit());
    is_fraction.then(|| "is this a decimal comma? Write a decimal point: the comma ends a value".to_owned())
}

/// Address of a node. Nodes are borrowed for all walks, so it names a node.
pub(super) fn address(node: &Node) -> usize {
    std::ptr::from_ref(node) as usize
}

/// What is remembered from walk to walk.
pub(super) struct Findings<'n> {
    root: &'n Node,
    prefix: &'n str,
    faults: RefCell<Vec<Fault>>,
    visits: Cell<usize>,
    /// Whether the walks ended before all faults were found.
    cut: Cell<bool>,
    /// Values that failed, by address.
    failed: RefCell<HashMap<usize, Standin>>,
    /// Missing keys, by address of the map.
    missing: RefCell<HashMap<usize, Vec<(&'static str, Standin)>>>,
    /// Nodes with a stand-in somewhere inside: what they say of themselves is not to be trusted.
    tainted: RefCell<HashSet<usize>>,
    /// Unknown keys that were reported, by address of their value.
    unknown: RefCell<HashSet<usize>>,
}

impl<'n> Findings<'n> {
    pub(super) fn new(root: &'n Node, prefix: &'n str) -> Self {
        Self {
            root,
            prefix,
            faults: RefCell::default(),
            visits: Cell::new(0),
            cut: Cell::new(false),
            failed: RefCell::default(),
            missing: RefCell::default(),
            tainted: RefCell::default(),
            unknown: RefCell::default(),
        }
    }

    pub(super) fn prefix(&self) -> &'n str {
        self.prefix
    }

    /// Counts a node.
    pub(super) fn visit(&self) {
        self.visits.set(self.visits.get() + 1);
    }

    /// What stands for a node, if it failed.
    pub(super) fn standin(&self, node: &Node) -> Option<Standin> {
        let failed = self.failed.borrow();
        if failed.is_empty() { None } else { failed.get(&address(node)).copied() }
    }

    /// The missing keys of a map that get a placeholder, with its form.
    pub(super) fn missing_of(&self, map: &Node) -> Vec<(&'static str, usize)> {
        let missing = self.missing.borrow();
        let Some(keys) = missing.get(&address(map)) else { return Vec::new() };
        let placeholder = |&(key, standin)| match standin {
            Standin::Placeholder(level) => Some((key, level)),
            Standin::Left => None,
        };
        keys.iter().filter_map(placeholder).collect()
    }

    /// Whether a key is in `fields`; reports it the first time if it is not. A field that it was
    /// meant for is then not reported as missing.
    pub(super) fn is_known(
        &self,
        map: &Node,
        map_path: &dyn Fn() -> String,
        entry: &(Key, Node),
        fields: &[&'static str],
    ) -> bool {
        let (key, value) = entry;
        if fields.contains(&key.text.as_str()) {
            return true;
        }
        if self.unknown.borrow_mut().insert(address(value)) {
            let free: Vec<&'static str> = fields.iter().copied().filter(|field| map.get(field).is_none()).collect();
            let hint = match nearest(&key.text, free.iter().copied()) {
                Some(near) => {
                    let mut missing = self.missing.borrow_mut();
                    let keys = missing.entry(address(map)).or_default();
                    if keys.iter().all(|(key, _)| *key != near) {
                        keys.push((near, Standin::FIRST));
                    }
                    self.tainted.borrow_mut().insert(address(map));
                    format!("did you mean `{near}`?")
                }
                None => hint_for(&key.text, "key", fields),
            };
            let hint = slip(key, value, fields).unwrap_or(hint);
            let fault = Fault::new(format!("unknown key `{}`", shown(&key.text)))
                .at(std::sync::Arc::clone(&value.file), key.span)
                .path(joined(&map_path(), Step::Key(&key.text)))
                .hint(hint);
            self.report(fault);
        }
        false
    }

    fn report(&self, fault: Fault) {
        let mut faults = self.faults.borrow_mut();
        if faults.len() < MOST_FAULTS {
            faults.push(fault);
        } else if faults.len() == MOST_FAULTS {
            faults.push(self.root.fault(format!("more than {MOST_FAULTS} faults; the others are not shown")));
        }
    }

    /// Remembers what an error says; false if another walk would not find more.
    pub(super) fn absorb(&self, error: NodeError) -> bool {
        let (cause, culprit) = error.into_parts();
        let place = culprit.and_then(|culprit| Some((self.node_at(&culprit.chain)?, culprit)));
        let Some((node, culprit)) = place else {
            // Not from this walk: said at the whole rather than not at all.
            if let Cause::Text(message, hint) = cause {
                self.report(Fault { hint, ..self.root.fault(message).path(self.prefix) });
            }
            return false;
        };
        let at = culprit.chain[0];
        match cause {
            Cause::Text(message, hint) => {
                if !self.failed.borrow().contains_key(&at) && !self.tainted.borrow().contains(&at) {
                    self.report(Fault { hint, ..node.fault(message).path(culprit.path) });
                }
                if !self.replace(&culprit.chain) {
                    return false;
                }
            }
            Cause::Placeholder => {
                if !self.replace(&culprit.chain) {
                    return false;
                }
            }
            Cause::Missing(key) => {
                let known =
                    self.missing.borrow().get(&at).and_then(|keys| keys.iter().find(|(k, _)| *k == key).copied());
                // Present but left out: it has been reported, and no placeholder went through.
                let given_up = node.get(key).is_some() || known.is_some_and(|(_, standin)| standin == Standin::Left);
                if given_up {
                    if !self.replace(&culprit.chain) {
                        return false;
                    }
                } else {
                    if known.is_none() {
                        let fault = node.fault(format!("missing key `{key}`")).hint(format!("add `{key}: ...`"));
                        self.report(fault.path(joined(&culprit.path, Step::Key(key))));
                    }
                    let mut missing = self.missing.borrow_mut();
                    let keys = missing.entry(at).or_default();
                    match keys.iter_mut().find(|(k, _)| *k == key) {
                        Some((_, standin)) => *standin = standin.next(),
                        None => keys.push((key, Standin::FIRST)),
                    }
                    self.tainted.borrow_mut().extend(&culprit.chain);
                }
            }
        }
        if self.visits.get() >= MOST_VISITS && self.faults.borrow().len() <= MOST_FAULTS {
            self.cut.set(true);
        }
        self.faults.borrow().len() <= MOST_FAULTS && !self.cut.get()
    }

    /// Gives a node its next stand-in; where it has none left, the node around it. False at the root.
    fn replace(&self, chain: &[usize]) -> bool {
        for (i, &at) in chain.iter().enumerate() {
            if i + 1 == chain.len() {
                return false;
            }
            let mut failed = self.failed.borrow_mut();
            let standin = failed.get(&at).copied();
            if standin != Some(Standin::Left) {
                failed.insert(at, standin.map_or(Standin::FIRST, Standin::next));
                self.tainted.borrow_mut().extend(&chain[i + 1..]);
                return true;
            }
        }
        false
    }

    /// The node that a chain of addresses leads to.
    fn node_at(&self, chain: &[usize]) -> Option<&'n Node> {
        let (&last, rest) = chain.split_last()?;
        if last != address(self.root) {
            return None;
        }
        rest.iter().rev().try_fold(self.root, |node, &wanted| match &node.value {
            Value::Seq(elements) => elements.iter().find(|element| address(element) == wanted),
            Value::Map(entries) => entries.iter().map(|(_, value)| value).find(|value| address(value) == wanted),
            _ => None,
        })
    }

    /// The faults in the order of the file.
    pub(super) fn finish(self) -> Faults {
        let mut faults = self.faults.into_inner();
        let last = if faults.len() > MOST_FAULTS {
            faults.pop()
        } else if self.cut.get() {
            Some(self.root.fault("the file is large, so the search for faults stops here; there may be more"))
        } else {
            None
        };
        faults.sort_by_key(|fault| fault.place.as_ref().map_or(0, |(_, span)| span.offset));
        faults.extend(last);
        Faults(faults)
    }
}

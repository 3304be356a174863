//! Builds nodes from the items in flat storage, and expands aliases within the limits.

use super::items::{Item, SpannedItem};
use super::reports::{FatalFault, Reports, fault, too_deep, too_many, written};
use super::{MAX_DEPTH, MAX_NODES};
use spectra_core::params::{Fault, Faults, Key, Node, SourceFile, Span, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// Builds the tree below `root`. An empty file gives a null at `start`.
pub(super) fn grow(
    file: &Arc<SourceFile>,
    items: &[SpannedItem],
    root: Option<usize>,
    start: Span,
    reports: Reports,
) -> Result<Node, Faults> {
    let Some(root) = root else { return Ok(Node::new(Value::Null, start, Arc::clone(file))) };
    let mut tree = Tree { file, items, reports, count: 0 };
    match tree.node(root, None, 0) {
        Ok(node) if tree.reports.is_empty() => Ok(node),
        Ok(_) => Err(tree.reports.into_faults()),
        Err(fault) => Err(tree.reports.and(*fault)),
    }
}

struct Tree<'a> {
    file: &'a Arc<SourceFile>,
    items: &'a [SpannedItem],
    reports: Reports,
    count: usize,
}

impl Tree<'_> {
    /// Builds the node of an item with `depth` lists and maps around it. `seat` is the place of its key, used
    /// for a missing value. The recursion is bounded by the depth.
    fn node(&mut self, index: usize, seat: Option<Span>, depth: usize) -> Result<Node, FatalFault> {
        let &SpannedItem { ref item, mut span } = &self.items[index];
        if let Item::Alias(target) = item {
            // The only new fault possible there is the size, which the alias causes; so the alias is its place.
            let here = |stop: FatalFault| Box::new(Fault { place: Some((Arc::clone(self.file), span)), ..*stop });
            return self.node(self.unalias(*target), None, depth).map_err(here);
        }
        self.count += 1;
        if self.count > MAX_NODES {
            return Err(too_many(self.file, span));
        }
        if depth >= MAX_DEPTH && !matches!(item, Item::Scalar(_)) {
            return Err(too_deep(self.file, span));
        }
        let value = match item {
            Item::Scalar(value) => {
                if span.len == 0 {
                    span = seat.unwrap_or(span);
                }
                value.clone()
            }
            Item::Seq(elements) => {
                let mut nodes = Vec::with_capacity(elements.len());
                for &element in elements {
                    nodes.push(self.node(element, None, depth + 1)?);
                }
                Value::Seq(nodes)
            }
            Item::Map(entries) => Value::Map(self.map(entries, depth)?),
            Item::Alias(_) => Value::Null,
        };
        Ok(Node::new(value, span, Arc::clone(self.file)))
    }

    fn map(&mut self, entries: &[(usize, usize)], depth: usize) -> Result<Vec<(Key, Node)>, FatalFault> {
        let mut nodes = Vec::with_capacity(entries.len());
        let mut seen: HashMap<String, usize> = HashMap::with_capacity(entries.len());
        for &(key, value) in entries {
            let span = self.items[key].span;
            let text = self.key(key);
            let node = self.node(value, Some(span), depth + 1)?;
            let Some(text) = text else { continue };
            if let Some(apart) = self.joined(key, value) {
                self.report(span, "`:` without a space after it".to_owned(), &format!("write `{apart}`"));
                continue;
            }
            if let Some(first) = seen.get(&text) {
                let hint = format!("remove one of them: the first is on line {first}");
                self.report(span, format!("the key `{}` appears twice", written(self.file, span)), &hint);
            } else {
                seen.insert(text.clone(), span.line);
                nodes.push((Key { text, span }, node));
            }
        }
        Ok(nodes)
    }

    /// Returns the text of a key, or reports a fault and returns `None` if it is not a valid key.
    fn key(&mut self, index: usize) -> Option<String> {
        let span = self.items[index].span;
        let item = &self.items[self.unalias(index)].item;
        let quoted = matches!(self.file.text.as_bytes().get(span.offset), Some(b'"' | b'\''));
        match item {
            Item::Scalar(Value::String(text)) if text == "<<" && !quoted => {
                self.report(span, "merge keys are not known here".to_owned(), "write the keys out");
                None
            }
            Item::Scalar(Value::String(text)) => Some(text.clone()),
            Item::Scalar(Value::Number(number)) => Some(number.text.clone()),
            Item::Scalar(Value::Bool(value)) => Some(value.to_string()),
            Item::Scalar(_) if span.len > 0 => Some(written(self.file, span)),
            Item::Scalar(_) => {
                self.report(span, "a key is missing before `:`".to_owned(), "write `key: value`");
                None
            }
            Item::Seq(_) | Item::Map(_) | Item::Alias(_) => {
                self.report(span, "a key must be a text, not a list or a map".to_owned(), "write `key: value`");
                None
            }
        }
    }

    /// Returns the correction of a key and value written without a space: to YAML, `{order:0}` has a key `order:0` without a value.
    fn joined(&self, key: usize, value: usize) -> Option<String> {
        let span = self.items[key].span;
        let is_empty = self.items[value].span.len == 0 && matches!(self.items[value].item, Item::Scalar(Value::Null));
        let text = self.file.text.get(span.offset..span.offset + span.len).filter(|_| is_empty)?;
        let (name, given) = text.split_once(':')?;
        let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c));
        let is_slip = is_name && !given.is_empty() && !given.starts_with(['/', '\\', ' ']);
        is_slip.then(|| format!("{name}: {given}"))
    }

    /// Resolves an alias, which may refer to another alias, to the index of its item.
    fn unalias(&self, mut index: usize) -> usize {
        // An alias refers only to an item before it, so this loop ends.
        while let Item::Alias(target) = self.items[index].item {
            index = target;
        }
        index
    }

    fn report(&mut self, span: Span, message: String, hint: &str) {
        self.reports.push(*fault(self.file, span, message, Some(hint)));
    }
}

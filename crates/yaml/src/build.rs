//! Collects the events of the parser as items in flat storage.
//!
//! Events go into flat storage first, without recursion and without copies, so that an alias costs
//! nothing until it is expanded. [`tree`] then builds nodes from the items.

use super::items::{Item, SpannedItem};
use super::mistakes;
use super::reports::{FatalFault, Reports, fault, too_deep, too_many, written};
use super::tree;
use super::{MAX_DEPTH, MAX_NODES};
use serde_saphyr::granit_parser::{Event, Marker, Parser, ScalarStyle, Span as Range, options};
use spectra_core::params::{Faults, Node, SourceFile, Span, Value};
use std::collections::HashMap;
use std::sync::Arc;

/// A list or map that is still open.
struct OpenCollection {
    index: usize,
    /// Key of a map whose value comes next.
    key: Option<usize>,
}

/// Parses the document of a file from `start` on, which is on the first line.
pub(super) fn document(file: &Arc<SourceFile>, start: Span) -> Result<Node, Faults> {
    let text = file.text.get(start.offset..).unwrap_or("");
    let mut builder = Builder {
        file,
        text,
        start,
        items: Vec::new(),
        open: Vec::new(),
        anchors: HashMap::new(),
        root: None,
        reports: Reports::default(),
    };
    let complete = builder.read();
    let Builder { items, root, reports, .. } = builder;
    if let Err(fault) = complete {
        return Err(reports.and(*fault));
    }
    tree::grow(file, &items, root, Span { len: 0, ..start }, reports)
}

struct Builder<'a> {
    file: &'a Arc<SourceFile>,
    text: &'a str,
    start: Span,
    items: Vec<SpannedItem>,
    open: Vec<OpenCollection>,
    anchors: HashMap<usize, usize>,
    root: Option<usize>,
    reports: Reports,
}

impl Builder<'_> {
    fn read(&mut self) -> Result<(), FatalFault> {
        let options = options! {
            emit_comments: false,
            disallow_directives: true,
            flow_nesting_limit: MAX_DEPTH,
            block_nesting_limit: MAX_DEPTH,
        };
        for event in Parser::new_from_str_with_options(self.text, options) {
            let (event, range) = event.map_err(|error| {
                let place = self.point(*error.marker());
                let bracket = |open: &OpenCollection| {
                    self.file.text[self.items[open.index].span.offset..].starts_with(['{', '['])
                };
                let open = self.open.iter().find(|open| bracket(open)).map(|open| self.items[open.index].span);
                let slip = mistakes::find_mistake(error.kind(), self.file, place, open);
                fault(self.file, slip.place, slip.message, slip.hint.as_deref())
            })?;
            self.event(event, range)?;
        }
        Ok(())
    }

    fn event(&mut self, event: Event<'_>, range: Range) -> Result<(), FatalFault> {
        let tagged = match &event {
            Event::Scalar(.., tag) | Event::SequenceStart(.., tag) | Event::MappingStart(.., tag) => tag.is_some(),
            _ => false,
        };
        if tagged {
            let place = self.span(range.tag_span().unwrap_or(range));
            let hint = "remove it: the type follows from the key, and a text can be put in quotes";
            let message = format!("the tag `{}` is not known here", written(self.file, place));
            self.reports.push(*fault(self.file, place, message, Some(hint)));
        }
        match event {
            Event::DocumentStart(..) if self.root.is_some() => {
                let place = self.span(range);
                return Err(fault(
                    self.file,
                    place,
                    "a second document in one file",
                    Some("one document per file: remove `---`"),
                ));
            }
            Event::Scalar(text, style, anchor, _) => {
                let value = match style {
                    ScalarStyle::Plain => Value::from_plain(&text),
                    _ => Value::String(text.into_owned()),
                };
                let index = self.add(Item::Scalar(value), range, anchor)?;
                self.attach(index);
            }
            Event::SequenceStart(_, anchor, _) => self.begin(Item::Seq(Vec::new()), range, anchor)?,
            Event::MappingStart(_, anchor, _) => self.begin(Item::Map(Vec::new()), range, anchor)?,
            Event::SequenceEnd | Event::MappingEnd => {
                if let Some(open) = self.open.pop() {
                    self.close(open.index, range);
                    self.attach(open.index);
                }
            }
            Event::Alias(anchor) => {
                let target = self.anchors.get(&anchor).copied();
                let within = self.open.iter().any(|open| Some(open.index) == target);
                let Some(target) = target.filter(|_| !within) else {
                    let place = self.span(range);
                    return Err(fault(
                        self.file,
                        place,
                        "this alias is inside the value that it refers to",
                        Some("write the values out"),
                    ));
                };
                let index = self.add(Item::Alias(target), range, 0)?;
                self.attach(index);
            }
            _ => {}
        }
        Ok(())
    }

    fn begin(&mut self, item: Item, range: Range, anchor: usize) -> Result<(), FatalFault> {
        let index = self.add(item, range, anchor)?;
        if self.open.len() >= MAX_DEPTH {
            return Err(too_deep(self.file, self.items[index].span));
        }
        self.open.push(OpenCollection { index, key: None });
        Ok(())
    }

    fn add(&mut self, item: Item, range: Range, anchor: usize) -> Result<usize, FatalFault> {
        let span = self.span(range);
        let index = self.items.len();
        // Keys are items too, so up to twice the limit is allowed here. The values are counted exactly later.
        if index >= 2 * MAX_NODES {
            return Err(too_many(self.file, span));
        }
        if anchor != 0 {
            self.anchors.insert(anchor, index);
        }
        self.items.push(SpannedItem { item, span });
        Ok(index)
    }

    /// Sets the end of a list or map: its closing bracket, or the end of its last entry.
    fn close(&mut self, index: usize, range: Range) {
        let last = match &self.items[index].item {
            Item::Seq(elements) => elements.last(),
            Item::Map(entries) => {
                entries.last().map(|(key, value)| if self.items[*value].span.len > 0 { value } else { key })
            }
            _ => None,
        };
        let end_of = |span: Span| span.offset + span.len;
        let bracket = self.span(range);
        let end = if bracket.len > 0 {
            end_of(bracket)
        } else {
            last.map_or(bracket.offset, |&last| end_of(self.items[last].span))
        };
        let is_list = matches!(self.items[index].item, Item::Seq(_));
        let span = &mut self.items[index].span;
        // The parser reports a list that is not indented below its key from its first entry on, without the dash.
        let offset = span.offset - self.start.offset;
        if is_list && !self.text[offset..].starts_with(['-', '[']) {
            let line = self.text[..offset].rfind('\n').map_or(0, |newline| newline + 1);
            let indent = self.text[line..offset].bytes().take_while(|&byte| byte == b' ').count();
            if self.text[line + indent..offset].starts_with('-') {
                *span = Span { column: 1 + indent, offset: self.start.offset + line + indent, ..*span };
            }
        }
        span.len = end.saturating_sub(span.offset);
    }

    /// Adds a finished item to the list or map that is open around it, or makes it the root.
    fn attach(&mut self, index: usize) {
        let Some(open) = self.open.last_mut() else {
            self.root = Some(index);
            return;
        };
        match &mut self.items[open.index].item {
            Item::Seq(elements) => elements.push(index),
            Item::Map(entries) => match open.key.take() {
                None => open.key = Some(index),
                Some(key) => entries.push((key, index)),
            },
            Item::Scalar(_) | Item::Alias(_) => {}
        }
    }

    fn point(&self, marker: Marker) -> Span {
        self.span(Range::empty(marker))
    }

    /// Converts a range of the parser to a place in the file.
    fn span(&self, range: Range) -> Span {
        let offset = range.start.byte_offset().unwrap_or(0).min(self.text.len());
        let end = range.end.byte_offset().unwrap_or(offset).min(self.text.len());
        // The parser counts lines from 1 and columns from 0. If the text starts inside a line, the columns of its first line are shifted.
        let shift = if range.start.line() <= 1 { self.start.column } else { 1 };
        Span {
            line: range.start.line().max(1) + self.start.line - 1,
            column: range.start.col() + shift,
            offset: self.start.offset + offset,
            len: end.saturating_sub(offset),
        }
    }
}

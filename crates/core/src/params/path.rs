//! Paths of keys: `film.exposure`, `surfaces[3].radius`.

use super::fault::Fault;
use super::node::{Key, MAX_DEPTH, Node, Value};
use super::place::Span;
use super::text::found;
use crate::names::shown;
use std::sync::Arc;

/// One step of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step<'a> {
    /// A key of a map.
    Key(&'a str),
    /// An index of a list.
    Index(usize),
}

/// Splits a path such as `surfaces[3].radius` into its steps.
///
/// # Errors
/// What is wrong with the path.
pub fn steps(path: &str) -> Result<Vec<Step<'_>>, String> {
    let mut steps = Vec::new();
    for part in path.split('.') {
        let (key, mut rest) = part.split_at(part.find('[').unwrap_or(part.len()));
        if key.is_empty() {
            return Err(format!("`{}` is not a path: a key is empty", shown(path)));
        }
        steps.push(Step::Key(key));
        while !rest.is_empty() {
            let index = rest.strip_prefix('[').and_then(|inner| inner.split_once(']'));
            let Some((index, after)) = index else {
                return Err(format!("`{}` is not a path: an index is written `[3]`", shown(path)));
            };
            let Ok(index) = index.parse() else {
                return Err(format!("`{}` is not a path: `{}` is not an index", shown(path), shown(index)));
            };
            steps.push(Step::Index(index));
            rest = after;
        }
    }
    if steps.len() > MAX_DEPTH {
        return Err(format!("the path has {} steps; at most {MAX_DEPTH} are followed", steps.len()));
    }
    Ok(steps)
}

/// Returns `path` with one more step.
pub(super) fn joined(path: &str, step: Step<'_>) -> String {
    match step {
        Step::Key(key) if path.is_empty() => shown(key),
        Step::Key(key) => format!("{path}.{}", shown(key)),
        Step::Index(index) => format!("{path}[{index}]"),
    }
}

impl Node {
    /// Returns the node at a path, if there is one; `None` also for an ill-formed path.
    #[must_use]
    pub fn at_path(&self, path: &str) -> Option<&Node> {
        steps(path).ok()?.into_iter().try_fold(self, Node::step)
    }

    fn step(&self, step: Step<'_>) -> Option<&Node> {
        match step {
            Step::Key(key) => self.get(key),
            Step::Index(index) => self.element(index),
        }
    }

    /// Follows a path as far as there are nodes.
    pub(super) fn nearest_at(&self, path: &str) -> &Node {
        let mut node = self;
        for step in steps(path).unwrap_or_default() {
            let Some(next) = node.step(step) else { break };
            node = next;
        }
        node
    }

    /// Puts a node at a path, as `--set path=value` does: replaces an existing value and creates missing maps. `[i]` must exist
    /// or be the first index after the end, which appends.
    ///
    /// # Errors
    /// The path is ill-formed, or leads through something that is neither a map nor a list; the tree is then unchanged.
    pub fn set_path(&mut self, path: &str, node: Node) -> Result<(), Fault> {
        let steps = steps(path).map_err(|message| node.fault(message))?;
        let file = Arc::clone(&node.file);
        // A key that is created points to the argument; the value behind it has its exact place.
        let whole = Span { len: file.text.find('=').unwrap_or(0), ..Span::default() };
        let made = if file.is_argument() { whole } else { node.span };
        self.put(&steps, "", made, node).map_err(|fault| {
            let hint = "a path names keys and, in brackets, entries from 0: `film.exposure`, `output[0]`";
            fault.at(file, made).path(shown(path)).hint(hint)
        })
    }

    /// Puts a node where the steps lead; `path` is the path of this node. New keys and maps get the place `made`.
    fn put(&mut self, steps: &[Step<'_>], path: &str, made: Span, node: Node) -> Result<(), Fault> {
        let Some((&step, rest)) = steps.split_first() else {
            *self = node;
            return Ok(());
        };
        let at = || if path.is_empty() { "the file".to_owned() } else { format!("`{path}`") };
        let what = found(self);
        let inner = joined(path, step);
        match (step, &mut self.value) {
            (_, Value::Null) => self.value = Self::around(node, steps, path, made)?.value,
            (Step::Key(key), Value::Map(entries)) => match entries.iter_mut().find(|(k, _)| k.text == key) {
                Some((key, value)) => {
                    value.put(rest, &inner, made, node)?;
                    if rest.is_empty() {
                        // A key has the same file as its value.
                        key.span = made;
                    }
                }
                None => {
                    let value = Self::around(node, rest, &inner, made)?;
                    entries.push((Key { text: key.to_owned(), span: made }, value));
                }
            },
            (Step::Key(key), _) => return Err(format!("{} is {what}, which has no key `{}`", at(), shown(key)).into()),
            (Step::Index(index), Value::Seq(elements)) => {
                let len = elements.len();
                match elements.get_mut(index) {
                    Some(element) => element.put(rest, &inner, made, node)?,
                    None if index == len => elements.push(Self::around(node, rest, &inner, made)?),
                    None => return Err(format!("{} has no entry {index}: it has {len}, from 0", at()).into()),
                }
            }
            (Step::Index(_), _) => return Err(format!("{} is {what}, not a list", at()).into()),
        }
        Ok(())
    }

    /// Wraps a node in the maps and lists that the steps to it need.
    fn around(node: Self, steps: &[Step<'_>], path: &str, made: Span) -> Result<Self, Fault> {
        let Some((&step, rest)) = steps.split_first() else { return Ok(node) };
        let file = Arc::clone(&node.file);
        let inner = Self::around(node, rest, &joined(path, step), made)?;
        Ok(Self::new(
            match step {
                Step::Key(key) => Value::Map(vec![(Key { text: key.to_owned(), span: made }, inner)]),
                Step::Index(0) => Value::Seq(vec![inner]),
                Step::Index(index) => return Err(format!("`{path}` has no entry {index}: it is empty").into()),
            },
            made,
            file,
        ))
    }
}

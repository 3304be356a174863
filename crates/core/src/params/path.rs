//! Paths of keys: `film.exposure`, `surfaces[3].radius`.

use super::fault::Fault;
use super::node::{Key, MAX_DEPTH, Node, Span, Value};
use super::text::{found, shown};
use std::sync::Arc;

/// One step of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step<'a> {
    /// A key of a map.
    Key(&'a str),
    /// An index of a list.
    Index(usize),
}

/// The steps of a path such as `surfaces[3].radius`.
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

/// `path` with one more step.
pub(super) fn joined(path: &str, step: Step<'_>) -> String {
    match step {
        Step::Key(key) if path.is_empty() => shown(key),
        Step::Key(key) => format!("{path}.{}", shown(key)),
        Step::Index(index) => format!("{path}[{index}]"),
    }
}

impl Node {
    /// The node at a path, if there is one; `None` also for an ill-formed path.
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
        // The key that this writes stands in the argument; the value behind it has the exact place.
        let whole = Span { len: file.text.find('=').unwrap_or(0), ..Span::default() };
        let made = if file.is_argument() { whole } else { node.span };
        self.settable(&steps).map_err(|message| {
            let hint = "a path names keys and, in brackets, entries from 0: `film.exposure`, `output[0]`";
            Fault::new(message).at(Arc::clone(&file), made).path(shown(path)).hint(hint)
        })?;
        let empty = |value| Node::new(value, made, Arc::clone(&file));
        let mut target = self;
        for (i, &step) in steps.iter().enumerate() {
            target = match step {
                Step::Key(key) => {
                    if matches!(target.value, Value::Null) {
                        target.value = Value::Map(Vec::new());
                    }
                    let Value::Map(entries) = &mut target.value else { return Ok(()) };
                    let index = match entries.iter().position(|(k, _)| k.text == key) {
                        Some(index) => index,
                        None => {
                            entries.push((Key { text: key.to_owned(), span: made }, empty(Value::Null)));
                            entries.len() - 1
                        }
                    };
                    if i + 1 == steps.len() {
                        // A key stands in the file of its value.
                        entries[index].0.span = made;
                    }
                    &mut entries[index].1
                }
                Step::Index(index) => {
                    if matches!(target.value, Value::Null) {
                        target.value = Value::Seq(Vec::new());
                    }
                    let Value::Seq(elements) = &mut target.value else { return Ok(()) };
                    if index == elements.len() {
                        elements.push(empty(Value::Null));
                    }
                    &mut elements[index]
                }
            };
        }
        *target = node;
        Ok(())
    }

    /// Whether a path can be set; if not, the text says why.
    fn settable(&self, steps: &[Step<'_>]) -> Result<(), String> {
        let mut node = Some(self);
        let mut path = String::new();
        for &step in steps {
            let at = |path: &str| if path.is_empty() { "the file".to_owned() } else { format!("`{path}`") };
            node = match (step, node.map(|n| (n, &n.value))) {
                (Step::Key(_), None | Some((_, Value::Null))) => None,
                (Step::Key(key), Some((n, Value::Map(_)))) => n.get(key),
                (Step::Key(key), Some((n, _))) => {
                    return Err(format!("{} is {}, which has no key `{}`", at(&path), found(n), shown(key)));
                }
                (Step::Index(0), None | Some((_, Value::Null))) => None,
                (Step::Index(index), None | Some((_, Value::Null))) => {
                    return Err(format!("{} has no entry {index}: it is empty", at(&path)));
                }
                (Step::Index(index), Some((n, Value::Seq(elements)))) => {
                    if index > elements.len() {
                        return Err(format!("{} has no entry {index}: it has {}, from 0", at(&path), elements.len()));
                    }
                    n.element(index)
                }
                (Step::Index(_), Some((n, _))) => return Err(format!("{} is {}, not a list", at(&path), found(n))),
            };
            path = joined(&path, step);
        }
        Ok(())
    }
}

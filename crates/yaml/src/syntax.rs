//! Translates the parser's errors to messages for people who write scenes.

use super::MAX_DEPTH;
use serde_saphyr::granit_parser::ErrorKind;

/// Whether an error is about a tab. The tab is then at or after the place that the parser names.
pub(super) fn is_tab(kind: &ErrorKind) -> bool {
    use ErrorKind as E;
    matches!(
        kind,
        E::TabInBlockIndentation
            | E::TabInIndentation
            | E::TabNotAllowed
            | E::TabInPlainScalar
            | E::TabAtBlockScalarStart
    )
}

/// Whether a text is a single word like a key, followed by a space but no `:`.
fn is_bare_key(text: &str) -> bool {
    let word = text.trim();
    text.ends_with(' ') && !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || matches!(c, '-' | '_' | '.'))
}

/// Returns the message and the hint for an error; `before` is the text of the line before the error.
pub(super) fn message(kind: &ErrorKind, before: &str) -> (String, Option<&'static str>) {
    use ErrorKind as E;
    if is_tab(kind) {
        return ("a tab where YAML wants spaces".to_owned(), Some("indent with spaces"));
    }
    let (message, hint) = match kind {
        E::RecursionLimitExceeded => return (format!("nested deeper than {MAX_DEPTH} levels"), None),
        E::UnclosedFlowCollection { open: '{' } | E::UnexpectedEofFlowMapping => ("`{` is never closed", "add `}`"),
        E::UnclosedFlowCollection { .. } | E::UnexpectedEofFlowSequence => ("`[` is never closed", "add `]`"),
        E::UnclosedQuotedScalar => ("a quote is never closed", "close it on the same line"),
        E::MisplacedFlowCollectionEnd => ("a closing bracket without its opening one", "remove it"),
        E::ExpectedFlowMappingSeparator => ("expected `,` or `}`", "separate `key: value` pairs with commas"),
        E::ExpectedFlowSequenceSeparator => ("expected `,` or `]`", "separate entries with commas"),
        E::MappingValueNotAllowed | E::InvalidColonPlacement
            if before.split_once(['{', '[']).is_some_and(|(key, _)| is_bare_key(key)) =>
        {
            ("a key without its `:` in front of the bracket", "write `key: {...}`")
        }
        E::CommentInterceptedScalar => (
            "a text that continues on the next line contains a comment",
            "if the next line is a key, it is indented too far: keys of one map start in the same column",
        ),
        E::MappingValueNotAllowed | E::InvalidColonPlacement if before.contains(": ") => {
            ("a second `: ` on one line", "put a text that holds `: ` in quotes, or write {key: value}")
        }
        E::MappingValueNotAllowed | E::InvalidColonPlacement => (
            "a `:` that does not end a key",
            "this line is read as one text with the lines above: a `:` needs a space after it; keys of one map start in the same column",
        ),
        E::MismatchedFlowCollectionEnd { open, close } => {
            return (format!("`{open}` is closed by `{close}`"), Some("close the innermost bracket first"));
        }
        E::InvalidMappingValueWhitespace => ("`:` without a space after it", "write `key: value`"),
        E::SimpleKeyExpected | E::InvalidSimpleKey => ("a key without its `:`", "write `key: value`"),
        E::ExpectedBlockMappingKey => ("expected a key here", "keys of one map start in the same column"),
        E::ExpectedBlockSequenceEntry => ("expected `- ` here", "entries of one list start in the same column"),
        E::InvalidIndentation | E::InvalidFlowScalarIndent | E::InvalidQuotedScalarIndent => {
            ("this line is indented wrongly", "keys of one map start in the same column")
        }
        E::BlockEntryInFlowCollection | E::BlockSequenceEntryNotAllowed => {
            ("`- ` cannot start an entry here", "start a list on a line of its own, or write [a, b]")
        }
        E::InvalidBlockEntryWhitespace => ("`-` without a space after it", "write `- entry`"),
        E::CommentNotSeparated => ("`#` without a space before it", "put a space before a comment"),
        E::UnexpectedCharacter { character } => {
            let hint = if matches!(character, '@' | '`' | '%' | '*' | '&' | '!' | '|' | '>') {
                Some("put the text in quotes")
            } else {
                None
            };
            return (format!("a value cannot start with `{}`", character.escape_default()), hint);
        }
        E::UnknownAnchor => {
            ("this alias refers to no anchor above it", "define it with `&name`, or put the text in quotes")
        }
        E::UnknownQuotedScalarEscape => {
            ("an unknown escape in a text with double quotes", "use single quotes, or double the backslash")
        }
        E::DirectiveDisallowed => ("YAML directives are not known here", "remove the line, or put the text in quotes"),
        E::InvalidDocumentEnd | E::ExpectedDocumentStart | E::MultipleDocumentsUnsupported => {
            ("text after the end of the document", "a file is one document; keys of one map start in the same column")
        }
        E::BomInsideDocument => ("a byte order mark inside the file", "remove it"),
        other => return (format!("not YAML: {other}"), None),
    };
    (message.to_owned(), Some(hint))
}

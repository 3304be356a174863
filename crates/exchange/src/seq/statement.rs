//! Splits the text of a file into commands.

/// A command with its values.
#[derive(Clone, Debug)]
pub(super) struct Statement<'a> {
    /// Line on which the command begins, from 1.
    pub(super) line: usize,
    /// The command, followed by its values. A quoted text is one word, with its quotes.
    pub(super) words: Vec<&'a str>,
}

/// Splits a file into its commands.
pub(super) fn split(text: &str) -> Vec<Statement<'_>> {
    let mut statements = Vec::new();
    let mut open: Option<Statement<'_>> = None;
    for (at, line) in text.lines().enumerate() {
        let mut rest = line;
        let mut goes_on = false;
        loop {
            rest = rest.trim_start();
            let Some(first) = rest.chars().next() else { break };
            match first {
                '!' => break,
                ';' => {
                    statements.extend(open.take());
                    rest = &rest[1..];
                }
                '&' => {
                    goes_on = true;
                    break;
                }
                _ => {
                    let (word, behind) = rest.split_at(end_of_word(rest));
                    rest = behind;
                    open.get_or_insert_with(|| Statement { line: at + 1, words: Vec::new() }).words.push(word);
                }
            }
        }
        if !goes_on {
            statements.extend(open.take());
        }
    }
    statements.extend(open);
    statements
}

/// Returns the end of the first word, bytes. Quotes hold a word together.
fn end_of_word(text: &str) -> usize {
    let mut quote = None;
    for (at, c) in text.char_indices() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => {}
            None if c == '\'' || c == '"' => quote = Some(c),
            None if c.is_whitespace() || matches!(c, ';' | '!' | '&') => return at,
            None => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_separators_and_continuation() {
        let text = "RDM;LEN \"a; b! c\"\n! nothing\ns -.05 &\n2 ! two\nCIR OBS L'A' 0.38; tit 'it is'\nx&";
        let found: Vec<(usize, Vec<&str>)> = split(text).into_iter().map(|s| (s.line, s.words)).collect();
        assert_eq!(
            found,
            [
                (1, vec!["RDM"]),
                (1, vec!["LEN", "\"a; b! c\""]),
                (3, vec!["s", "-.05", "2"]),
                (5, vec!["CIR", "OBS", "L'A'", "0.38"]),
                (5, vec!["tit", "'it is'"]),
                (6, vec!["x"]),
            ]
        );
    }
}

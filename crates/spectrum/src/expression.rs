//! Parses algebra of spectra in one line: `1 - wratten-25`, `(D65 + 0.5 * A) / 2`, `wratten-12^2`.
//!
//! Names can contain `-`, `/`, `.` and even spaces (`he-ne`, `spectra/illuminants/A.csv`, `5600 K`). Therefore `+ - /` are
//! operators only with spaces on both sides, or after a `)`. `*` and `^` occur in no name and need no spaces. Parentheses that
//! open within a name belong to it: `function:exp(-((w - 550) / 20)^4)`. The usual precedence holds: `^` first and from the
//! right, then a sign, then `*` and `/`, then `+` and `-`.

use crate::error::SpectrumError;
use crate::inline::number;

/// Length of the longest expression that is read, in bytes.
const LONGEST: usize = 8192;
/// Largest depth to which parentheses and signs may be nested.
const DEEPEST: u32 = 48;

/// Operator between two spectra.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    Plus,
    Minus,
    Times,
    Over,
    Power,
}

/// Syntax tree of an expression; its names are not yet looked up.
#[derive(Debug, PartialEq)]
pub(crate) enum Tree {
    Number(f64),
    /// A name, with the position of its first character and its number of characters.
    Name {
        text: String,
        at: usize,
        len: usize,
    },
    Negative(Box<Tree>),
    /// Two operands, with the operator and its position in characters.
    Joined {
        sign: Sign,
        at: usize,
        parts: Box<[Tree; 2]>,
    },
}

impl Tree {
    /// Returns whether the expression contains a name.
    pub(crate) fn has_name(&self) -> bool {
        match self {
            Self::Number(_) => false,
            Self::Name { .. } => true,
            Self::Negative(part) => part.has_name(),
            Self::Joined { parts, .. } => parts.iter().any(Self::has_name),
        }
    }
}

/// Parses `text`. A text without any operator or parenthesis is a name, even if it is a number.
pub(crate) fn parse(text: &str) -> Result<Tree, SpectrumError> {
    if text.len() > LONGEST {
        let text = text.chars().take(80).collect();
        let message = format!("an expression of more than {LONGEST} characters");
        return Err(SpectrumError::Expression { text, at: 0, message, hint: "put its parts into files".to_owned() });
    }
    let characters: Vec<char> = text.chars().collect();
    let mut reader = Reader { text, characters: &characters, at: 0, depth: 0, groups: 0 };
    let tree = reader.sum()?;
    reader.skip();
    if let Some(c) = reader.peek() {
        return Err(match c {
            ')' => reader.fault(reader.at, "this `)` closes nothing", "remove it, or write a `(` before it"),
            _ => reader.fault(
                reader.at,
                "a sign is missing here",
                "write one of ` + `, ` - `, ` * ` and ` / ` between two spectra: `2 * (D65 + A)`",
            ),
        });
    }
    Ok(match tree {
        Tree::Number(_) if number(text).is_some() => {
            Tree::Name { text: text.trim().to_owned(), at: 0, len: characters.len() }
        }
        tree => tree,
    })
}

struct Reader<'a> {
    text: &'a str,
    characters: &'a [char],
    at: usize,
    depth: u32,
    /// Number of parentheses that are open at the current position.
    groups: u32,
}

impl Reader<'_> {
    fn peek(&self) -> Option<char> {
        self.characters.get(self.at).copied()
    }

    fn is_space(&self, at: usize) -> bool {
        self.characters.get(at).is_none_or(|c| c.is_whitespace())
    }

    fn skip(&mut self) {
        while self.peek().is_some_and(char::is_whitespace) {
            self.at += 1;
        }
    }

    fn fault(&self, at: usize, message: &str, hint: &str) -> SpectrumError {
        SpectrumError::Expression { text: self.text.to_owned(), at, message: message.to_owned(), hint: hint.to_owned() }
    }

    /// Enters one more level, or fails if the nesting is too deep.
    fn deeper(&mut self) -> Result<(), SpectrumError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("parentheses or signs are nested more than {DEEPEST} deep");
            return Err(self.fault(self.at, &message, "put a part of it into a file"));
        }
        Ok(())
    }

    fn joined(sign: Sign, at: usize, left: Tree, right: Tree) -> Tree {
        Tree::Joined { sign, at, parts: Box::new([left, right]) }
    }

    fn sum(&mut self) -> Result<Tree, SpectrumError> {
        let mut left = self.product()?;
        // The tree becomes as deep as the expression is long; the limit on its length bounds that.
        loop {
            self.skip();
            let sign = match self.peek() {
                Some('+') => Sign::Plus,
                Some('-') => Sign::Minus,
                _ => return Ok(left),
            };
            let at = self.at;
            self.at += 1;
            let right = self.product()?;
            left = Self::joined(sign, at, left, right);
        }
    }

    fn product(&mut self) -> Result<Tree, SpectrumError> {
        let mut left = self.signed()?;
        loop {
            self.skip();
            let sign = match self.peek() {
                Some('*') => Sign::Times,
                Some('/') => Sign::Over,
                _ => return Ok(left),
            };
            let at = self.at;
            self.at += 1;
            let right = self.signed()?;
            left = Self::joined(sign, at, left, right);
        }
    }

    fn signed(&mut self) -> Result<Tree, SpectrumError> {
        self.skip();
        match self.peek() {
            Some(sign @ ('-' | '+')) => {
                self.at += 1;
                self.deeper()?;
                let part = self.signed()?;
                self.depth -= 1;
                Ok(match (sign, part) {
                    ('-', Tree::Number(value)) => Tree::Number(-value),
                    ('-', part) => Tree::Negative(Box::new(part)),
                    (_, part) => part,
                })
            }
            _ => self.power(),
        }
    }

    fn power(&mut self) -> Result<Tree, SpectrumError> {
        let base = self.value()?;
        self.skip();
        if self.peek() != Some('^') {
            return Ok(base);
        }
        let at = self.at;
        self.at += 1;
        self.deeper()?;
        let exponent = self.signed()?;
        self.depth -= 1;
        Ok(Self::joined(Sign::Power, at, base, exponent))
    }

    fn value(&mut self) -> Result<Tree, SpectrumError> {
        const STANDS: &str = "write a spectrum or a number after each sign: `D65 + 5000 * line:e`";
        self.skip();
        match self.peek() {
            Some('(') => {
                let open = self.at;
                self.at += 1;
                self.deeper()?;
                self.groups += 1;
                let inside = self.sum()?;
                self.skip();
                match self.peek() {
                    Some(')') => {}
                    None => return Err(self.fault(open, "this `(` is never closed", "write a `)` where it ends")),
                    Some(_) => {
                        let hint = "write one of ` + `, ` - `, ` * ` and ` / ` between two spectra";
                        return Err(self.fault(self.at, "a sign is missing here", hint));
                    }
                }
                self.at += 1;
                self.depth -= 1;
                self.groups -= 1;
                Ok(inside)
            }
            Some(')') => Err(self.fault(self.at, "a spectrum is missing before this `)`", STANDS)),
            Some(c @ ('*' | '/' | '^')) if c != '/' || self.is_space(self.at + 1) => {
                Err(self.fault(self.at, &format!("a spectrum is missing before this `{c}`"), STANDS))
            }
            None if self.text.trim().is_empty() => {
                Err(self.fault(0, "no spectrum is written", "`spectra list spectrum` shows all names"))
            }
            None => Err(self.fault(self.at, "the expression ends where a spectrum is expected", STANDS)),
            Some(_) => self.name(),
        }
    }

    fn name(&mut self) -> Result<Tree, SpectrumError> {
        let start = self.at;
        let mut open: Vec<usize> = Vec::new();
        while let Some(c) = self.peek() {
            match c {
                '(' => open.push(self.at),
                ')' if open.pop().is_none() => break,
                '*' | '^' if open.is_empty() => break,
                '+' | '-' | '/'
                    if open.is_empty()
                        && self.at > start
                        && self.is_space(self.at - 1)
                        && self.is_space(self.at + 1) =>
                {
                    break;
                }
                _ => {}
            }
            self.at += 1;
        }
        if let Some(open) = open.first() {
            return Err(self.fault(*open, "this `(` is never closed", "write a `)` where it ends"));
        }
        if self.peek() == Some(')') && self.groups == 0 {
            return Err(self.fault(self.at, "this `)` closes nothing", "remove it, or write a `(` before it"));
        }
        let written: String = self.characters[start..self.at].iter().collect();
        let name = written.trim_end();
        if let Some(value) = number(name) {
            return Ok(Tree::Number(value));
        }
        Ok(Tree::Name { text: name.to_owned(), at: start, len: name.chars().count() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Formats the tree with brackets around every pair.
    fn shown(tree: &Tree) -> String {
        match tree {
            Tree::Number(value) => value.to_string(),
            Tree::Name { text, .. } => text.clone(),
            Tree::Negative(part) => format!("-[{}]", shown(part)),
            Tree::Joined { sign, parts, .. } => {
                let sign = match sign {
                    Sign::Plus => '+',
                    Sign::Minus => '-',
                    Sign::Times => '*',
                    Sign::Over => '/',
                    Sign::Power => '^',
                };
                format!("[{}{sign}{}]", shown(&parts[0]), shown(&parts[1]))
            }
        }
    }

    #[test]
    fn signs_and_names_are_told_apart() {
        for (text, want) in [
            ("D65", "D65"),
            ("0.5", "0.5"),
            ("5600 K", "5600 K"),
            ("he-ne", "he-ne"),
            ("spectra/illuminants/A.csv", "spectra/illuminants/A.csv"),
            ("/data/lamp.csv#warm", "/data/lamp.csv#warm"),
            ("2 * /data/lamp.csv", "[2*/data/lamp.csv]"),
            ("a lamp (1).csv", "a lamp (1).csv"),
            ("1 - wratten-25", "[1-wratten-25]"),
            ("0.5 * D65 + line:e", "[[0.5*D65]+line:e]"),
            ("2*D65", "[2*D65]"),
            ("a - b - c", "[[a-b]-c]"),
            ("a / b * c", "[[a/b]*c]"),
            ("(a + b) * (c)", "[[a+b]*c]"),
            ("(a)-b", "[a-b]"),
            ("-a^2", "-[[a^2]]"),
            ("a^-2", "[a^-2]"),
            ("a ^ 2 ^ 3", "[a^[2^3]]"),
            ("10^(-0.3 * gaussian:550,20)", "[10^[-0.3*gaussian:550,20]]"),
            ("D65 * function:exp(-((w - 550) / 20)^4) + A", "[[D65*function:exp(-((w - 550) / 20)^4)]+A]"),
            ("rgb:#ff8040 by smooth * 2", "[rgb:#ff8040 by smooth*2]"),
            ("+ a", "a"),
        ] {
            assert_eq!(parse(text).map(|tree| shown(&tree)).as_deref(), Ok(want), "{text}");
        }
    }
}

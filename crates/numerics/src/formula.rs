//! A function of one variable as people write it: `exp(-((w - 550) / 20)^4)`.
//!
//! Numbers, the variable, `pi`, `+ - * / ^` with the usual order (`^` first and from the right, so that `-x^2` is -(x^2)),
//! parentheses, and the functions of [`FUNCTIONS`]. All of them give the same bits on every machine.

/// List of the functions that a formula may contain, for messages.
pub const FUNCTIONS: &str =
    "abs, cos, erf, exp, ln, log10, max(a, b), min(a, b), sin, sqrt, step (1 from 0 on, else 0), tan, tanh";

/// Longest text that is read, bytes.
const LONGEST: usize = 4096;
/// Deepest nesting of parentheses and signs.
const DEEPEST: u32 = 64;

/// A function of one variable.
#[derive(Clone, Debug)]
pub struct Formula {
    text: String,
    /// Steps of the evaluation, in postfix order.
    steps: Vec<Step>,
}

/// An error in a formula, and its position.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormulaFault {
    /// Number of the character at which the error is, from 0.
    pub at: usize,
    /// Message that says what is wrong.
    pub message: String,
    /// Hint that says what to write instead.
    pub hint: String,
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Number(f64),
    Variable,
    Negate,
    One(fn(f64) -> f64),
    Two(fn(f64, f64) -> f64),
}

impl PartialEq for Formula {
    /// Compares the texts of the formulas.
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl Formula {
    /// Reads a formula of the variable called `variable`.
    ///
    /// # Errors
    /// What is wrong, at which character, and what to write.
    pub fn parse(text: &str, variable: &str) -> Result<Self, FormulaFault> {
        if text.len() > LONGEST {
            let message = format!("a formula of more than {LONGEST} characters");
            return Err(FormulaFault { at: 0, message, hint: "use a table instead".to_owned() });
        }
        let characters: Vec<char> = text.chars().collect();
        let mut reader = Reader { characters: &characters, at: 0, depth: 0, variable, steps: Vec::new() };
        reader.sum()?;
        reader.skip();
        match reader.peek() {
            None => Ok(Self { text: text.trim().to_owned(), steps: reader.steps }),
            Some(')') => Err(reader.fault("this `)` closes nothing", "remove it, or write a `(` before it")),
            Some(c) => Err(reader.fault(
                &format!("`{c}` is not expected here"),
                "write one of + - * / ^ between two values, as in `2 * w`",
            )),
        }
    }

    /// Text of the formula, as it was written.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Evaluates the formula at `variable`; NaN or infinite where the formula has no value.
    #[must_use]
    pub fn at(&self, variable: f64) -> f64 {
        let mut stack: Vec<f64> = Vec::with_capacity(16);
        for step in &self.steps {
            let value = match *step {
                Step::Number(value) => value,
                Step::Variable => variable,
                Step::Negate => -stack.pop().unwrap_or(f64::NAN),
                Step::One(f) => f(stack.pop().unwrap_or(f64::NAN)),
                Step::Two(f) => {
                    let second = stack.pop().unwrap_or(f64::NAN);
                    f(stack.pop().unwrap_or(f64::NAN), second)
                }
            };
            stack.push(value);
        }
        stack.pop().unwrap_or(f64::NAN)
    }
}

struct Reader<'a> {
    characters: &'a [char],
    at: usize,
    depth: u32,
    variable: &'a str,
    steps: Vec<Step>,
}

impl Reader<'_> {
    fn peek(&self) -> Option<char> {
        self.characters.get(self.at).copied()
    }

    fn skip(&mut self) {
        while self.peek().is_some_and(char::is_whitespace) {
            self.at += 1;
        }
    }

    fn fault(&self, message: &str, hint: &str) -> FormulaFault {
        self.fault_at(self.at, message, hint)
    }

    fn fault_at(&self, at: usize, message: &str, hint: &str) -> FormulaFault {
        FormulaFault { at, message: message.to_owned(), hint: hint.to_owned() }
    }

    fn deeper(&mut self) -> Result<(), FormulaFault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.fault(&format!("parentheses are nested more than {DEEPEST} deep"), "write fewer"));
        }
        Ok(())
    }

    fn sum(&mut self) -> Result<(), FormulaFault> {
        self.product()?;
        loop {
            self.skip();
            let step = match self.peek() {
                Some('+') => Step::Two(|a, b| a + b),
                Some('-') => Step::Two(|a, b| a - b),
                _ => return Ok(()),
            };
            self.at += 1;
            self.product()?;
            self.steps.push(step);
        }
    }

    fn product(&mut self) -> Result<(), FormulaFault> {
        self.signed()?;
        loop {
            self.skip();
            let step = match self.peek() {
                Some('*') if self.characters.get(self.at + 1) == Some(&'*') => {
                    return Err(self.fault("`**` is not an operator", "a power is written `^`"));
                }
                Some('*') => Step::Two(|a, b| a * b),
                Some('/') => Step::Two(|a, b| a / b),
                _ => return Ok(()),
            };
            self.at += 1;
            self.signed()?;
            self.steps.push(step);
        }
    }

    fn signed(&mut self) -> Result<(), FormulaFault> {
        self.skip();
        match self.peek() {
            Some(sign @ ('-' | '+')) => {
                self.at += 1;
                self.deeper()?;
                self.signed()?;
                self.depth -= 1;
                if sign == '-' {
                    self.steps.push(Step::Negate);
                }
                Ok(())
            }
            _ => self.power(),
        }
    }

    fn power(&mut self) -> Result<(), FormulaFault> {
        self.value()?;
        self.skip();
        if self.peek() == Some('^') {
            self.at += 1;
            self.deeper()?;
            // From the right, and with a sign: 2^-x.
            self.signed()?;
            self.depth -= 1;
            self.steps.push(Step::Two(libm::pow));
        }
        Ok(())
    }

    fn value(&mut self) -> Result<(), FormulaFault> {
        self.skip();
        match self.peek() {
            Some('(') => {
                let open = self.at;
                self.at += 1;
                self.deeper()?;
                self.sum()?;
                self.close(open)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.word(),
            Some(')') => {
                Err(self.fault("a value is missing before this `)`", "write a value, such as a number or the variable"))
            }
            Some(c) => Err(self.fault(
                &format!("`{c}` is not expected here"),
                "write a number, the variable, a function or a `(` here",
            )),
            None => {
                let hint = format!("write a value, such as a number, `{}` or a function", self.variable);
                Err(self.fault("the formula ends where a value is expected", &hint))
            }
        }
    }

    fn close(&mut self, open: usize) -> Result<(), FormulaFault> {
        self.skip();
        if self.peek() != Some(')') {
            return Err(match self.peek() {
                None => self.fault_at(open, "this `(` is never closed", "write a `)` where it ends"),
                Some(',') => self.fault("a `,` is not expected here", "only `min` and `max` take two values"),
                Some(c) => self.fault(
                    &format!("`{c}` is not expected here"),
                    "write one of + - * / ^ between two values, as in `2 * w`",
                ),
            });
        }
        self.at += 1;
        self.depth -= 1;
        Ok(())
    }

    fn number(&mut self) -> Result<(), FormulaFault> {
        let start = self.at;
        let digits = |reader: &mut Self| {
            while reader.peek().is_some_and(|c| c.is_ascii_digit() || c == '.') {
                reader.at += 1;
            }
        };
        digits(self);
        if matches!(self.peek(), Some('e' | 'E')) {
            let sign = usize::from(matches!(self.characters.get(self.at + 1), Some('+' | '-')));
            if self.characters.get(self.at + 1 + sign).is_some_and(char::is_ascii_digit) {
                self.at += 1 + sign;
                digits(self);
            }
        }
        let text: String = self.characters[start..self.at].iter().collect();
        let value = text.parse().ok().filter(|v: &f64| v.is_finite());
        let fault =
            || self.fault_at(start, &format!("`{text}` is not a number"), "write a number such as 550, 0.5 or 1e-3");
        let value = value.ok_or_else(fault)?;
        self.steps.push(Step::Number(value));
        Ok(())
    }

    fn word(&mut self) -> Result<(), FormulaFault> {
        let start = self.at;
        while self.peek().is_some_and(|c| c.is_alphanumeric() || c == '_') {
            self.at += 1;
        }
        let word: String = self.characters[start..self.at].iter().collect();
        if word == self.variable {
            self.steps.push(Step::Variable);
            return Ok(());
        }
        let step = match word.as_str() {
            "pi" => {
                self.steps.push(Step::Number(std::f64::consts::PI));
                return Ok(());
            }
            "abs" => Step::One(f64::abs),
            "cos" => Step::One(libm::cos),
            "erf" => Step::One(libm::erf),
            "exp" => Step::One(libm::exp),
            "ln" => Step::One(libm::log),
            "log10" => Step::One(libm::log10),
            "sin" => Step::One(libm::sin),
            "sqrt" => Step::One(f64::sqrt),
            "step" => Step::One(|x| if x >= 0.0 { 1.0 } else { 0.0 * x }),
            "tan" => Step::One(libm::tan),
            "tanh" => Step::One(libm::tanh),
            "max" => Step::Two(|a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }),
            "min" => Step::Two(|a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }),
            "log" => {
                return Err(self.fault_at(start, "`log` could mean base 10 or e", "write `ln` or `log10`"));
            }
            _ => {
                let hint = format!("the variable is `{}`; functions: {FUNCTIONS}; and `pi`", self.variable);
                let shown: String = word.chars().take(40).collect();
                return Err(self.fault_at(start, &format!("`{shown}` is neither the variable nor a function"), &hint));
            }
        };
        self.skip();
        let open = self.at;
        if self.peek() != Some('(') {
            return Err(self.fault(
                &format!("`{word}` has no parentheses"),
                &format!("write it as in `{word}({})`", self.variable),
            ));
        }
        self.at += 1;
        self.deeper()?;
        self.sum()?;
        if matches!(step, Step::Two(_)) {
            self.skip();
            if self.peek() != Some(',') {
                return Err(self.fault(
                    &format!("`{word}` takes two values"),
                    &format!("write it as in `{word}(0, {})`", self.variable),
                ));
            }
            self.at += 1;
            self.sum()?;
        }
        self.close(open)?;
        self.steps.push(step);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str, x: f64) -> f64 {
        Formula::parse(text, "w").unwrap_or_else(|e| panic!("{text}: {e:?}")).at(x)
    }

    #[test]
    fn the_usual_order() {
        for (text, want) in [
            ("-3^2", -9.0),
            ("2^3^2", 512.0),
            ("2^-1", 0.5),
            ("1 - 2 - 3", -4.0),
            ("8 / 4 / 2", 1.0),
            ("2 + 3 * 4", 14.0),
            ("(2+3)*4", 20.0),
            ("- - 2", 2.0),
            ("1.5e2 + .5", 150.5),
            ("max(1, min(5, 3))", 3.0),
            ("step(-1) + step(0)", 1.0),
            ("w / 2", 275.0),
            ("sqrt(w * w)", 550.0),
            ("log10(1e3) + ln(exp(1)) + abs(-1)", 5.0),
            ("sin(pi / 2) + cos(0) + tan(0) + tanh(0) + erf(0)", 2.0),
        ] {
            assert!((at(text, 550.0) - want).abs() < 1e-12 * want.abs(), "{text}: {}", at(text, 550.0));
        }
        assert!(at("sqrt(-w)", 1.0).is_nan() && at("1/(w-1)", 1.0).is_infinite());
    }

    #[test]
    fn faults_have_a_place_and_a_hint() {
        for (text, place, message) in [
            ("", 0, "ends"),
            ("w +", 3, "ends"),
            ("(w", 0, "never closed"),
            ("w)", 1, "closes nothing"),
            ("2 w", 2, "not expected"),
            ("exp w", 4, "no parentheses"),
            ("exp(w, 2)", 5, "not expected"),
            ("min(w)", 5, "two values"),
            ("log(w)", 0, "base"),
            ("x + 1", 0, "neither"),
            ("w ** 2", 2, "not an operator"),
            ("1.2.3", 0, "not a number"),
            ("1e999", 0, "not a number"),
            ("()", 1, "missing"),
            ("w $ 2", 2, "not expected"),
        ] {
            let fault = Formula::parse(text, "w").expect_err(text);
            assert!(
                fault.at == place && fault.message.contains(message) && !fault.hint.is_empty(),
                "{text}: {fault:?}"
            );
        }
        assert!(Formula::parse(&"(".repeat(5000), "w").is_err() && Formula::parse(&"-".repeat(4000), "w").is_err());
        assert!(Formula::parse(&"(".repeat(200), "w").is_err());
    }
}

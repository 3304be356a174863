//! Names of plugins, which become crates, Rust types, and kinds in scenes.

use crate::outcome::Failure;
use spectra_core::params::Fault;
use spectra_core::registry;

/// Length of the longest allowed name, bytes.
const LONGEST: usize = 64;

/// Names that a crate cannot have: keywords of Rust (The Rust Reference, "Keywords"), and crates that every program contains.
const RESERVED: [&str; 60] = [
    "abstract",
    "alloc",
    "as",
    "async",
    "await",
    "become",
    "box",
    "break",
    "const",
    "continue",
    "core",
    "crate",
    "do",
    "dyn",
    "else",
    "enum",
    "extern",
    "false",
    "final",
    "fn",
    "for",
    "gen",
    "if",
    "impl",
    "in",
    "let",
    "loop",
    "macro",
    "match",
    "mod",
    "move",
    "mut",
    "override",
    "priv",
    "proc-macro",
    "pub",
    "ref",
    "return",
    "schemars",
    "self",
    "serde",
    "static",
    "std",
    "struct",
    "super",
    "test",
    "trait",
    "true",
    "try",
    "type",
    "typeof",
    "union",
    "unsafe",
    "unsized",
    "use",
    "virtual",
    "where",
    "while",
    "yield",
    "spectra",
];

/// Checks that a name is in kebab-case and not too long.
pub(super) fn check(name: &str) -> Result<(), Failure> {
    let fault = |text: String| {
        Err(Failure::from(Fault::new(text).hint("use lower-case letters, digits and hyphens, such as `ripple-glass`")))
    };
    let shown: String = name.chars().take(LONGEST).collect();
    if name.is_empty() || name.len() > LONGEST {
        return fault(format!(
            "`{shown}` is not a valid name: it has {} characters, 1 to {LONGEST} are allowed",
            name.chars().count()
        ));
    }
    let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    if let Some(bad) = name.chars().find(|c| !good(*c)) {
        return fault(format!(
            "`{}` is not a valid name: `{}` is not allowed in it",
            shown.escape_debug(),
            bad.escape_debug()
        ));
    }
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) {
        return fault(format!("`{name}` is not a valid name: it does not begin with a letter"));
    }
    if name.ends_with('-') || name.contains("--") {
        return fault(format!("`{name}` is not a valid name: hyphens go between words"));
    }
    Ok(())
}

/// Checks a name for a plugin of this stage: besides [`check`], it must not be reserved or already registered.
pub(super) fn check_plugin(name: &str, stage: &str) -> Result<(), Failure> {
    check(name)?;
    if RESERVED.contains(&name) {
        let fault = Fault::new(format!("`{name}` cannot be the name of a crate: Rust reserves it"));
        return Err(fault.hint(format!("choose another name, such as `my-{name}`")).into());
    }
    if name.starts_with("spectra-") {
        let fault = Fault::new(format!("`{name}`: names like this are reserved for the crates of spectra"));
        return Err(fault
            .hint(format!("choose another name, such as `{}`", name.trim_start_matches("spectra-")))
            .into());
    }
    if let Some(taken) = registry::list().into_iter().find(|l| l.stage == stage && l.name == name) {
        let text = format!("{stage} `{name}` already exists, in crate {} {}", taken.package, taken.version);
        return Err(Fault::new(text)
            .hint(format!("choose another name; `spectra doc {stage}/{name}` shows that one"))
            .into());
    }
    Ok(())
}

/// Converts a name to that of a Rust type: `even-asphere` becomes `EvenAsphere`.
pub(super) fn camel_case(name: &str) -> String {
    let mut out = String::new();
    for word in name.split('-') {
        let mut letters = word.chars();
        out.extend(letters.next().map(|c| c.to_ascii_uppercase()));
        out.push_str(letters.as_str());
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_kebab_case() {
        for good in ["ripple", "even-asphere-2", "a"] {
            assert!(check(good).is_ok(), "{good}");
        }
        for bad in ["", "Ripple", "two words", "under_score", "-a", "a-", "a--b", "2nd", "a/b", "..", "\u{e9}", "a\n"] {
            assert!(check(bad).is_err(), "{bad:?}");
        }
        assert!(check(&"x".repeat(65)).is_err());
    }

    #[test]
    fn keywords_are_no_crates() {
        for bad in ["fn", "self", "core", "union", "spectra-core", "serde"] {
            assert!(check_plugin(bad, "surface").is_err(), "{bad}");
        }
        assert!(check_plugin("fn-2", "surface").is_ok());
    }

    #[test]
    fn types_are_camel_case() {
        assert_eq!([camel_case("even-asphere-2"), camel_case("x")], ["EvenAsphere2", "X"]);
    }
}

//! Guesses what was meant by a word that is not a command: `spectra scene.yaml`, `spectra render scene.yaml`.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use spectra_core::params::Fault;
use spectra_scene::bundled::{self, Bundled};
use std::ffi::OsString;
use std::path::Path;

/// Words that users may type, with the command that does what they mean.
const OTHERS: [(&str, &str); 18] = [
    ("render", "run SCENE"),
    ("open", "run SCENE"),
    ("view", "run SCENE"),
    ("validate", "check SCENE"),
    ("lint", "check SCENE"),
    ("licenses", "--licenses"),
    ("licences", "--licenses"),
    ("completion", "completions bash"),
    ("init", "new scene NAME"),
    ("stock", "film info NAME"),
    ("develop", "film develop PICTURE --stock tri-x"),
    ("info", "lens info LENS"),
    ("import", "lens import FILE"),
    ("export", "lens export LENS"),
    ("draw", "lens draw LENS"),
    ("trace", "lens trace LENS"),
    ("cube", "film cube STOCK"),
    ("scenes", "list scene"),
];

/// Arguments that users may give to `film develop`, with a hint how to do what they mean.
const OTHER_ARGUMENTS: [(&str, &str); 6] = [
    ("--frames", "select frames by file name: `plate.000[1-8].exr`, or `'plate.####.exr'` for all"),
    ("--filter", "a filter goes in front of a lens: `--lens helios --set lens.filters=[wratten-12]`"),
    ("--filters", "a filter goes in front of a lens: `--lens helios --set lens.filters=[wratten-12]`"),
    ("--iso", "each stock has a fixed speed: `--push 1` develops it longer, `--exposure=+1` exposes it more"),
    ("--film", "write `--stock tri-x`"),
    ("--aperture", "write `--lens helios --f-number f/2`"),
];

/// Returns an error with a hint for an unknown command or argument of the command line `line`, whose first word is the program.
/// Returns `None` for other errors, and if no better command is known.
pub(crate) fn suggestion(error: &clap::Error, line: &[OsString]) -> Option<Fault> {
    if error.kind() == ErrorKind::UnknownArgument && holds(line, &["film", "develop"]) {
        let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidArg) else { return None };
        let (_, hint) = OTHER_ARGUMENTS.iter().find(|(argument, _)| argument == typed)?;
        return Some(Fault::new(format!("`film develop` has no `{typed}`")).hint(*hint));
    }
    if error.kind() != ErrorKind::InvalidSubcommand {
        return None;
    }
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    let behind = line.iter().position(|word| word.to_str() == Some(typed)).and_then(|at| line.get(at + 1));
    let behind = behind.and_then(|word| word.to_str()).filter(|word| !word.starts_with('-'));
    let command = of_word(typed, behind)?;
    Some(Fault::new(format!("`{typed}` is not a command")).hint(format!("did you mean `spectra {command}`?")))
}

/// Whether the command line calls this command.
fn holds(line: &[OsString], command: &[&str]) -> bool {
    let words = line.iter().skip(1).filter_map(|word| word.to_str()).filter(|word| !word.starts_with('-'));
    words.take(command.len()).eq(command.iter().copied())
}

/// Returns the error for `--set film.stock tri-x`, where a space stands instead of `=`; `None` if the line has no such mistake.
pub(crate) fn set_without_equals(line: &[OsString]) -> Option<Fault> {
    let words: Vec<&str> = line.iter().map(|word| word.to_str().unwrap_or_default()).collect();
    let at = words.iter().take_while(|word| **word != "--").position(|word| *word == "--set")?;
    let (path, value) = (*words.get(at + 1)?, *words.get(at + 2)?);
    let is_path = path.starts_with(|c: char| c.is_ascii_alphabetic())
        && path.chars().all(|c| c.is_ascii_alphanumeric() || ".-_[]".contains(c));
    let is_value =
        !value.is_empty() && !value.starts_with('-') && !value.ends_with(".yaml") && !value.ends_with(".yml");
    (is_path && is_value).then(|| {
        let quoted = if value.contains([' ', '{', '[', '*', '$']) { format!("\"{value}\"") } else { value.to_owned() };
        Fault::new(format!("`--set {path} {value}`: `=` is missing")).hint(format!("write `--set {path}={quoted}`"))
    })
}

/// Removes the tip to write `-- -1` or `-- --sample`, which would turn an intended option or number into a file name.
pub(crate) fn without_false_tips(mut error: clap::Error) -> clap::Error {
    if error.kind() == ErrorKind::UnknownArgument
        && let Some(ContextValue::StyledStrs(tips)) = error.remove(ContextKind::Suggested)
    {
        let others: Vec<_> = tips.into_iter().filter(|tip| !tip.to_string().contains("as a value, use")).collect();
        if !others.is_empty() {
            error.insert(ContextKind::Suggested, ContextValue::StyledStrs(others));
        }
    }
    error
}

/// Returns the command, without `spectra`, that a word means; `behind` is the next word of the line.
fn of_word(typed: &str, behind: Option<&str>) -> Option<String> {
    let typed = typed.trim();
    if let Some((_, command)) = OTHERS.iter().find(|(word, _)| word.eq_ignore_ascii_case(typed)) {
        if typed.eq_ignore_ascii_case("info")
            && let Some(command) =
                behind.and_then(|name| of_word(name, None)).filter(|command| command.contains(" info "))
        {
            return Some(command);
        }
        let is_place = |word: &&str| word.len() > 2 && word.chars().all(|c| c.is_ascii_uppercase());
        let place = command.split(' ').find(is_place);
        return Some(match (place, behind) {
            (Some(place), Some(behind)) => command.replacen(place, behind, 1),
            _ => (*command).to_owned(),
        });
    }
    let ending = Path::new(typed).extension().map(|ending| ending.to_ascii_lowercase());
    if ending.as_ref().is_some_and(|ending| ending == "yaml" || ending == "yml") {
        return Some(format!("run {typed}"));
    }
    if ending.is_some_and(|ending| ["jpg", "jpeg", "png", "tif", "tiff", "exr"].iter().any(|own| ending == *own)) {
        return Some(format!("film develop {typed} --stock tri-x"));
    }
    let (kind, name) = bundled::meanings(typed).into_iter().find(|(kind, _)| *kind != Bundled::Glass)?;
    Some(match kind {
        Bundled::Scene => format!("run {name}"),
        Bundled::Lens => format!("lens info {name}"),
        Bundled::Stock => format!("film info {name}"),
        Bundled::Spectrum | Bundled::Glass => format!("spectrum info {name}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::Arguments;
    use clap::Parser;

    #[test]
    fn words_that_are_no_command_have_one_behind_them() {
        for (typed, command) in [
            ("scene.yaml", "run scene.yaml"),
            ("render", "run SCENE"),
            ("develop", "film develop PICTURE --stock tri-x"),
            ("holiday.JPG", "film develop holiday.JPG --stock tri-x"),
            ("biotar-ortho", "run biotar-ortho"),
            ("helios", "lens info helios-44-58-f2"),
            ("tri-x", "film info kodak-tri-x-400"),
            ("D65", "spectrum info D65"),
        ] {
            let error = Arguments::try_parse_from(["spectra", typed]).expect_err(typed);
            let hint = suggestion(&error, &[]).and_then(|fault| fault.hint).unwrap_or_default();
            assert_eq!(hint, format!("did you mean `spectra {command}`?"));
        }
        let line = |words: &str| words.split(' ').map(OsString::from).collect::<Vec<_>>();
        for (typed, hint) in [
            ("spectra develop a.png", "`spectra film develop a.png --stock tri-x`"),
            ("spectra info tri-x", "`spectra film info kodak-tri-x-400`"),
            ("spectra info helios", "`spectra lens info helios-44-58-f2`"),
            ("spectra info --json", "`spectra lens info LENS`"),
            ("spectra film develop a.png --stock tri-x --frames 1-3", "`'plate.####.exr'`"),
            ("spectra film develop a.png --stock tri-x --filter red", "lens.filters=[wratten-12]"),
        ] {
            let error = Arguments::try_parse_from(line(typed)).expect_err(typed);
            let said = suggestion(&error, &line(typed)).and_then(|fault| fault.hint).unwrap_or_default();
            assert!(said.contains(hint), "{typed}: {said}");
        }
        for (typed, hint) in [
            ("spectra check --set film.stock tri-x a.yaml", Some("write `--set film.stock=tri-x`")),
            ("spectra run a.yaml --set film.stock tri-x", Some("write `--set film.stock=tri-x`")),
            ("spectra check --set film.stock a.yaml", None),
            ("spectra check --set film.stock=tri-x a", None),
            ("spectra run a.yaml --set film.stock -v", None),
        ] {
            let said = set_without_equals(&line(typed)).and_then(|fault| fault.hint);
            assert_eq!(said.as_deref(), hint, "{typed}");
        }
        for words in
            [&["run", "a.yaml", "--threads", "-1"][..], &["film", "develop", "a.png", "--stock", "x", "--samples"]]
        {
            let error = Arguments::try_parse_from([&["spectra"], words].concat()).expect_err("no argument");
            let text = without_false_tips(error).to_string();
            assert!(text.contains("unexpected argument") && !text.contains("-- "), "{text}");
        }
        // The parser's hint for `spectra lst` is good enough.
        let error = Arguments::try_parse_from(["spectra", "lst"]).expect_err("no command");
        assert!(suggestion(&error, &[]).is_none() && error.to_string().contains("list"), "{error}");
    }
}

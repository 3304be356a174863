//! What was meant by a word that is no command: `spectra scene.yaml`, `spectra render scene.yaml`.

use clap::error::{ContextKind, ContextValue, ErrorKind};
use spectra_core::params::Fault;
use spectra_scene::bundled::{self, Bundled};
use std::path::Path;

/// Words that people write for a command of ours.
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

/// What to write in place of an unknown command; `None` for other errors, and where nothing comes to mind.
pub(crate) fn meant(error: &clap::Error) -> Option<Fault> {
    if error.kind() != ErrorKind::InvalidSubcommand {
        return None;
    }
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    let command = of_word(typed)?;
    Some(Fault::new(format!("`{typed}` is not a command")).hint(format!("did you mean `spectra {command}`?")))
}

/// Takes away the tip to write `-- -1` or `-- --sample`, which makes the name of a file of what was meant as an option or a number.
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

/// The command, without `spectra`.
fn of_word(typed: &str) -> Option<String> {
    let typed = typed.trim();
    if let Some((_, command)) = OTHERS.iter().find(|(word, _)| word.eq_ignore_ascii_case(typed)) {
        return Some((*command).to_owned());
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
            let hint = meant(&error).and_then(|fault| fault.hint).unwrap_or_default();
            assert_eq!(hint, format!("did you mean `spectra {command}`?"));
        }
        for words in
            [&["run", "a.yaml", "--threads", "-1"][..], &["film", "develop", "a.png", "--stock", "x", "--samples"]]
        {
            let error = Arguments::try_parse_from([&["spectra"], words].concat()).expect_err("no argument");
            let text = without_false_tips(error).to_string();
            assert!(text.contains("unexpected argument") && !text.contains("-- "), "{text}");
        }
        // The parser's own hint is as good: `spectra lst`.
        let error = Arguments::try_parse_from(["spectra", "lst"]).expect_err("no command");
        assert!(meant(&error).is_none() && error.to_string().contains("list"), "{error}");
    }
}

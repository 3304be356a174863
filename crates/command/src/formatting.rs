//! Formatting of numbers, times and names for people.

pub(crate) use spectra_session::formatting::*;
use std::path::{Path, PathBuf};

/// Returns the default file for a figure of `name`: `NAME.svg` in the working folder.
pub(crate) fn figure_of(name: &str) -> PathBuf {
    let file = Path::new(name.trim()).file_name().map_or("figure".into(), |name| name.to_string_lossy());
    let stem = file.strip_suffix(".yaml").or(file.strip_suffix(".yml")).or(file.strip_suffix(".csv")).unwrap_or(&file);
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '-' };
    PathBuf::from(format!("{}.svg", stem.chars().map(plain).collect::<String>()))
}

/// Whether the name of a file has the extension of YAML.
pub(crate) fn is_yaml(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("yaml") || e.eq_ignore_ascii_case("yml"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_called_by_what_they_show() {
        for (name, file) in [
            ("zeiss-biotar-50-f1.4", "zeiss-biotar-50-f1.4.svg"),
            ("my/lens.yaml", "lens.svg"),
            ("colorchecker#red", "colorchecker-red.svg"),
            ("blackbody:5800", "blackbody-5800.svg"),
            ("", "figure.svg"),
        ] {
            assert_eq!(figure_of(name), Path::new(file), "{name}");
        }
    }
}

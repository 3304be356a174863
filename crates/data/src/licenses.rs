//! Sources and licenses of the bundled data.

use crate::{FILES, text};

/// A license and a source, with the bundled files that state both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct License {
    /// Terms as the file states them, such as `CC0-1.0`.
    pub license: String,
    /// Publication or catalogue that the numbers come from.
    pub source: String,
    /// Paths in the repository of the bundled files, sorted.
    pub files: Vec<&'static str>,
}

/// Returns the value of `key` in a line such as `# key: value` (CSV) or `key: value` (YAML at its first level).
fn value<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    let line = line.strip_prefix('#').map_or(line, str::trim_start);
    let value = line.strip_prefix(key)?.strip_prefix(':')?.trim();
    let quoted = value.strip_prefix('"').and_then(|v| v.strip_suffix('"'));
    let quoted = quoted.or_else(|| value.strip_prefix('\'').and_then(|v| v.strip_suffix('\'')));
    Some(quoted.unwrap_or(value)).filter(|v| !v.is_empty())
}

/// Returns terms and source from a line `!source MARK TEXT` of a catalogue that joins several sources, each text naming its
/// terms.
fn catalogue_source(line: &str) -> Option<(&str, &str)> {
    const TERMS: [&str; 6] = ["CC0 1.0", "CC-BY 4.0", "MIT", "Apache-2.0", "BSD-3", "BSD-2"];
    let (_, source) = line.strip_prefix("!source ")?.split_once(' ')?;
    let terms = TERMS.into_iter().find(|t| source.contains(t))?;
    Some((terms, source.trim()))
}

/// Returns the licenses and sources that bundled files state: one entry for each pair of license and source, sorted.
///
/// In the first 60 lines of a file, the first `license` and the first `source` count, and every line `!source MARK TEXT`.
#[must_use]
pub fn licenses() -> Vec<License> {
    let mut all: Vec<License> = Vec::new();
    for (name, _) in FILES {
        let Some(text) = text(name) else { continue };
        // Terms stand at the head of a file; the data rows below are not searched.
        let head: Vec<&str> = text.lines().take(60).collect();
        let license = head.iter().find_map(|l| value(l, "license").or_else(|| value(l, "licence")));
        let source = head.iter().find_map(|l| value(l, "source"));
        let stated = license.zip(source);
        for (license, source) in stated.into_iter().chain(head.iter().filter_map(|l| catalogue_source(l))) {
            match all.iter_mut().find(|l| l.license == license && l.source == source) {
                Some(known) => known.files.push(name),
                None => all.push(License { license: license.into(), source: source.into(), files: vec![name] }),
            }
        }
    }
    all.sort_by(|a, b| (&a.license, &a.source).cmp(&(&b.license, &b.source)));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_from_csv_and_yaml_heads() {
        assert_eq!(value("# license: CC0-1.0", "license"), Some("CC0-1.0"));
        assert_eq!(value("license: \"MIT\"", "license"), Some("MIT"));
        assert_eq!(value("  license: nested", "license"), None);
        assert_eq!(value("licenses: x", "license"), None);
        assert_eq!(value("license:", "license"), None);
    }

    #[test]
    fn catalogues_name_several_sources() {
        let line = "!source hoya HOYA optical glass catalogue, as carried by ZemaxGlass 1.0 (MIT)";
        assert_eq!(
            catalogue_source(line),
            Some(("MIT", "HOYA optical glass catalogue, as carried by ZemaxGlass 1.0 (MIT)"))
        );
        assert_eq!(catalogue_source("!source x unknown terms"), None);
    }

    #[test]
    fn each_pair_appears_once_with_all_its_files() {
        let all = licenses();
        for (i, a) in all.iter().enumerate() {
            assert!(all[i + 1..].iter().all(|b| (&a.license, &a.source) != (&b.license, &b.source)));
        }
        let daylight = all.iter().find(|l| l.files.contains(&"spectra/illuminants/D65.csv")).expect("D65 is bundled");
        assert!(daylight.license.starts_with("BSD-3-Clause") && daylight.source.contains("CIE 15"));
    }
}

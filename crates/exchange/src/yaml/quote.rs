//! Quoting of texts for YAML.

/// Writes a text as a scalar on one line: plain if it cannot be misread, otherwise in double quotes.
pub(super) fn scalar(text: &str) -> String {
    let plain = text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '/' | '_' | '-' | '+' | '.'))
        && !["true", "false", "null", "inf"].contains(&text.to_ascii_lowercase().as_str());
    if plain { text.to_owned() } else { quoted(text) }
}

/// Writes a text in double quotes (YAML 1.2, section 7.3.1).
pub(super) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => {
                out.push('\\');
                out.push(c);
            }
            '\n' => out.push_str("\\n"),
            '\t' => out.push_str("\\t"),
            // Escape controls and characters that no printable stream may contain (section 5.1).
            c if c.is_control() || matches!(c, '\u{feff}' | '\u{fffe}' | '\u{ffff}' | '\u{2028}' | '\u{2029}') => {
                out.push_str(&format!("\\u{:04x}", u32::from(c)));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// Makes a text printable on the single line of a comment.
pub(super) fn comment(text: &str) -> String {
    let printable =
        |c: char| !(c.is_control() || matches!(c, '\u{feff}' | '\u{fffe}' | '\u{ffff}' | '\u{2028}' | '\u{2029}'));
    text.chars().map(|c| if printable(c) { c } else { ' ' }).collect::<String>().trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_where_safe() {
        for text in ["SCHOTT/N-BK7", "air", "poly_methyl_methacrylate/Sultanova", "H2O/Daimon-20.0C"] {
            assert_eq!(scalar(text), text);
        }
        assert_eq!(scalar("true"), "\"true\"");
        assert_eq!(scalar("1e5"), "\"1e5\"");
        assert_eq!(scalar("a: b # c"), "\"a: b # c\"");
        assert_eq!(scalar("a\"\\\n\u{7}"), "\"a\\\"\\\\\\n\\u0007\"");
    }
}

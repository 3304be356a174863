//! Recognizes words, marks and numbers of patents in English, German and Japanese.

use super::TableNote;
use crate::number;
use crate::source::shortened;

/// Superscript digits from 0 to 9, and the superscript minus.
const RAISED: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻";

/// Converts typographic characters to plain ones: minus signs, wide letters and digits, Greek letters, thin spaces.
pub(in crate::csv) fn plain(text: &str) -> String {
    let one = |c: char| match c {
        '\u{2212}' | '\u{2010}'..='\u{2015}' | '\u{fe63}' | '\u{ff0d}' => '-',
        '\u{ff01}'..='\u{ff5e}' => char::from_u32(c as u32 - 0xff01 + 0x21).unwrap_or(c),
        '\u{3000}' | '\u{a0}' | '\u{2000}'..='\u{200a}' | '\u{202f}' => ' ',
        '\u{3bd}' | '\u{39d}' => 'v',
        _ => c,
    };
    let mut typed = String::with_capacity(text.len());
    let mut was_raised = false;
    for c in text.chars() {
        // Write superscript digits as a power: `10⁻⁴`.
        let raised = RAISED.chars().position(|own| own == c).and_then(|at| "0123456789-".chars().nth(at));
        if raised.is_some() && !was_raised {
            typed.push('^');
        }
        typed.push(raised.unwrap_or_else(|| one(c)));
        was_raised = raised.is_some();
    }
    typed
}

/// Converts a number as printed (a blank after the sign, `1.2 x 10^-5`) to one that can be parsed. Digits separated by a blank are not
/// joined.
pub(in crate::csv) fn figure(cell: &str) -> String {
    let words: Vec<&str> = cell.split_whitespace().collect();
    let is_sign = |word: &str| ["-", "+", "x", "X", "×", "*"].contains(&word);
    let joins = |pair: &[&str]| is_sign(pair[0]) || is_sign(pair[1]) || pair[1].starts_with(['×', '*', '^', 'e', 'E']);
    if !words.windows(2).all(joins) {
        return cell.trim().to_owned();
    }
    let powers = words.concat().replace(['×', 'x', 'X'], "*").replace("**", "^");
    let typed = match powers.split_once("*10") {
        Some((head, tail)) => format!("{head}e{}", tail.trim_start_matches('^').trim_matches(['(', ')', '{', '}'])),
        None => powers,
    };
    if number::parse(&typed).is_some() { typed } else { cell.trim().to_owned() }
}

/// Returns the letters of a word in lower case.
fn letters(word: &str) -> String {
    word.chars().filter(|c| c.is_alphabetic()).flat_map(char::to_lowercase).collect()
}

/// Parses the mark of a surface: returns its number, whether it is the stop, and whether it is aspherical. `None` if it is not a mark.
pub(super) fn mark(cell: &str) -> Option<(Option<u32>, bool, bool)> {
    let digits: String = cell.chars().filter(char::is_ascii_digit).collect();
    let rest = letters(cell);
    let is_stop = is_stop(&rest) || rest == "s" || rest == "st";
    let is_marked = cell.contains(['*', '＊']) || rest.starts_with("asp");
    let is_number = rest.is_empty() || is_stop || is_marked || rest == "r";
    let bare = cell.chars().all(|c| c.is_alphanumeric() || "*() .:#-".contains(c));
    (is_number && bare && (!digits.is_empty() || is_stop) && digits.len() < 4)
        .then(|| (digits.parse().ok(), is_stop, is_marked))
}

/// Whether a word means the stop; the word is in lower case without blanks.
pub(super) fn is_stop(word: &str) -> bool {
    [
        "stop",
        "sto",
        "aperturestop",
        "apestop",
        "aperstop",
        "apstop",
        "diaphragm",
        "aperturediaphragm",
        "blende",
        "iris",
        "絞り",
        "開口絞り",
    ]
    .contains(&word)
}

/// Whether a remark consists only of a word for the stop: `Aperture stop S`, `(絞り)`.
pub(in crate::csv) fn is_stop_phrase(words: &str) -> bool {
    let plain = letters(words);
    is_stop(&plain) || is_stop(plain.trim_end_matches('s')) || is_stop(plain.trim_start_matches("the"))
}

/// Returns a note if the stop is mentioned in a sentence but has no row, with the line of the sentence.
pub(super) fn stop_in_prose(lines: &[&str]) -> Option<TableNote> {
    let is_about = |line: &&str| -> bool {
        let plain = line.to_lowercase();
        ["diaphragm", "aperture stop", "blende", "絞り"].iter().any(|word| plain.contains(word))
    };
    let at = lines.iter().position(is_about)?;
    let text =
        format!("the stop has no row, only a text: `{}`; add a row `stop` at its position", shortened(lines[at]));
    Some((at + 1, true, text))
}

/// Whether a gap has no number, but a word for a variable gap.
pub(in crate::csv) fn is_variable(cell: &str) -> bool {
    let plain: String = cell.to_lowercase().chars().filter(|c| !c.is_whitespace() && !"()[]".contains(*c)).collect();
    plain.starts_with("var") || plain == "可変" || is_back_focus(cell) || gap_number(Some(cell)).is_some()
}

/// Returns the number of a gap from its name, `d5`, `Di5` or `(D 5)`.
pub(super) fn gap_number(cell: Option<&str>) -> Option<u32> {
    let plain: String = cell?.to_lowercase().chars().filter(|c| !c.is_whitespace() && !"()[]".contains(*c)).collect();
    let rest = plain.strip_prefix("di").or(plain.strip_prefix('d'))?;
    rest.trim_end_matches("variable").parse().ok()
}

/// Whether a name means the back focus: `BF`, `B.F.`, `s'`.
pub(super) fn is_back_focus(name: &str) -> bool {
    let is_image_side = name.trim_start_matches(['(', '[']).starts_with("s'");
    is_image_side
        || ["bf", "fb", "bfl", "backfocus", "backfocallength", "schnittweite"].contains(&letters(name).as_str())
}

/// Returns the number of a surface from a phrase: `14`, `Third surface`, `第11面`.
pub(super) fn surface_number(words: &str) -> Option<u32> {
    const ORDINALS: [&str; 20] = [
        "first",
        "second",
        "third",
        "fourth",
        "fifth",
        "sixth",
        "seventh",
        "eighth",
        "ninth",
        "tenth",
        "eleventh",
        "twelfth",
        "thirteenth",
        "fourteenth",
        "fifteenth",
        "sixteenth",
        "seventeenth",
        "eighteenth",
        "nineteenth",
        "twentieth",
    ];
    let digits = words.split(|c: char| !c.is_ascii_digit()).find(|word| !word.is_empty());
    if let Some(digits) = digits {
        return digits.parse().ok();
    }
    let plain = words.to_lowercase();
    let mut of = plain.split(|c: char| !c.is_alphanumeric());
    of.find_map(|word| ORDINALS.iter().position(|ordinal| *ordinal == word)).map(|at| at as u32 + 1)
}

/// Words that begin the text after or before a table.
const OTHER: [&str; 18] = [
    "asph",
    "variable",
    "various",
    "zoom",
    "focal",
    "unit",
    "f-number",
    "fno",
    "f no",
    "image height",
    "half angle",
    "angle of view",
    "total",
    "conditional",
    "single lens",
    "data",
    "example",
    "table",
];

/// Whether a line begins something other than a row.
pub(super) fn is_other(line: &str) -> bool {
    let plain = line.trim().trim_start_matches(['[', '(', '<', '"', '【']).to_lowercase();
    OTHER.iter().any(|word| plain.starts_with(word)) || plain.starts_with("非球面") || plain.starts_with("各種")
}

/// Whether a word means a plane.
pub(super) fn is_plane(word: &str) -> bool {
    ["∞", "oo", "plane", "plano", "plan", "flat", "inf", "infinity", "infinite"].contains(&word.to_lowercase().as_str())
}

/// Whether a row is that of the object or the image, judged by its first words.
pub(super) fn is_end(words: &str) -> bool {
    let plain = words.trim().to_lowercase();
    ["obj", "img", "ima", "image", "物面", "物体面", "像面"].iter().any(|end| plain.starts_with(end))
}

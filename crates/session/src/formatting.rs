//! Formatting of numbers, times and file names for people.

/// Formats a count with a space between groups of digits: `157 286 400`.
#[must_use]
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut out = String::with_capacity(digits.len() + digits.len() / 3);
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            out.push(' ');
        }
        out.push(digit);
    }
    out
}

/// Formats a count with a noun: `1 ray`, `1 540 rays`.
#[must_use]
pub fn counted(value: u64, noun: &str) -> String {
    let plural = if value == 1 { "" } else { "s" };
    format!("{} {noun}{plural}", count(value))
}

/// Formats a rate in few characters: `23.4 million rays/s`.
#[must_use]
pub fn rate(rays_per_second: f64) -> String {
    match rays_per_second {
        r if r >= 1e9 => format!("{:.2} billion rays/s", r / 1e9),
        r if r >= 1e8 => format!("{:.0} million rays/s", r / 1e6),
        r if r >= 1e6 => format!("{:.1} million rays/s", r / 1e6),
        r if r >= 1e5 => format!("{:.2} million rays/s", r / 1e6),
        r => format!("{r:.0} rays/s"),
    }
}

/// Formats a duration: `0.8 s`, `41 s`, `2 min 03 s`, `1 h 05 min`.
#[must_use]
pub fn duration(seconds: f64) -> String {
    // Nobody waits for longer than this limit, a million hours.
    let whole = seconds.clamp(0.0, 3.6e9).round() as u64;
    match whole {
        0..10 => format!("{:.1} s", seconds.max(0.0)),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
    }
}

/// Formats a part of a whole in percent: `12 %`, or `0.3 %` with a decimal if it is small.
#[must_use]
pub fn percent(part: u64, whole: u64) -> String {
    let percent = 100.0 * part as f64 / whole.max(1) as f64;
    if percent < 9.95 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// Lists the files of one picture in a line: `out/a.exr, a-ortho.png, a.json`.
#[must_use]
pub fn files(names: &[String]) -> String {
    let folder = |name: &str| name.rfind(['/', '\\']).map_or(0, |at| at + 1);
    let first = names.first().map_or("", |name| &name[..folder(name)]);
    let short = |(at, name): (usize, &String)| match name.split_at(folder(name)) {
        (there, file) if at > 0 && there == first => file.to_owned(),
        _ => name.clone(),
    };
    let names: Vec<String> = names.iter().map(|name| name.strip_prefix("./").unwrap_or(name).to_owned()).collect();
    names.iter().enumerate().map(short).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped() {
        assert_eq!(
            ["0", "999", "1 000", "157 286 400"],
            [0, 999, 1000, 157_286_400].map(count).each_ref().map(String::as_str)
        );
    }

    #[test]
    fn one_is_no_plural() {
        assert_eq!([1, 0, 1540].map(|n| counted(n, "ray")), ["1 ray", "0 rays", "1 540 rays"]);
    }

    #[test]
    fn durations_keep_what_matters() {
        let shown = [0.84, 41.2, 59.7, 123.0, 3900.0, f64::INFINITY].map(duration);
        assert_eq!(shown, ["0.8 s", "41 s", "1 min 00 s", "2 min 03 s", "1 h 05 min", "1000000 h 00 min"]);
    }

    #[test]
    fn files_of_a_folder_share_a_line() {
        let names = ["out/a.exr", "out/a.png", "else/a.json"].map(str::to_owned);
        assert_eq!(files(&names), "out/a.exr, a.png, else/a.json");
        assert_eq!(files(&["./a.exr", "./a.png"].map(str::to_owned)), "a.exr, a.png");
    }

    #[test]
    fn rates_and_parts_are_short() {
        assert_eq!(
            [rate(950.0), rate(699_246.0), rate(3.81e6), rate(1.9e8)],
            ["950 rays/s", "0.70 million rays/s", "3.8 million rays/s", "190 million rays/s"]
        );
        assert_eq!([percent(1, 8), percent(1, 300), percent(0, 0)], ["12 %", "0.3 %", "0.0 %"]);
    }
}

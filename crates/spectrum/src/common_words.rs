//! Words that people use for light and for filters, and the bundled spectra that they mean: `tungsten`, `yellow`.

use crate::names::normalized;

/// Words, and what to write for each of them: the spectrum, then what else could be meant.
const WORDS: [(&[&str], &str, &str); 19] = [
    (
        &["daylight", "sunlight", "sun", "noon", "midday"],
        "D55",
        "5500 K, which daylight films are made for; D65 is bluer, D50 yellower",
    ),
    (&["flash", "strobe", "speedlight"], "D55", "5500 K, which daylight films are made for"),
    (&["cloudy", "overcast", "clouds"], "D65", "6500 K"),
    (&["shade", "sky", "skylight", "blue-sky"], "D75", "7500 K, or `daylight:10000`"),
    (&["moonlight", "moon"], "daylight:4100", "sunlight from a yellowish ground"),
    (&["sunset", "sunrise", "golden-hour"], "blackbody:3500", "or as low as `blackbody:2500`"),
    (&["candle", "candlelight", "fire", "flame"], "blackbody:1900", "1900 K"),
    (&["incandescent", "bulb", "light-bulb", "lamp", "edison"], "A", "a bulb of 2856 K"),
    (
        &["tungsten", "studio"],
        "A",
        "a bulb of 2856 K; a studio lamp is `iso-7589-studio-tungsten`, 3200 K is `blackbody:3200`",
    ),
    (&["halogen", "quartz"], "blackbody:3200", "3200 K"),
    (&["fluorescent", "office", "cool-white"], "FL2", "cool white; `FL11` has three narrow bands"),
    (&["led"], "LED-B3", "white of 4100 K; `led:450,20` is one chip"),
    (&["red"], "wratten-25", "a filter; deeper is `wratten-29`; light of a red chip is `led:630,20`"),
    (
        &["yellow"],
        "wratten-8",
        "a filter; deeper are `wratten-12` and `wratten-15`; light of a yellow chip is `led:590,20`",
    ),
    (&["orange"], "wratten-15", "a deep yellow filter, the nearest to it; light of an orange chip is `led:610,20`"),
    (&["green"], "wratten-58", "a filter; light of a green chip is `led:530,30`"),
    (&["blue"], "wratten-47", "a filter; light of a blue chip is `led:450,20`"),
    (&["magenta"], "wratten-32", "a filter"),
    (&["nd", "neutral-density"], "constant:0.125", "a filter of three stops"),
];

/// Returns a hint that says what to write for such a word.
pub(crate) fn hint_for_word(name: &str) -> Option<String> {
    let key = normalized(name);
    let key =
        key.strip_suffix("filter").or(key.strip_suffix("light").filter(|k| *k == "tungsten")).unwrap_or(key.as_str());
    let (_, spectrum, more) = WORDS.iter().find(|(words, ..)| words.iter().any(|word| normalized(word) == key))?;
    Some(format!("write `{spectrum}` ({more})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_word_leads_to_is_there() {
        for (words, spectrum, more) in WORDS {
            for name in std::iter::once(spectrum).chain(more.split('`').skip(1).step_by(2)) {
                let light = crate::find_emission(name).is_ok();
                assert!(light || crate::find_transmittance(name).is_ok(), "{words:?}: {name}");
            }
            for word in words {
                assert!(crate::find_emission(word).is_err(), "`{word}` is a spectrum's own name");
            }
        }
        assert_eq!(hint_for_word("Golden Hour").as_deref().map(|hint| &hint[..22]), Some("write `blackbody:3500`"));
        assert!(
            hint_for_word("yellow filter").is_some() && hint_for_word("D65").is_none() && hint_for_word("").is_none()
        );
    }
}

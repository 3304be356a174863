//! The keys of a film that affect its exposure.

/// Keys that only metered films have.
pub(crate) const KEYS: [&str; 4] = ["metering", "meter", "spot", "compensation"];
/// Other keys of a film that change the exposure of its pictures.
const OTHERS: [&str; 4] = ["exposure", "stock", "iso", "kind"];

/// Returns whether a path of a scene leads to something that affects the exposure: one of these keys, or the whole film.
pub(crate) fn is_of_meter(path: &str) -> bool {
    let mut steps = path.split(['.', '[']);
    let is_film = steps.next() == Some("film");
    let mut rest = steps.filter(|step| !step.ends_with(']'));
    is_film && rest.next().is_none_or(|key| KEYS.contains(&key) || OTHERS.contains(&key))
}

//! The keys of a film by which a camera meters.

/// Keys that only a camera which meters has.
pub(crate) const KEYS: [&str; 4] = ["metering", "meter", "spot", "compensation"];
/// Keys of a film besides by which the exposure of its pictures changes.
const OTHERS: [&str; 4] = ["exposure", "stock", "iso", "kind"];

/// Whether a path of a scene leads to what a film is exposed by: one of these keys, or the whole film.
pub(crate) fn is_of_meter(path: &str) -> bool {
    let mut steps = path.split(['.', '[']);
    let is_film = steps.next() == Some("film");
    let mut rest = steps.filter(|step| !step.ends_with(']'));
    is_film && rest.next().is_none_or(|key| KEYS.contains(&key) || OTHERS.contains(&key))
}

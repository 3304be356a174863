//! The keys of a film by which a camera meters.

use crate::Series;

/// Keys that only a camera which meters has.
pub(crate) const KEYS: [&str; 4] = ["metering", "meter", "spot", "compensation"];

/// Whether a series sets one of these keys, or an exposure, for each of its pictures: then each is metered by itself.
#[must_use]
pub fn is_animated(series: &Series) -> bool {
    let of_meter = |path: &String| {
        let mut steps = path.split(['.', '[']);
        let film = steps.next() == Some("film");
        let mut rest = steps.filter(|step| !step.ends_with(']'));
        film && rest.next().is_none_or(|key| {
            KEYS.contains(&key) || key == "exposure" || key == "stock" || key == "iso" || key == "kind"
        })
    };
    let used = |path: &String| match path.strip_prefix("variables.") {
        Some(name) => {
            let name = name.split(['.', '[']).next().unwrap_or(name);
            series.uses_of_variable(name).into_iter().map(|(path, _)| path).collect()
        }
        None => vec![path.clone()],
    };
    series.set_paths().iter().flat_map(used).any(|path| of_meter(&path))
}

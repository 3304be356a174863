//! Warnings about color film in light that it is not balanced for.
//!
//! A gray card in the light that a film is balanced for exposes its layers alike. In another white light one layer gets more than
//! another, and the picture has a cast. A photographer removes it with a conversion filter in front of the lens.

use crate::SceneFilm;
use crate::filters::conversion;
use spectra_color::cct;
use spectra_core::math::log2;
use spectra_core::params::{Node, Params, Value, Warning};
use spectra_core::spectral::{Channel, Grid, SpectralPower};
use spectra_spectrum::Observer;

/// Smallest difference between the layers, stops, that gives a warning. Daylight film between D50 and D75 stays below.
const STOPS: f64 = 1.0;
/// Largest distance from the Planckian locus (CIE 1960) at which light counts as white. More strongly colored light is taken as
/// intended.
const WHITE_DUV: f64 = 0.02;
/// Strongest conversion filter that is suggested, mired.
const MIRED: i32 = 250;

/// Returns the warnings about color casts of the films of a scene in its light. `channels` include the filters of the scene.
pub(crate) fn casts(
    films: &[SceneFilm],
    channels: &[Channel],
    light: &SpectralPower,
    grid: &Grid,
    params: &Params,
) -> Vec<Warning> {
    let filters = params.get("lens").and_then(|lens| lens.get("filters"));
    let filters: &[Node] = match filters.map(|node| &node.value) {
        Some(Value::Seq(items)) => items,
        _ => &[],
    };
    // A filter other than a conversion filter is there for its color.
    if filters.iter().any(|filter| filter.get("mired").is_none()) {
        return Vec::new();
    }
    let [x, y, z] = Observer::cie_1931_2deg().xyz_of_power(light);
    let sum = x + y + z;
    let Some(white) = cct([x / sum, y / sum]).filter(|white| white.duv.abs() <= WHITE_DUV) else { return Vec::new() };
    let of = |(index, film): (usize, &SceneFilm)| {
        let first = film.channels.start;
        let own = channels.get(first..first + film.film.balanced_channels())?;
        let spread = |mired: f64| -> Option<(f64, usize, usize)> {
            let filter = conversion(mired, grid);
            let exposures: Vec<f64> = own
                .iter()
                .map(|c| {
                    let filtered: Vec<f64> = c.response.iter().zip(&filter).map(|(r, t)| r * t).collect();
                    log2(light.seen_by(&filtered))
                })
                .collect();
            let by = |a: &&usize, b: &&usize| exposures[**a].total_cmp(&exposures[**b]);
            let all: Vec<usize> = (0..exposures.len()).collect();
            let (least, most) = (*all.iter().min_by(by)?, *all.iter().max_by(by)?);
            let stops = exposures[most] - exposures[least];
            stops.is_finite().then_some((stops, least, most))
        };
        let (stops, least, most) = spread(0.0)?;
        if stops < STOPS {
            return None;
        }
        let tried = (-MIRED..=MIRED).filter_map(|mired| spread(f64::from(mired)).map(|(left, ..)| (left, mired)));
        let (left, mired) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let at = place(film, index, params);
        let layer = |i: usize| own[i].name.rsplit('.').next().unwrap_or_default().to_owned();
        let text = format!(
            "{} is balanced for a different light from this one of {:.0} K: on a gray card its {} layer gets {stops:.1} stops more than its {} \
             layer, so the picture has a cast",
            film.film.name(),
            white.kelvin,
            layer(most),
            layer(least)
        );
        let hint = if left < 0.5 * stops && !filters.is_empty() {
            format!(
                "add `{{mired: {mired}}}` to `lens.filters`, or use a film balanced for this light; ignore this if the cast is intended"
            )
        } else if left < 0.5 * stops {
            format!(
                "write `lens.filters: [{{mired: {mired}}}]`, which is a conversion filter, or use a film balanced for this light; ignore \
                 this if the cast is intended"
            )
        } else {
            "use a film balanced for this light; ignore this if the cast is intended".to_owned()
        };
        Some(Warning(params.fault(&at, text).hint(hint)))
    };
    films.iter().enumerate().filter_map(of).collect()
}

/// Returns the path in a scene at which messages about a film are placed: its stock, or the film section if the section names no
/// stock. `index` is the film's place in the list of films.
#[must_use]
pub fn place(film: &SceneFilm, index: usize, params: &Params) -> String {
    let section = params.get("film").map(|node| if film.name.is_some() { node.element(index) } else { Some(node) });
    let at = film.name.as_ref().map_or_else(|| "film".to_owned(), |_| format!("film[{index}]"));
    if section.flatten().is_some_and(|node| node.get("stock").is_some()) { format!("{at}.stock") } else { at }
}

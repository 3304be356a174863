//! Films that an exposure leaves black or white all over, and those exposed for longer than anybody knows what they do.

use spectra_core::frame::ExposureFrame;
use spectra_core::math::log2;
use spectra_core::params::Warning;
use spectra_core::shutter;
use spectra_core::stage::Beyond;
use spectra_scene::{Scene, SceneFilm, place_of_film};

/// What is said of a scene's films of such a frame: at the exposure, with what to write in its place.
pub(crate) fn beyond(scene: &Scene, exposure: &ExposureFrame) -> Vec<Warning> {
    let of = |(index, film): (usize, &SceneFilm)| {
        let own = film.exposure(exposure);
        let beyond = film.film.beyond(&own)?;
        let at = film.name.as_ref().map_or_else(|| "film".to_owned(), |_| format!("film[{index}]"));
        let key = if film.film.is_metered() { "compensation" } else { "exposure" };
        let time_s = film.film.metered_time_s(&own);
        let gray_s = film.film.gray_time_s(&own)?;
        let stops = log2(time_s / gray_s);
        let text = format!(
            "the film is {} nearly all over: {} is {:.0} stops {} than the time at which the mean of the frame is a mid gray",
            if beyond == Beyond::Dark { "without light" } else { "saturated with light" },
            shutter::words(time_s),
            stops.abs(),
            if stops < 0.0 { "shorter" } else { "longer" }
        );
        let fault = scene.params.fault(&format!("{at}.{key}"), text);
        Some(Warning(fault.hint(if film.film.is_metered() {
            format!("`compensation` in stops, such as `1` or `-1`; the time without it is {}", shutter::words(gray_s))
        } else {
            format!("`exposure: {}`, or `metering: average` in place of `exposure`", shutter::words(gray_s))
        })))
    };
    let long = |(index, film): (usize, &SceneFilm)| {
        let time_s = film.film.metered_time_s(&film.exposure(exposure));
        let text = film.film.long_exposure_doubt(time_s)?;
        let fault = scene.params.fault(&place_of_film(film, index, &scene.params), text);
        Some(Warning(fault.hint(
            "open the lens or light the scene for a time of a second at most; or state `reciprocity` in a stock of your own, `like` this one",
        )))
    };
    let films = || scene.films.iter().enumerate();
    films().filter_map(of).chain(films().filter_map(long)).collect()
}

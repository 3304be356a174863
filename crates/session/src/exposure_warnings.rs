//! Warnings about films that an exposure leaves dark or saturated all over, and about exposures longer than a film's published
//! data cover.

use spectra_core::frame::ExposureFrame;
use spectra_core::math::log2;
use spectra_core::params::Warning;
use spectra_core::shutter;
use spectra_core::stage::Misexposure;
use spectra_scene::{Scene, SceneFilm, place_of_film};

/// Returns the warnings about films that a frame leaves dark or saturated, or whose exposure is longer than is known for them.
/// Each warning points at the exposure in the scene and says what to write instead.
pub(crate) fn exposure_warnings(scene: &Scene, exposure: &ExposureFrame) -> Vec<Warning> {
    let of = |(index, film): (usize, &SceneFilm)| {
        let own = film.exposure(exposure);
        let beyond = film.film.misexposure(&own)?;
        let at = film.name.as_ref().map_or_else(|| "film".to_owned(), |_| format!("film[{index}]"));
        let key = if film.film.is_metered() { "compensation" } else { "exposure" };
        let time_s = film.film.metered_time_s(&own);
        let gray_s = film.film.gray_time_s(&own)?;
        let stops = log2(time_s / gray_s);
        let text = format!(
            "nearly the whole film is {}: {} is {:.0} stops {} than the time that makes the mean of the frame a mid gray",
            if beyond == Misexposure::Dark { "unexposed" } else { "saturated" },
            shutter::format_time(time_s),
            stops.abs(),
            if stops < 0.0 { "shorter" } else { "longer" }
        );
        let fault = scene.params.fault(&format!("{at}.{key}"), text);
        Some(Warning(fault.hint(if film.film.is_metered() {
            format!(
                "set `compensation` in stops, such as `1` or `-1`; without it the time is {}",
                shutter::format_time(gray_s)
            )
        } else {
            format!("write `exposure: {}`, or `metering: average` instead of `exposure`", shutter::format_time(gray_s))
        })))
    };
    let long = |(index, film): (usize, &SceneFilm)| {
        let time_s = film.film.metered_time_s(&film.exposure(exposure));
        let text = film.film.long_exposure_warning(time_s)?;
        let fault = scene.params.fault(&place_of_film(film, index, &scene.params), text);
        Some(Warning(fault.hint(
            "open the aperture or add light until 1 s or less is enough; or write a stock file of your own with `like: NAME`, \
             the name of this stock, and its loss, such as `reciprocity: {exponent: 1.3, above: 1 s}`",
        )))
    };
    let films = || scene.films.iter().enumerate();
    films().filter_map(of).chain(films().filter_map(long)).collect()
}

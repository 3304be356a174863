//! Converts command-line options to settings of a scene's film.

use super::arguments::FilmKeys;
use super::load;
use crate::outcome::Failure;
use spectra_core::params::Fault;
use spectra_darkroom::Setting;
use std::path::Path;

/// Returns the setting of an option's value at a path of a scene.
pub(super) fn set(path: &str, option: &str, value: &str) -> Setting {
    Setting { path: path.to_owned(), value: value.to_owned(), as_typed: format!("{option} {value}") }
}

/// Returns a setting whose value follows from what the user wrote, `said`.
fn following(path: &str, said: String, value: &str) -> Setting {
    Setting { path: path.to_owned(), value: value.to_owned(), as_typed: said }
}

/// Returns the name of the stock for use in file names.
pub(super) fn stem(stock: &str) -> String {
    Path::new(stock).file_stem().map_or_else(|| stock.to_owned(), |s| s.to_string_lossy().into_owned())
}

/// Returns the light of the scene: `--illuminant`, or else the light that the stock is made for, in which gray stays gray.
pub(super) fn illuminant(keys: &FilmKeys, said: &str, stock: &str) -> Result<Setting, Failure> {
    Ok(match &keys.illuminant {
        Some(light) => set("source.illuminant", "--illuminant", light),
        None => following("source.illuminant", format!("--stock {said}"), &load(stock)?.reference_illuminant),
    })
}

/// Checks that `--exposure` is in stops. Photographers may give an exposure time instead; the error has a hint for that.
pub(super) fn stops(keys: &FilmKeys) -> Result<(), Failure> {
    let Some(said) = &keys.exposure else { return Ok(()) };
    let time = said.trim().trim_end_matches('s').trim_end();
    let is_time = time.len() < said.trim().len() || time.starts_with("1/");
    if is_time && time.trim_start_matches("1/").parse::<f64>().is_ok_and(|value| value > 0.0) {
        let text = format!("`--exposure` takes stops over or under the metered exposure, but `{said}` is a time");
        let hint = format!("write `--exposure=+1`, or set the time itself: `--set film.exposure=\"{time} s\"`");
        return Err(Fault::new(text).hint(hint).into());
    }
    Ok(())
}

/// Returns the settings of all film options, by the keys of a scene. `said` is the user's own name for `stock`.
pub(super) fn settings(keys: &FilmKeys, said: &str, stock: &str) -> Vec<Setting> {
    let mut all = vec![following("film.stock", format!("--stock {said}"), stock)];
    for (path, option, value) in [
        ("film.compensation", "--exposure", &keys.exposure),
        ("film.iso", "--iso", &keys.iso),
        ("film.development", "--development", &keys.development),
        ("film.push", "--push", &keys.push),
        ("film.view", "--view", &keys.viewing.view),
        ("film.print", "--print", &keys.viewing.print),
        ("film.paper.grade", "--grade", &keys.grade),
        ("film.scan", "--scan", &keys.scan),
    ] {
        all.extend(value.as_ref().map(|value| set(path, option, value)));
    }
    // Only a scan has a scale, so `--scan` alone implies the view `scan`.
    if let (Some(scale), None) = (&keys.scan, &keys.viewing.view) {
        all.push(following("film.view", format!("--scan {scale}"), "scan"));
    }
    all
}

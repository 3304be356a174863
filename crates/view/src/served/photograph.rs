//! Photographs in the viewer: the scene that `film develop` would make of one.

use spectra_core::stage::{Source, Still};
use spectra_darkroom::{Photograph, PictureJob, Setting, last_number};
use spectra_film::stock::Stock;
use spectra_scene::FileResources;
use spectra_session::{Rendering, Session, SessionError};
use std::path::Path;
use std::sync::Arc;

/// Stock of a photograph if none is named.
pub(super) const USUAL: &str = "kodak-portra-400";

/// Returns the settings that develop a photograph on a stock, in the light for which the stock is made, so that gray stays gray.
pub(super) fn of(file: &Path, stock: Option<&str>) -> Result<Photograph, SessionError> {
    let stock = stock.unwrap_or(USUAL);
    let light = light_of(stock)?;
    let name = file.file_stem().map_or_else(|| "photograph".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let setting = |path: &str, value: &str| Setting {
        path: path.to_owned(),
        value: value.to_owned(),
        as_typed: format!("--stock {stock}"),
    };
    Ok(Photograph {
        plate: PictureJob {
            file: file.to_string_lossy().into_owned(),
            output: format!("{name}.png"),
            number: last_number(&name),
        },
        settings: vec![setting("film.stock", stock), setting("source.illuminant", &light)],
        format: None,
    })
}

/// Returns the name of the light for which a stock is made.
///
/// # Errors
/// A stock that cannot be read.
pub(super) fn light_of(stock: &str) -> Result<String, SessionError> {
    Ok(Stock::load(stock, &FileResources::beside(Path::new("")))?.reference_illuminant)
}

/// Largest width at which the pixels of a photograph are kept for further exposures.
const KEPT_PX: u32 = 1920;

/// Pixels of a photograph that are kept for further exposures, because reading the file takes longer than everything else. A large
/// photograph is kept with fewer pixels.
pub(super) struct Small {
    /// Source to which the pixels belong.
    source: Arc<dyn Source>,
    still: Still,
    /// Width of the picture in the file, pixels.
    own_px: u32,
}

impl Small {
    /// Exposes the film of a scene to its photograph. Uses the pixels in `kept` if they are of the same source; otherwise reads them and
    /// stores them there.
    pub(super) fn expose(kept: &mut Option<Self>, session: &Session) -> Result<Rendering, SessionError> {
        let scene = session.scene();
        let known = kept.take_if(|small| Arc::ptr_eq(&small.source, &scene.source));
        let small = match known {
            Some(small) => small,
            None => {
                // For a source that is not a flat picture, `expose` returns the error.
                let Some(still) = scene.source.still() else { return session.expose() };
                let still = still?;
                let own_px = still.width_px;
                Self { source: Arc::clone(&scene.source), still: shrunk(still), own_px }
            }
        };
        let small = kept.insert(small);
        let has_enough = scene.imager.size().width_px <= small.still.width_px;
        if has_enough || small.own_px == small.still.width_px {
            session.expose_still(&small.still)
        } else {
            session.expose()
        }
    }
}

/// Returns the picture with at most [`KEPT_PX`] pixels across, each the mean of those that it covers.
fn shrunk(still: Still) -> Still {
    if still.width_px <= KEPT_PX {
        return still;
    }
    let [from_x, from_y] = [still.width_px, still.height_px].map(|n| n as usize);
    let to_x = KEPT_PX as usize;
    let to_y = (from_y * to_x).div_ceil(from_x).max(1);
    let span = |i: usize, from: usize, to: usize| i * from / to..((i + 1) * from / to).max(i * from / to + 1);
    let mut rgb = Vec::with_capacity(to_x * to_y);
    for y in 0..to_y {
        for x in 0..to_x {
            let (columns, rows) = (span(x, from_x, to_x), span(y, from_y, to_y));
            let mut sum = [0.0_f64; 3];
            for row in rows.clone() {
                for pixel in &still.rgb[row * from_x..][columns.clone()] {
                    sum.iter_mut().zip(pixel).for_each(|(sum, v)| *sum += f64::from(*v));
                }
            }
            let count = (columns.len() * rows.len()) as f64;
            rgb.push(sum.map(|sum| (sum / count) as f32));
        }
    }
    // The picture keeps its aspect ratio exactly, although the number of pixels is rounded.
    let aspect = still.pixel_aspect * from_x as f64 / from_y as f64;
    Still {
        width_px: to_x as u32,
        height_px: to_y as u32,
        pixel_aspect: aspect * to_y as f64 / to_x as f64,
        rgb,
        ..still
    }
}

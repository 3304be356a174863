//! `spectra picture plot`: plots a quantity in false color, or the picture in its colors.

use super::arguments::PicturePlot;
use super::{field, load, output, quantity, refuse, stem};
use crate::console;
use crate::folder::apart;
use crate::outcome::{DONE, Outcome};
use spectra_analysis::picture::{Quantity, Scale, clipping, color, view};
use spectra_plot::Format;

/// Word of `--quantity` for the view of clipped pixels.
const CLIPPING: &str = "clipping";
/// Word of `--quantity` for the picture in its colors.
const COLOR: &str = "color";

/// Plots a picture in false color or in its colors, and writes the figure to a file.
pub(super) fn plot(arguments: &PicturePlot) -> Outcome {
    let path = &arguments.file;
    if let Some(given) = &arguments.output {
        // A wrong extension is reported before anything is read.
        Format::of(given)?;
    }
    let picture = load(path)?;
    let asked = arguments.quantity.as_deref().map(str::trim);
    let white = arguments.white.white;
    let eye = arguments.seen_by;
    // With --seen-by alone, the picture itself is shown.
    let asked = asked.or(eye.map(|_| COLOR));
    let (canvas, name) = if asked == Some(COLOR) && picture.planes.channel(COLOR).is_none() {
        let title = match eye {
            Some(eye) => format!("{}: as {} sees it", stem(path), eye.eye()),
            None => format!("{}: color", stem(path)),
        };
        (color(&picture, white, &title).map_err(|error| refuse(path, error))?, COLOR.to_owned())
    } else if asked == Some(CLIPPING) && picture.planes.channel(CLIPPING).is_none() {
        let title = format!("{}: clipping", stem(path));
        (clipping(&picture, white, &title).map_err(|error| refuse(path, error))?, CLIPPING.to_owned())
    } else {
        let asked = asked.map(|name| quantity(name, &picture, &[CLIPPING, COLOR])).transpose()?;
        let quantity = asked.unwrap_or_else(|| Quantity::usual(&picture));
        let name = match &quantity {
            Quantity::Channel(name) => name.clone(),
            other => Quantity::NAMED.iter().find(|(_, own)| own == other).map_or("view", |(word, _)| word).to_owned(),
        };
        let field = field(path, &picture, &quantity, white)?;
        let scale = Scale { is_log: arguments.log, range: arguments.range };
        let title = format!("{}: {}", stem(path), field.name);
        (view(&picture, &field, scale, &title).map_err(|error| refuse(path, error))?, name)
    };
    let (canvas, name) = match eye {
        None => (canvas, name),
        Some(eye) => (eye.simulate(canvas), format!("{name}-{}", eye.word())),
    };
    let output = output(arguments.output.as_ref(), path, &format!("{name}.png"));
    apart(&output, &[path])?;
    canvas.write(&output)?;
    console::note(&format!("wrote {}", output.display()));
    Ok(DONE)
}

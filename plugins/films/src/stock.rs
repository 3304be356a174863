//! `film: stock`, black-and-white negative film from a data file, printed.

use serde::Deserialize;
use spectra_core::frame::{DisplayPicture, ExposureFrame};
use spectra_core::math::log10;
use spectra_core::params::{Fault, Faults, Params, Positive, Time, nearest};
use spectra_core::registry::{Context, FilmEntry};
use spectra_core::spectral::Channel;
use spectra_core::stage::Film;
use spectra_film::develop::develop;
use spectra_film::print::{Paper, Print, metered_exposure_lx_s};
use spectra_film::stock::Stock;

/// Parameters of `kind: stock` as written in a scene.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct StockParams {
    /// Name of a bundled stock, such as `ilford-ortho-plus`, or a YAML file beside the scene.
    pub stock: String,
    /// Exposure time, s if bare.
    pub exposure: Positive<Time>,
    /// How the film is developed: a name from the stock's file; the first one there if left out.
    #[serde(default)]
    pub development: Option<String>,
}

/// A black-and-white negative film, developed and printed.
#[derive(Clone, Debug)]
pub struct StockFilm {
    stock: Stock,
    development: String,
    channels: Vec<Channel>,
    exposure_time_s: f64,
    print: Print,
}

impl StockFilm {
    /// The film that `params` describe.
    ///
    /// # Errors
    /// What is wrong with the parameters or with the stock's file.
    pub fn build(params: &Params, context: &Context<'_>) -> Result<Self, Faults> {
        let StockParams { stock, exposure, development } = params.parse()?;
        let stock = Stock::load(&stock, context.resources).map_err(|faults| place_at_stock(faults, params, &stock))?;
        let [layer] = &stock.layers[..] else {
            let text = format!("{} has {} layers; this process develops films of one", stock.name, stock.layers.len());
            return Err(params.fault("stock", text).into());
        };
        let chosen = match &development {
            None => layer.developments.first(),
            Some(name) => layer.development(name),
        };
        let Some(chosen) = chosen else {
            let known: Vec<&str> = layer.developments.iter().map(|d| d.name.as_str()).collect();
            let text = format!("{} has no curve for the development `{}`", stock.name, development.unwrap_or_default());
            return Err(params.fault("development", text).hint(format!("known: {}", known.join(", "))).into());
        };
        let gray = chosen.curve.density(log10(metered_exposure_lx_s(stock.iso)));
        let unprintable = |error| params.fault("stock", format!("{}: {error}", stock.name));
        let print = Print::balanced(&Paper::default(), chosen.curve.unexposed_density(), gray).map_err(unprintable)?;
        let blind = |error| params.fault("stock", format!("{}: {error}", stock.name));
        let channels = stock.channels(&context.grid).map_err(blind)?;
        let development = chosen.name.clone();
        Ok(Self { stock, development, channels, exposure_time_s: exposure.s(), print })
    }

    /// The stock.
    #[must_use]
    pub fn stock(&self) -> &Stock {
        &self.stock
    }

    /// The print that it ends in.
    #[must_use]
    pub fn print(&self) -> &Print {
        &self.print
    }
}

/// A file that is not found has no place of its own: the key that names it has.
fn place_at_stock(faults: Faults, params: &Params, name: &str) -> Faults {
    let place = |fault: Fault| {
        if fault.place.is_some() {
            return fault;
        }
        let known: Vec<&str> = Stock::bundled().collect();
        let hint = match (nearest(name, known.iter().copied()), fault.hint) {
            (Some(near), _) => format!("did you mean `{near}`?"),
            (None, Some(hint)) => hint,
            (None, None) => format!("bundled stocks: {}", known.join(", ")),
        };
        params.fault("stock", fault.message).hint(hint)
    };
    faults.into_iter().map(place).collect::<Vec<_>>().into()
}

impl Film for StockFilm {
    fn channels(&self) -> Vec<Channel> {
        self.channels.clone()
    }

    fn exposure_time_s(&self) -> f64 {
        self.exposure_time_s
    }

    fn develop(&self, exposure: &ExposureFrame) -> Result<DisplayPicture, String> {
        let developed = develop(&self.stock, &self.development, exposure, self.exposure_time_s);
        let developed = developed.map_err(|error| error.to_string())?;
        let size = developed.size;
        // One layer, as `build` saw to it.
        let gray = developed.layers.iter().flat_map(|layer| self.print.pictures(&layer.density));
        let rgb = gray.map(|v| [v; 3]).collect();
        Ok(DisplayPicture { width_px: size.width_px, height_px: size.height_px, rgb })
    }

    fn describe(&self) -> String {
        let assumed = self.stock.layers.iter().any(|l| l.development(&self.development).is_some_and(|d| d.assumed));
        let curve = if assumed { " (curve assumed)" } else { "" };
        format!(
            "{}, ISO {}, {} development{curve}, exposed for {} s, printed",
            self.stock.name, self.stock.iso, self.development, self.exposure_time_s
        )
    }
}

fn build(params: &Params, context: &Context<'_>) -> Result<Box<dyn Film>, Faults> {
    Ok(Box::new(StockFilm::build(params, context)?))
}

inventory::submit! {
    FilmEntry::new(
        "stock",
        "Black-and-white negative film from a data file, developed and printed.",
        env!("CARGO_PKG_NAME"),
        env!("CARGO_PKG_VERSION"),
        build,
    )
    .or_default()
}

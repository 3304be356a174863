//! Turns a developed film into the picture that a scene asks for: a print, a scan, a projection or the film itself.

use crate::settings::StockParams;
use crate::stocks::load_stock;
use crate::view::{Grade, PaperPrint, Picture, ScanParams, View};
use spectra_core::math::log10;
use spectra_core::params::{Faults, Params, Positive as AboveZero};
use spectra_core::resources::Resources;
use spectra_film::emulsion::Emulsion;
use spectra_film::positive::{Positive, PositiveError};
use spectra_film::print::{Paper, Print, USUAL_GRADE};
use spectra_film::stock::{Medium, Process, Stock};
use spectra_film::viewing_options::{PictureWhite, ViewingOptions};
use spectra_spectrum::{Emission, find_emission_in};

/// A picture process and its description in words.
pub(crate) struct DescribedProcess {
    pub picture: Picture,
    pub words: String,
}

/// Builds the process that turns a developed `film` into the picture that `p` asks for. `gray_lx_s` is the exposure that a mid gray
/// subject left on the film, lx s.
pub(crate) fn build_process(
    p: &StockParams,
    params: &Params,
    resources: &dyn Resources,
    stock: &Stock,
    film: &Emulsion,
    gray_lx_s: f64,
) -> Result<DescribedProcess, Faults> {
    let mut faults = Faults::new();
    let usual = if stock.process == Process::Reversal { View::Projection } else { View::Print };
    let view = p.view.unwrap_or(usual);
    let printed = view == View::Print;
    if p.paper.is_some() && (film.layers() != 1 || stock.process == Process::Reversal) {
        let text = format!("`paper` is for black-and-white negatives, which {} is not", stock.name);
        let hint = if stock.process == Process::Reversal {
            "leave `paper` out"
        } else {
            "leave `paper` out; `print: kodak-endura-premier` is a paper for color negatives"
        };
        return Err(params.fault("paper", text).hint(hint).into());
    }
    for (key, given) in [
        ("print", p.print.is_some()),
        ("print-development", p.print_development.is_some()),
        ("paper", p.paper.is_some()),
        ("lamp", p.lamp.is_some()),
    ] {
        if given && !printed {
            faults.push(
                params
                    .fault(key, "this applies to prints only")
                    .hint(format!("write `view: print`, or leave `{key}` out")),
            );
        }
    }
    if p.scan.is_some() && view != View::Scan {
        faults.push(params.fault("scan", "this applies to scans only").hint("write `view: scan`, or leave `scan` out"));
    }
    for (key, given) in [("surround", p.surround.is_some()), ("black", p.black.is_some())] {
        if given && matches!(view, View::Scan | View::Negative) {
            faults.push(
                params.fault(key, "this applies to prints and projections only").hint(format!("leave `{key}` out")),
            );
        }
    }
    let look = ViewingOptions {
        white: p.white.unwrap_or_default().into(),
        black: p.black.unwrap_or_default().into(),
        surround: p.surround.unwrap_or_default().into(),
    };
    let light = faults.take(emission(params, "light", p.light.as_deref().unwrap_or("D55"), resources));
    let lamp = match p.lamp.as_deref() {
        Some(name) => faults.take(emission(params, "lamp", name, resources)).map(Some),
        None => Some(None),
    };
    match (view, stock.process) {
        (View::Print | View::Negative | View::Scan, Process::Reversal) => {
            let fault = params.fault("view", format!("{} is already a positive", stock.name));
            faults.push(fault.hint("write `view: projection`"));
        }
        (View::Projection, Process::Negative) => {
            let fault = params.fault("view", format!("{} is a negative, and would be projected as one", stock.name));
            faults.push(fault.hint("write `view: print`, `view: scan` or `view: negative`"));
        }
        _ => {}
    }
    let (Some(light), Some(lamp)) = faults.into_result((light, lamp))? else { return Err(Faults::new()) };
    let unfit = |error: PositiveError| Faults::from(params.fault("stock", format!("{}: {error}", stock.name)));
    let positive =
        |picture: Positive, words: String| DescribedProcess { picture: Picture::Positive(Box::new(picture)), words };
    match view {
        View::Print => print(p, params, resources, stock, film, gray_lx_s, &Lights { light, lamp, look }),
        View::Scan => {
            let scale = p.scan.unwrap_or_default();
            let words = match scale {
                ScanParams::Picture => "scanned",
                ScanParams::Log => "scanned, logarithmic (Cineon)",
                ScanParams::Adx => "scanned, logarithmic (ADX16)",
                ScanParams::Density => "scanned, density / 4",
            };
            let scan = Positive::scanned(stock, film, gray_lx_s, scale.into()).map_err(unfit)?;
            Ok(positive(scan, words.into()))
        }
        View::Negative => {
            let lamp = ViewingOptions { white: PictureWhite::Lamp, ..ViewingOptions::default() };
            let table = Positive::transmitted(stock, film, &light, lamp).map_err(unfit)?;
            Ok(positive(table, "the negative itself".into()))
        }
        View::Projection => {
            let projected = Positive::transmitted(stock, film, &light, look).map_err(unfit)?;
            Ok(positive(projected, "projected".into()))
        }
    }
}

/// The lights by which a print is made and viewed.
struct Lights {
    /// Light by which the print is viewed.
    light: Emission,
    /// Lamp of the printer; the print stock's reference light if `None`.
    lamp: Option<Emission>,
    /// White, black and surround of the finished picture.
    look: ViewingOptions,
}

fn print(
    p: &StockParams,
    params: &Params,
    resources: &dyn Resources,
    stock: &Stock,
    film: &Emulsion,
    gray_lx_s: f64,
    lights: &Lights,
) -> Result<DescribedProcess, Faults> {
    let on = match (&p.print, &p.paper, &stock.print) {
        (Some(_), Some(_), _) => {
            let fault = params.fault("paper", "a print is either on a print stock or on paper");
            return Err(fault.hint("keep either `print` or `paper`").into());
        }
        (Some(name), None, _) => Some(name.clone()),
        (None, None, Some(usual)) => Some(usual.clone()),
        _ => None,
    };
    let Some(on) = on else {
        if film.layers() != 1 {
            let fault = params.fault("stock", format!("{} needs a print stock for its colors", stock.name));
            return Err(fault.hint("write `print: kodak-vision-2383`, or `view: scan`").into());
        }
        return on_paper(p, params, stock, film, gray_lx_s, lights.look);
    };
    let print_stock = load_stock(&on, "print", params, resources)?;
    if print_stock.medium == Medium::Paper {
        no_surround(p, params)?;
    }
    let development = match &p.print_development {
        Some(name) => name.clone(),
        None => print_stock.developments().next().unwrap_or_default().to_owned(),
    };
    let key = if p.print_development.is_some() { "print-development" } else { "print" };
    let emulsion = Emulsion::new(&print_stock, &development).map_err(|e| params.fault(key, e.to_string()))?;
    let lamp = lights.lamp.as_ref().unwrap_or(&print_stock.reference);
    let positive = Positive::printed(film, gray_lx_s, &print_stock, emulsion, lamp, &lights.light, lights.look);
    let positive = positive.map_err(|error| {
        // If the scene names no print stock, this one came from the camera film's file.
        let key = if p.print.is_some() { "print" } else { "stock" };
        let text = match &error {
            PositiveError::NoPrintStock { .. } => error.to_string(),
            _ => format!("{} cannot be printed on {error}", stock.name),
        };
        let fault = params.fault(key, text);
        match error {
            PositiveError::Unbalanced { .. } => {
                fault.hint("write `view: scan` to see the film without a print, or name another print stock at `print`")
            }
            PositiveError::NoPrintStock { .. } => fault.hint("`spectra list stock` lists the print stocks separately"),
            PositiveError::DarkLight | PositiveError::NoGray => fault,
        }
    })?;
    Ok(DescribedProcess {
        picture: Picture::Positive(Box::new(positive)),
        words: format!("printed on {}", print_stock.name),
    })
}

/// Checks that no surround is set for a print on paper, which hangs in a lit room.
fn no_surround(p: &StockParams, params: &Params) -> Result<(), Faults> {
    if p.surround.is_none() {
        return Ok(());
    }
    let fault = params.fault("surround", "a print on paper is viewed in a lit room");
    Err(fault.hint("leave `surround` out, or print on film: `print: kodak-vision-2383`").into())
}

fn on_paper(
    p: &StockParams,
    params: &Params,
    stock: &Stock,
    film: &Emulsion,
    gray_lx_s: f64,
    look: ViewingOptions,
) -> Result<DescribedProcess, Faults> {
    no_surround(p, params)?;
    let grade = p.paper.and_then(|p| p.grade);
    let stated = match grade {
        Some(Grade::Number(grade)) => Some(grade),
        Some(Grade::Auto(_)) | None => None,
    };
    let Some(range) = Paper::range_of_grade(stated.unwrap_or(USUAL_GRADE)) else {
        let text = format!("there is no paper of grade {}", stated.unwrap_or_default());
        return Err(params
            .fault("paper.grade", text)
            .hint("write a grade from 0 (soft) to 5 (hard), or `auto`")
            .into());
    };
    if grade.is_some() && p.paper.is_some_and(|p| p.range.is_some()) {
        let fault = params.fault("paper.range", "a grade has its own range");
        return Err(fault.hint("keep either `grade` or `range`").into());
    }
    if p.white.is_some() {
        let fault = params.fault("white", "the white of a print on paper is the paper");
        return Err(fault.hint("leave `white` out, or print on film: `print: kodak-2302`").into());
    }
    let usual = Paper::of_range(p.paper.and_then(|p| p.range).map_or(range, AboveZero::get));
    let given = |value: Option<Option<AboveZero<f64>>>, usual: f64| value.flatten().map_or(usual, AboveZero::get);
    let paper = Paper {
        range: usual.range,
        maximum_density: given(p.paper.map(|p| p.maximum_density), usual.maximum_density),
        toe: given(p.paper.map(|p| p.toe), usual.toe),
        shoulder: given(p.paper.map(|p| p.shoulder), usual.shoulder),
    };
    let gray = film.amount(0, log10(gray_lx_s));
    let print = Print::balanced(&paper, film.amount(0, f64::NEG_INFINITY), gray, look.black);
    let key = if p.paper.is_some() { "paper" } else { "stock" };
    let print = print.map_err(|error| params.fault(key, format!("{}: {error}", stock.name)))?;
    let automatic = matches!(grade, Some(Grade::Auto(_)));
    let words = match p.paper.and_then(|p| p.range) {
        Some(range) => format!("printed on paper of range {}", range.get()),
        None if automatic => "printed on the grade of paper that suits it".to_owned(),
        None => format!("printed on paper of grade {}", stated.unwrap_or(USUAL_GRADE)),
    };
    let picture = PaperPrint { metered: print, automatic: automatic.then_some(paper), black: look.black };
    Ok(DescribedProcess { picture: Picture::Paper(Box::new(picture)), words })
}

fn emission(params: &Params, key: &str, name: &str, resources: &dyn Resources) -> Result<Emission, Faults> {
    find_emission_in(name, resources).map_err(|error| error.faults(|text| params.fault(key, text)))
}

//! Warnings about likely mistakes, and about data that make a picture less accurate than it looks. They need the whole scene.
//!
//! A bare number has the unit that its key states. A slip there still makes a picture, but a wrong one. The rules here look for
//! numbers without a unit, and for values that no camera has.

use crate::cached_resources::BUNDLED;
use crate::frame_view::UncoveredFrame;
use spectra_core::params::{Length, Node, OrInfinity, Params, Positive, Value, Warnings};
use spectra_core::resources::Resources;
use spectra_core::spectral::{Channel, Grid};
use spectra_core::stage::Source;
use spectra_lens::Lens;

/// Shortest exposure without a unit, s, that gives a warning: `125` is probably meant as 1/125 s.
const LONG_S: f64 = 8.0;
/// Fraction of the focal length. A source nearer than that gives a warning if its distance has no unit: `2` is probably meant as
/// 2 m.
const NEAR: f64 = 0.5;
/// Largest fraction of the exposure that may rest on extrapolated data without a warning.
const UNMEASURED: f64 = 0.01;
/// Limit like [`UNMEASURED`] for the glass of a bundled lens: all known data are in its file, and users cannot add any.
const UNMEASURED_BUNDLED: f64 = 0.25;

/// A scene with all its parts assembled.
pub(crate) struct AssembledScene<'a> {
    pub params: &'a Params,
    pub resources: &'a dyn Resources,
    pub lens: &'a Lens,
    pub source: &'a dyn Source,
    pub channels: &'a [Channel],
    pub grid: Grid,
    /// Whether ghosts are traced, or may be.
    pub ghosts: bool,
}

impl AssembledScene<'_> {
    /// Adds all warnings about the scene.
    pub(crate) fn warn(&self, dark: Option<&UncoveredFrame>, warnings: &Warnings) {
        for text in &self.lens.warnings {
            let hint = format!("`spectra lens info {}` shows the glass behind each surface", self.lens_file());
            warnings.push(self.params.fault("lens.file", text).hint(hint));
        }
        self.distances(warnings);
        self.focus(warnings);
        self.exposures(warnings);
        if let Some(dark) = dark {
            self.dark(dark, warnings);
        }
        self.light(warnings);
        self.glass(warnings);
        self.assumed_absorption(warnings);
        self.ghosts(warnings);
    }

    /// Warns about prisms: the ghosts of their faces are not traced.
    fn ghosts(&self, warnings: &Warnings) {
        let elements = self.lens.elements.iter().enumerate();
        let prisms: Vec<String> =
            elements.filter(|(_, e)| e.solid.is_some()).map(|(at, _)| (at + 1).to_string()).collect();
        if prisms.is_empty() || !self.ghosts {
            return;
        }
        let key = "render.reflections.order";
        let key = if self.at(key).is_some() { key } else { "lens.file" };
        let text = format!(
            "ghosts that the faces of a prism reflect (surface{} {} of the lens) are not traced, so their light is missing in the picture",
            if prisms.len() == 1 { "" } else { "s" },
            prisms.join(", ")
        );
        let hint = "write the faces as surfaces of `kind: plane` between bends of the axis to get their ghosts; `order: 0` traces none";
        warnings.push(self.params.fault(key, text).hint(hint));
    }

    /// Warns about a source that is very close to the lens.
    fn distances(&self, warnings: &Warnings) {
        let efl_mm = self.lens.first_order(self.lens.reference_nm).efl_mm.abs();
        let source = self.params.get("source");
        let layers = source.and_then(|source| source.get("layers")).map_or(0, |layers| match &layers.value {
            Value::Seq(items) => items.len(),
            _ => 0,
        });
        let keys = (0..layers).map(|i| format!("source.layers[{i}].distance"));
        for key in std::iter::once("source.distance".to_owned()).chain(keys) {
            let Some(mm) = self.at(&key).and_then(bare) else { continue };
            if efl_mm.is_finite() && mm < NEAR * efl_mm {
                let fault = self.params.fault(&key, format!("this is only {mm} mm in front of the lens"));
                warnings.push(
                    fault.hint(format!(
                        "a number without a unit is in mm: did you mean `{mm} m`? If not, write `{mm} mm`"
                    )),
                );
            }
        }
    }

    /// Warns about a focus so near that the image is larger than the subject.
    fn focus(&self, warnings: &Warnings) {
        let key = if self.at("lens.focus.distance").is_some() { "lens.focus.distance" } else { "lens.focus" };
        let Some(node) = self.at(key) else { return };
        let Ok(distance) = node.parse::<OrInfinity<Positive<Length>>>() else { return };
        let mm = distance.mm();
        let first = self.lens.first_order(self.lens.reference_nm);
        let magnification = self.lens.paraxial_magnification(mm, self.lens.reference_nm).abs();
        if !(mm.is_finite() && first.efl_mm.is_finite() && magnification > 1.0) {
            return;
        }
        let text = if mm <= -first.ffl_mm {
            format!("focused at {mm} mm, which is within the focal length: no image is formed on the film")
        } else {
            format!("focused at {mm} mm: the image on the film is {magnification:.1} times as large as the subject")
        };
        let hint = match bare(node) {
            Some(number) => format!("a number without a unit is in mm: did you mean `{number} m`?"),
            None => "`focus` is measured from the first vertex of the lens, such as `focus: 2 m`".to_owned(),
        };
        warnings.push(self.params.fault(key, text).hint(hint));
    }

    /// Warns about exposures of many seconds.
    fn exposures(&self, warnings: &Warnings) {
        let films = match self.params.get("film").map(|film| &film.value) {
            Some(Value::Seq(items)) => (0..items.len()).map(|i| format!("film[{i}].exposure")).collect(),
            _ => vec!["film.exposure".to_owned()],
        };
        for key in films.into_iter().chain(["imager.exposure".to_owned()]) {
            let Some(seconds) = self.at(&key).and_then(bare).filter(|s| *s >= LONG_S && s.is_finite()) else {
                continue;
            };
            let fault = self.params.fault(&key, format!("an exposure of {seconds} seconds"));
            warnings.push(fault.hint(format!("did you mean `1/{seconds} s`? If not, write `{seconds} s`")));
        }
    }

    /// Warns about a frame that is larger than the image circle of the lens.
    fn dark(&self, dark: &UncoveredFrame, warnings: &Warnings) {
        let Some(circle_mm) = dark.circle_mm else { return };
        let key = if self.at("imager.format").is_some() { "imager.format" } else { "imager.width" };
        let text = format!(
            "the image circle of this lens is about {circle_mm:.0} mm; the frame's diagonal is {:.0} mm, so {:.0} % of the frame stays dark",
            dark.diagonal_mm,
            (100.0 * dark.share).max(1.0)
        );
        let hint = format!(
            "use a frame with a diagonal of at most {circle_mm:.0} mm, or a lens that covers this one (`spectra list lens`)"
        );
        warnings.push(self.params.fault(key, text).hint(hint));
    }

    /// Warns about light that is extrapolated with constant values beyond the measured range.
    fn light(&self, warnings: &Warnings) {
        for end in warnings.ends() {
            let [first, last] = end.measured_nm;
            let share = self.share(|nm| nm < first || nm > last);
            if share > UNMEASURED {
                let text = format!(
                    "`{}` has rows from {first:.0} to {last:.0} nm; beyond them its end values are used, which make {:.0} % of the exposure",
                    end.place.message,
                    100.0 * share
                );
                let fault = spectra_core::params::Fault { message: text, ..end.place };
                let hint = "if there is no light beyond, end the table with a row of 0, or write `# outside: zero` at the top of a CSV file \
                            (`outside: zero` of a table in YAML)";
                warnings.push(fault.hint(hint));
            }
        }
    }

    fn lens_file(&self) -> &str {
        self.at("lens.file").and_then(Node::as_str).unwrap_or_default()
    }

    /// Returns whether the lens is a bundled one, whatever part of its name is given.
    fn is_bundled_lens(&self) -> bool {
        let read = self.resources.document(self.lens_file(), &["lenses"], &[".yaml"]);
        read.is_ok_and(|read| read.node().file.name.starts_with(BUNDLED))
    }

    /// Warns about glass with unknown absorption, if the absorption assumed instead darkens the picture.
    fn assumed_absorption(&self, warnings: &Warnings) {
        if let Some((medium, lender, stops)) = self.lens.darkened_by_assumption() {
            let text = format!(
                "the absorption of {medium} is not known; that of {} is assumed, which darkens the lens by {stops:.1} stops at {:.0} nm",
                lender.full_name, self.lens.reference_nm
            );
            let hint = "write `lens.absorption: false` if the lens is clear, or a glass file of its own with `internal-transmittance`";
            warnings.push(self.params.fault("lens.file", text).hint(hint));
        }
    }

    /// Warns about glass whose formula is used outside the measured range.
    fn glass(&self, warnings: &Warnings) {
        let may = if self.is_bundled_lens() { UNMEASURED_BUNDLED } else { UNMEASURED };
        let (from_nm, to_nm) = (self.grid.start_nm, self.grid.end_nm());
        let beyond = self.lens.media.iter().filter(|medium| !medium.medium.covers(from_nm, to_nm));
        let ranges: Vec<(&str, (f64, f64))> =
            beyond.filter_map(|medium| Some((medium.label.as_str(), medium.medium.range_nm()?))).collect();
        let share = self.share(|nm| ranges.iter().any(|(_, (first, last))| nm < *first || nm > *last));
        if share > may {
            let named: Vec<String> = ranges
                .iter()
                .map(|(label, (first, last))| format!("{label} from {first:.0} to {last:.0} nm"))
                .collect();
            let text = format!(
                "{:.0} % of the exposure lies beyond the wavelengths at which the lens's glass was measured, so its formula is extrapolated: {}",
                100.0 * share,
                named.join(", ")
            );
            let hint = "use a glass that was measured there, or `wavelengths: {band: [400 nm, 700 nm]}`";
            warnings.push(self.params.fault("lens.file", text).hint(hint));
        }
    }

    /// Returns the fraction of the exposure, summed over all channels, that comes from the wavelengths that `is_counted` selects.
    fn share(&self, is_counted: impl Fn(f64) -> bool) -> f64 {
        let spectrum = self.source.spectrum();
        let (mut counted, mut all) = (0.0, 0.0);
        let mut add = |nm: f64, exposure: f64| {
            all += exposure;
            counted += if is_counted(nm) { exposure } else { 0.0 };
        };
        for (i, (nm, power)) in self.grid.wavelengths_nm().zip(&spectrum.continuum).enumerate() {
            let response: f64 = self.channels.iter().filter_map(|c| c.response.get(i)).map(|r| r.max(0.0)).sum();
            add(nm, power * response * self.grid.step_nm);
        }
        for line in &spectrum.lines {
            let i = ((line.wavelength_nm - self.grid.start_nm) / self.grid.step_nm).round();
            if i >= 0.0 {
                let response: f64 =
                    self.channels.iter().filter_map(|c| c.response.get(i as usize)).map(|r| r.max(0.0)).sum();
                add(line.wavelength_nm, line.power * response);
            }
        }
        if all > 0.0 { counted / all } else { 0.0 }
    }

    /// Returns the value at a path of the scene.
    fn at(&self, path: &str) -> Option<&Node> {
        let mut node = self.params.node();
        for step in path.split('.') {
            let (key, index) = match step.split_once('[') {
                Some((key, index)) => (key, index.trim_end_matches(']').parse::<usize>().ok()),
                None => (step, None),
            };
            node = node.get(key)?;
            if let Some(index) = index {
                node = node.element(index)?;
            }
        }
        Some(node)
    }
}

/// Returns a number that was written without a unit.
fn bare(node: &Node) -> Option<f64> {
    match &node.value {
        Value::Number(number) => Some(number.value),
        _ => None,
    }
}

//! The dispersion study: a thin beam through a prism, ray by ray, and fits of Cauchy's formula to the glass of the prism.
//!
//! A page sends numbers and places in lists. The prism is put together here as the text of a lens file, and traced like any lens.

use glam::DVec3;
use serde_json::{Value, json};
use spectra_color::{RgbSpace, spectral_color_linear, to_u8};
use spectra_core::math::{asin, sin};
use spectra_core::params::{Params, SourceFile};
use spectra_glass::fit::{Sample, cauchy_by_rows, cauchy_least_squares};
use spectra_glass::{Catalog, Category, Glass, lines};
use spectra_optics::Optics;
use spectra_scene::FileResources;
use spectra_spectrum::{BAND, Emission, Observer, bundled_spectra, find_emission};
use spectra_tracer::Indices;
use std::path::Path;
use std::sync::LazyLock;

/// Range of wavelengths that a screen can show, nm.
const VISIBLE_NM: [f64; 2] = [390.0, 710.0];
/// Number of wavelengths by which a continuous spectrum is sampled.
const WAVELENGTHS: usize = 320;
/// Distance in mm in front of the prism at which the beam starts. `BEHIND_MM` is the length of its path behind the prism.
const BEFORE_MM: f64 = 60.0;
const BEHIND_MM: f64 = 150.0;
/// Largest number of rays in an answer.
const MAX_RAYS: usize = 64;
/// Lines in the study's table of glasses, from violet to red.
const LINES: [lines::Line; 6] = [lines::H, lines::G, lines::F, lines::E, lines::D, lines::C];

/// Names of the media that are clear over the whole range of [`VISIBLE_NM`].
static GLASSES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let is_glass = |glass: &Glass| {
        let kind = matches!(
            glass.category,
            Category::OpticalGlass | Category::TechnicalGlass | Category::Crystal | Category::Plastic
        );
        kind && glass.range_nm.0 <= VISIBLE_NM[0] && VISIBLE_NM[1] <= glass.range_nm.1
    };
    Catalog::bundled().glasses().filter(is_glass).map(|glass| format!("{}/{}", glass.maker, glass.name)).collect()
});

/// Names of the lights, with the study's own first.
static LIGHTS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let is_light = |path: &str| path.starts_with("spectra/lamps/") || path.starts_with("spectra/illuminants/");
    let all = bundled_spectra().filter(|(_, path)| is_light(path)).map(|(name, _)| name.to_owned());
    let own = ["blackbody:5800", "hydrogen"].map(str::to_owned);
    let others = all.filter(|name| !own.contains(name));
    own.clone().into_iter().chain(others).filter(|name| find_emission(name).is_ok()).collect()
});

/// A prism and the beam that enters it.
#[derive(Clone, Debug)]
pub(crate) struct Prism {
    /// Angle between the faces, degrees.
    pub apex_deg: f64,
    /// Length of a face, mm.
    pub side_mm: f64,
    pub glass: String,
    /// Angle between the beam and the normal of the first face, degrees; positive if the beam comes from the side of the base.
    pub incidence_deg: f64,
    /// Height of the beam over the middle of the first face, mm.
    pub beam_mm: f64,
    pub light: String,
    /// Whether colors are as bright as the light and the eye make them, relative to the brightest. If false, all have full brightness.
    pub is_true: bool,
}

impl Prism {
    /// Parses the words of a page, which gives glass and light by their indices in the lists of [`choices`]. The error names the wrong
    /// word.
    pub(crate) fn of(word: impl Fn(&str) -> Option<String>) -> Result<Self, String> {
        let number = |name: &str, least: f64, most: f64| {
            let text = word(name).ok_or_else(|| format!("the number `{name}` is missing"))?;
            let value = text.parse().ok().filter(|value: &f64| (least..=most).contains(value));
            value.ok_or_else(|| format!("`{name}` must be a number from {least} to {most}"))
        };
        let one_of = |name: &str, all: &[String]| {
            let at = word(name).and_then(|text| text.parse::<usize>().ok());
            at.and_then(|at| all.get(at).cloned()).ok_or_else(|| format!("`{name}` is not an index of its list"))
        };
        Ok(Self {
            apex_deg: number("apex", 5.0, 90.0)?,
            side_mm: number("side", 5.0, 60.0)?,
            glass: one_of("glass", &GLASSES)?,
            incidence_deg: number("incidence", -85.0, 85.0)?,
            beam_mm: number("beam", -30.0, 30.0)?,
            light: one_of("light", &LIGHTS)?,
            is_true: word("intensity").as_deref() == Some("true"),
        })
    }

    /// Returns the prism as the text of a lens file. Its axis is the direction of the beam and meets the middle of the first face. The text
    /// `end` follows the second face.
    fn text(&self, end: &str) -> String {
        let Self { apex_deg, side_mm, glass, incidence_deg, .. } = self;
        let half = side_mm / 2.0;
        format!(
            "name: Prism of {apex_deg} degrees\nreference-line: d\ncoating: bare\nsurfaces:\n\
             - {{kind: coordinate-break, tilt: [{incidence_deg}, 0, 0]}}\n\
             - {{kind: plane, glass: {glass:?}, semi-diameter: {half}}}\n\
             - {{kind: coordinate-break, decenter: [0, {half}]}}\n\
             - {{kind: coordinate-break, tilt: [-{apex_deg}, 0, 0]}}\n\
             - {{kind: coordinate-break, decenter: [0, -{half}]}}\n\
             - {{kind: plane, semi-diameter: {half}{end}"
        )
    }

    /// Returns the lens file for a scene, with a screen perpendicular to the light of the d line at the end of the study's rays.
    ///
    /// # Errors
    /// The light of the d line does not leave through the second face.
    pub(crate) fn file(&self) -> Result<String, String> {
        let deviation_deg = self
            .deviation_deg(&self.lens()?, lines::D.wavelength_nm)
            .ok_or("the beam does not leave through the second face: no light reaches a screen")?;
        // The light leaves at this angle to the normal of the second face.
        let leaves_deg = deviation_deg + self.apex_deg - self.incidence_deg;
        Ok(self.text(&format!(
            "}}\n- {{kind: coordinate-break, tilt: [{leaves_deg:.4}, 0, 0], thickness: {BEHIND_MM}}}\n"
        )))
    }

    fn lens(&self) -> Result<Optics, String> {
        let text = self.text(", thickness: 1}\n");
        let node = spectra_yaml::parse(SourceFile::new("prism", text)).map_err(|faults| faults.to_string())?;
        let params = Params::section(node, "").map_err(|faults| faults.to_string())?;
        let lens = spectra_lens::parse(&params, &FileResources::beside(Path::new("")));
        lens.map(Optics::new).map_err(|faults| faults.to_string())
    }

    fn light(&self) -> Result<Emission, String> {
        find_emission(&self.light).map_err(|error| error.to_string())
    }

    /// Returns the wavelengths, in nm, and the brightness of each, relative to the brightest. Any first part of the list is
    /// spread over the whole spectrum.
    fn rays(&self) -> Result<Vec<(f64, f64)>, String> {
        let light = self.light()?;
        let is_visible = |nm: f64| (VISIBLE_NM[0]..=VISIBLE_NM[1]).contains(&nm);
        let seen =
            |nm: f64| RgbSpace::srgb().from_xyz(Observer::cie_1931_2deg().at(nm)).into_iter().fold(0.0, f64::max);
        let lines = light.lines().iter().filter(|line| is_visible(line.wavelength_nm));
        let mut lines: Vec<(f64, f64)> =
            lines.map(|line| (line.wavelength_nm, line.power * seen(line.wavelength_nm))).collect();
        let step = (VISIBLE_NM[1] - VISIBLE_NM[0]) / WAVELENGTHS as f64;
        // 197 and 320 have no common divisor, so every index occurs once, and successive ones are far apart.
        let order = (0..WAVELENGTHS).map(|k| k * 197 % WAVELENGTHS);
        let nm = order.map(|k| VISIBLE_NM[0] + step * (k as f64 + 0.5));
        let mut continuum: Vec<(f64, f64)> =
            if light.continuum().is_some() { nm.map(|nm| (nm, light.at(nm) * seen(nm))).collect() } else { Vec::new() };
        // Lines and continuum cannot be compared, so each group is relative to its own brightest.
        for group in [&mut lines, &mut continuum] {
            let most = group.iter().map(|ray| ray.1).fold(0.0, f64::max);
            group.iter_mut().for_each(|ray| ray.1 = if self.is_true && most > 0.0 { ray.1 / most } else { 1.0 });
        }
        lines.append(&mut continuum);
        Ok(lines)
    }

    /// Returns the outline and the figures of the prism, and the index of its glass with the fits, as JSON.
    ///
    /// # Errors
    /// The reason why there is no such prism.
    pub(crate) fn shown(&self) -> Result<Value, String> {
        let lens = self.lens()?;
        let half = self.side_mm / 2.0;
        let corner = |at: usize, y: f64| {
            let p = lens.elements[at].pose.point(DVec3::new(0.0, y, 0.0));
            [p.z, p.y]
        };
        let glass = Catalog::bundled().find(&self.glass).map_err(|error| error.message())?;
        let n = |nm: f64| glass.index(nm);
        let nd = n(lines::D.wavelength_nm);
        let half_apex = (self.apex_deg / 2.0).to_radians();
        let bent = nd * sin(half_apex);
        // At least deviation the path is symmetric, and both faces bend the ray alike.
        let least = (bent < 1.0).then(|| {
            let incidence = asin(bent);
            [incidence.to_degrees(), (2.0 * (incidence - half_apex)).to_degrees()]
        });
        let samples: Vec<Sample> =
            LINES.iter().map(|line| Sample { wavelength_nm: line.wavelength_nm, n: n(line.wavelength_nm) }).collect();
        let rows = cauchy_by_rows(&samples).map_err(|error| error.to_string())?;
        let two = cauchy_least_squares(&samples, 2).map_err(|error| error.to_string())?;
        let three = cauchy_least_squares(&samples, 3).map_err(|error| error.to_string())?;
        let nm: Vec<f64> = (0..=64).map(|k| VISIBLE_NM[0] + f64::from(k) * 5.0).collect();
        let curve = |of: &dyn Fn(f64) -> f64| nm.iter().map(|nm| of(*nm)).collect::<Vec<f64>>();
        Ok(json!({
            "outline": [corner(0, -half), corner(0, half), corner(1, -half)],
            "rays": self.rays()?.len(),
            "nd": nd,
            "least_deviation": least,
            "deviation_deg": self.deviation_deg(&lens, lines::D.wavelength_nm),
            "spread_deg": self.deviation_deg(&lens, 400.0).zip(self.deviation_deg(&lens, 700.0)).map(|(a, b)| a - b),
            "cauchy": {
                "nm": nm,
                "catalogue": curve(&n),
                "rows": curve(&|nm| rows.fit.formula.index(nm)),
                "two": curve(&|nm| two.formula.index(nm)),
                "three": curve(&|nm| three.formula.index(nm)),
                "samples": samples.iter().map(|s| [s.wavelength_nm, s.n]).collect::<Vec<_>>(),
                "a": rows.a,
                "b_nm2": rows.b_nm2,
                "apart": [rows.fit.max_deviation, two.max_deviation, three.max_deviation],
            },
        }))
    }

    /// Returns the deviation of the beam at a wavelength, degrees; `None` if it does not leave through the second face.
    fn deviation_deg(&self, lens: &Optics, wavelength_nm: f64) -> Option<f64> {
        let tracer = lens.tracer(Indices::At(wavelength_nm)).ok()?;
        let path = tracer.path(DVec3::new(0.0, self.beam_mm, -BEFORE_MM), DVec3::Z, wavelength_nm);
        path.end.is_none().then(|| spectra_core::math::acos(path.direction.z.clamp(-1.0, 1.0)).to_degrees())
    }

    /// Traces `count` rays from number `first` on, and returns their colors and their paths, as pairs of z and y in mm, as JSON.
    ///
    /// # Errors
    /// The reason why there is no such prism.
    pub(crate) fn traced(&self, first: usize, count: usize) -> Result<Value, String> {
        let lens = self.lens()?;
        let all = self.rays()?;
        let mut rays = Vec::new();
        for (nm, strength) in all.into_iter().skip(first).take(count.min(MAX_RAYS)) {
            let tracer = lens.tracer(Indices::At(nm)).map_err(|error| error.to_string())?;
            let path = tracer.path(DVec3::new(0.0, self.beam_mm, -BEFORE_MM), DVec3::Z, nm);
            let mut points: Vec<[f64; 2]> = path.points.iter().map(|p| [p.z, p.y]).collect();
            let goes_on = matches!(path.end, None | Some((spectra_core::Loss::Missed, _)));
            if let Some(last) = path.points.last().filter(|_| goes_on) {
                let end = *last + path.direction * BEHIND_MM;
                points.push([end.z, end.y]);
            }
            let linear = spectral_color_linear(nm, RgbSpace::srgb()).map(|v| v * strength);
            rays.push(json!({"nm": nm, "rgb": RgbSpace::srgb().encode(linear).map(to_u8), "points": points}));
        }
        Ok(json!({"first": first, "rays": rays}))
    }
}

/// Returns the lists of glasses and lights, from which a page chooses, as JSON.
pub(crate) fn choices() -> Value {
    json!({"glasses": *GLASSES, "lights": *LIGHTS, "range_nm": [BAND.start_nm, BAND.end_nm()]})
}

#[cfg(test)]
mod tests {
    use super::*;
    use spectra_plugins as _;

    fn prism() -> Prism {
        Prism {
            apex_deg: 60.0,
            side_mm: 30.0,
            glass: "SCHOTT/N-SF11".to_owned(),
            incidence_deg: 63.1713,
            beam_mm: 0.0,
            light: "blackbody:5800".to_owned(),
            is_true: false,
        }
    }

    /// The deviation is that of Snell's law applied twice in the plane, and it is least at the stated incidence.
    #[test]
    fn deviation_is_that_of_two_refractions() {
        let snell = |prism: &Prism, nm: f64| {
            let n = Catalog::bundled().find(&prism.glass).expect("a glass").index(nm);
            let apex = prism.apex_deg.to_radians();
            let first = prism.incidence_deg.to_radians();
            let inside = apex - asin(sin(first) / n);
            (first + asin(n * sin(inside)) - apex).to_degrees()
        };
        for (apex_deg, incidence_deg) in [(60.0, 63.1713), (60.0, 70.0), (30.0, 20.0), (45.0, 50.0)] {
            let prism = Prism { apex_deg, incidence_deg, ..prism() };
            let lens = prism.lens().expect("a prism");
            for nm in [436.0, 587.56, 656.0] {
                let got = prism.deviation_deg(&lens, nm).expect("it leaves");
                assert!((got - snell(&prism, nm)).abs() < 1e-6, "{apex_deg} {incidence_deg} {nm}: {got}");
            }
        }
        let shown = prism().shown().expect("a prism");
        let least = [0, 1].map(|i| shown["least_deviation"][i].as_f64().expect("a number"));
        assert!(
            (least[0] - 63.1713).abs() < 1e-3
                && (shown["deviation_deg"].as_f64().expect("a number") - least[1]).abs() < 1e-5
        );
    }

    #[test]
    fn every_ray_is_there_once_and_bends_as_its_color_does() {
        let all = prism().rays().expect("rays");
        let mut nm: Vec<f64> = all.iter().map(|ray| ray.0).collect();
        nm.sort_by(f64::total_cmp);
        nm.dedup();
        assert_eq!(nm.len(), WAVELENGTHS);
        let some = prism().traced(300, 64).expect("rays");
        assert_eq!(some["rays"].as_array().expect("a list").len(), WAVELENGTHS - 300);
        let lamp = Prism { light: "hydrogen".to_owned(), is_true: true, ..prism() };
        let rays = lamp.traced(0, 64).expect("rays")["rays"].as_array().expect("a list").clone();
        let end = |ray: &Value| {
            ray["points"].as_array().expect("a list").last().expect("a point")[1].as_f64().expect("a number")
        };
        let of =
            |nm: f64| rays.iter().find(|ray| (ray["nm"].as_f64().expect("a number") - nm).abs() < 1.0).expect("a line");
        assert!(end(of(486.1)) < end(of(656.3)), "blue is bent more");
        assert!(rays.iter().any(|ray| ray["rgb"] == json!([255, 0, 0])), "{rays:?}");
    }

    #[test]
    fn names_are_those_of_the_lists() {
        let words = |glass: &'static str, light: &'static str| {
            Prism::of(move |name| {
                Some(str::to_owned(match name {
                    "glass" => glass,
                    "light" => light,
                    "side" | "apex" => "30",
                    _ => "1",
                }))
            })
        };
        assert_eq!(words("0", "1").expect("a prism").light, "hydrogen");
        for (glass, light) in [("0", "../lamp.csv"), ("/etc/passwd", "0"), ("-1", "0"), ("0", "100000"), ("", "0")] {
            assert!(words(glass, light).is_err(), "{glass} {light}");
        }
        assert!(GLASSES.len() > 300 && LIGHTS.len() > 15, "{} {}", GLASSES.len(), LIGHTS.len());
    }

    #[test]
    fn cauchys_formula_lies_by_the_catalogue() {
        let shown = prism().shown().expect("a prism");
        let apart = [0, 1, 2].map(|i| shown["cauchy"]["apart"][i].as_f64().expect("a number"));
        // More terms fit better, and the means of the table's rows fit worse than least squares.
        assert!(apart[2] < apart[1] && apart[1] <= apart[0] && apart[2] < 1e-3, "{apart:?}");
    }
}

//! Spectra in YAML: every kind by its name, those made of others among them.
//!
//! ```yaml
//! spectra: 1
//! name: a warm lamp behind a filter
//! kind: product
//! factors:
//!   - {kind: blackbody, temperature: 2856 K}
//!   - {kind: mixture, terms: [{amplitude: 0.9, center: 560, sigma: 300}, {amplitude: -0.5, center: 520, sigma: 25}]}
//! ```
//!
//! | `kind` | keys |
//! |---|---|
//! | `line` | `wavelength` (a number, or a letter such as `"C'"`), `power` (1) |
//! | `lines` | `lines`: a list of `{wavelength, power}` |
//! | `constant` | `value` (1) |
//! | `rectangle` | `from`, `to`, `value` (1) |
//! | `gaussian` | `center`, `sigma`, `peak` (1) |
//! | `blackbody` | `temperature`: radiance, W m^-2 sr^-1 nm^-1 |
//! | `daylight` | `temperature`: CIE daylight, relative |
//! | `table` | `wavelengths`, `values`, `scale` (`linear` or `log10`), `outside` (`zero`, `constant` or `geometric`) |
//! | `histogram` | `edges` and `counts`, one fewer: what a detector measured between neighboring edges |
//! | `mixture` | `terms`: signed Gaussians `{amplitude, center, sigma}` |
//! | `product`, `sum` | `factors`, `parts`: spectra, as maps like these or by name |
//! | `scale` | `spectrum`, and one of `factor`, `peak`, `power` (W over 350-830 nm) or `luminance` (cd/m2) |
//!
//! A file may say what it is a spectrum `of` (`emission`, `transmittance`, `reflectance`, `sensitivity`) and, in words,
//! its `name`, `source`, `licence`, `conditions` and `note`. Without `of` a function is what is wanted where it is named.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use spectra_core::params::{
    Dimension, Fault, Faults, Kinds, Luminance, NonNegative, Params, Part, Positive, Power, Quantity, StageNode,
    Temperature, Wavelength, Whole, keys_of, nearest, quantity, schema_of,
};
use spectra_core::spectral::Line;

use crate::by_name::{Found, Loader};
use crate::emission::Emission;
use crate::error::SpectrumError;
use crate::gaussian::{GaussianMixture, GaussianTerm};
use crate::illuminants::daylight;
use crate::lines::LineOrWavelength;
use crate::meta::{Kind, Meta, Outside, Scale};
use crate::piece::{Piece, of_shape};
use crate::shape::Shape;
use crate::table::MAX_ROWS;
use crate::tabulated::Tabulated;

/// A place on the axis of wavelengths, of any sign: a Gaussian's center may lie far outside of all light. nm if bare.
#[derive(Clone, Copy, Debug)]
struct Center(f64);

impl Quantity for Center {
    const DIMENSION: Dimension = Dimension::Length;
    const NOUN: &'static str = "wavelength";
    const BARE_UNIT: &'static str = "nm";
    const EXAMPLE: &'static str = "550 nm";

    fn from_bare(value: f64) -> Self {
        Self(value)
    }

    fn bare(self) -> f64 {
        self.0
    }
}

impl JsonSchema for Center {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Center".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schema_of::<Self>()
    }
}

impl<'de> Deserialize<'de> for Center {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        quantity::deserialize(deserializer)
    }
}

/// What a file says of itself beside its spectrum.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Head {
    /// Format of the file: 1; 1 if absent.
    #[expect(dead_code, reason = "its schema allows one version")]
    spectra: Option<Whole<1, 1>>,
    /// What it is a spectrum of: `emission`, `transmittance`, `reflectance` or `sensitivity`; what is wanted where it
    /// is named, if absent.
    of: Option<KindName>,
    /// Name for people.
    name: Option<String>,
    /// Where the figures come from.
    source: Option<String>,
    /// Licence of the figures.
    licence: Option<String>,
    /// How it was measured: angle, temperature, age.
    conditions: Option<String>,
    /// Doubts and choices, for people.
    note: Option<String>,
}

/// What a file is a spectrum of.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
enum KindName {
    Emission,
    Transmittance,
    Reflectance,
    Sensitivity,
}

impl From<KindName> for Kind {
    fn from(name: KindName) -> Self {
        match name {
            KindName::Emission => Self::Emission,
            KindName::Transmittance => Self::Transmittance,
            KindName::Reflectance => Self::Reflectance,
            KindName::Sensitivity => Self::Sensitivity,
        }
    }
}

/// Kinds of spectra that a file can hold.
pub(crate) const KINDS: [&str; 13] = [
    "blackbody",
    "constant",
    "daylight",
    "gaussian",
    "histogram",
    "line",
    "lines",
    "mixture",
    "product",
    "rectangle",
    "scale",
    "sum",
    "table",
];

/// One spectral line.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LineParams {
    /// Where it lies: a short name such as `C'`, or a wavelength, nm if bare.
    wavelength: LineOrWavelength,
    /// Power of the line, relative or W; 1 if absent.
    power: Option<NonNegative<f64>>,
}

/// Several spectral lines.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct LinesParams {
    /// The lines, one or more.
    #[schemars(length(min = 1))]
    lines: Vec<LineParams>,
}

/// The same at every wavelength.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ConstantParams {
    /// Its value at every wavelength; 1 if absent.
    value: Option<NonNegative<f64>>,
}

/// A value between two wavelengths, and nothing outside.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct RectangleParams {
    /// Where it begins, nm if bare.
    from: Wavelength,
    /// Where it ends, nm if bare.
    to: Wavelength,
    /// Its value in between; 1 if absent. Outside it is 0.
    value: Option<NonNegative<f64>>,
}

/// A bell: peak x exp(-(w - center)^2 / (2 sigma^2)).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct GaussianParams {
    /// Wavelength of the peak, nm if bare; it may lie outside of all light.
    center: Center,
    /// Standard deviation, nm if bare.
    sigma: Positive<Wavelength>,
    /// Value at the peak; 1 if absent.
    peak: Option<NonNegative<f64>>,
}

/// Light by its temperature.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct TemperatureParams {
    /// Temperature, K if bare: of a blackbody, or the correlated color temperature of daylight.
    temperature: Temperature,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum ScaleName {
    /// As they are.
    Linear,
    /// Logarithms to base 10.
    Log10,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum OutsideName {
    /// Nothing.
    Zero,
    /// The nearest value.
    Constant,
    /// Falling off as at the end of the table.
    Geometric,
}

/// Values at wavelengths, linear in between.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct TableParams {
    /// Wavelengths, nm if bare, increasing.
    #[schemars(length(min = 1))]
    wavelengths: Vec<Wavelength>,
    /// Values there, as many: shares of 1 of a transmittance or reflectance, any scale of the others.
    values: Vec<f64>,
    /// What the values are: `linear`, or `log10` of it; `linear` if absent.
    scale: Option<ScaleName>,
    /// What lies outside of the table: `zero`, `constant` (the nearest value) or `geometric` (falling off as at the
    /// end); what is usual of its kind if absent.
    outside: Option<OutsideName>,
}

/// What a detector measured in bins.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct HistogramParams {
    /// Edges of the bins, nm if bare, increasing.
    #[schemars(length(min = 2))]
    edges: Vec<Wavelength>,
    /// What was measured between neighboring edges, one fewer; 0 or more.
    counts: Vec<f64>,
}

/// One signed Gaussian.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct TermParams {
    /// Value at its center, of either sign.
    amplitude: f64,
    /// Wavelength of its center, nm if bare; it may lie outside of all light.
    center: Center,
    /// Standard deviation, nm if bare.
    sigma: Positive<Wavelength>,
}

/// A sum of signed Gaussians.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct MixtureParams {
    /// Signed Gaussians, 1 to 4096; where their sum is negative it counts as 0.
    // More than any fit has, and than a product of several that is written out.
    #[schemars(length(min = 1, max = 4096))]
    terms: Vec<TermParams>,
}

/// Spectra multiplied: a light behind filters.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ProductParams {
    /// What is multiplied, one or more: the first is what is wanted, such as a light, the others are filters. By name,
    /// or as maps with their `kind`.
    factors: Vec<Part<SpectrumForm>>,
}

/// Spectra added.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct SumParams {
    /// What is added, one or more: by name, or as maps with their `kind`.
    parts: Vec<Part<SpectrumForm>>,
}

/// A spectrum, brighter or darker.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct ScaleParams {
    /// What is scaled: by name, or as a map with its `kind`.
    spectrum: Part<SpectrumForm>,
    /// What it is multiplied by. One of the four is given.
    factor: Option<NonNegative<f64>>,
    /// Its greatest value afterwards.
    peak: Option<NonNegative<f64>>,
    /// Its power over 350-830 nm afterwards, W if bare; of light only.
    power: Option<Power>,
    /// Its luminance afterwards, cd/m2 if bare; of light only.
    luminance: Option<Luminance>,
}

/// What stands where a spectrum is wanted: a name or an expression, or a map with its kind.
struct SpectrumForm;

impl JsonSchema for SpectrumForm {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "spectrum".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let inside = kinds(generator, None);
        json_schema!({ "x-words": "name, expression or map", "x-see": "spectrum", "if": { "type": "string" }, "else": inside })
    }
}

/// The schema of a file that holds a spectrum.
#[must_use]
pub fn schema(generator: &mut SchemaGenerator) -> Schema {
    let head = Head::json_schema(generator);
    let mut schema = kinds(generator, Some(&head));
    schema.insert("description".to_owned(), ABOUT.into());
    schema
}

/// What a person reads about such a file.
const ABOUT: &str = "\
A spectrum: a light, a filter, a surface or a sensitivity, by its kind.

It may say what it is a spectrum `of`; without that, a function such as a table or a Gaussian is what is wanted where the \
file is named. Lights are radiance or power a nanometer, relative unless scaled; transmittances and reflectances are shares \
of 1. Spectra are made of others by `product`, `sum` and `scale`; what stands there is a map like these, the name of a \
bundled spectrum or file (`D65`, `wratten-15`, `gel.csv`), or an expression such as `blackbody:3200`. A table of many rows \
is better kept as CSV.

# Examples
```yaml
# A warm lamp behind a filter
spectra: 1
name: Enlarger lamp
kind: product
factors:
  - {kind: blackbody, temperature: 2856 K}
  - {kind: table, wavelengths: [400, 500, 600, 700], values: [0.1, 0.4, 0.85, 0.9], outside: constant}
```
```yaml
kind: scale
spectrum: {kind: lines, lines: [{wavelength: \"C'\", power: 2}, {wavelength: 546.07 nm}]}
luminance: 120 cd/m2
```";

fn kinds(generator: &mut SchemaGenerator, shared: Option<&Schema>) -> Schema {
    let own = KINDS.iter().map(|name| {
        let schema = match *name {
            "blackbody" | "daylight" => {
                let mut schema = TemperatureParams::json_schema(generator);
                let daylight = "CIE daylight of a correlated color temperature, relative.";
                let blackbody = "Light of a blackbody by Planck's law, W m^-2 sr^-1 nm^-1.";
                let said = if *name == "daylight" { daylight } else { blackbody };
                schema.insert("description".to_owned(), said.into());
                schema
            }
            "constant" => ConstantParams::json_schema(generator),
            "gaussian" => GaussianParams::json_schema(generator),
            "histogram" => HistogramParams::json_schema(generator),
            "line" => LineParams::json_schema(generator),
            "lines" => LinesParams::json_schema(generator),
            "mixture" => MixtureParams::json_schema(generator),
            "product" => ProductParams::json_schema(generator),
            "rectangle" => RectangleParams::json_schema(generator),
            "scale" => ScaleParams::json_schema(generator),
            "sum" => SumParams::json_schema(generator),
            _ => TableParams::json_schema(generator),
        };
        (*name, schema)
    });
    let kinds = own.collect();
    Kinds { key: "kind", kinds, default: None, shared, by_name: false }.schema()
}

/// The spectrum of a whole file, as what is wanted unless the file says what it is of; and what it says of itself.
pub(crate) fn of_file(file: &Params, wanted: Kind, loader: &Loader<'_>) -> Result<(Piece, Meta), Faults> {
    let whole = Params::stage(file.node().clone(), "")?;
    let keys = keys_of::<Head>();
    let (head, _) = whole.split(&keys);
    let mut faults = Faults::new();
    let said: Option<Head> = faults.take(head.parse());
    let of = said.as_ref().and_then(|head| head.of).map(Kind::from);
    let piece = faults.take(of_stage(&whole, of.unwrap_or(wanted), loader, &keys));
    let (Some(said), Some(piece)) = (said, piece) else { return Err(faults) };
    faults.into_result(())?;
    let piece = match of {
        Some(kind) => {
            let found = piece.into_found(kind).map_err(|e| whole.fault_here(e.to_string()))?;
            if found.kind() != kind {
                let text = format!("what the file holds is of kind {}", found.kind());
                return Err(whole.fault("of", text).into());
            }
            Piece::Typed(found)
        }
        None => piece,
    };
    let Head { name, source, licence, conditions, note, .. } = said;
    let notes = note.into_iter().collect();
    Ok((piece, Meta { name, kind: of, source, licence, conditions, notes, ..Meta::default() }))
}

/// What is written in place of a spectrum: a name, or a map with its kind.
fn of_node(node: &StageNode, wanted: Kind, loader: &Loader<'_>) -> Result<Piece, Faults> {
    match node.node().as_str() {
        Some(name) => loader.piece(name, wanted).map_err(|e| match e {
            SpectrumError::Document(faults) => faults,
            other => other.faults(|text| node.fault(text)),
        }),
        None => {
            loader.count("this file").map_err(|e| node.fault(e.to_string()))?;
            of_stage(&node.params()?, wanted, loader, &[])
        }
    }
}

/// A map with a kind; `beside` are keys that are somebody else's.
fn of_stage(params: &Params, wanted: Kind, loader: &Loader<'_>, beside: &[String]) -> Result<Piece, Faults> {
    let Some(kind) = params.kind() else {
        let fault = params.fault_here("a spectrum names its `kind`");
        return Err(fault.hint(format!("one of {}", KINDS.join(", "))).into());
    };
    let (_, own) = params.split(beside);
    let at = |key: &'static str| move |e: SpectrumError| Faults::from(params.fault(key, e.to_string()));
    let light = |light| Piece::Typed(Found::Emission(light));
    let times = |shape: Shape, value: Option<NonNegative<f64>>| match value {
        Some(value) => shape.scaled(value.get()).map(Piece::Bare),
        None => Ok(Piece::Bare(shape)),
    };
    match kind {
        "line" => Emission::new(None, vec![line(&own.parse()?)]).map(light).map_err(at("wavelength")),
        "lines" => {
            let LinesParams { lines } = own.parse()?;
            let lines: Vec<Line> = lines.iter().map(line).collect();
            Emission::new(None, lines).map(light).map_err(at("lines"))
        }
        "constant" => {
            let ConstantParams { value } = own.parse()?;
            Shape::constant(value.map_or(1.0, NonNegative::get)).map(Piece::Bare).map_err(at("value"))
        }
        "rectangle" => {
            let p: RectangleParams = own.parse()?;
            Shape::rectangle(p.from.nm(), p.to.nm()).and_then(|s| times(s, p.value)).map_err(at("to"))
        }
        "gaussian" => {
            let p: GaussianParams = own.parse()?;
            Shape::gaussian(p.center.0, p.sigma.nm()).and_then(|s| times(s, p.peak)).map_err(at("sigma"))
        }
        "blackbody" => {
            let TemperatureParams { temperature } = own.parse()?;
            Emission::blackbody(temperature.kelvin()).map(light).map_err(at("temperature"))
        }
        "daylight" => {
            let TemperatureParams { temperature } = own.parse()?;
            daylight(temperature.kelvin()).map(light).map_err(at("temperature"))
        }
        "table" => table(&own, wanted),
        "histogram" => histogram(&own),
        "mixture" => mixture(&own),
        "product" => {
            let ProductParams { factors } = own.parse()?;
            // The first may be what is wanted; what stands behind it are filters.
            let wanted = |i| if i == 0 { wanted } else { Kind::Transmittance };
            together(&factors, wanted, loader, Piece::times, || params.fault("factors", "there are none"))
        }
        "sum" => {
            let SumParams { parts } = own.parse()?;
            together(&parts, |_| wanted, loader, Piece::plus, || params.fault("parts", "there are none"))
        }
        "scale" => scaled(params, own.parse()?, wanted, loader),
        other => {
            let fault = params.fault("kind", format!("no spectrum is of kind `{other}`"));
            Err(match nearest(other, KINDS.iter().copied()) {
                Some(near) => fault.hint(format!("did you mean `{near}`?")),
                None => fault.hint(format!("one of {}", KINDS.join(", "))),
            }
            .into())
        }
    }
}

fn line(p: &LineParams) -> Line {
    Line { wavelength_nm: p.wavelength.nm(), power: p.power.map_or(1.0, NonNegative::get) }
}

/// A fault for each value that does not increase.
fn rising(params: &Params, key: &str, nm: &[Wavelength], faults: &mut Faults) {
    for (i, pair) in nm.windows(2).enumerate() {
        if pair[1].nm() <= pair[0].nm() {
            let text = format!("{} nm does not come after {} nm", pair[1].nm(), pair[0].nm());
            faults.push(params.fault(&format!("{key}[{}]", i + 1), text).hint("wavelengths must increase"));
        }
    }
}

/// Checks lengths before anything is made of them.
fn lengths(params: &Params, keys: [&str; 2], [found, wanted]: [usize; 2], what: &str) -> Result<(), Fault> {
    if found > MAX_ROWS || wanted > MAX_ROWS {
        return Err(params.fault(keys[0], format!("more than {MAX_ROWS} points")));
    }
    if found == 0 || found != wanted {
        let fault = params.fault(keys[1], format!("{found} {}, but {what} asks for {wanted}", keys[1]));
        return Err(fault.hint("each has its own, in the same order"));
    }
    Ok(())
}

fn table(params: &Params, wanted: Kind) -> Result<Piece, Faults> {
    let p: TableParams = params.parse()?;
    let counts = [p.values.len(), p.wavelengths.len()];
    lengths(params, ["wavelengths", "values"], counts, "the list of wavelengths")?;
    let (mut faults, scale) = (Faults::new(), p.scale.unwrap_or(ScaleName::Linear));
    rising(params, "wavelengths", &p.wavelengths, &mut faults);
    for (i, value) in p.values.iter().enumerate() {
        let text = match scale {
            ScaleName::Log10 if value.abs() > 20.0 => format!("{value} is implausible as a logarithm to base 10"),
            ScaleName::Linear if *value < 0.0 => format!("{wanted} cannot be negative: {value}"),
            ScaleName::Linear if wanted.bound().is_some_and(|b| *value > b) => {
                format!("{value} is more than a {wanted} can be: given as percent? divide by 100")
            }
            _ => continue,
        };
        let hint = if *value < 0.0 { "write 0 where nothing was measured" } else { "is the `scale` wrong?" };
        faults.push(params.fault(&format!("values[{i}]"), text).hint(hint));
    }
    faults.into_result(())?;
    let outside = match p.outside {
        None => wanted.outside(),
        Some(OutsideName::Zero) => Outside::Zero,
        Some(OutsideName::Constant) => Outside::Constant,
        Some(OutsideName::Geometric) => Outside::Geometric,
    };
    let scale = if matches!(scale, ScaleName::Log10) { Scale::Log10 } else { Scale::Linear };
    let nm: Vec<f64> = p.wavelengths.iter().map(|w| w.nm()).collect();
    let table = Tabulated::new(&nm, &p.values, outside, scale).map_err(|e| params.fault("values", e.to_string()))?;
    Ok(Piece::Bare(Shape::tabulated(table)))
}

fn histogram(params: &Params) -> Result<Piece, Faults> {
    let p: HistogramParams = params.parse()?;
    let wanted = [p.counts.len(), p.edges.len().saturating_sub(1)];
    lengths(params, ["edges", "counts"], wanted, "one between each two edges")?;
    let mut faults = Faults::new();
    rising(params, "edges", &p.edges, &mut faults);
    for (i, count) in p.counts.iter().enumerate().filter(|(_, c)| **c < 0.0) {
        let fault = params.fault(&format!("counts[{i}]"), format!("a count cannot be negative: {count}"));
        faults.push(fault.hint("write 0 where nothing was counted"));
    }
    faults.into_result(())?;
    let edges: Vec<f64> = p.edges.iter().map(|w| w.nm()).collect();
    let shape = Shape::histogram(&edges, &p.counts).map_err(|e| params.fault("counts", e.to_string()))?;
    Ok(Piece::Bare(shape))
}

fn mixture(params: &Params) -> Result<Piece, Faults> {
    let MixtureParams { terms } = params.parse()?;
    let mut faults = Faults::new();
    let term = |(i, t): (usize, &TermParams)| {
        let term = GaussianTerm::new(t.amplitude, t.center.0, t.sigma.nm());
        faults.take(term.map_err(|e| params.fault(&format!("terms[{i}]"), e.to_string())))
    };
    let terms: Vec<GaussianTerm> = terms.iter().enumerate().filter_map(term).collect();
    faults.into_result(())?;
    let shape =
        Shape::positive_mixture(GaussianMixture::new(terms)).map_err(|e| params.fault("terms", e.to_string()))?;
    Ok(Piece::Bare(shape.0))
}

fn together(
    nodes: &[Part<SpectrumForm>],
    wanted: impl Fn(usize) -> Kind,
    loader: &Loader<'_>,
    join: impl Fn(Piece, Piece) -> Result<Piece, SpectrumError>,
    none: impl Fn() -> Fault,
) -> Result<Piece, Faults> {
    let mut faults = Faults::new();
    let mut joined: Option<Piece> = None;
    for (i, node) in nodes.iter().enumerate() {
        // What is wrong with one hides nothing that is wrong with the next.
        let Some(next) = faults.take(of_node(node, wanted(i), loader)) else { continue };
        joined = match joined {
            None => Some(next),
            Some(before) => Some(join(before, next).map_err(|e| node.fault(e.to_string()))?),
        };
    }
    faults.into_result(())?;
    joined.ok_or_else(|| none().into())
}

fn scaled(params: &Params, p: ScaleParams, wanted: Kind, loader: &Loader<'_>) -> Result<Piece, Faults> {
    let piece = of_node(&p.spectrum, wanted, loader)?;
    let said = [p.factor.is_some(), p.peak.is_some(), p.power.is_some(), p.luminance.is_some()];
    if said.iter().filter(|s| **s).count() != 1 {
        let fault = params.fault_here("a scale takes one of `factor`, `peak`, `power` and `luminance`");
        return Err(fault.into());
    }
    if let Some(factor) = p.factor {
        return piece.scaled(factor.get()).map_err(|e| params.fault("factor", e.to_string()).into());
    }
    if let (Some(peak), Piece::Bare(shape)) = (p.peak, &piece) {
        let highest = shape.extremes().1;
        if !(highest > 0.0 && highest.is_finite()) {
            return Err(params.fault("peak", "the spectrum has no peak to scale").into());
        }
        let scaled = shape.scaled(peak.get() / highest).map_err(|e| params.fault("peak", e.to_string()))?;
        return Ok(Piece::Bare(scaled));
    }
    let found = piece.into_found(Kind::Emission).map_err(|e| params.fault("spectrum", e.to_string()))?;
    let (key, scaled) = match (found, p.peak, p.power, p.luminance) {
        (Found::Emission(light), Some(peak), ..) => {
            ("peak", light.scaled_to_peak().and_then(|l| l.scaled(peak.get())).map(Found::Emission))
        }
        (Found::Emission(light), _, Some(power), _) => ("power", light.scaled_to_power(power.w()).map(Found::Emission)),
        (Found::Emission(light), _, _, Some(luminance)) => {
            ("luminance", light.scaled_to_luminance(luminance.cd_per_m2()).map(Found::Emission))
        }
        (matter, Some(peak), ..) => ("peak", to_peak(matter, peak.get())),
        (matter, ..) => {
            let text = format!("only light is scaled to a power or a luminance; this is of kind {}", matter.kind());
            return Err(params.fault("spectrum", text).into());
        }
    };
    scaled.map(Piece::Typed).map_err(|e| params.fault(key, e.to_string()).into())
}

fn to_peak(matter: Found, peak: f64) -> Result<Found, SpectrumError> {
    let shape = match &matter {
        Found::Transmittance(filter) => filter.shape(),
        Found::Reflectance(surface) => surface.shape(),
        Found::Sensitivity(detector) => detector.shape(),
        Found::Emission(_) => return Ok(matter),
    };
    let highest = shape.extremes().1;
    if !(highest > 0.0 && highest.is_finite()) {
        return Err(SpectrumError::NothingToScale("peak"));
    }
    of_shape(shape.scaled(peak / highest)?, matter.kind())
}

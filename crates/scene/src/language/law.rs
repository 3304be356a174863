//! Interpolation of values, including quantities with units.

use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::math::pow;
use spectra_core::params::{Dimension, Fault, Node, Number, Reading, Unit, Value};

/// Ways to interpolate from one value to the next.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Law {
    /// Linear interpolation.
    #[default]
    Linear,
    /// A monotone cubic through all values, which starts and stops gently.
    Smooth,
    /// Equal ratios, like the stops of an aperture or exposure.
    Logarithmic,
    /// Linear in one over the value, like the turn of a focus ring.
    Reciprocal,
    /// No interpolation: each value stays until the next.
    Hold,
}

/// Values at places along a line, with interpolation between them.
#[derive(Clone, Debug)]
pub(super) struct Track {
    at: Vec<f64>,
    nodes: Vec<Node>,
    law: Law,
    values: Values,
}

#[derive(Clone, Debug)]
enum Values {
    /// Values without interpolation.
    Held,
    /// Numbers in one unit.
    Scalar { values: Vec<f64>, unit: Option<&'static Unit> },
    /// Lists of equal length, interpolated element by element.
    List(Vec<Track>),
}

impl Track {
    /// Makes a track of values at increasing places.
    ///
    /// # Errors
    /// Values that are not quantities, or of different dimensions, or outside the domain of the law.
    pub(super) fn new(at: &[f64], nodes: &[Node], law: Law) -> Result<Self, Fault> {
        let values = if law == Law::Hold || nodes.len() < 2 { Values::Held } else { values_of(at, nodes, law)? };
        Ok(Self { at: at.to_vec(), nodes: nodes.to_vec(), law, values })
    }

    /// Returns the value at a place. Before the first and after the last value it is constant. At given places it is returned as
    /// written.
    pub(super) fn value_at(&self, place: f64) -> Node {
        let next = self.at.partition_point(|at| *at <= place);
        let before = next.saturating_sub(1);
        let exact = next == 0 || next == self.at.len() || self.at[before] == place;
        let node = &self.nodes[before];
        if exact {
            return node.clone();
        }
        let value = match &self.values {
            Values::Held => return node.clone(),
            Values::List(tracks) => Value::Seq(tracks.iter().map(|track| track.value_at(place)).collect()),
            Values::Scalar { values, unit } => written(self.scalar_at(values, before, place), *unit),
        };
        Node::new(value, node.span, std::sync::Arc::clone(&node.file))
    }

    /// Returns the number between the value at `before` and the next one.
    fn scalar_at(&self, values: &[f64], before: usize, place: f64) -> f64 {
        let (a, b) = (values[before], values[before + 1]);
        let length = self.at[before + 1] - self.at[before];
        let t = (place - self.at[before]) / length;
        match self.law {
            Law::Linear | Law::Hold => (1.0 - t) * a + t * b,
            Law::Logarithmic => a * pow(b / a, t),
            Law::Reciprocal => 1.0 / ((1.0 - t) / a + t / b),
            Law::Smooth => {
                let [from, to] = [before, before + 1].map(|i| slope(&self.at, values, i) * length);
                let u = 1.0 - t;
                // The cubic Hermite polynomial in Bernstein form.
                u * u * u * a + 3.0 * u * u * t * (a + from / 3.0) + 3.0 * u * t * t * (b - to / 3.0) + t * t * t * b
            }
        }
    }
}

/// Returns the slope of the monotone cubic at a value: the weighted harmonic mean of the slopes on either side, 0 at the ends and
/// at extrema (F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 300, 1984).
fn slope(at: &[f64], values: &[f64], i: usize) -> f64 {
    if i == 0 || i + 1 == values.len() {
        return 0.0;
    }
    let (h0, h1) = (at[i] - at[i - 1], at[i + 1] - at[i]);
    let (d0, d1) = ((values[i] - values[i - 1]) / h0, (values[i + 1] - values[i]) / h1);
    if d0 * d1 <= 0.0 {
        return 0.0;
    }
    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
    (w0 + w1) / (w0 / d0 + w1 / d1)
}

fn values_of(at: &[f64], nodes: &[Node], law: Law) -> Result<Values, Fault> {
    if let Value::Seq(first) = &nodes[0].value {
        let mut tracks = Vec::with_capacity(first.len());
        for i in 0..first.len() {
            let mut column = Vec::with_capacity(nodes.len());
            for node in nodes {
                match &node.value {
                    Value::Seq(items) if items.len() == first.len() => column.push(items[i].clone()),
                    _ => {
                        return Err(
                            node.fault(format!("expected a list of {} values, like the first one", first.len()))
                        );
                    }
                }
            }
            tracks.push(Track::new(at, &column, law)?);
        }
        return Ok(Values::List(tracks));
    }
    scalars(nodes, law)
}

fn scalars(nodes: &[Node], law: Law) -> Result<Values, Fault> {
    let read: Vec<(f64, Option<&'static Unit>)> =
        nodes.iter().map(|node| quantity(node, law)).collect::<Result<_, _>>()?;
    let unit = nodes.iter().zip(&read).find_map(|(node, (_, unit))| unit.map(|unit| (node, unit)));
    let mut values = Vec::with_capacity(nodes.len());
    for (node, (value, own)) in nodes.iter().zip(read) {
        values.push(match (unit, own) {
            (None, _) => value,
            (Some((_, unit)), Some(own)) if own.dimension == unit.dimension => own.convert(value, unit),
            (Some((_, unit)), None) if value.is_infinite() || unit.dimension == Dimension::FNumber => value,
            // A bare number among percentages.
            (Some((_, unit)), None) if unit.dimension == Dimension::Ratio => {
                Unit::find("").map_or(value, |whole| whole.convert(value, unit))
            }
            (Some((first, unit)), own) => {
                let found = own.map_or("bare number", |own| own.dimension.noun());
                let [this, first] = [node, first].map(|n| n.as_str().unwrap_or_default());
                let wanted = unit.dimension.noun();
                let fault = node.fault(format!("`{this}` and `{first}` are of different kinds: {found} and {wanted}"));
                return Err(fault.hint("interpolated values must have the same dimension"));
            }
        });
    }
    let bad = |good: &dyn Fn(f64) -> bool| values.iter().position(|v| !good(*v));
    let sign = values[0].signum();
    let (wrong, words) = match law {
        Law::Logarithmic => (bad(&|v| v > 0.0), "`logarithmic` takes values above zero"),
        Law::Reciprocal => {
            (bad(&|v| v != 0.0 && v.signum() == sign), "`reciprocal` takes values of one sign that are not zero")
        }
        Law::Linear | Law::Smooth | Law::Hold => (None, ""),
    };
    match wrong {
        Some(at) => Err(nodes[at].fault(words)),
        None => Ok(Values::Scalar { values, unit: unit.map(|(_, unit)| unit) }),
    }
}

/// Returns the number and unit of a value.
fn quantity(node: &Node, law: Law) -> Result<(f64, Option<&'static Unit>), Fault> {
    let text = node.as_str();
    let reading = match &node.value {
        Value::Number(number) if number.value.is_finite() => Reading::Bare(number.value),
        _ => text.map_or(Reading::Text, Reading::of),
    };
    match reading {
        Reading::Bare(value) => Ok((value, None)),
        Reading::Quantity { value, unit } => Ok((value, Some(unit))),
        Reading::Infinity(negative) if law == Law::Reciprocal => {
            Ok((if negative { f64::NEG_INFINITY } else { f64::INFINITY }, None))
        }
        Reading::Infinity(_) => Err(node
            .fault("this law cannot interpolate to infinity")
            .hint("use the law `reciprocal`, which interpolates 1/value")),
        Reading::UnknownUnit(unit) => Err(node.fault(format!("unknown unit `{unit}`"))),
        Reading::DecimalComma => Err(node.fault("a number with a comma").hint("write a decimal point")),
        Reading::TooLarge | Reading::NotANumber => Err(node.fault("found a number that is not finite")),
        Reading::Text => {
            let found = text.map_or_else(
                || "this value".to_owned(),
                |text| format!("the text `{}`", text.chars().take(48).collect::<String>()),
            );
            Err(node.fault(format!("{found} cannot be interpolated")).hint("only numbers, quantities such as `2 m` and lists of them can be interpolated; for other values, write `interpolation: hold` in an animation, or a list in a sweep"))
        }
    }
}

/// Returns a number with its unit as written in a scene.
fn written(value: f64, unit: Option<&'static Unit>) -> Value {
    if value.is_infinite() {
        return Value::String(if value > 0.0 { "inf" } else { "-inf" }.to_owned());
    }
    match unit {
        None => Value::Number(Number { value, text: value.to_string() }),
        Some(unit) if unit.dimension == Dimension::FNumber => Value::String(format!("f/{value}")),
        Some(unit) => Value::String(format!("{value} {}", unit.symbols[0]).trim_end().to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language::yaml_writer::one_line;
    use crate::yaml::parse;
    use spectra_core::params::SourceFile;

    fn track(at: &[f64], values: &str, law: Law) -> Result<Track, String> {
        let list = parse(SourceFile::new("t.yaml", values)).expect(values);
        let Value::Seq(nodes) = list.value else { panic!("a list") };
        Track::new(at, &nodes, law).map_err(|fault| fault.to_string())
    }

    fn at(values: &str, law: Law, place: f64) -> String {
        let track = track(&[1.0, 5.0], values, law).unwrap_or_else(|text| panic!("{values}: {text}"));
        one_line(&track.value_at(place))
    }

    #[test]
    fn quantities_keep_unit_and_form() {
        for (values, law, place, wanted) in [
            ("[2 m, 50 cm]", Law::Linear, 3.0, "1.25 m"),
            ("[2 m, 50 cm]", Law::Linear, 1.0, "2 m"),
            ("[2 m, 50 cm]", Law::Linear, 5.0, "50 cm"),
            ("[2 m, 50 cm]", Law::Linear, 0.0, "2 m"),
            ("[2 m, 50 cm]", Law::Linear, 9.0, "50 cm"),
            ("[f/2, f/8]", Law::Logarithmic, 3.0, "f/4"),
            ("[f/2, 8]", Law::Logarithmic, 3.0, "f/4"),
            ("[1/64 s, 1/4 s]", Law::Logarithmic, 3.0, "0.0625 s"),
            ("[10, 20]", Law::Linear, 2.0, "12.5"),
            ("[50 %, 1]", Law::Linear, 3.0, "75 %"),
            ("[[0, 1 mm], [4, 2 mm]]", Law::Linear, 3.0, "[2, 1.5 mm]"),
            ("[a, b]", Law::Hold, 4.9, "a"),
            ("[{x: 1}, true]", Law::Hold, 5.0, "true"),
            // Linear in diopters: 0 and 2 at the ends, so 0.5, 1 and 1.5 between.
            ("[infinity, 50 cm]", Law::Reciprocal, 2.0, "200 cm"),
            ("[inf, 50 cm]", Law::Reciprocal, 3.0, "100 cm"),
            ("[2 m, inf]", Law::Reciprocal, 3.0, "4 m"),
            ("[inf, inf]", Law::Reciprocal, 3.0, "inf"),
            // With two values the curve is 3 t^2 - 2 t^3.
            ("[0, 32]", Law::Smooth, 2.0, "5"),
            ("[0, 32]", Law::Smooth, 3.0, "16"),
        ] {
            assert_eq!(at(values, law, place), wanted, "{values} at {place}");
        }
    }

    /// A stop is a factor of the square root of two: a quarter of the way from f/2 to f/8 is f/2.828.
    #[test]
    fn equal_ratios_are_stops() {
        let text = at("[f/2, f/8]", Law::Logarithmic, 2.0);
        let value: f64 = text.trim_start_matches("f/").parse().expect("a number");
        assert!((value / (2.0 * std::f64::consts::SQRT_2) - 1.0).abs() < 4.0 * f64::EPSILON, "{text}");
    }

    /// The inner slopes by Fritsch and Butland are those of scipy.interpolate.PchipInterpolator, and 0 at the ends. The values
    /// come from scipy.interpolate.CubicHermiteSpline with these slopes.
    #[test]
    fn the_smooth_way_is_the_monotone_cubic() {
        let track = track(&[0.0, 1.0, 3.0, 4.0, 6.0], "[0, 1, 2, 5, 4]", Law::Smooth).expect("good");
        for (place, wanted) in SMOOTH {
            let Value::Number(number) = track.value_at(place).value else { panic!("a number") };
            assert!((number.value - wanted).abs() < 1e-12, "{place}: {} {wanted}", number.value);
        }
    }

    const SMOOTH: [(f64, f64); 7] = [
        (0.25, 0.123_798_076_923_076_91),
        (0.5, 0.413_461_538_461_538_44),
        (1.5, 1.263_677_055_702_917_8),
        (2.7, 1.763_929_045_092_838_4),
        (3.3, 2.784_862_068_965_517),
        (3.9, 4.924_379_310_344_827),
        (5.0, 4.5),
    ];

    #[test]
    fn what_has_nothing_between_is_refused() {
        for (values, law, said) in [
            ("[2 m, 3 s]", Law::Linear, "t.yaml:1:7: `3 s` and `2 m` are of different kinds: time and length"),
            ("[2 m, 3]", Law::Linear, "t.yaml:1:7: `3` and `2 m` are of different kinds: bare number and length"),
            ("[3, 2 m]", Law::Linear, "t.yaml:1:2: `3` and `2 m` are of different kinds"),
            ("[a, b]", Law::Linear, "the text `a` cannot be interpolated"),
            ("[true, 1]", Law::Linear, "this value cannot be interpolated"),
            ("[{a: 1}, {a: 2}]", Law::Linear, "this value cannot be interpolated"),
            ("[inf, 1 m]", Law::Linear, "cannot interpolate to infinity"),
            ("[0, 1]", Law::Logarithmic, "t.yaml:1:2: `logarithmic` takes values above zero"),
            ("[1, -1]", Law::Reciprocal, "t.yaml:1:5: `reciprocal` takes values of one sign"),
            ("[0, 1]", Law::Reciprocal, "t.yaml:1:2: `reciprocal`"),
            ("[[1, 2], [1]]", Law::Linear, "t.yaml:1:10: expected a list of 2 values"),
            ("[[1, 2], 3]", Law::Linear, "expected a list of 2 values"),
            ("[[1, a], [1, 2]]", Law::Linear, "the text `a` cannot be interpolated"),
            ("[2 mn, 3 m]", Law::Linear, "unknown unit `mn`"),
            ("['2,5', 3]", Law::Linear, "a number with a comma"),
        ] {
            let text = track(&[1.0, 5.0], values, law).map(|_| ()).expect_err(values);
            assert!(text.contains(said), "{values}: {text}");
        }
    }
}

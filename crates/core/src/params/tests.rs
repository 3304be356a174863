//! Tests of the tree walk beyond single values, on trees made by hand.

use super::*;
use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::HashMap;
use std::sync::Arc;

fn node(value: Value) -> Node {
    Node::new(value, Span::default(), Arc::new(SourceFile::new("t.yaml", "")))
}

fn plain(text: &str) -> Node {
    node(Value::from_plain(text))
}

fn map(entries: &[(&str, Node)]) -> Node {
    let entry = |(key, value): &(&str, Node)| (Key { text: (*key).to_owned(), span: Span::default() }, value.clone());
    node(Value::Map(entries.iter().map(entry).collect()))
}

fn list(elements: &[Node]) -> Node {
    node(Value::Seq(elements.to_vec()))
}

/// Returns `path: message` of each fault.
fn said<T>(result: Result<T, Faults>) -> Vec<String> {
    let faults = result.err().unwrap_or_default();
    let mut said: Vec<String> = faults.iter().map(|fault| format!("{}: {}", fault.path, fault.message)).collect();
    said.sort();
    said
}

#[test]
fn plain_scalars_follow_the_core_schema() {
    let number = |text: &str| match Value::from_plain(text) {
        Value::Number(number) => Some(number.value),
        _ => None,
    };
    // YAML 1.2.2, section 10.3.2.
    for (text, value) in [
        ("0", 0.0),
        ("0o7", 7.0),
        ("0x3A", 58.0),
        ("-19", -19.0),
        ("0.", 0.0),
        ("-0.0", -0.0),
        (".5", 0.5),
        ("+12e03", 12e3),
        ("-2E+05", -2e5),
        (".inf", f64::INFINITY),
        ("-.Inf", f64::NEG_INFINITY),
        ("+.INF", f64::INFINITY),
        ("007", 7.0),
    ] {
        assert_eq!(number(text), Some(value), "{text}");
    }
    assert!(number(".NAN").is_some_and(f64::is_nan));
    for text in [
        "1_000", "inf", "nan", "0x", "0xg", "1e", "e1", ".", "-", "+", "1.2.3", "12 mm", "1/2", "--1", "+-1", "-0x3A",
        "-.nan",
    ] {
        assert!(matches!(Value::from_plain(text), Value::String(_)), "{text}");
    }
    for text in ["", "~", "null", "Null", "NULL"] {
        assert!(matches!(Value::from_plain(text), Value::Null), "{text}");
    }
    for text in ["True", "yes", "on", "FALSE", "y"] {
        assert!(matches!(Value::from_plain(text), Value::String(_)), "{text}");
    }
}

#[test]
fn quantities_convert_exactly() {
    let mm = |text: &str| Length::from_text(text).map(Length::mm);
    assert_eq!(mm("41.8"), Ok(41.8));
    assert_eq!(mm("5.375 cm"), Ok(53.75));
    assert_eq!(mm("2 in"), Ok(50.8));
    // The f64 nearest to 0.5875618 is not that number, so its thousandfold may be one unit in the last place off.
    assert!(
        Wavelength::from_text("0.5875618 um").is_ok_and(|line| (line.nm() - 587.5618).abs() <= 587.5618 * f64::EPSILON)
    );
    assert_eq!(Time::from_text("1/60").map(Time::s), Ok(1.0 / 60.0));
    assert_eq!(Angle::from_text("1 rad").map(Angle::rad), Ok(1.0));
    assert_eq!(Angle::from_text("250 mrad").map(Angle::rad), Ok(0.25));
    assert_eq!(Angle::from_text("5400 arcmin").map(Angle::rad), Ok(std::f64::consts::FRAC_PI_2));
    assert_eq!(FNumber::from_text("f/2").map(FNumber::number), Ok(2.0));
    assert_eq!(Ratio::from_text("18 %").map(Ratio::number), Ok(0.18));
    assert_eq!(SpatialFrequency::from_text("1200 lines/mm").map(SpatialFrequency::per_mm), Ok(1200.0));
    assert_eq!(RadiantIntensity::from_text("5 mW/sr").map(RadiantIntensity::w_per_sr), Ok(0.005));
    assert_eq!(Power::from_text("1 kW").map(Power::w), Ok(1000.0));
    assert_eq!(Illuminance::from_text("10 klx").map(Illuminance::lx), Ok(10_000.0));
    assert_eq!(Luminance::from_text("300 nit").map(Luminance::cd_per_m2), Ok(300.0));
    assert_eq!(
        OrInfinity::<Positive<Length>>::from_text("inf").map(OrInfinity::<Positive<Length>>::mm),
        Ok(f64::INFINITY)
    );
    assert!(OrInfinity::<Positive<Length>>::from_text("-3").is_err());
    assert!(Positive::<f64>::from_text("50 %").is_err());
}

/// Every example must be read by its own type, and every bare unit must be one.
#[test]
fn examples_are_right() {
    fn check<Q: Quantity>() {
        assert!(Q::from_text(Q::EXAMPLE).is_ok(), "{}", Q::EXAMPLE);
        assert!(
            Q::BARE_UNIT.is_empty() || Unit::find(Q::BARE_UNIT).is_some_and(|unit| unit.dimension == Q::DIMENSION),
            "{}",
            Q::BARE_UNIT
        );
        assert!(Q::from_text("5 furlong").is_err() && Q::from_text("").is_err() && Q::from_text("nan").is_err());
        assert_eq!(Q::from_text("inf").is_ok(), Q::INFINITY);
        assert_eq!(Q::from_text("-1").is_ok(), Q::BOUND == Bound::Any);
        assert_eq!(Q::from_text("0").is_ok(), Q::BOUND != Bound::Positive);
    }
    check::<f64>();
    check::<Length>();
    check::<LengthOrInfinity>();
    check::<Positive<Length>>();
    check::<NonNegative<Time>>();
    check::<Wavelength>();
    check::<Time>();
    check::<Angle>();
    check::<Temperature>();
    check::<Luminance>();
    check::<FNumber>();
    check::<Illuminance>();
    check::<Exposure>();
    check::<Power>();
    check::<RadiantIntensity>();
    check::<Ratio>();
    check::<SpatialFrequency>();
}

#[test]
fn several_missing_and_wrong_keys_come_in_one_go() {
    #[derive(Debug, Deserialize, JsonSchema)]
    #[allow(dead_code)]
    struct Inner {
        a: Length,
        b: Time,
        c: String,
        d: Vec<f64>,
        e: HashMap<String, u8>,
        f: Option<StageNode>,
        g: StageNode,
    }
    #[derive(Debug, Deserialize, JsonSchema)]
    #[allow(dead_code)]
    struct Outer {
        first: Inner,
        second: Inner,
        third: (f64, Length),
    }
    let tree = map(&[
        ("first", map(&[("a", plain("2 s")), ("d", list(&[plain("1"), plain("x"), plain("3"), plain("y")]))])),
        ("third", list(&[plain("x"), plain("1 s")])),
    ]);
    let expected = [
        "first.a: found a time, expected a length such as 50 mm",
        "first.b: missing key `b`",
        "first.c: missing key `c`",
        "first.d[1]: found the text `x`, expected a number such as 1.5",
        "first.d[3]: found the text `y`, expected a number such as 1.5",
        "first.e: missing key `e`",
        "first.g: missing key `g`",
        "second: missing key `second`",
        "third[0]: found the text `x`, expected a number such as 1.5",
        "third[1]: found a time, expected a length such as 50 mm",
    ];
    assert_eq!(said(tree.parse::<Outer>()), expected);
}

#[test]
fn checks_of_a_whole_are_made_on_what_is_right() {
    #[derive(Debug, Deserialize, JsonSchema)]
    #[serde(try_from = "Raw")]
    #[allow(dead_code)]
    struct Range(f64, f64);
    #[derive(Debug, Deserialize, JsonSchema)]
    struct Raw {
        from: f64,
        to: f64,
    }
    impl TryFrom<Raw> for Range {
        type Error = String;
        fn try_from(raw: Raw) -> Result<Self, String> {
            if raw.from < raw.to { Ok(Self(raw.from, raw.to)) } else { Err("`from` must be below `to`".to_owned()) }
        }
    }
    #[derive(Debug, Deserialize, JsonSchema)]
    #[allow(dead_code)]
    struct Outer {
        range: Range,
        other: Range,
    }
    let tree = |from: &str| {
        map(&[
            ("range", map(&[("from", plain(from)), ("to", plain("0"))])),
            ("other", map(&[("from", plain("2")), ("to", plain("1"))])),
        ])
    };
    let below = ": `from` must be below `to`";
    assert_eq!(said(tree("x").parse::<Outer>()), ["range.from: found the text `x`, expected a number such as 1.5"]);
    assert_eq!(said(tree("3").parse::<Outer>()), [below]);
    assert_eq!(said(tree("-1").parse::<Outer>()), [below]);
    assert_eq!(said(map(&[("from", plain("3")), ("to", plain("2"))]).parse::<Range>()), [below]);
}

#[test]
fn types_that_hold_themselves_end() {
    #[derive(Debug, Deserialize, JsonSchema)]
    #[serde(rename_all = "kebab-case")]
    #[allow(dead_code)]
    enum Expression {
        Sum(Box<Expression>, Box<Expression>),
        Number(f64),
    }
    #[derive(Debug, Deserialize, JsonSchema)]
    #[allow(dead_code)]
    struct Holder {
        value: Expression,
        after: f64,
    }
    let sum = map(&[("sum", list(&[map(&[("number", plain("1"))]), map(&[("number", plain("x"))])]))]);
    let tree = map(&[("value", sum), ("after", plain("y"))]);
    let expected = [
        "after: found the text `y`, expected a number such as 1.5",
        "value.sum[1].number: found the text `x`, expected a number such as 1.5",
    ];
    assert_eq!(said(tree.parse::<Holder>()), expected);
}

#[test]
fn any_keys() {
    let right = map(&[("550 nm", plain("1")), ("600", plain("2"))]);
    #[derive(Debug, Deserialize, JsonSchema, PartialEq)]
    struct Row(String, f64);
    assert_eq!(right.parse::<HashMap<String, f64>>().map(|map| map["550 nm"]), Ok(1.0));
    assert_eq!(list(&[plain("a"), plain("2")]).parse(), Ok(Row("a".to_owned(), 2.0)));
}

#[test]
fn a_fault_in_one_of_several_forms_has_its_own_place() {
    #[derive(Debug, Deserialize, JsonSchema)]
    #[serde(untagged)]
    #[allow(dead_code)]
    enum Glass {
        Name(String),
        Model { nd: f64, vd: f64 },
    }
    #[derive(Debug, Deserialize, JsonSchema)]
    #[allow(dead_code)]
    struct Holder {
        glass: Glass,
        nd: Length,
    }
    let model = |vd: &str| map(&[("nd", plain("1.6")), ("vd", plain(vd))]);
    assert!(map(&[("glass", model("57")), ("nd", plain("1"))]).parse::<Holder>().is_ok());
    assert!(map(&[("glass", plain("N-BK7")), ("nd", plain("1"))]).parse::<Holder>().is_ok());
    let wrong = map(&[("glass", model("x")), ("nd", plain("1 s"))]);
    let paths: Vec<String> = wrong.parse::<Holder>().unwrap_err().iter().map(|fault| fault.path.clone()).collect();
    assert_eq!(paths, ["glass.vd", "nd"]);
}

#[test]
fn a_stage_node_does_not_come_from_other_formats() {
    let buffered = map(&[("a", plain("1"))]);
    #[derive(Debug, Deserialize, JsonSchema)]
    #[serde(untagged)]
    #[allow(dead_code)]
    enum Either {
        Stage(StageNode),
    }
    assert!(buffered.parse::<Either>().is_err());
    assert!(buffered.parse::<StageNode>().is_ok());
}

#[test]
fn folders_of_files() {
    let folder = |name: &str| SourceFile::new(name, "").folder().map(|path| path.display().to_string());
    assert_eq!(folder("scenes/a.yaml").as_deref(), Some("scenes"));
    assert_eq!(folder("a.yaml").as_deref(), Some(""));
    assert_eq!(folder("--set lens.file=x/y.yaml").as_deref(), Some(""));
    assert_eq!(folder("bundled:lenses/a.yaml"), None);
}

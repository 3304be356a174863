//! Tests small inputs, each with the exact place and the essential part of the message.

use super::*;
use schemars::JsonSchema;
use serde::Deserialize;
use spectra_core::params::{
    Angle, Exposure, FNumber, Length, LengthOrInfinity, NonNegative, Params, Positive, Ratio, StageNode, Temperature,
    Time, Wavelength,
};
use std::collections::BTreeMap;

mod hostile;

/// Parameters with a field of each kind.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(dead_code)] // Most fields exist only to be deserialized.
struct Camera {
    #[serde(default)]
    focus: Option<LengthOrInfinity>,
    #[serde(default)]
    radius: Option<Length>,
    #[serde(default)]
    semi_diameter: Option<Positive<Length>>,
    #[serde(default)]
    f_number: Option<FNumber>,
    #[serde(default)]
    exposure: Option<Time>,
    #[serde(default)]
    fog: Option<NonNegative<Exposure>>,
    #[serde(default)]
    wavelength: Option<Wavelength>,
    #[serde(default)]
    tilt: Option<Angle>,
    #[serde(default)]
    temperature: Option<Temperature>,
    #[serde(default)]
    haze: Option<Ratio>,
    #[serde(default)]
    conic: Option<f64>,
    #[serde(default)]
    seed: Option<u64>,
    #[serde(default)]
    blades: Option<u8>,
    #[serde(default)]
    mirror: Option<bool>,
    #[serde(default)]
    name: Option<String>,
    #[serde(default)]
    direction: Option<Direction>,
    #[serde(default)]
    resolution: Option<[u32; 2]>,
    #[serde(default)]
    surfaces: Vec<Surface>,
    #[serde(default)]
    lines: BTreeMap<String, Wavelength>,
    #[serde(default)]
    color: Option<StageNode>,
    #[serde(default)]
    stop: Option<Stop>,
}

#[derive(Debug, Deserialize, JsonSchema, PartialEq)]
#[serde(rename_all = "kebab-case")]
enum Direction {
    Auto,
    Forward,
    Backward,
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[allow(dead_code)] // As above.
enum Stop {
    Open,
    Circle { radius: Length },
    FNumber(FNumber),
}

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[allow(dead_code)] // As above.
struct Surface {
    radius: Length,
    thickness: Length,
    #[serde(default)]
    glass: Option<String>,
}

fn tree(text: &str) -> Result<Node, Faults> {
    parse(SourceFile::new("t.yaml", text))
}

fn camera(text: &str) -> Result<Camera, Faults> {
    tree(text)?.parse()
}

/// Cases: the input, and for each fault its line, its column and the essential parts of its message and hint. An empty hint means none,
/// or only an example of the right form.
type Row = (&'static str, &'static [(usize, usize, &'static str, &'static str)]);

fn check(rows: &[Row]) {
    for (text, expected) in rows {
        let faults = camera(text).expect_err(text);
        let said: Vec<String> = faults.iter().map(ToString::to_string).collect();
        assert_eq!(faults.len(), expected.len(), "{text:?}: {said:#?}");
        for (fault, &(line, column, message, hint)) in faults.iter().zip(*expected) {
            let (_, span) = fault.place.as_ref().expect("every fault of a file has a place");
            assert_eq!((span.line, span.column), (line, column), "{text:?}: {fault}");
            assert!(fault.message.contains(message), "{text:?}: {fault}");
            match (&fault.hint, hint) {
                (None, "") => {}
                (Some(given), "") if given.contains("as in `") => {}
                (Some(given), hint) if !hint.is_empty() => assert!(given.contains(hint), "{text:?}: {fault}"),
                _ => panic!("{text:?}: hint of {fault}, expected {hint:?}"),
            }
        }
    }
}

#[test]
fn quantities_are_checked_by_dimension() {
    check(&[
        ("focus: 2 s", &[(1, 8, "found a time, expected a length such as 50 mm", "units: nm, um, mm, cm, m")]),
        ("exposure: 5 mm", &[(1, 11, "found a length, expected a time such as 1/125 s", "a bare number is in s")]),
        (
            "wavelength: 5500 K",
            &[(1, 13, "found a temperature, expected a positive wavelength such as 550 nm", "bare number is in nm")],
        ),
        ("f-number: 2 m", &[(1, 11, "found a length, expected a positive f-number such as f/2.8", "")]),
        ("f-number: F2.8", &[(1, 11, "expected a positive f-number", "write `f/2.8`")]),
        ("radius: f/2", &[(1, 9, "found an f-number, expected a length", "units")]),
        ("radius: 50 mn", &[(1, 9, "unknown unit `mn`", "did you mean `nm`?")]),
        ("radius: 50 MM", &[(1, 9, "unknown unit `MM`", "did you mean `mm`?")]),
        ("radius: 50 parsec", &[(1, 9, "unknown unit `parsec`", "units: nm, um, mm")]),
        ("radius: 2,8 mm", &[(1, 9, "found the text `2,8 mm`", "decimal point")]),
        ("radius: big", &[(1, 9, "found the text `big`, expected a length such as 50 mm", "")]),
        ("radius: [1]", &[(1, 9, "found a list, expected a length", "without brackets")]),
        ("radius: {mm: 1}", &[(1, 9, "found a map, expected a length", "")]),
        ("radius: true", &[(1, 9, "found true, expected a length", "")]),
        ("conic: 2 m", &[(1, 8, "found a length, expected a number such as 1.5", "")]),
        ("haze: 5 mm", &[(1, 7, "found a length, expected a ratio such as 50 %", "units: %; or a bare number")]),
        ("fog: 3 lx", &[(1, 6, "found an illuminance, expected a non-negative exposure", "lx s")]),
        ("tilt: 3 mm", &[(1, 7, "found a length, expected an angle such as 12 deg", "deg")]),
        ("temperature: 20 C", &[(1, 14, "unknown unit `C`", "K")]),
    ]);
}

#[test]
fn signs_and_infinities_are_checked() {
    check(&[
        ("semi-diameter: -5 mm", &[(1, 16, "found -5 mm, expected a positive length such as 50 mm", "")]),
        ("semi-diameter: 0", &[(1, 16, "found 0, expected a positive length", "")]),
        ("fog: -1", &[(1, 6, "found -1, expected a non-negative exposure", "")]),
        ("wavelength: -550", &[(1, 13, "found -550, expected a positive wavelength", "")]),
        ("radius: .nan", &[(1, 9, "found .nan, expected a length", "")]),
        ("focus: .nan", &[(1, 8, "found .nan, expected a length such as 50 mm or `inf`", "")]),
        ("radius: .inf", &[(1, 9, "found .inf, expected a length", "")]),
        ("radius: 1e999", &[(1, 9, "found 1e999, which is too large", "")]),
        ("radius: 1e308 km", &[(1, 9, "found 1e308 km, which is too large", "")]),
        ("conic: .nan", &[(1, 8, "found .nan, expected a number", "")]),
        ("conic: -.inf", &[(1, 8, "found -.inf, expected a number", "")]),
        ("focus: -.inf", &[(1, 8, "found -.inf, expected a length", "")]),
    ]);
}

#[test]
fn types_say_what_was_found_and_expected() {
    check(&[
        ("seed: 1.5", &[(1, 7, "found the number 1.5, expected a whole number such as 16", "from 0 to")]),
        ("seed: -1", &[(1, 7, "found -1, which is out of range", "a whole number from 0 to 18446744073709551615")]),
        ("blades: 300", &[(1, 9, "found 300, which is out of range", "a whole number from 0 to 255")]),
        ("seed: many", &[(1, 7, "found the text `many`, expected a whole number", "")]),
        ("conic: '1.5'", &[(1, 8, "found the text `1.5`, expected a number", "remove the quotes")]),
        ("mirror: yes", &[(1, 9, "found the text `yes`, expected true or false", "write `true`")]),
        ("mirror: off", &[(1, 9, "found the text `off`, expected true or false", "write `false`")]),
        ("mirror: 1", &[(1, 9, "found the number 1, expected true or false", "")]),
        ("name: true", &[(1, 7, "found true, expected a text", "quotes")]),
        ("name: [a]", &[(1, 7, "found a list, expected a text", "")]),
        ("direction: backwards", &[(1, 12, "unknown value `backwards` for `direction`", "did you mean `backward`?")]),
        ("direction: up", &[(1, 12, "unknown value `up` for `direction`", "known: auto, forward, backward")]),
        ("direction: [up]", &[(1, 12, "found a list, expected one of auto, forward, backward", "")]),
        ("resolution: [1, 2, 3]", &[(1, 13, "found a list of 3, expected a list of 2", "write 2 values")]),
        ("resolution: [1]", &[(1, 13, "found a list of 1, expected a list of 2", "write 2 values")]),
        ("resolution: 640", &[(1, 13, "found the number 640, expected a list of 2", "write 2 values")]),
        ("resolution: [640, x]", &[(1, 19, "found the text `x`, expected a whole number", "")]),
        ("surfaces: 3", &[(1, 11, "found the number 3, expected a list", "put it in brackets: `[3]`")]),
        ("surfaces: [3]", &[(1, 12, "found the number 3, expected a map", "known keys: radius, thickness, glass")]),
        ("lines: {g: 436, h: 2 s}", &[(1, 20, "found a time, expected a positive wavelength", "nm")]),
        ("stop: {circle: {radius: 1 s}}", &[(1, 25, "found a time, expected a length", "units")]),
        ("stop: circle", &[(1, 7, "unknown value `circle` for `stop`", "known: open")]),
        ("stop: {open: 3}", &[(1, 8, "unknown key `open`", "known keys: circle, f-number")]),
        ("stop: {f-number: 2 s}", &[(1, 18, "found a time, expected a positive f-number", "")]),
        ("stop: {hole: 3}", &[(1, 8, "unknown key `hole`", "known keys: circle, f-number")]),
        ("[1, 2]", &[(1, 1, "found a list, expected a map", "known keys: focus")]),
        ("", &[(1, 1, "found nothing, expected a map", "known keys: focus")]),
    ]);
}

#[test]
fn keys_are_checked() {
    check(&[
        ("raduis: 5", &[(1, 1, "unknown key `raduis`", "did you mean `radius`?")]),
        ("f_number: 2", &[(1, 1, "unknown key `f_number`", "did you mean `f-number`?")]),
        ("zoom: 5", &[(1, 1, "unknown key `zoom`", "known keys: focus, radius, semi-diameter")]),
        ("kind: 5", &[(1, 1, "unknown key `kind`", "known keys")]),
        ("{radius: 1, rad: 2}", &[(1, 13, "unknown key `rad`", "did you mean `radius`?")]),
        ("surfaces:\n  - radius: 5\n", &[(2, 5, "missing key `thickness`", "add `thickness: ...`")]),
        ("surfaces:\n- {radius: 5}\n", &[(2, 3, "missing key `thickness`", "add `thickness: ...`")]),
        ("surfaces:\n- {}\n", &[(2, 3, "missing key `radius`", "add"), (2, 3, "missing key `thickness`", "add")]),
        ("surfaces:\n-\n", &[(2, 2, "found nothing, expected a map", "known keys")]),
        // The right name of a misspelled key is not reported as missing, too.
        ("surfaces:\n- {radius: 5, thicknes: 3}\n", &[(2, 15, "unknown key `thicknes`", "did you mean `thickness`?")]),
        // A key with a wrong value is not reported as missing either.
        ("surfaces:\n- {radius: 5 s, thickness: 3}\n", &[(2, 12, "found a time", "units")]),
        ("radius: 1\nradius: 2\n", &[(2, 1, "the key `radius` appears twice", "remove one of them")]),
    ]);
}

#[test]
fn all_faults_of_a_file_come_in_one_go() {
    let text = "\
focus: 2 s
radius: 41.8 mn
f-number: -2
surfaces:
  - {radius: x, thickness: 5}
  - {radius: 5, glas: N-BK7}
  - 7
  - radius: 5
    thickness: [1]
    tickness: 2
lines:
  g: 436
  h: 1 K
stop:
  circle:
    radious: 3
zoom: 3
mirror: no
";
    let faults = camera(text).unwrap_err();
    let said: Vec<String> = faults.iter().map(|fault| format!("{} {}", fault.path, fault)).collect();
    let expected = [
        ("focus", "1:8", "found a time"),
        ("radius", "2:9", "unknown unit `mn`"),
        ("f-number", "3:11", "found -2, expected a positive f-number"),
        ("surfaces[0].radius", "5:14", "found the text `x`"),
        ("surfaces[1].thickness", "6:5", "missing key `thickness`"),
        ("surfaces[1].glas", "6:17", "unknown key `glas`"),
        ("surfaces[2]", "7:5", "found the number 7, expected a map"),
        ("surfaces[3].thickness", "9:16", "found a list"),
        ("surfaces[3].tickness", "10:5", "unknown key `tickness`"),
        ("lines.h", "13:6", "found a temperature"),
        ("stop.circle.radious", "16:5", "unknown key `radious`"),
        ("zoom", "17:1", "unknown key `zoom`"),
        ("mirror", "18:9", "found the text `no`"),
    ];
    assert_eq!(said.len(), expected.len(), "{said:#?}");
    for (said, (path, place, kernel)) in said.iter().zip(expected) {
        assert!(
            said.starts_with(&format!("{path} t.yaml:{place}: ")) && said.contains(kernel),
            "{said}: {path} {place} {kernel}"
        );
    }
}

#[test]
fn right_files_are_read() {
    let text = "\
focus: inf
radius: -1 in
semi-diameter: 18
f-number: f/1.4
exposure: 1/125 s
fog: 20 lx s
wavelength: 0.55 um
tilt: 90
temperature: 5500 K
haze: 18 %
conic: -1
seed: 18446744073709551615
blades: 1e1
mirror: true
name: 135
direction: backward
resolution: [960, 640]
surfaces:
- {radius: 41.8, thickness: 5.375, glass: SCHOTT/BAF9}
- radius: 2 cm
  thickness: &gap 3
- {radius: 1, thickness: *gap}
lines: {C': 643.85, e: 546.07 nm}
color: {kind: fraunhofer, R: \"C'\"}
stop: {circle: {radius: 4}}
";
    let camera = camera(text).unwrap();
    assert_eq!(camera.focus.map(LengthOrInfinity::mm), Some(f64::INFINITY));
    assert_eq!(camera.radius.map(Length::mm), Some(-25.4));
    assert_eq!(camera.semi_diameter.map(|d| d.mm()), Some(18.0));
    assert_eq!(camera.f_number.map(FNumber::number), Some(1.4));
    assert_eq!(camera.exposure.map(Time::s), Some(0.008));
    assert_eq!(camera.fog.map(|fog| fog.lx_s()), Some(20.0));
    assert_eq!(camera.wavelength.map(Wavelength::nm), Some(550.0));
    assert_eq!(camera.tilt.map(Angle::rad), Some(std::f64::consts::FRAC_PI_2));
    assert_eq!(camera.temperature.map(Temperature::kelvin), Some(5500.0));
    assert_eq!(camera.haze.map(Ratio::number), Some(0.18));
    assert_eq!(camera.conic, Some(-1.0));
    assert_eq!(camera.seed, Some(u64::MAX));
    assert_eq!(camera.blades, Some(10));
    assert_eq!(camera.mirror, Some(true));
    assert_eq!(camera.name.as_deref(), Some("135"));
    assert_eq!(camera.direction, Some(Direction::Backward));
    assert_eq!(camera.resolution, Some([960, 640]));
    assert_eq!(camera.surfaces.len(), 3);
    assert_eq!(camera.surfaces[0].glass.as_deref(), Some("SCHOTT/BAF9"));
    assert_eq!(camera.surfaces[2].thickness.mm(), 3.0);
    assert_eq!(camera.lines["e"].nm(), 546.07);
    assert!(matches!(camera.stop, Some(Stop::Circle { .. })));
    let color = camera.color.unwrap();
    assert_eq!(color.path(), "color");
    let params = color.params().unwrap();
    assert_eq!(params.kind(), Some("fraunhofer"));
    let fault = params.fault("R", "no such line");
    assert_eq!((fault.to_string().as_str(), fault.path.as_str()), ("t.yaml:24:30: no such line", "color.R"));
}

#[test]
fn stages_are_taken_with_their_places() {
    #[derive(Debug, Deserialize, JsonSchema)]
    struct Scene {
        source: StageNode,
        surfaces: Vec<StageNode>,
    }
    let text = "source: chart\nsurfaces:\n- {kind: sphere, radius: 2 s}\n- {radius: 5}\n";
    let scene: Scene = tree(text).unwrap().parse().unwrap();
    assert_eq!(scene.source.params().unwrap().kind(), Some("chart"));
    let params = scene.surfaces[0].params().unwrap();
    assert_eq!((params.kind(), params.path()), (Some("sphere"), "surfaces[0]"));
    let faults = params.parse::<Surface>().unwrap_err();
    assert_eq!(faults.len(), 2);
    let missing = &faults.0[0];
    assert_eq!((missing.path.as_str(), missing.message.as_str()), ("surfaces[0].thickness", "missing key `thickness`"));
    let wrong = &faults.0[1];
    assert!(wrong.to_string().starts_with("t.yaml:3:26: found a time"), "{wrong}");
    assert_eq!(params.fault("kind", "x").to_string(), "t.yaml:3:10: x");
    assert_eq!(params.fault("thickness", "x").to_string(), "t.yaml:3:3: x");
    assert_eq!(scene.surfaces[1].params().unwrap().kind(), None);
    for (text, said) in [
        ("3", "found the number 3"),
        ("[a]", "found a list"),
        ("{kind: [a]}", "found a list, expected the name of a kind"),
    ] {
        let faults = Params::stage(tree(text).unwrap(), "film").unwrap_err();
        assert!(faults.to_string().contains(said), "{faults}");
    }
}

#[test]
fn syntax_errors_have_a_place() {
    check(&[
        ("a: [1, 2", &[(1, 4, "`[` is never closed", "add `]`")]),
        ("a: {b: 2", &[(1, 4, "`{` is never closed", "add `}`")]),
        ("a: [1, {b: 3]", &[(1, 8, "`{` is closed by `]`", "innermost bracket")]),
        ("a: 1\n\tb: 2", &[(2, 1, "a tab", "spaces")]),
        ("a: b: c", &[(1, 5, "a second `: `", "quotes")]),
        ("a: 1\n b: 2", &[(2, 2, "indented deeper than the one above", "same column")]),
        ("a: {b: 2\nc: 3", &[(1, 4, "`{` is never closed", "line 2")]),
        ("a: {b: 2 c: 3}", &[(1, 10, "before `c`", "commas")]),
        ("a:\n\tb: 1\n\tc: 2", &[(2, 1, "a tab", "spaces")]),
        ("a\nb: 2", &[(1, 1, "a key without its `:`", "key: value")]),
        ("a:1\nb: 2", &[(1, 1, "`:` without a space after it", "write `a: 1`")]),
        (
            "x: {a:1, b: 2, c:d e}",
            &[
                (1, 5, "`:` without a space after it", "write `a: 1`"),
                (1, 16, "`:` without a space after it", "write `c: d e`"),
            ],
        ),
        ("a: 'x", &[(1, 4, "a quote is never closed", "close it")]),
        ("a: @x", &[(1, 4, "cannot start with `@`", "quotes")]),
        ("a: 1\nb: %x", &[(2, 4, "cannot start with `%`", "quotes")]),
        ("a: - 1", &[(1, 4, "`- ` cannot start an entry here", "a line of its own")]),
        ("- a\nb: 1", &[(2, 1, "expected `- ` here", "same column")]),
        ("a: *b", &[(1, 4, "this alias refers to no anchor above it", "&name")]),
        ("a: &b [*b]", &[(1, 8, "inside the value that it refers to", "write the values out")]),
        ("a: !x 1", &[(1, 4, "the tag `!x`", "remove it")]),
        ("a: !!str 1\nb: !<x> 2", &[(1, 4, "the tag `!!str`", "remove it"), (2, 4, "the tag `!<x>`", "remove it")]),
        ("a: 1\n---\nb: 1", &[(2, 1, "a second document", "remove `---`")]),
        ("%YAML 1.2\n---\na: 1", &[(1, 1, "directives", "remove the line")]),
        ("a: {<<: *b}", &[(1, 9, "this alias refers to no anchor above it", "&name")]),
        ("a: &b {c: 1}\nd: {<<: *b}", &[(2, 5, "merge keys", "write the keys out")]),
        ("? [a]\n: 1", &[(1, 3, "a key must be a text", "key: value")]),
        (": 1", &[(1, 1, "a key is missing", "key: value")]),
        (
            "a: 1\nb: {c: 1, d: 2, c: 3}\na: 2",
            &[(2, 17, "the key `c` appears twice", "remove"), (3, 1, "the key `a` appears twice", "remove")],
        ),
        ("\u{e9}\u{e9}: [\u{e9}, 'x", &[(1, 9, "a quote is never closed", "close it")]),
    ]);
}

#[test]
fn bytes_that_are_no_text_have_a_place() {
    let fault = |bytes: &[u8]| parse_bytes("t.yaml", bytes).unwrap_err().0.remove(0);
    let latin = fault(b"a: 1\nname: caf\xe9\n");
    assert_eq!(latin.to_string(), "t.yaml:2:10: this byte is not UTF-8 (save it as UTF-8)");
    let utf16 = fault(b"\xff\xfea\0:\0");
    assert!(utf16.to_string().contains("UTF-16"), "{utf16}");
    assert!(parse_bytes("t.yaml", b"\xef\xbb\xbfa: 1").unwrap().get("a").is_some());
}

#[test]
fn overrides_replace_and_create() {
    let mut root = tree("film: {stock: a, exposure: 1 s}\nsurfaces: [{radius: 1}]\nempty:\n").unwrap();
    for argument in [
        "film.exposure=1/60 s",
        "imager.resolution=[10, 20]",
        "surfaces[0].radius=5 s",
        "surfaces[1]={radius: 3}",
        "empty.x=1",
        "film.stock=null",
    ] {
        parse_override(argument).unwrap().apply(&mut root).unwrap();
    }
    assert_eq!(root.at_path("film.exposure").and_then(Node::as_str), Some("1/60 s"));
    assert_eq!(root.at_path("imager.resolution[1]").and_then(Node::as_str), Some("20"));
    assert_eq!(root.at_path("surfaces[1].radius").and_then(Node::as_str), Some("3"));
    assert_eq!(root.at_path("empty.x").and_then(Node::as_str), Some("1"));
    assert!(root.at_path("film.stock").is_some_and(|node| node.as_str().is_none()));

    let said = parse_override("lens.f-number= ").unwrap_err().to_string();
    assert!(said.contains("`lens.f-number` has no value"), "{said}");

    let fault = root.at_path("surfaces[0].radius").unwrap().parse::<Length>().unwrap_err().0.remove(0);
    assert_eq!(fault.place_text().as_deref(), Some("--set surfaces[0].radius=5 s"));
    let (file, span) = fault.place.unwrap();
    assert_eq!(&file.text[span.offset..span.offset + span.len], "5 s");

    // An unknown key set by an override is reported at the override, even in a map of the file.
    parse_override("surfaces[1].radios=4").unwrap().apply(&mut root).unwrap();
    let faults = root.at_path("surfaces[1]").unwrap().parse::<Surface>().unwrap_err();
    assert!(faults.to_string().contains("--set surfaces[1].radios=4: unknown key `radios`"), "{faults}");
}

#[test]
fn overrides_that_lead_nowhere_are_refused() {
    let base = tree("film: {stock: a}\nsurfaces: [1, 2]\n").unwrap();
    for (argument, said) in [
        ("film", "--set film: `=` is missing"),
        ("=3", "a key is empty"),
        ("film..x=3", "a key is empty"),
        ("film.stock.x=3", "--set film.stock.x=3: `film.stock` is the text `a`, which has no key `x`"),
        ("surfaces[4]=3", "`surfaces` has no entry 4: it has 2, from 0"),
        ("surfaces[x]=3", "`x` is not an index"),
        ("surfaces[1=3", "an index is written `[3]`"),
        ("film[0]=3", "`film` is a map, not a list"),
        ("new[1]=3", "`new` has no entry 1"),
        ("film.x=[1", "--set film.x=[1: `[` is never closed"),
    ] {
        let mut root = base.clone();
        let result = parse_override(argument).and_then(|set| set.apply(&mut root).map_err(Faults::from));
        let faults = result.expect_err(argument);
        assert!(faults.to_string().contains(said), "{argument}: {faults}");
        assert_eq!(format!("{root:?}"), format!("{base:?}"), "{argument} changed the tree");
    }
}

//! Computes how an element of an SVG file is painted, from its attributes, `style`, style sheets and inherited properties.

use super::FillRule;
use super::attribute::{plain_length, shortened};
use super::outline::{Cap, Join, Pen};
use roxmltree::Node;
use simplecss::{AttributeOperator, DeclarationTokenizer, PseudoClass, StyleSheet};
use std::str::FromStr;

/// A color with its opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Color {
    /// Relative luminance of the display color, 0 to 1.
    pub(super) luminance: f64,
    /// Opacity of the color, 0 to 1.
    pub(super) alpha: f64,
}

/// Properties of an element, inherited or stated by itself.
#[derive(Clone, Debug)]
pub(super) struct Style {
    pub(super) fill: Option<Color>,
    pub(super) rule: FillRule,
    pub(super) fill_opacity: f64,
    pub(super) stroke: Option<Color>,
    pub(super) stroke_opacity: f64,
    pub(super) pen: Pen,
    pub(super) opacity: f64,
    pub(super) visible: bool,
    /// Whether the element and everything in it is left out.
    pub(super) hidden: bool,
    color: Color,
}

const BLACK: Color = Color { luminance: 0.0, alpha: 1.0 };

impl Default for Style {
    /// Returns the initial style of SVG: filled in black, without a stroke.
    fn default() -> Self {
        Self {
            fill: Some(BLACK),
            rule: FillRule::NonZero,
            fill_opacity: 1.0,
            stroke: None,
            stroke_opacity: 1.0,
            pen: Pen { width: 1.0, join: Join::Miter, cap: Cap::Butt, miter_limit: 4.0 },
            opacity: 1.0,
            visible: true,
            hidden: false,
            color: BLACK,
        }
    }
}

/// An element in the form that selectors of style sheets need.
struct Element<'a, 'i>(Node<'a, 'i>);

impl simplecss::Element for Element<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Element)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Element)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator<'_>) -> bool {
        self.0.attribute(name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        matches!(class, PseudoClass::FirstChild) && self.0.prev_sibling_element().is_none()
    }
}

/// Returns a property of an element. `style` takes precedence over style sheets, and these over attributes.
fn property<'a>(node: Node<'a, '_>, sheet: &StyleSheet<'a>, name: &str) -> Option<&'a str> {
    let declared = node
        .attribute("style")
        .and_then(|style| DeclarationTokenizer::from(style).filter(|d| d.name == name).map(|d| d.value).last());
    let in_sheet = || {
        let matching = sheet.rules.iter().filter(|rule| rule.selector.matches(&Element(node)));
        matching.flat_map(|rule| &rule.declarations).filter(|d| d.name == name).map(|d| d.value).next_back()
    };
    declared.or_else(in_sheet).or_else(|| node.attribute(name)).map(str::trim)
}

impl Style {
    /// Returns the style of an element inside an element of this style.
    ///
    /// # Errors
    /// Fails for an invalid value, and for properties that are not supported: patterns, gradients, clips, dashes and others.
    pub(super) fn of<'a>(&self, node: Node<'a, '_>, sheet: &StyleSheet<'a>) -> Result<Self, String> {
        let mut style = self.clone();
        let get = |name: &str| property(node, sheet, name).filter(|value| *value != "inherit");
        for unknown in ["clip-path", "mask", "filter", "marker-start", "marker-mid", "marker-end", "stroke-dasharray"] {
            if get(unknown).is_some_and(|value| value != "none") {
                return Err(format!("`{unknown}` is not understood in an aperture"));
            }
        }
        style.hidden = get("display") == Some("none");
        if let Some(value) = get("visibility") {
            style.visible = value == "visible";
        }
        if let Some(value) = get("color") {
            style.color = color(value)?;
        }
        if let Some(value) = get("fill") {
            style.fill = paint(value, style.color, "fill")?;
        }
        if let Some(value) = get("stroke") {
            style.stroke = paint(value, style.color, "stroke")?;
        }
        if let Some(value) = get("fill-rule") {
            style.rule = match value {
                "evenodd" => FillRule::EvenOdd,
                "nonzero" => FillRule::NonZero,
                other => return Err(format!("unknown fill-rule `{}`", shortened(other))),
            };
        }
        for (name, to) in [("fill-opacity", &mut style.fill_opacity), ("stroke-opacity", &mut style.stroke_opacity)] {
            if let Some(value) = get(name) {
                *to = opacity(value)?;
            }
        }
        if let Some(value) = get("opacity") {
            style.opacity *= opacity(value)?;
        }
        if let Some(value) = get("stroke-linejoin") {
            style.pen.join = match value {
                "round" => Join::Round,
                "bevel" => Join::Bevel,
                _ => Join::Miter,
            };
        }
        if let Some(value) = get("stroke-linecap") {
            style.pen.cap = match value {
                "round" => Cap::Round,
                "square" => Cap::Square,
                _ => Cap::Butt,
            };
        }
        if let Some(value) = get("stroke-miterlimit") {
            let limit = value.parse::<f64>().ok().filter(|v| *v >= 1.0);
            style.pen.miter_limit = limit.ok_or_else(|| format!("not a miter limit: `{}`", shortened(value)))?;
        }
        if let Some(value) = get("stroke-width") {
            style.pen.width = plain_length(value)?;
            if style.pen.width < 0.0 {
                return Err(format!("the stroke width is {}", style.pen.width));
            }
        }
        Ok(style)
    }
}

fn opacity(text: &str) -> Result<f64, String> {
    let (number, scale) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    let value = number.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    value.map(|v| (v * scale).clamp(0.0, 1.0)).ok_or_else(|| format!("not an opacity: `{}`", shortened(text)))
}

fn paint(text: &str, current: Color, name: &str) -> Result<Option<Color>, String> {
    match svgtypes::Paint::from_str(text) {
        Ok(svgtypes::Paint::None) => Ok(None),
        Ok(svgtypes::Paint::CurrentColor) => Ok(Some(current)),
        Ok(svgtypes::Paint::Color(c)) => Ok(Some(display(c))),
        Ok(svgtypes::Paint::FuncIRI(..)) => {
            Err(format!("`{name}` with a gradient or pattern is not understood in an aperture"))
        }
        _ => Err(format!("not a color for `{name}`: `{}`", shortened(text))),
    }
}

fn color(text: &str) -> Result<Color, String> {
    svgtypes::Color::from_str(text).map(display).map_err(|_| format!("not a color: `{}`", shortened(text)))
}

/// Returns the luminance of an sRGB color on its encoded scale, with the weights of Rec. 709, as for picture masks.
fn display(c: svgtypes::Color) -> Color {
    let [r, g, b] = [c.red, c.green, c.blue].map(|v| f64::from(v) / 255.0);
    Color { luminance: 0.2126 * r + 0.7152 * g + 0.0722 * b, alpha: f64::from(c.alpha) / 255.0 }
}

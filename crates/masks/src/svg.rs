//! Reads an SVG file as an aperture.
//!
//! Supported are `svg`, `g`, `a`, `use`, `path`, `rect`, `circle`, `ellipse`, `line`, `polyline` and `polygon`, with
//! transforms, fill rules, strokes, opacity, `style` and style sheets (SVG 1.1). Any other element that would be painted is a fault:
//! a difference between an aperture and its drawing would be noticed only late.

use super::attribute::{length, plain_length, shortened};
use super::outline::{Path, Point, stroked};
use super::style::Style;
use super::{Drawing, FLATNESS_MM, FillRule, Painted};
use roxmltree::{Document, Node, ParsingOptions};
use schemars::JsonSchema;
use serde::Deserialize;
use simplecss::StyleSheet;
use spectra_core::math;
use spectra_core::params::{Fault, Faults, SourceFile, Span};
use std::str::FromStr;
use std::sync::Arc;
use svgtypes::{Align, AspectRatio, PathParser, PathSegment, PointsParser, TransformListParser};
use svgtypes::{TransformListToken, ViewBox};

/// Largest number of nodes in a file.
const MAX_NODES: u32 = 200_000;
/// Largest number of painted elements, including those that `use` repeats.
const MAX_PAINTED: usize = 50_000;
/// Largest depth of nesting.
const MAX_DEPTH: usize = 64;
/// Largest number of corners of all outlines together.
const MAX_CORNERS: usize = 2_000_000;
/// Largest number of rules in the style sheets.
const MAX_RULES: usize = 1000;
/// Allowed width and height of a page, mm.
const SIZES_MM: std::ops::RangeInclusive<f64> = 1e-3..=1e5;

/// Parts of a drawing that are open to light.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum Open {
    /// Everything that is painted is open, in any color.
    Filled,
    /// White is open, and gray passes in part.
    White,
}

/// Reads an SVG file as a drawing. `name` is the name of the file in messages; `width_mm` overrides the width that the file states. If
/// `open` is `None`, all shapes must be light or all dark, and every shape is open.
///
/// # Errors
/// Returns every fault of the file, with line and column.
pub fn read(name: &str, bytes: &[u8], width_mm: Option<f64>, open: Option<Open>) -> Result<Drawing, Faults> {
    let text = std::str::from_utf8(bytes).map_err(|_| Fault::new(format!("{name}: is not UTF-8 text")))?;
    let file = Arc::new(SourceFile::new(name, text));
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    // Drawing programs write a document type, which has no effect here.
    let options = if text.contains("<!DOCTYPE") { ParsingOptions { allow_dtd: true, ..options } } else { options };
    let document = Document::parse_with_options(text, options).map_err(|e| {
        let at = e.pos();
        let offset = text.split_inclusive('\n').take(at.row.saturating_sub(1) as usize).map(str::len).sum();
        let span = Span { line: at.row as usize, column: at.col as usize, offset, len: 0 };
        Fault::new(format!("this is not an SVG: {e}")).at(Arc::clone(&file), span)
    })?;
    let root = document.root_element();
    let place = |node: Node<'_, '_>| span_of(text, node.range().start);
    let fault = |node: Node<'_, '_>, text: String| Fault::new(text).at(Arc::clone(&file), place(node));
    if root.tag_name().name() != "svg" {
        return Err(fault(root, format!("this is not an SVG, but `{}`", shortened(root.tag_name().name()))).into());
    }
    let page = page(root, width_mm).map_err(|(text, hint)| fault(root, text).hint(hint))?;
    let mut sheet = StyleSheet::new();
    for style in root.descendants().filter(|n| n.has_tag_name("style") || n.tag_name().name() == "style") {
        sheet.parse_more(style.text().unwrap_or_default());
    }
    if sheet.rules.len() > MAX_RULES {
        return Err(fault(root, format!("too many style rules: {}", sheet.rules.len())).into());
    }
    let mut painter = Painter {
        document: &document,
        sheet,
        text,
        file: Arc::clone(&file),
        page: [page.view.w, page.view.h],
        shapes: Vec::new(),
        painted: 0,
        corners: 0,
        faults: Faults::new(),
    };
    painter.children(root, page.mm_from_user, &Style::default(), 0);
    let Painter { shapes, mut faults, .. } = painter;
    if faults.is_empty() && shapes.is_empty() {
        faults.push(fault(root, "nothing is painted in it".to_owned()));
    }
    let white = |s: &Painted| s.transmittance > 0.5;
    if faults.is_empty() && open.is_none() && shapes.iter().any(white) && !shapes.iter().all(white) {
        let fault = fault(root, "it has light and dark shapes: which of them are open?".to_owned());
        faults.push(
            fault.hint("write `open: white` (white passes, black stops) or `open: filled` (all pass) in the aperture"),
        );
    }
    let (width_mm, height_mm) = page.size_mm;
    let filled = |s: Painted| if open == Some(Open::White) { s } else { Painted { transmittance: 1.0, ..s } };
    let shapes: Vec<Painted> = shapes.into_iter().map(filled).collect();
    faults.into_result(())?;
    Ok(Drawing::new(width_mm, height_mm, &shapes))
}

fn span_of(text: &str, offset: usize) -> Span {
    let before = &text[..offset];
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    let line = before.matches('\n').count() + 1;
    let rest = &text[offset..];
    let len =
        rest.find(['>', '\n', '\r']).map_or(rest.len(), |end| if rest.as_bytes()[end] == b'>' { end + 1 } else { end });
    Span { line, column: before[start..].chars().count() + 1, offset, len }
}

/// Affine map from (x, y) to (a x + c y + e, b x + d y + f).
#[derive(Clone, Copy, Debug)]
struct Matrix {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
    f: f64,
}

impl Matrix {
    fn apply(self, [x, y]: Point) -> Point {
        [self.a * x + self.c * y + self.e, self.b * x + self.d * y + self.f]
    }

    /// Returns the map that applies `o` first and then this one.
    fn times(self, o: Self) -> Self {
        Self {
            a: self.a * o.a + self.c * o.b,
            b: self.b * o.a + self.d * o.b,
            c: self.a * o.c + self.c * o.d,
            d: self.b * o.c + self.d * o.d,
            e: self.a * o.e + self.c * o.f + self.e,
            f: self.b * o.e + self.d * o.f + self.f,
        }
    }

    /// Returns an upper bound of the largest stretch, at most sqrt(2) times too large.
    fn scale(self) -> f64 {
        (self.a * self.a + self.b * self.b + self.c * self.c + self.d * self.d).sqrt()
    }
}

struct Page {
    view: ViewBox,
    size_mm: (f64, f64),
    mm_from_user: Matrix,
}

/// Returns the page: its size, and the map from user units to mm from its center. The error is a message and a hint.
fn page(root: Node<'_, '_>, width_mm: Option<f64>) -> Result<Page, (String, &'static str)> {
    const HINT: &str = "write `width=\"24mm\"` in the drawing, or `width: 24` next to the file name in the aperture";
    let [width, height] = ["width", "height"].map(|name| root.attribute(name).and_then(length));
    let px = |l: Option<(f64, Option<f64>)>| l.map(|(v, mm)| mm.map_or(v, |mm| v * mm * 96.0 / 25.4));
    let view = match root.attribute("viewBox").map(ViewBox::from_str) {
        Some(Ok(view)) => view,
        Some(Err(_)) => return Err(("its viewBox is not four numbers".to_owned(), "write viewBox=\"0 0 24 24\"")),
        None => match (px(width), px(height)) {
            (Some(w), Some(h)) => ViewBox { x: 0.0, y: 0.0, w, h },
            _ => return Err(("how large is the drawing? It has no viewBox".to_owned(), "write viewBox=\"0 0 24 24\"")),
        },
    };
    let good = |v: f64| v.is_finite() && v > 0.0;
    if !(good(view.w) && good(view.h) && view.x.is_finite() && view.y.is_finite()) {
        return Err((
            format!("a page of {} by {} is not possible", view.w, view.h),
            "write a width and a height above 0",
        ));
    }
    let shape = match (px(width), px(height)) {
        (Some(w), Some(h)) if good(w) && good(h) => h / w,
        _ => view.h / view.w,
    };
    let stated = |l: Option<(f64, Option<f64>)>| l.and_then(|(v, mm)| mm.map(|mm| v * mm));
    let size_mm = match (width_mm, stated(width), stated(height)) {
        (Some(width_mm), ..) | (None, Some(width_mm), _) => (width_mm, width_mm * shape),
        (None, None, Some(height_mm)) => (height_mm / shape, height_mm),
        (None, None, None) => return Err(("how large is the drawing? It states no width in mm".to_owned(), HINT)),
    };
    if !(SIZES_MM.contains(&size_mm.0) && SIZES_MM.contains(&size_mm.1)) {
        return Err((format!("a page of {} by {} mm is too small or too large", size_mm.0, size_mm.1), HINT));
    }
    let ratio = root.attribute("preserveAspectRatio").and_then(|text| AspectRatio::from_str(text).ok());
    let (sx, sy) = (size_mm.0 / view.w, size_mm.1 / view.h);
    let (sx, sy) = match ratio {
        None | Some(AspectRatio { align: Align::XMidYMid, slice: false, .. }) => (sx.min(sy), sx.min(sy)),
        Some(AspectRatio { align: Align::None, .. }) => (sx, sy),
        Some(_) => {
            let text = "this preserveAspectRatio is not understood in an aperture".to_owned();
            return Err((text, "leave it out, or write `none`"));
        }
    };
    let (cx, cy) = (view.x + 0.5 * view.w, view.y + 0.5 * view.h);
    // y points down in a drawing and up in a lens.
    let mm_from_user = Matrix { a: sx, b: 0.0, c: 0.0, d: -sy, e: -sx * cx, f: sy * cy };
    Ok(Page { view, size_mm, mm_from_user })
}

struct Painter<'a, 'i> {
    document: &'a Document<'i>,
    sheet: StyleSheet<'a>,
    text: &'a str,
    file: Arc<SourceFile>,
    /// Width and height of the page in user units, which percentages refer to.
    page: [f64; 2],
    shapes: Vec<Painted>,
    painted: usize,
    corners: usize,
    faults: Faults,
}

impl<'a, 'i> Painter<'a, 'i> {
    fn fault(&mut self, node: Node<'_, '_>, text: String) {
        // The number of messages is limited, since a drawing may have thousands of faulty elements.
        if self.faults.len() < 20 {
            self.faults.push(Fault::new(text).at(Arc::clone(&self.file), span_of(self.text, node.range().start)));
        }
    }

    fn children(&mut self, parent: Node<'a, 'i>, matrix: Matrix, style: &Style, depth: usize) {
        for node in parent.children().filter(Node::is_element) {
            self.element(node, matrix, style, depth + 1);
        }
    }

    fn element(&mut self, node: Node<'a, 'i>, matrix: Matrix, inherited: &Style, depth: usize) {
        const SVG: &str = "http://www.w3.org/2000/svg";
        // Elements in other namespaces are private data of drawing programs.
        if node.tag_name().namespace().is_some_and(|space| space != SVG) {
            return;
        }
        let name = node.tag_name().name();
        match name {
            "title" | "desc" | "metadata" | "style" | "defs" | "symbol" | "clipPath" | "mask" | "linearGradient"
            | "radialGradient" | "pattern" | "marker" | "filter" | "script" => return,
            _ => {}
        }
        if depth > MAX_DEPTH || self.painted >= MAX_PAINTED {
            if self.faults.is_empty() {
                self.fault(node, format!("more than {MAX_DEPTH} nested elements, or {MAX_PAINTED} in all"));
            }
            return;
        }
        self.painted += 1;
        let style = match inherited.of(node, &self.sheet) {
            Ok(style) => style,
            Err(text) => return self.fault(node, text),
        };
        if style.hidden {
            return;
        }
        let matrix = match node.attribute("transform").map(transform) {
            None => matrix,
            Some(Ok(own)) => matrix.times(own),
            Some(Err(text)) => return self.fault(node, text),
        };
        match name {
            "g" | "a" => self.children(node, matrix, &style, depth),
            "use" => self.repeated(node, matrix, &style, depth),
            "path" | "rect" | "circle" | "ellipse" | "line" | "polyline" | "polygon" => {
                let scale = matrix.scale();
                if scale == 0.0 {
                    return; // The element is scaled to nothing.
                }
                if !scale.is_finite() {
                    return self.fault(node, "it extends too far".to_owned());
                }
                let tolerance = FLATNESS_MM / scale;
                match self.outline(node, name, tolerance) {
                    Ok(path) => self.paint(node, &path, matrix, &style),
                    Err(text) => self.fault(node, text),
                }
            }
            "text" => self.fault(node, "text is not understood in an aperture: convert it to paths".to_owned()),
            other => self.fault(node, format!("`{}` is not understood in an aperture", shortened(other))),
        }
    }

    /// Paints a `use` element: another element again, at another position.
    fn repeated(&mut self, node: Node<'a, 'i>, matrix: Matrix, style: &Style, depth: usize) {
        let href = node.attribute("href").or_else(|| node.attribute(("http://www.w3.org/1999/xlink", "href")));
        let id = href.and_then(|text| text.trim().strip_prefix('#'));
        let found = id.and_then(|id| self.document.descendants().find(|n| n.attribute("id") == Some(id)));
        let Some(target) = found else {
            return self.fault(
                node,
                format!("`use` refers to nothing in this file: `{}`", shortened(href.unwrap_or_default())),
            );
        };
        let moved = (self.coordinate(node, "x", 0), self.coordinate(node, "y", 1));
        let (Ok(x), Ok(y)) = moved else { return self.fault(node, "`use` has an invalid position".to_owned()) };
        let matrix = matrix.times(Matrix { a: 1.0, b: 0.0, c: 0.0, d: 1.0, e: x, f: y });
        if target.tag_name().name() == "symbol" {
            if target.attribute("viewBox").is_some() {
                return self.fault(target, "a symbol with a viewBox is not understood in an aperture".to_owned());
            }
            self.children(target, matrix, style, depth);
        } else {
            self.element(target, matrix, style, depth + 1);
        }
    }

    /// Returns a length of an element in user units; 0 if absent. Percentages refer to the page's width (`of` = 0), height (1) or
    /// diagonal (2).
    fn coordinate(&self, node: Node<'_, '_>, name: &str, of: usize) -> Result<f64, String> {
        let Some(text) = node.attribute(name) else { return Ok(0.0) };
        if let Some(number) = text.trim().strip_suffix('%') {
            let [w, h] = self.page;
            let whole = [w, h, ((w * w + h * h) / 2.0).sqrt()][of];
            let share = number.parse::<f64>().ok().filter(|v| v.is_finite());
            return share.map(|s| 0.01 * s * whole).ok_or_else(|| format!("not a length: `{}`", shortened(text)));
        }
        plain_length(text).map_err(|e| format!("{name}: {e}"))
    }

    fn outline(&self, node: Node<'_, '_>, name: &str, tolerance: f64) -> Result<Path, String> {
        let mut path = Path::new(tolerance);
        let at = |name: &str, of: usize| self.coordinate(node, name, of);
        let size = |name: &str, of: usize| {
            let value = at(name, of)?;
            if value >= 0.0 { Ok(value) } else { Err(format!("{name} is {value}")) }
        };
        match name {
            "path" => path_data(node.attribute("d").unwrap_or_default(), &mut path)?,
            "circle" => {
                let (center, r) = ([at("cx", 0)?, at("cy", 1)?], size("r", 2)?);
                if r > 0.0 {
                    path.ellipse(center, [r, r]);
                }
            }
            "ellipse" => {
                let (center, radii) = ([at("cx", 0)?, at("cy", 1)?], [size("rx", 0)?, size("ry", 1)?]);
                if radii[0] > 0.0 && radii[1] > 0.0 {
                    path.ellipse(center, radii);
                }
            }
            "rect" => {
                let (x, y, w, h) = (at("x", 0)?, at("y", 1)?, size("width", 0)?, size("height", 1)?);
                let given = |name: &str, of: usize| match node.attribute(name) {
                    None | Some("auto") => Ok(None),
                    Some(_) => size(name, of).map(Some),
                };
                let (rx, ry) = (given("rx", 0)?, given("ry", 1)?);
                let (rx, ry) = (rx.or(ry).unwrap_or(0.0).min(0.5 * w), ry.or(rx).unwrap_or(0.0).min(0.5 * h));
                if w > 0.0 && h > 0.0 {
                    rectangle(&mut path, [x, y], [w, h], [rx, ry]);
                }
            }
            "line" => {
                path.begin([at("x1", 0)?, at("y1", 1)?]);
                path.line([at("x2", 0)?, at("y2", 1)?]);
            }
            _ => {
                let text = node.attribute("points").unwrap_or_default();
                for (i, (x, y)) in PointsParser::from(text).enumerate() {
                    if i == 0 { path.begin([x, y]) } else { path.line([x, y]) }
                }
                if path.parts.is_empty() && !text.trim().is_empty() {
                    return Err(format!("not a list of points: `{}`", shortened(text)));
                }
                if name == "polygon" {
                    path.close();
                }
            }
        }
        Ok(path)
    }

    fn paint(&mut self, node: Node<'_, '_>, path: &Path, matrix: Matrix, style: &Style) {
        if !style.visible {
            return;
        }
        let mut areas = Vec::new();
        if let Some(color) = style.fill {
            let outlines: Vec<Vec<Point>> = path.parts.iter().map(|(points, _)| points.clone()).collect();
            areas.push((outlines, style.rule, color, style.fill_opacity));
        }
        let mut too_long = path.is_too_long();
        if let Some(color) = style.stroke.filter(|_| style.pen.width > 0.0) {
            match stroked(path, style.pen) {
                Some(outlines) => areas.push((outlines, FillRule::NonZero, color, style.stroke_opacity)),
                None => too_long = true,
            }
        }
        for (mut outlines, rule, color, opacity) in areas {
            let opacity = opacity * color.alpha * style.opacity;
            outlines.retain(|points| points.len() > 2);
            if opacity == 0.0 || outlines.is_empty() {
                continue;
            }
            self.corners += outlines.iter().map(Vec::len).sum::<usize>();
            if self.corners > MAX_CORNERS {
                too_long = true;
                break;
            }
            for point in outlines.iter_mut().flatten() {
                *point = matrix.apply(*point);
                if !(point[0].abs() < 1e9 && point[1].abs() < 1e9) {
                    return self.fault(node, "it extends too far".to_owned());
                }
            }
            self.shapes.push(Painted { outlines, rule, transmittance: color.luminance, opacity });
        }
        if too_long {
            self.fault(node, format!("more than {MAX_CORNERS} corners"));
        }
    }
}

fn rectangle(path: &mut Path, [x, y]: Point, [w, h]: Point, [rx, ry]: Point) {
    if rx == 0.0 || ry == 0.0 {
        path.begin([x, y]);
        for corner in [[x + w, y], [x + w, y + h], [x, y + h]] {
            path.line(corner);
        }
        return path.close();
    }
    path.begin([x + rx, y]);
    let arcs = [
        ([x + w - rx, y], [x + w, y + ry]),
        ([x + w, y + h - ry], [x + w - rx, y + h]),
        ([x + rx, y + h], [x, y + h - ry]),
        ([x, y + ry], [x + rx, y]),
    ];
    for (line, arc) in arcs {
        path.line(line);
        path.arc([rx, ry], 0.0, false, true, arc);
    }
    path.close();
}

/// Adds the segments of path data to a path (SVG 1.1, chapter 8.3).
fn path_data(text: &str, path: &mut Path) -> Result<(), String> {
    let (mut start, mut closed) = ([0.0; 2], false);
    // The last control point, if the last segment was a curve of that degree.
    let (mut cubic, mut quadratic): (Option<Point>, Option<Point>) = (None, None);
    for segment in PathParser::from(text) {
        let segment = segment.map_err(|e| format!("its path: {e}"))?;
        let here = if closed { start } else { path.end() };
        let to = |abs: bool, x: f64, y: f64| if abs { [x, y] } else { [here[0] + x, here[1] + y] };
        let mirrored = |point: Option<Point>| point.map_or(here, |[x, y]| [2.0 * here[0] - x, 2.0 * here[1] - y]);
        if closed && !matches!(segment, PathSegment::MoveTo { .. } | PathSegment::ClosePath { .. }) {
            path.begin(start);
        }
        let (mut next_cubic, mut next_quadratic) = (None, None);
        let was_closed = std::mem::replace(&mut closed, false);
        match segment {
            PathSegment::MoveTo { abs, x, y } => {
                start = to(abs, x, y);
                path.begin(start);
            }
            PathSegment::LineTo { abs, x, y } => path.line(to(abs, x, y)),
            PathSegment::HorizontalLineTo { abs, x } => path.line([if abs { x } else { here[0] + x }, here[1]]),
            PathSegment::VerticalLineTo { abs, y } => path.line([here[0], if abs { y } else { here[1] + y }]),
            PathSegment::CurveTo { abs, x1, y1, x2, y2, x, y } => {
                path.cubic(to(abs, x1, y1), to(abs, x2, y2), to(abs, x, y));
                next_cubic = Some(to(abs, x2, y2));
            }
            PathSegment::SmoothCurveTo { abs, x2, y2, x, y } => {
                path.cubic(mirrored(cubic), to(abs, x2, y2), to(abs, x, y));
                next_cubic = Some(to(abs, x2, y2));
            }
            PathSegment::Quadratic { abs, x1, y1, x, y } => {
                path.quadratic(to(abs, x1, y1), to(abs, x, y));
                next_quadratic = Some(to(abs, x1, y1));
            }
            PathSegment::SmoothQuadratic { abs, x, y } => {
                let control = mirrored(quadratic);
                path.quadratic(control, to(abs, x, y));
                next_quadratic = Some(control);
            }
            PathSegment::EllipticalArc { abs, rx, ry, x_axis_rotation, large_arc, sweep, x, y } => {
                path.arc([rx, ry], x_axis_rotation, large_arc, sweep, to(abs, x, y));
            }
            PathSegment::ClosePath { .. } => {
                if !was_closed {
                    path.close();
                }
                closed = true;
            }
        }
        (cubic, quadratic) = (next_cubic, next_quadratic);
    }
    Ok(())
}

fn transform(text: &str) -> Result<Matrix, String> {
    let mut matrix = Matrix { a: 1.0, b: 0.0, c: 0.0, d: 1.0, e: 0.0, f: 0.0 };
    let one = matrix;
    for token in TransformListParser::from(text) {
        let own = match token.map_err(|e| format!("its transform: {e}"))? {
            TransformListToken::Matrix { a, b, c, d, e, f } => Matrix { a, b, c, d, e, f },
            TransformListToken::Translate { tx, ty } => Matrix { e: tx, f: ty, ..one },
            TransformListToken::Scale { sx, sy } => Matrix { a: sx, d: sy, ..one },
            TransformListToken::Rotate { angle } => {
                let (sin, cos) = (math::sin(angle.to_radians()), math::cos(angle.to_radians()));
                Matrix { a: cos, b: sin, c: -sin, d: cos, ..one }
            }
            TransformListToken::SkewX { angle } => Matrix { c: math::tan(angle.to_radians()), ..one },
            TransformListToken::SkewY { angle } => Matrix { b: math::tan(angle.to_radians()), ..one },
        };
        matrix = matrix.times(own);
    }
    Ok(matrix)
}

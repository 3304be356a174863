//! Output of a drawing as SVG 1.1.

use crate::canvas::{Canvas, DrawnPartKind};
use crate::color::Color;
use crate::geometry::{Point, Rect};
use crate::paint::{Paint, Picture};
use crate::stroke::{Cap, Stroke};
use crate::write::png;
use std::fmt::Write;

impl Canvas {
    /// Returns the drawing as the text of a self-contained SVG file: text is drawn as strokes, and pictures are embedded.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let (width, height) = (number(self.width), number(self.height));
        let mut svg = Svg { body: String::new(), definitions: String::new(), names: 0, clips: Vec::new() };
        for part in &self.parts {
            let clip = part.clip.map(|rect| svg.clip(rect));
            let clip = clip.map_or(String::new(), |id| format!(" clip-path=\"url(#{id})\""));
            match &part.kind {
                DrawnPartKind::Fill { polygon, paint } => svg.fill(polygon, paint, &clip),
                DrawnPartKind::Line { points, closed, stroke } => {
                    svg.stroke(&path(std::slice::from_ref(points), *closed), stroke, &clip);
                }
                DrawnPartKind::Text { text, strokes, stroke, halo } => {
                    let way = path(strokes, false);
                    svg.line(&format!("<g role=\"img\" aria-label=\"{}\"{clip}>", escaped(text)));
                    halo.iter().chain([stroke]).for_each(|stroke| svg.stroke(&way, stroke, ""));
                    svg.line("</g>");
                }
            }
        }
        let title = escaped(&self.title);
        let definitions = match svg.definitions.as_str() {
            "" => String::new(),
            text => format!("<defs>\n{text}</defs>\n"),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n<title>{title}</title>\n{definitions}\
             <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n{}</svg>\n",
            self.background.hex(),
            svg.body
        )
    }
}

struct Svg {
    body: String,
    definitions: String,
    names: usize,
    clips: Vec<(Rect, String)>,
}

impl Svg {
    fn line(&mut self, text: &str) {
        self.body.push_str(text);
        self.body.push('\n');
    }

    fn name(&mut self) -> String {
        self.names += 1;
        format!("d{}", self.names)
    }

    /// Returns the identifier of the clip path for this rectangle.
    fn clip(&mut self, rect: Rect) -> String {
        if let Some((_, id)) = self.clips.iter().find(|(known, _)| *known == rect) {
            return id.clone();
        }
        let id = self.name();
        self.define_clip(&id, &rect.corners());
        self.clips.push((rect, id.clone()));
        id
    }

    fn define_clip(&mut self, id: &str, polygon: &[Point]) {
        let way = path(&[polygon.to_vec()], true);
        // Ignore the result: writing to a String cannot fail, here and below.
        let _ = writeln!(self.definitions, "<clipPath id=\"{id}\"><path d=\"{way}\"/></clipPath>");
    }

    fn fill(&mut self, polygon: &[Point], paint: &Paint, clip: &str) {
        let way = path(&[polygon.to_vec()], true);
        match paint {
            Paint::Solid(color) => {
                let opacity = opacity("fill-opacity", *color);
                self.line(&format!("<path d=\"{way}\" fill=\"{}\"{opacity}{clip}/>", color.hex()));
            }
            Paint::Gradient { from, to, stops } => {
                let id = self.name();
                let _ = writeln!(
                    self.definitions,
                    "<linearGradient id=\"{id}\" gradientUnits=\"userSpaceOnUse\" x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\">",
                    number(from[0]),
                    number(from[1]),
                    number(to[0]),
                    number(to[1])
                );
                for stop in stops {
                    let opacity = opacity("stop-opacity", stop.color);
                    let (at, color) = (format!("{:.5}", stop.at), stop.color.hex());
                    let _ = writeln!(self.definitions, "<stop offset=\"{at}\" stop-color=\"{color}\"{opacity}/>");
                }
                self.definitions.push_str("</linearGradient>\n");
                self.line(&format!("<path d=\"{way}\" fill=\"url(#{id})\"{clip}/>"));
            }
            Paint::Picture(picture) => self.picture(polygon, picture, clip),
        }
    }

    fn picture(&mut self, polygon: &[Point], picture: &Picture, clip: &str) {
        // Skip a picture with a wrong number of pixels, as rasterization does.
        let Ok(bytes) = png(picture.rgb.as_flattened(), picture.width_px, picture.height_px) else { return };
        let id = self.name();
        self.define_clip(&id, polygon);
        let place = picture.place;
        let (x, y) = (number(place.left), number(place.top));
        let (width, height) = (number(place.width()), number(place.height()));
        let data = base64(&bytes);
        self.line(&format!(
            "<g{clip}><g clip-path=\"url(#{id})\"><image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" \
             preserveAspectRatio=\"none\" xlink:href=\"data:image/png;base64,{data}\"/></g></g>"
        ));
    }

    fn stroke(&mut self, way: &str, stroke: &Stroke, clip: &str) {
        let cap = if stroke.cap == Cap::Round { " stroke-linecap=\"round\"" } else { "" };
        let opacity = opacity("stroke-opacity", stroke.color);
        let dashes = match stroke.dashes.as_slice() {
            [] => String::new(),
            lengths => {
                let lengths: Vec<String> = lengths.iter().map(|l| number(*l)).collect();
                format!(" stroke-dasharray=\"{}\"", lengths.join(" "))
            }
        };
        let light = if stroke.is_light { " style=\"mix-blend-mode:screen\"" } else { "" };
        let (color, width) = (stroke.color.hex(), number(stroke.width));
        self.line(&format!(
            "<path d=\"{way}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" \
             stroke-linejoin=\"round\"{cap}{opacity}{dashes}{light}{clip}/>"
        ));
    }
}

fn opacity(attribute: &str, color: Color) -> String {
    if color.opacity < 1.0 { format!(" {attribute}=\"{}\"", number(color.opacity)) } else { String::new() }
}

/// Formats a number with two decimals; smaller differences are not visible on any screen.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

fn path(lines: &[Vec<Point>], closed: bool) -> String {
    let mut out = String::new();
    for line in lines {
        let points = line.iter().filter(|p| p.iter().all(|c| c.is_finite()));
        for (i, [x, y]) in points.enumerate() {
            let _ = write!(out, "{}{} {}", if i == 0 { 'M' } else { 'L' }, number(*x), number(*y));
        }
        if closed && !line.is_empty() {
            out.push('Z');
        }
    }
    out
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Replace control characters, which XML cannot represent.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Encodes bytes as base 64 (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |i: usize| u32::from(three.get(i).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for i in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * i) & 63) as usize] as char;
            out.push(if i <= three.len() { letter } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors of RFC 4648, section 10.
    #[test]
    fn base64_of_the_standard() {
        for (text, want) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(text.as_bytes()), want);
        }
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([number(1.0), number(-0.001), number(2.505), number(10.0)], ["1", "0", "2.5", "10"]);
    }
}

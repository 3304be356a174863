//! A drawing: its parts in order.

use crate::color::Color;
use crate::geometry::{Point, Rect, circle};
use crate::paint::Paint;
use crate::raster::{Pixels, Raster};
use crate::stroke::{Cap, Stroke};
use crate::text::{TextStyle, plain};

/// Oversampling per side of a pixel in drawings that add up light.
const FINER: u32 = 3;

/// A drawing whose later parts cover earlier ones.
#[derive(Clone, Debug)]
pub struct Canvas {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) title: String,
    pub(crate) background: Color,
    pub(crate) parts: Vec<DrawnPart>,
    clip: Option<Rect>,
}

/// A part of a drawing.
#[derive(Clone, Debug)]
pub(crate) struct DrawnPart {
    pub kind: DrawnPartKind,
    /// Clip rectangle; `None` shows the whole part.
    pub clip: Option<Rect>,
}

#[derive(Clone, Debug)]
pub(crate) enum DrawnPartKind {
    Fill { polygon: Vec<Point>, paint: Paint },
    Line { points: Vec<Point>, closed: bool, stroke: Stroke },
    Text { text: String, strokes: Vec<Vec<Point>>, stroke: Stroke, halo: Option<Stroke> },
}

impl Canvas {
    /// Creates a white canvas of `width` x `height` (CSS pixels, clamped to 1-16384) with a title for screen readers.
    #[must_use]
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        let [width, height] = [width, height].map(|l| if l.is_nan() { 1.0 } else { l.clamp(1.0, 16384.0) });
        Self { width, height, title: title.to_owned(), background: Color::WHITE, parts: Vec::new(), clip: None }
    }

    /// Returns the canvas with another background color.
    #[must_use]
    pub fn on(mut self, background: Color) -> Self {
        self.background = background;
        self
    }

    /// Width and height of the canvas, CSS pixels.
    #[must_use]
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// Clips everything drawn from now on to `clip`; `None` ends clipping.
    pub fn clip(&mut self, clip: Option<Rect>) {
        self.clip = clip;
    }

    fn add(&mut self, kind: DrawnPartKind) {
        self.parts.push(DrawnPart { kind, clip: self.clip });
    }

    /// Draws a straight line between two points.
    pub fn line(&mut self, from: Point, to: Point, stroke: &Stroke) {
        self.polyline(&[from, to], stroke);
    }

    /// Draws a line through several points.
    pub fn polyline(&mut self, points: &[Point], stroke: &Stroke) {
        self.add(DrawnPartKind::Line { points: points.to_vec(), closed: false, stroke: stroke.clone() });
    }

    /// Draws a line around a polygon.
    pub fn outline(&mut self, points: &[Point], stroke: &Stroke) {
        self.add(DrawnPartKind::Line { points: points.to_vec(), closed: true, stroke: stroke.clone() });
    }

    /// Draws a filled polygon. Where it overlaps itself, it is filled.
    pub fn polygon(&mut self, points: &[Point], paint: impl Into<Paint>) {
        self.add(DrawnPartKind::Fill { polygon: points.to_vec(), paint: paint.into() });
    }

    /// Draws a filled rectangle.
    pub fn rectangle(&mut self, rect: Rect, paint: impl Into<Paint>) {
        self.polygon(&rect.corners(), paint);
    }

    /// Draws a filled disc.
    pub fn disc(&mut self, center: Point, radius: f64, paint: impl Into<Paint>) {
        self.polygon(&circle(center, radius), paint);
    }

    /// Draws a circle as a line.
    pub fn circle(&mut self, center: Point, radius: f64, stroke: &Stroke) {
        self.outline(&circle(center, radius), stroke);
    }

    /// Draws a line of text with its baseline at a point. `_{...}` is a subscript and `^{...}` a superscript, as in `n_{d}` and `10^{-3}`.
    pub fn text(&mut self, at: Point, text: &str, style: &TextStyle) {
        let stroke = |color, width| Stroke::new(color, width).round();
        self.add(DrawnPartKind::Text {
            text: plain(text),
            strokes: style.strokes(at, text),
            stroke: stroke(style.color, style.pen()),
            halo: style.halo.map(|color| stroke(color, style.pen() + 0.28 * style.size)),
        });
    }

    /// Returns the drawing with every color (sRGB code values) changed, for example as a color-blind eye sees it. Opacities stay.
    #[must_use]
    pub fn with_colors(mut self, change: impl Fn([u8; 3]) -> [u8; 3]) -> Self {
        let color = |color: &mut Color| color.rgb = change(color.rgb);
        color(&mut self.background);
        for part in &mut self.parts {
            match &mut part.kind {
                DrawnPartKind::Fill { paint: Paint::Solid(solid), .. } => color(solid),
                DrawnPartKind::Fill { paint: Paint::Gradient { stops, .. }, .. } => {
                    stops.iter_mut().for_each(|stop| color(&mut stop.color));
                }
                DrawnPartKind::Fill { paint: Paint::Picture(picture), .. } => {
                    picture.rgb.iter_mut().for_each(|rgb| *rgb = change(*rgb));
                }
                DrawnPartKind::Line { stroke, .. } => color(&mut stroke.color),
                DrawnPartKind::Text { stroke, halo, .. } => {
                    color(&mut stroke.color);
                    halo.iter_mut().for_each(|halo| color(&mut halo.color));
                }
            }
        }
        self
    }

    /// Renders the drawing to pixels, `scale` of them per canvas unit.
    #[must_use]
    pub fn to_pixels(&self, scale: f64) -> Pixels {
        // Overlapping light soon clips to white, even where it covers only part of a pixel, so that edges turn into stairs. Render it to
        // finer pixels and average them after all light is added.
        let shines = |part: &DrawnPart| matches!(&part.kind, DrawnPartKind::Line { stroke, .. } if stroke.is_light);
        if self.parts.iter().any(shines) {
            return self.on_pixels(scale * f64::from(FINER)).shrunk(FINER);
        }
        self.on_pixels(scale)
    }

    fn on_pixels(&self, scale: f64) -> Pixels {
        let mut raster = Raster::new(self.width, self.height, scale, self.background);
        for part in &self.parts {
            match &part.kind {
                DrawnPartKind::Fill { polygon, paint } => raster.fill(std::slice::from_ref(polygon), paint, part.clip),
                DrawnPartKind::Line { points, closed, stroke } => {
                    let area = stroke.outline(points, *closed);
                    if stroke.is_light {
                        raster.shine(&area, &stroke.color.into(), part.clip);
                    } else {
                        raster.fill(&area, &stroke.color.into(), part.clip);
                    }
                }
                DrawnPartKind::Text { strokes, stroke, halo, .. } => {
                    for stroke in halo.iter().chain([stroke]) {
                        debug_assert_eq!(stroke.cap, Cap::Round);
                        let areas: Vec<_> = strokes.iter().flat_map(|s| stroke.outline(s, false)).collect();
                        raster.fill(&areas, &stroke.color.into(), part.clip);
                    }
                }
            }
        }
        raster.finish()
    }
}

//! What is drawn, in order.

use crate::color::Color;
use crate::geometry::{Point, Rect, circle};
use crate::paint::Paint;
use crate::raster::{Pixels, Raster};
use crate::stroke::{Cap, Stroke};
use crate::text::{TextStyle, plain};

/// Pixels a side of one of the picture, where light is added up.
const FINER: u32 = 3;

/// A drawing. Later parts cover earlier ones.
#[derive(Clone, Debug)]
pub struct Canvas {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) title: String,
    pub(crate) background: Color,
    pub(crate) parts: Vec<Part>,
    clip: Option<Rect>,
}

/// A part of a drawing.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    pub kind: PartKind,
    /// Where it shows; everywhere if `None`.
    pub clip: Option<Rect>,
}

#[derive(Clone, Debug)]
pub(crate) enum PartKind {
    Fill { polygon: Vec<Point>, paint: Paint },
    Line { points: Vec<Point>, closed: bool, stroke: Stroke },
    Text { text: String, strokes: Vec<Vec<Point>>, stroke: Stroke, halo: Option<Stroke> },
}

impl Canvas {
    /// A white sheet of `width` x `height` (units of a CSS pixel, clamped to 1-16384) with a title for those who cannot
    /// see it.
    #[must_use]
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        let [width, height] = [width, height].map(|l| if l.is_nan() { 1.0 } else { l.clamp(1.0, 16384.0) });
        Self { width, height, title: title.to_owned(), background: Color::WHITE, parts: Vec::new(), clip: None }
    }

    /// The same with another ground.
    #[must_use]
    pub fn on(mut self, background: Color) -> Self {
        self.background = background;
        self
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// What is drawn from here on shows within `clip` only; `None` lifts that.
    pub fn clip(&mut self, clip: Option<Rect>) {
        self.clip = clip;
    }

    fn add(&mut self, kind: PartKind) {
        self.parts.push(Part { kind, clip: self.clip });
    }

    /// A line from one place to another.
    pub fn line(&mut self, from: Point, to: Point, stroke: &Stroke) {
        self.polyline(&[from, to], stroke);
    }

    /// A line through places.
    pub fn polyline(&mut self, points: &[Point], stroke: &Stroke) {
        self.add(PartKind::Line { points: points.to_vec(), closed: false, stroke: stroke.clone() });
    }

    /// A line around a polygon.
    pub fn outline(&mut self, points: &[Point], stroke: &Stroke) {
        self.add(PartKind::Line { points: points.to_vec(), closed: true, stroke: stroke.clone() });
    }

    /// A filled polygon; where it overlaps itself, it is filled.
    pub fn polygon(&mut self, points: &[Point], paint: impl Into<Paint>) {
        self.add(PartKind::Fill { polygon: points.to_vec(), paint: paint.into() });
    }

    /// A filled rectangle.
    pub fn rectangle(&mut self, rect: Rect, paint: impl Into<Paint>) {
        self.polygon(&rect.corners(), paint);
    }

    /// A filled disc.
    pub fn disc(&mut self, center: Point, radius: f64, paint: impl Into<Paint>) {
        self.polygon(&circle(center, radius), paint);
    }

    /// A circle.
    pub fn circle(&mut self, center: Point, radius: f64, stroke: &Stroke) {
        self.outline(&circle(center, radius), stroke);
    }

    /// A line of text on its base line; `_{...}` is lowered, `^{...}` raised, as in `n_{d}` and `10^{-3}`.
    pub fn text(&mut self, at: Point, text: &str, style: &TextStyle) {
        let stroke = |color, width| Stroke::new(color, width).round();
        self.add(PartKind::Text {
            text: plain(text),
            strokes: style.strokes(at, text),
            stroke: stroke(style.color, style.pen()),
            halo: style.halo.map(|color| stroke(color, style.pen() + 0.28 * style.size)),
        });
    }

    /// The drawing with every color (sRGB code values) changed: as another eye has it. Opacities stay.
    #[must_use]
    pub fn with_colors(mut self, change: impl Fn([u8; 3]) -> [u8; 3]) -> Self {
        let color = |color: &mut Color| color.rgb = change(color.rgb);
        color(&mut self.background);
        for part in &mut self.parts {
            match &mut part.kind {
                PartKind::Fill { paint: Paint::Solid(solid), .. } => color(solid),
                PartKind::Fill { paint: Paint::Gradient { stops, .. }, .. } => {
                    stops.iter_mut().for_each(|stop| color(&mut stop.color));
                }
                PartKind::Fill { paint: Paint::Picture(picture), .. } => {
                    picture.rgb.iter_mut().for_each(|rgb| *rgb = change(*rgb));
                }
                PartKind::Line { stroke, .. } => color(&mut stroke.color),
                PartKind::Text { stroke, halo, .. } => {
                    color(&mut stroke.color);
                    halo.iter_mut().for_each(|halo| color(&mut halo.color));
                }
            }
        }
        self
    }

    /// The drawing on pixels, `scale` of them a unit.
    #[must_use]
    pub fn to_pixels(&self, scale: f64) -> Pixels {
        // Light on light soon is white also where it covers a part of a pixel only, and edges turn into stairs: it is drawn
        // on finer pixels, whose means are taken once all is added up.
        let shines = |part: &Part| matches!(&part.kind, PartKind::Line { stroke, .. } if stroke.is_light);
        if self.parts.iter().any(shines) {
            return self.on_pixels(scale * f64::from(FINER)).shrunk(FINER);
        }
        self.on_pixels(scale)
    }

    fn on_pixels(&self, scale: f64) -> Pixels {
        let mut raster = Raster::new(self.width, self.height, scale, self.background);
        for part in &self.parts {
            match &part.kind {
                PartKind::Fill { polygon, paint } => raster.fill(std::slice::from_ref(polygon), paint, part.clip),
                PartKind::Line { points, closed, stroke } => {
                    let area = stroke.outline(points, *closed);
                    if stroke.is_light {
                        raster.shine(&area, &stroke.color.into(), part.clip);
                    } else {
                        raster.fill(&area, &stroke.color.into(), part.clip);
                    }
                }
                PartKind::Text { strokes, stroke, halo, .. } => {
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

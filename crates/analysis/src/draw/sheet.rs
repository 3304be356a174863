//! The sheet on which a lens is drawn.

use super::{DrawnRay, Outlines, SectionView, Solid, outlines, reach_mm};
use glam::DVec3;
use spectra_color::spectral_color_srgb8;
use spectra_core::math::{log10, pow};
use spectra_lens::Lens;
use spectra_plot::{Anchor, Canvas, Color, Point, Rect, Stroke, TextStyle};

/// The background of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingBackground {
    /// White paper: tinted glass, a scale, a caption.
    Light,
    /// Black: white glass, and rays that add their light where they cross.
    Dark,
}

/// Layout of a drawing: its size, background and contents besides the lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Width, in CSS pixels.
    pub width: f64,
    /// Height, in CSS pixels; `None` fits it to the lens.
    pub height: Option<f64>,
    /// Width of the shown region, mm; `None` fits it to the lens.
    pub width_mm: Option<f64>,
    /// Background.
    pub ground: DrawingBackground,
    /// Section plane.
    pub view: SectionView,
    /// A line of text below the lens; empty for none.
    pub caption: String,
    /// Whether the space behind the lens up to the image plane is shown.
    pub image: bool,
}

/// Maps mm in the section to points on the canvas.
struct Scale {
    factor: f64,
    origin: Point,
}

impl Scale {
    fn at(&self, [z, v]: [f64; 2]) -> Point {
        [self.origin[0] + self.factor * z, self.origin[1] - self.factor * v]
    }
}

const MARGIN: f64 = 24.0;
const CAPTION: f64 = 34.0;
/// Least height of a drawing, and its largest height in units of its width.
const LEAST_HEIGHT: f64 = 160.0;
const MOST_HEIGHT: f64 = 1.6;

impl Sheet {
    /// Draws a lens with rays and returns the figure.
    #[must_use]
    pub fn draw(&self, lens: &Lens, rays: &[DrawnRay]) -> Canvas {
        let parts = outlines(lens, &self.view, &reach_mm(lens, rays));
        let image_mm = self.image_mm(lens, rays);
        let (low, high) = self.extent_mm(lens, &parts, rays, image_mm);
        let footer = if self.caption.is_empty() { 0.0 } else { CAPTION };
        let wide = (self.width - 2.0 * MARGIN) / (high[0] - low[0]).max(1e-6);
        let height = self.height.unwrap_or_else(|| {
            ((high[1] - low[1]) * wide + 2.0 * MARGIN + footer).clamp(LEAST_HEIGHT, MOST_HEIGHT * self.width)
        });
        let tall = (height - 2.0 * MARGIN - footer) / (high[1] - low[1]).max(1e-6);
        let factor = self.width_mm.map_or(wide.min(tall), |mm| self.width / mm);
        let origin = [
            0.5 * self.width - factor * 0.5 * (low[0] + high[0]),
            0.5 * (height - footer) + factor * 0.5 * (low[1] + high[1]),
        ];
        let scale = Scale { factor, origin };
        let mut canvas = Canvas::new(self.width, height, &lens.name);
        if self.ground == DrawingBackground::Dark {
            canvas = canvas.on(Color::BLACK);
        }
        self.axis(&mut canvas, &scale, [low[0], high[0]], lens);
        for solid in &parts.solids {
            canvas.polygon(&self.places(&scale, &solid.outline), self.glass(solid));
        }
        let edge = Rect::new(0.0, 0.0, self.width, height - footer);
        canvas.clip(Some(edge));
        for ray in rays {
            self.ray(&mut canvas, &scale, lens, ray, edge);
        }
        canvas.clip(None);
        self.edges(&mut canvas, &scale, &parts);
        if self.image {
            self.image_plane(&mut canvas, &scale, lens, image_mm);
        }
        if footer > 0.0 {
            self.footer(&mut canvas, &scale, height);
        }
        canvas
    }

    fn ink(&self) -> Color {
        if self.ground == DrawingBackground::Dark { Color::WHITE } else { Color::INK }
    }

    fn places(&self, scale: &Scale, points: &[DVec3]) -> Vec<Point> {
        points.iter().map(|p| scale.at(self.view.place(*p))).collect()
    }

    /// Lower and upper end of the image plane, mm: the range that the rays reach, with a margin.
    fn image_mm(&self, lens: &Lens, rays: &[DrawnRay]) -> [f64; 2] {
        let seen = rays.iter().filter_map(|ray| {
            let p = at_image(lens, ray)?;
            Some(self.view.vertical(lens.image_pose.local_point(p))).filter(|h| h.is_finite())
        });
        let [low, high] = seen.fold([0.0_f64; 2], |[low, high], h| [low.min(h), high.max(h)]);
        let more = 0.12 * (high - low);
        [low - more, high + more]
    }

    /// Lower left and upper right corner of everything shown, mm.
    fn extent_mm(&self, lens: &Lens, parts: &Outlines, rays: &[DrawnRay], image_mm: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let solids = parts.solids.iter().flat_map(|s| &s.outline);
        let sheets = parts.sheets.iter().chain(parts.mirrors.iter().map(|m| &m.0)).flatten();
        let mut points: Vec<DVec3> = solids.chain(sheets).chain(parts.stops.iter().flatten()).copied().collect();
        points.extend(lens.elements.iter().map(|e| e.pose.origin_mm));
        if self.image {
            for h in image_mm {
                points.push(lens.image_pose.point(self.view.across(h, 0.0)));
            }
        }
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for place in points.iter().map(|p| self.view.place(*p)).filter(|p| p.iter().all(|v| v.is_finite())) {
            for k in 0..2 {
                low[k] = low[k].min(place[k]);
                high[k] = high[k].max(place[k]);
            }
        }
        if !(low[0] <= high[0] && low[1] <= high[1]) {
            return ([-1.0; 2], [1.0; 2]);
        }
        // Leave room in front for the incoming rays.
        let size = (high[0] - low[0]).max(high[1] - low[1]).max(1e-3);
        low[0] -= if rays.is_empty() { 0.04 } else { 0.22 } * size.min(high[1] - low[1] + 0.2 * size);
        high[0] += 0.02 * size;
        for k in 0..2 {
            if high[k] - low[k] < 0.05 * size {
                (low[k], high[k]) = (low[k] - 0.1 * size, high[k] + 0.1 * size);
            }
        }
        (low, high)
    }

    fn axis(&self, canvas: &mut Canvas, scale: &Scale, [left, right]: [f64; 2], lens: &Lens) {
        let folded = lens.elements.iter().any(|e| e.pose.rotation != glam::DMat3::IDENTITY && !e.reversed);
        if self.ground == DrawingBackground::Dark || folded {
            return;
        }
        let stroke = Stroke::new(Color::GREY.with_opacity(0.7), 0.6).dashed(&[14.0, 3.0, 2.0, 3.0]);
        canvas.line(scale.at([left, 0.0]), scale.at([right, 0.0]), &stroke);
    }

    /// Tint of a glass: blue for crowns, amber for flints, deeper for a higher index.
    fn glass(&self, solid: &Solid) -> Color {
        if self.ground == DrawingBackground::Dark {
            return Color::WHITE.with_opacity(0.16);
        }
        let flint = ((60.0 - solid.vd) / 35.0).clamp(0.0, 1.0);
        let dense = ((solid.nd - 1.45) / 0.45).clamp(0.0, 1.0);
        let pale = Color::new(0xdd, 0xec, 0xf8).toward(Color::new(0xf7, 0xec, 0xd6), flint);
        let deep = Color::new(0x9c, 0xc4, 0xe6).toward(Color::new(0xe2, 0xc2, 0x8a), flint);
        pale.toward(deep, dense)
    }

    fn edges(&self, canvas: &mut Canvas, scale: &Scale, parts: &Outlines) {
        let stroke = Stroke::new(self.ink(), if self.ground == DrawingBackground::Dark { 1.6 } else { 1.0 }).round();
        for solid in &parts.solids {
            canvas.outline(&self.places(scale, &solid.outline), &stroke);
        }
        for sheet in &parts.sheets {
            canvas.polyline(&self.places(scale, sheet), &stroke);
        }
        for (mirror, behind) in &parts.mirrors {
            self.mirror(canvas, scale, mirror, *behind);
        }
        for blade in &parts.stops {
            canvas.polyline(&self.places(scale, blade), &Stroke::new(self.ink(), 3.2));
        }
    }

    /// Draws a mirror: a line with hatching behind it.
    fn mirror(&self, canvas: &mut Canvas, scale: &Scale, points: &[DVec3], behind: DVec3) {
        const HATCHES: usize = 28;
        let places = self.places(scale, points);
        canvas.polyline(&places, &Stroke::new(self.ink(), 1.8).round());
        let Some(middle) = points.get(points.len() / 2) else { return };
        let (a, b) = (scale.at(self.view.place(*middle)), scale.at(self.view.place(behind)));
        let length = ((b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2)).sqrt().max(1e-9);
        let out = [(b[0] - a[0]) / length * 6.0, (b[1] - a[1]) / length * 6.0];
        let thin = Stroke::new(self.ink().with_opacity(0.7), 0.7);
        let step = places.len().saturating_sub(1).max(1) as f64 / HATCHES as f64;
        for k in 0..=HATCHES {
            let Some(p) = places.get((k as f64 * step) as usize) else { continue };
            // Slanted hatching, as in technical drawings.
            canvas.line(*p, [p[0] + out[0] + 0.5 * out[1], p[1] + out[1] - 0.5 * out[0]], &thin);
        }
    }

    fn image_plane(&self, canvas: &mut Canvas, scale: &Scale, lens: &Lens, ends_mm: [f64; 2]) {
        let ends = ends_mm.map(|h| lens.image_pose.point(self.view.across(h, 0.0)));
        canvas.polyline(&self.places(scale, &ends), &Stroke::new(self.ink(), 1.6));
    }

    fn ray(&self, canvas: &mut Canvas, scale: &Scale, lens: &Lens, ray: &DrawnRay, edge: Rect) {
        let mut points = self.places(scale, &ray.path.points);
        let Some(first) = points.first().copied() else { return };
        // Begin at the edge of the picture, not where the trace began.
        if points.len() > 1 {
            let to = points[1];
            if let Some(start) = leaves(to, [first[0] - to[0], first[1] - to[1]], edge) {
                points[0] = if edge.holds(&Rect::new(first[0], first[1], first[0], first[1])) { first } else { start };
            }
        }
        if ray.goes_on()
            && let Some(last) = points.last().copied()
        {
            let image = if self.image { at_image(lens, ray) } else { None };
            match image.map(|p| scale.at(self.view.place(p))) {
                Some(place) => points.push(place),
                None => {
                    let [z, v] = self.view.place(ray.path.direction);
                    points.extend(leaves(last, [z, -v], edge));
                }
            }
        }
        let color = Color::from(spectral_color_srgb8(ray.wavelength_nm));
        let stroke = match self.ground {
            DrawingBackground::Light => Stroke::new(color.toward(Color::BLACK, 0.12), 0.75),
            DrawingBackground::Dark => Stroke::new(color.with_opacity(ray.strength), 1.0).as_light(),
        };
        canvas.polyline(&points, &stroke);
    }

    /// Draws the caption and a scale bar of a round length.
    fn footer(&self, canvas: &mut Canvas, scale: &Scale, height: f64) {
        let style = TextStyle { color: self.ink(), ..TextStyle::new(12.0) };
        canvas.text([MARGIN, height - 14.0], &self.caption, &style);
        let most = 0.22 * (self.width - 2.0 * MARGIN) / scale.factor;
        let power = pow(10.0, log10(most).floor());
        let length = [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|l| *l <= most).unwrap_or(power);
        let (right, y) = (self.width - MARGIN, height - 16.0);
        let left = right - length * scale.factor;
        let stroke = Stroke::new(self.ink(), 1.0);
        canvas.line([left, y], [right, y], &stroke);
        for x in [left, right] {
            canvas.line([x, y - 3.0], [x, y + 3.0], &stroke);
        }
        let text = TextStyle { color: self.ink(), anchor: Anchor::Middle, ..TextStyle::new(11.0) };
        canvas.text([0.5 * (left + right), y - 6.0], &format!("{length} mm"), &text);
    }
}

/// Returns the point where a ray that left the lens meets the image plane, mm.
fn at_image(lens: &Lens, ray: &DrawnRay) -> Option<DVec3> {
    let last = ray.path.points.last().filter(|_| ray.path.end.is_none())?;
    let (p, d) = (lens.image_pose.local_point(*last), lens.image_pose.local_direction(ray.path.direction));
    let t = -p.z / d.z;
    (t.is_finite() && t >= 0.0).then(|| *last + t * ray.path.direction)
}

/// Returns the point where a line from `from` in the direction `way` leaves the sheet.
fn leaves(from: Point, way: [f64; 2], edge: Rect) -> Option<Point> {
    let mut nearest = f64::INFINITY;
    for (at, step, low, high) in [(from[0], way[0], edge.left, edge.right), (from[1], way[1], edge.top, edge.bottom)] {
        if step != 0.0 {
            nearest = nearest.min(((if step > 0.0 { high } else { low }) - at) / step);
        }
    }
    (nearest.is_finite() && nearest >= 0.0).then(|| [from[0] + nearest * way[0], from[1] + nearest * way[1]])
}

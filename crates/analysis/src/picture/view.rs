//! View of one quantity of a picture with a color scale.

use super::measured::{Measured, NotMeasured};
use super::quantity_map::QuantityMap;
use super::summary::is_outside;
use spectra_color::{Gamut, RgbSpace, into_gamut, to_u8, xyz_of_oklab};
use spectra_plot::{Axes, Axis, Canvas, Color, Paint, Picture, Rect, Stop, Stroke, TextStyle, nice_ticks, text_width};

/// Longest side of the picture on the sheet, canvas units.
const SIDE: f64 = 760.0;
/// Largest number of pixels along a side; a larger picture is reduced by averaging.
const MOST_PX: usize = 1520;
/// Left and upper edge of the picture on the sheet.
const LEFT: f64 = 78.0;
const TOP: f64 = 44.0;
/// Gap between picture and scale bar, width of the bar, and width of its labels.
const GAP: f64 = 22.0;
const BAR: f64 = 18.0;
const LABELS: f64 = 92.0;
/// Smallest value of a logarithmic scale, relative to the largest, unless a range is given.
const DEEPEST: f64 = 1e-6;

/// Range and kind of the scale of a view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scale {
    /// Whether the scale is logarithmic.
    pub is_log: bool,
    /// Lower and upper end; if `None`, the range of the values (a linear scale starts at 0 or below).
    pub range: Option<[f64; 2]>,
}

/// The resolved ends of a scale.
struct Ends {
    low: f64,
    high: f64,
    is_log: bool,
}

impl Ends {
    fn of(field: &QuantityMap, scale: Scale) -> Result<Self, NotMeasured> {
        let Some([least, most]) = field.range() else {
            return Err(NotMeasured::new(
                format!("{} is undefined in the whole picture", field.name),
                "choose another `--quantity`",
            ));
        };
        if field.is_hue {
            return Ok(Self { low: 0.0, high: 360.0, is_log: false });
        }
        let is_log = scale.is_log;
        let [low, high] = match scale.range {
            Some(range) => range,
            None if is_log => {
                let positive = field.values.iter().filter(|v| **v > 0.0 && v.is_finite()).copied();
                [positive.fold(f64::INFINITY, f64::min).max(DEEPEST * most), most]
            }
            None => [least.min(0.0), most],
        };
        if is_log && !(low > 0.0 && high > 0.0) {
            let text = format!("{} is nowhere above 0, so a logarithmic scale shows nothing", field.name);
            return Err(NotMeasured::new(text, "leave `--log` out, or give a `--range` above 0"));
        }
        // Widen an empty range: a quantity that is the same everywhere needs a scale too.
        let high = match high {
            h if h > low => h,
            h if is_log => h * 1.01,
            0.0 => 1.0,
            h => h + 0.01 * h.abs(),
        };
        Ok(Self { low, high, is_log })
    }

    fn share(&self, value: f64) -> f64 {
        let at = |v: f64| if self.is_log { libm::log10(v) } else { v };
        let share = (at(value) - at(self.low)) / (at(self.high) - at(self.low));
        // Values of 0 and below are at the low end of a logarithmic scale.
        if self.is_log && value <= 0.0 { 0.0 } else { share.clamp(0.0, 1.0) }
    }

    /// Returns the ticks and their labels.
    fn marks(&self, is_hue: bool) -> Vec<(f64, String)> {
        if is_hue {
            return (0..=6).map(|i| (60.0 * f64::from(i), (60 * i).to_string())).collect();
        }
        if !self.is_log {
            let ticks = nice_ticks(self.low, self.high, 8);
            return ticks.values.iter().map(|v| (*v, label(*v, ticks.label(*v)))).collect();
        }
        let decades = libm::log10(self.high / self.low);
        let steps: &[f64] = if decades > 4.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let first = libm::floor(libm::log10(self.low)) as i32;
        let last = libm::ceil(libm::log10(self.high)) as i32;
        let all = (first..=last).flat_map(|power| steps.iter().map(move |step| (*step, power)));
        let marks = all.map(|(step, power)| (step * libm::pow(10.0, f64::from(power)), step, power));
        let inside = marks.filter(|(v, ..)| (self.low * (1.0 - 1e-9)..=self.high * (1.0 + 1e-9)).contains(v));
        let inside: Vec<(f64, String)> = inside.map(|(v, step, power)| (v, power_label(step, power))).collect();
        if inside.len() > 1 {
            return inside;
        }
        [self.low, self.high].into_iter().map(|v| (v, super::quantity_map::short(v))).collect()
    }
}

/// Label of a tick of a linear scale; a long number becomes a multiple of a power of ten.
fn label(value: f64, plain: String) -> String {
    if value != 0.0 && (value.abs() >= 1e6 || value.abs() < 1e-4) {
        let power = libm::floor(libm::log10(value.abs())) as i32;
        let rest = (value / libm::pow(10.0, f64::from(power)) * 1e4).round_ties_even() / 1e4;
        return format!("{rest} \u{d7} 10^{{{}}}", signed(power));
    }
    plain
}

fn power_label(step: f64, power: i32) -> String {
    match power {
        -3..=4 => super::quantity_map::short(step * libm::pow(10.0, f64::from(power))),
        _ if step == 1.0 => format!("10^{{{}}}", signed(power)),
        _ => format!("{step} \u{d7} 10^{{{}}}", signed(power)),
    }
}

fn signed(power: i32) -> String {
    power.to_string().replace('-', "\u{2212}")
}

/// Returns the color of a share (0 to 1) of a scale: Oklab lightness rises evenly from dark blue through green to light yellow.
fn shade(share: f64) -> [u8; 3] {
    let hue = (285.0 - 180.0 * share).to_radians();
    let chroma = 0.09 + 0.06 * share;
    oklab(0.22 + 0.72 * share, chroma, hue)
}

/// Returns the color of a hue angle, degrees: the angle of CIE h is used in Oklab, at the same lightness all around.
fn wheel(degrees: f64) -> [u8; 3] {
    oklab(0.72, 0.13, degrees.to_radians())
}

fn oklab(lightness: f64, chroma: f64, hue: f64) -> [u8; 3] {
    let srgb = RgbSpace::srgb();
    let xyz = xyz_of_oklab([lightness, chroma * libm::cos(hue), chroma * libm::sin(hue)]);
    srgb.encode(into_gamut(srgb.from_xyz(xyz), srgb, Gamut::Perceptual)).map(to_u8)
}

/// Color of pixels without a value, such as the hue of a gray.
const UNDEFINED: [u8; 3] = [128, 128, 128];

/// Draws one quantity of a picture, with its rows and columns along the frame and a scale bar.
///
/// # Errors
/// There is nothing to show: the quantity is defined nowhere, or is nowhere above 0 on a logarithmic scale.
pub fn view(picture: &Measured, field: &QuantityMap, scale: Scale, title: &str) -> Result<Canvas, NotMeasured> {
    let ends = Ends::of(field, scale)?;
    let table: Vec<[u8; 3]> = (0..=1023).map(|i| shade(f64::from(i) / 1023.0)).collect();
    let color = |value: f64| match value {
        v if !v.is_finite() => UNDEFINED,
        v if field.is_hue => wheel(v),
        v => table[(ends.share(v) * 1023.0).round_ties_even() as usize],
    };
    let shown = Shown::of(picture, field.is_hue, &|pixel| field.values[pixel]);
    let rgb = shown.values.iter().map(|v| color(*v)).collect();
    let note = field.white.clone();
    let mut canvas = sheet(picture, title, note.as_deref(), &shown, rgb);
    bar(&mut canvas, &shown.frame, field, &ends);
    Ok(canvas)
}

/// Draws what a screen cannot show. Brightness is gray; pixels are marked in color if they are beyond white, outside sRGB, or not
/// a number. `white` is the Y of full white in the picture's unit; if `None`, [`Measured::white`] is used.
///
/// # Errors
/// The picture has no colors, or no pixel of it is lit.
pub fn clipping(picture: &Measured, white: Option<f64>, title: &str) -> Result<Canvas, NotMeasured> {
    const OVER: [u8; 3] = [0xe0, 0x3c, 0x28];
    const OUTSIDE: [u8; 3] = [0x2a, 0x6f, 0xdb];
    const BOTH: [u8; 3] = [0xc2, 0x35, 0xc9];
    const BROKEN: [u8; 3] = [0xf2, 0xd1, 0x1e];
    if picture.colors.is_none() {
        return Err(picture.without_colors());
    }
    let white = white.or_else(|| picture.white()).ok_or_else(super::quantity_map::dark)?;
    let srgb = RgbSpace::srgb();
    let kind = |pixel: usize| {
        let xyz = picture.xyz_under_d65(pixel).unwrap_or([f64::NAN; 3]);
        if xyz.iter().any(|v| !v.is_finite()) {
            return 3.0;
        }
        let over = picture.is_clipped(pixel) || srgb.from_xyz(xyz).iter().any(|v| *v > white * (1.0 + 1e-6));
        let outside = xyz[1] > 0.0 && is_outside(srgb, xyz);
        match (over, outside) {
            (true, true) => 2.0,
            (true, false) => 0.0,
            (false, true) => 1.0,
            // Gray by brightness, coded as a negative number to tell it from the kinds.
            (false, false) => -1.0 - srgb.encode([(xyz[1] / white).clamp(0.0, 1.0); 3])[0],
        }
    };
    let colors = [OVER, OUTSIDE, BOTH, BROKEN];
    let mut counts = [0_usize; 4];
    let kinds: Vec<f64> = (0..picture.planes.pixels()).map(kind).collect();
    kinds.iter().filter(|k| **k >= 0.0).for_each(|k| counts[*k as usize] += 1);
    // Show the highest kind in each block, so that a single marked pixel does not vanish.
    let shown = Shown::worst(picture, &|pixel| kinds[pixel]);
    let rgb = shown.values.iter().map(|v| if *v >= 0.0 { colors[*v as usize] } else { [to_u8(0.85 * (-1.0 - v)); 3] });
    let note = super::quantity_map::describe_white(white, picture.unit);
    let mut canvas = sheet(picture, title, Some(&note), &shown, rgb.collect());
    let style = TextStyle::new(13.0);
    let words = ["beyond white", "outside sRGB", "both", "not a number"];
    let mut y = shown.frame.top + 12.0;
    for ((color, word), count) in colors.into_iter().zip(words).zip(counts) {
        let x = shown.frame.right + GAP;
        canvas.rectangle(Rect::new(x, y - 11.0, x + 14.0, y + 3.0), Color::from(color));
        canvas.text([x + 22.0, y], word, &style);
        let share = 100.0 * count as f64 / kinds.len() as f64;
        let share = if count > 0 && share < 0.01 { "< 0.01 %".to_owned() } else { format!("{share:.2} %") };
        canvas.text([x + 22.0, y + 18.0], &share, &style.clone().color(Color::GREY));
        y += 46.0;
    }
    Ok(canvas)
}

/// Values of a picture, reduced to the pixels on the sheet.
pub(super) struct Shown {
    pub(super) frame: Rect,
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) values: Vec<f64>,
}

impl Shown {
    /// Reduces a picture to the shown pixels by the mean of the finite values of each block; angles use the first finite value.
    pub(super) fn of(picture: &Measured, is_angle: bool, value: &dyn Fn(usize) -> f64) -> Self {
        let mean = |block: &mut dyn Iterator<Item = f64>| {
            let mut finite = block.filter(|v| v.is_finite());
            if is_angle {
                return finite.next().unwrap_or(f64::NAN);
            }
            let (sum, count) = finite.fold((0.0, 0_usize), |(sum, count), v| (sum + v, count + 1));
            if count > 0 { sum / count as f64 } else { f64::NAN }
        };
        Self::blocks(picture, value, &mean)
    }

    /// Reduces a picture to the shown pixels by the largest value of each block.
    fn worst(picture: &Measured, value: &dyn Fn(usize) -> f64) -> Self {
        Self::blocks(picture, value, &|block| block.fold(f64::NEG_INFINITY, f64::max))
    }

    fn blocks(
        picture: &Measured,
        value: &dyn Fn(usize) -> f64,
        of_block: &dyn Fn(&mut dyn Iterator<Item = f64>) -> f64,
    ) -> Self {
        let [width, height] = [picture.planes.width as usize, picture.planes.height as usize];
        let step = width.max(height).div_ceil(MOST_PX);
        let (columns, rows) = (width.div_ceil(step), height.div_ceil(step));
        let values = (0..rows * columns).map(|i| {
            let (column, row) = (i % columns * step, i / columns * step);
            let pixels = (row..height.min(row + step))
                .flat_map(|row| (column..width.min(column + step)).map(move |column| row * width + column));
            of_block(&mut pixels.map(value))
        });
        let values = values.collect();
        let aspect = width as f64 * picture.planes.pixel_aspect / height as f64;
        let [across, down] = if aspect > 1.0 { [SIDE, SIDE / aspect] } else { [SIDE * aspect, SIDE] };
        // Keep a picture of one row visible.
        let (across, down) = (across.max(40.0), down.max(40.0));
        Self { frame: Rect::new(LEFT, TOP, LEFT + across, TOP + down), columns, rows, values }
    }
}

/// Draws the sheet with title, picture, rows and columns.
pub(super) fn sheet(picture: &Measured, title: &str, note: Option<&str>, shown: &Shown, rgb: Vec<[u8; 3]>) -> Canvas {
    let frame = shown.frame;
    let mut canvas = Canvas::new(frame.right + GAP + BAR + LABELS + 24.0, frame.bottom + 62.0, title);
    let style = TextStyle::new(14.0);
    canvas.text([frame.left, frame.top - 16.0], title, &style.clone().weight(1.3));
    if let Some(note) = note {
        let at = [frame.left + text_width(title, style.size) * 1.06 + 22.0, frame.top - 16.0];
        canvas.text(at, note, &TextStyle::new(12.5).color(Color::GREY));
    }
    // Draw each pixel as a square with sharp edges, as far as the resolution of the sheet allows.
    let sharp = (2.0 * SIDE / shown.columns.max(shown.rows) as f64).floor().clamp(1.0, 64.0) as usize;
    let (columns, rows) = (shown.columns * sharp, shown.rows * sharp);
    let fine = (0..columns * rows).map(|i| rgb[i / columns / sharp * shown.columns + i % columns / sharp]);
    let place = Picture { place: frame, width_px: columns as u32, height_px: rows as u32, rgb: fine.collect() };
    canvas.polygon(&frame.corners(), Paint::Picture(place));
    let columns = Axis::new("column / px", 0.0, f64::from(picture.planes.width)).ticks(8, 2);
    let rows = Axis::new("row / px", f64::from(picture.planes.height), 0.0).ticks(6, 2);
    Axes::new(frame, columns, rows).draw_frame(&mut canvas);
    canvas
}

/// Draws the scale bar of a view, to the right of it.
fn bar(canvas: &mut Canvas, frame: &Rect, field: &QuantityMap, ends: &Ends) {
    let left = frame.right + GAP;
    let place = Rect::new(left, frame.top, left + BAR, frame.bottom);
    let stop = |i: i32| {
        let at = f64::from(i) / 128.0;
        let rgb = if field.is_hue { wheel(360.0 * at) } else { shade(at) };
        Stop { at, color: Color::from(rgb) }
    };
    let stops = (0..=128).map(stop).collect();
    canvas.rectangle(place, Paint::Gradient { from: [left, place.bottom], to: [left, place.top], stops });
    canvas.outline(&place.corners(), &Stroke::new(Color::INK, 1.0));
    let style = TextStyle::new(13.0);
    let mut widest = 0.0_f64;
    for (value, label) in ends.marks(field.is_hue) {
        let y = place.bottom - ends.share(value) * place.height();
        canvas.line([place.right, y], [place.right + 5.0, y], &Stroke::new(Color::INK, 1.0));
        canvas.text([place.right + 9.0, y + style.half_cap()], &label, &style);
        widest = widest.max(text_width(&label, style.size));
    }
    let middle = 0.5 * (place.top + place.bottom);
    let name = TextStyle::new(14.5).middle().turned_deg(90.0);
    canvas.text([place.right + 9.0 + widest + 24.0, middle], &field.label(), &name);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each color is lighter than the one before, so that the scale can be read in gray too.
    #[test]
    fn the_scale_gets_lighter() {
        let luminance = |share: f64| {
            let srgb = RgbSpace::srgb();
            srgb.luminance(srgb.decode(shade(share).map(|v| f64::from(v) / 255.0)))
        };
        assert!((0..100).all(|i| luminance(f64::from(i + 1) / 100.0) > luminance(f64::from(i) / 100.0)));
    }

    #[test]
    fn logarithmic_scales_have_ticks() {
        let marks =
            |low, high| Ends { low, high, is_log: true }.marks(false).into_iter().map(|(_, l)| l).collect::<Vec<_>>();
        assert_eq!(marks(0.1, 10.0), ["0.1", "0.2", "0.5", "1", "2", "5", "10"]);
        assert_eq!(
            marks(1e-7, 1.0),
            ["10^{\u{2212}7}", "10^{\u{2212}6}", "10^{\u{2212}5}", "10^{\u{2212}4}", "0.001", "0.01", "0.1", "1"]
        );
        assert_eq!(marks(3.0, 3.03), ["3", "3.03"]);
    }
}

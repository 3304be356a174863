//! The contact sheet: thumbnails of all pictures of a sweep, side by side.

use spectra_color::{Transfer, to_u8};
use spectra_core::frame::DisplayPicture;
use spectra_core::math::log10;
use spectra_core::params::{Dimension, Reading};
use spectra_core::sink::{Out, WriteFault};
use spectra_plot::{Canvas, Color, Format, Paint, Picture, Rect, TextStyle, text_width};
use spectra_scene::{Developed, Member, SweptAxis};
use std::io::Cursor;

/// Space around and between the cells, pixels.
const GAP: f64 = 18.0;
/// Font size of the labels, pixels.
const LETTERS: f64 = 19.0;
/// Distance from one line of text to the next, pixels.
const LINE: f64 = 28.0;
/// Approximate largest width of the sheet, pixels.
const WIDEST: f64 = 3600.0;
/// Largest width of a thumbnail, pixels, and the smallest that the layout allows.
const THUMBNAIL: [f64; 2] = [480.0, 24.0];
/// Smallest width of a cell, pixels, so that a label fits.
const CELL: f64 = 120.0;
/// Largest number of lines below a thumbnail.
const LINES: usize = 4;
/// Background: a little darker than the middle of a screen, so that neither whites nor blacks blend into it.
const GROUND: Color = Color::new(38, 38, 38);
const LETTER: Color = Color::new(214, 214, 214);
const EMPTY: Color = Color::new(52, 52, 52);

/// A downscaled picture, sRGB code values.
#[derive(Clone, Debug)]
struct Thumbnail {
    width_px: usize,
    height_px: usize,
    rgb: Vec<[u8; 3]>,
}

/// Contact sheets under construction, one for each film.
pub(crate) struct Contact {
    columns: usize,
    rows: usize,
    /// Headings of the columns, and of the rows; empty if each cell has its own label.
    heads: [Vec<Vec<String>>; 2],
    /// Labels below the cells; empty if rows and columns have headings.
    labels: Vec<Vec<String>>,
    /// Largest width and height of a thumbnail, pixels.
    largest: [usize; 2],
    /// Name of each film, and its cells.
    sheets: Vec<(Option<String>, Vec<Option<Thumbnail>>)>,
}

impl Contact {
    /// Lays out a sheet for these pictures, which are about as large as `size_px`. If several paths are swept as a product, the
    /// last one runs across and the others down. Other sweeps fill rows.
    pub(crate) fn new(axes: &[SweptAxis], members: &[Member], size_px: [u32; 2]) -> Self {
        let names = short_names(members);
        let name =
            |path: &str| names.iter().find(|(p, _)| p == path).map_or(path.to_owned(), |(_, short)| short.clone());
        let word = |path: &str, value: &str| format!("{} {}", name(path), rounded(value));
        let (columns, heads, labels) = match axes.split_last() {
            Some((across, down)) if !down.is_empty() => {
                let columns = across.values.len();
                let column_heads = across.values.iter().map(|v| vec![word(&across.path, v)]).collect();
                let of_row = |member: &Member| {
                    let own = member.values.iter().take(down.len());
                    own.map(|(path, value)| word(path, value)).collect::<Vec<_>>()
                };
                let row_heads = members.iter().step_by(columns).map(of_row).collect();
                (columns, [column_heads, row_heads], Vec::new())
            }
            _ => {
                let differs = |path: &str| {
                    let value = |m: &Member| m.values.iter().find(|(p, _)| p == path).map(|(_, v)| v.clone());
                    members.iter().any(|m| value(m) != value(&members[0]))
                };
                let label = |m: &Member| {
                    let own = m.values.iter().filter(|(path, _)| members.len() == 1 || differs(path));
                    own.map(|(path, value)| word(path, value)).collect::<Vec<_>>()
                };
                (in_rows(members.len()), [Vec::new(), Vec::new()], members.iter().map(label).collect())
            }
        };
        let rows = members.len().div_ceil(columns);
        let [width, height] = size_px.map(|s| f64::from(s.max(1)));
        let room = (WIDEST / columns as f64 - GAP).clamp(THUMBNAIL[1], THUMBNAIL[0]).min(width);
        // The canvas is limited to 16384 pixels.
        let tallest = (15_000.0 / rows as f64 - GAP - LINE * LINES as f64).max(8.0);
        let width_px = room.min(tallest * width / height).max(1.0);
        let largest = [width_px, (width_px * height / width).max(1.0)].map(|s| s.round() as usize);
        Self { columns, rows, heads, labels, largest, sheets: Vec::new() }
    }

    /// Puts the pictures of a member, one for each film, into its cells.
    pub(crate) fn put(&mut self, index: usize, pictures: &[Developed]) {
        for (film, picture) in pictures {
            let small = Thumbnail::of(picture, self.largest);
            self.cell(film.as_deref(), index, small);
        }
    }

    /// Largest picture file that is read, bytes; a larger one is not a picture of a sweep.
    pub(crate) const LARGEST_BYTES: u64 = 4 << 30;

    /// Puts a picture file from an earlier run into its cell, if the file can be read.
    pub(crate) fn put_file(&mut self, index: usize, film: Option<&str>, bytes: &[u8]) {
        let reader = image::ImageReader::new(Cursor::new(bytes)).with_guessed_format();
        let read = reader.ok().and_then(|r| r.decode().ok()).map(image::DynamicImage::into_rgb16);
        let Some(read) = read else { return };
        let linear = |v: u16| Transfer::Srgb.decode(f64::from(v) / 65535.0) as f32;
        let picture = DisplayPicture {
            width_px: read.width(),
            height_px: read.height(),
            rgb: read.pixels().map(|p| p.0.map(linear)).collect(),
        };
        let small = Thumbnail::of(&picture, self.largest);
        self.cell(film, index, small);
    }

    fn cell(&mut self, film: Option<&str>, index: usize, small: Thumbnail) {
        let at = self.sheets.iter().position(|(name, _)| name.as_deref() == film);
        let at = at.unwrap_or_else(|| {
            self.sheets.push((film.map(str::to_owned), vec![None; self.columns * self.rows]));
            self.sheets.len() - 1
        });
        if let Some(cell) = self.sheets[at].1.get_mut(index) {
            *cell = Some(small);
        }
    }

    /// Names of the films that have a sheet.
    pub(crate) fn films(&self) -> Vec<Option<String>> {
        self.sheets.iter().map(|(film, _)| film.clone()).collect()
    }

    /// Returns the left and upper edge, pixels, of the thumbnail of a member on the sheet.
    fn place(&self, index: usize) -> [f64; 2] {
        let (column, row) = (index % self.columns, index / self.columns);
        let [left, top] = self.margins();
        let [width, height] = self.pitch();
        [left + column as f64 * width, top + row as f64 * height]
    }

    /// Returns the distance from cell to cell, pixels: across and down.
    fn pitch(&self) -> [f64; 2] {
        let lines = self.labels.iter().map(|l| l.len().min(LINES)).max().unwrap_or(0);
        let label = if lines > 0 { LINE * lines as f64 + 0.4 * GAP } else { 0.0 };
        [self.cell_width() + GAP, (self.largest[1] as f64).max(self.row_head()) + label + GAP]
    }

    fn cell_width(&self) -> f64 {
        (self.largest[0] as f64).max(CELL).round()
    }

    /// Returns the height that the heading of a row needs, pixels.
    fn row_head(&self) -> f64 {
        self.heads[1].iter().map(|l| l.len().min(LINES)).max().unwrap_or(0) as f64 * LINE
    }

    /// Returns the distance from the edges of the sheet to the first cell, pixels: left and top.
    fn margins(&self) -> [f64; 2] {
        let widest = self.heads[1].iter().flatten().map(|text| text_width(text, LETTERS)).fold(0.0, f64::max);
        let left = if widest > 0.0 { (widest + GAP).min(420.0).round() } else { 0.0 };
        [GAP + left, GAP + if self.heads[0].is_empty() { 0.0 } else { LINE }]
    }

    fn draw(&self, cells: &[Option<Thumbnail>], title: &str) -> Canvas {
        let [left, top] = self.margins();
        let [width, height] = self.pitch();
        let size = [left + self.columns as f64 * width, top + self.rows as f64 * height];
        let mut canvas = Canvas::new(size[0], size[1], title).on(GROUND);
        let style = TextStyle::new(LETTERS).color(LETTER);
        for (index, cell) in cells.iter().enumerate() {
            let [x, y] = self.place(index);
            match cell {
                Some(cell) => {
                    let [w, h] = [cell.width_px, cell.height_px].map(|s| s as f64);
                    let place = Rect::new(x, y, x + w, y + h);
                    let (width_px, height_px) = (cell.width_px as u32, cell.height_px as u32);
                    canvas.rectangle(
                        place,
                        Paint::Picture(Picture { place, width_px, height_px, rgb: cell.rgb.clone() }),
                    );
                }
                None if index < self.labels.len().max(self.heads[1].len() * self.columns) => {
                    let [w, h] = self.largest.map(|s| s as f64);
                    canvas.rectangle(Rect::new(x, y, x + w, y + h), EMPTY);
                }
                None => {}
            }
            for (line, text) in self.labels.get(index).into_iter().flatten().take(LINES).enumerate() {
                let base = y + self.largest[1] as f64 + LINE * (line as f64 + 0.9);
                canvas.text([x, base], &fitting(text, self.cell_width() + 0.5 * GAP), &style);
            }
        }
        for (column, head) in self.heads[0].iter().enumerate() {
            let [x, _] = self.place(column);
            let text = head.first().map_or("", String::as_str);
            canvas.text([x, GAP + 0.6 * LINE], &fitting(text, self.cell_width() + 0.5 * GAP), &style);
        }
        for (row, head) in self.heads[1].iter().enumerate() {
            let [x, y] = self.place(row * self.columns);
            for (line, text) in head.iter().take(LINES).enumerate() {
                let base = y + LINE * (line as f64 + 0.7);
                canvas.text([GAP, base], &fitting(text, x - 1.5 * GAP), &style);
            }
        }
        canvas
    }

    /// Writes the sheet of a film as PNG; does nothing if the film has none.
    ///
    /// # Errors
    /// The sheet cannot be drawn, or `out` cannot be written.
    pub(crate) fn write(&self, film: Option<&str>, title: &str, out: &mut dyn Out) -> Result<(), WriteFault> {
        let Some((_, cells)) = self.sheets.iter().find(|(name, _)| name.as_deref() == film) else { return Ok(()) };
        Ok(out.write_all(&self.draw(cells, title).to_bytes(Format::Png, 1.0)?)?)
    }
}

/// Returns the number of columns that gives about the shape of a page for pictures in landscape format.
fn in_rows(count: usize) -> usize {
    match count {
        0..=5 => count.max(1),
        _ => (1..).find(|n| n * n >= count).unwrap_or(count),
    }
}

/// Returns each path with its last key as a short name, or with the whole path if several end in that key.
fn short_names(members: &[Member]) -> Vec<(String, String)> {
    let mut paths: Vec<&str> = members.iter().flat_map(|m| &m.values).map(|(path, _)| path.as_str()).collect();
    paths.sort_unstable();
    paths.dedup();
    let last = |path: &str| path.rsplit('.').next().unwrap_or(path).to_owned();
    let short = |path: &str| {
        let own = last(path);
        if paths.iter().filter(|other| last(other) == own).count() > 1 { path.to_owned() } else { own }
    };
    paths.iter().map(|path| ((*path).to_owned(), short(path))).collect()
}

/// Shortens a value to about four digits: `f/2.828` for `f/2.82842712474619`.
fn rounded(value: &str) -> String {
    /// Shorter values are shown as they were written.
    const SHORT: usize = 9;
    let figures = |v: f64| {
        let digits = (3 - log10(v.abs()).floor() as i64).clamp(0, 12) as usize;
        let text = format!("{v:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    };
    let text = value.trim_matches('"');
    if text.len() <= SHORT {
        return text.to_owned();
    }
    match Reading::of(text) {
        Reading::Bare(v) if v != 0.0 => figures(v),
        Reading::Quantity { value: v, unit } if v != 0.0 && !text.contains("1/") => match unit.dimension {
            Dimension::FNumber => format!("f/{}", figures(v)),
            _ => format!("{} {}", figures(v), unit.symbols[0]),
        },
        _ => text.to_owned(),
    }
}

/// Returns a text, cut off where the width, pixels, ends.
fn fitting(text: &str, width: f64) -> String {
    // Keeps the plot from reading `_{` and `^{` in a user's text as subscripts and superscripts.
    let text = text.replace("_{", "_ {").replace("^{", "^ {");
    if text_width(&text, LETTERS) <= width {
        return text;
    }
    let mut cut: String = text.chars().take(200).collect();
    while !cut.is_empty() && text_width(&format!("{cut}..."), LETTERS) > width {
        cut.pop();
    }
    format!("{cut}...")
}

impl Thumbnail {
    /// Downscales the picture as a screen shows it: each pixel is the mean of the light of those that it covers.
    fn of(picture: &DisplayPicture, [width, height]: [usize; 2]) -> Self {
        let (from_width, from_height) = (picture.width_px as usize, picture.height_px as usize);
        let scale = (width as f64 / from_width as f64).min(height as f64 / from_height as f64).min(1.0);
        let [width_px, height_px] = [from_width, from_height].map(|s| ((s as f64 * scale).round() as usize).max(1));
        let (columns, rows) = (shares(from_width, width_px), shares(from_height, height_px));
        let mut rgb = Vec::with_capacity(width_px * height_px);
        for (first_row, row_shares) in &rows {
            for (first_column, column_shares) in &columns {
                let mut sum = [0.0_f64; 3];
                for (row, row_share) in row_shares.iter().enumerate() {
                    let start = (first_row + row) * from_width + first_column;
                    for (pixel, column_share) in picture.rgb[start..].iter().zip(column_shares) {
                        for (sum, light) in sum.iter_mut().zip(pixel) {
                            *sum += f64::from(light.clamp(0.0, 1.0)) * row_share * column_share;
                        }
                    }
                }
                rgb.push(sum.map(|light| to_u8(Transfer::Srgb.encode(light))));
            }
        }
        Self { width_px, height_px, rgb }
    }
}

/// Divides `from` pixels into `to` equal parts. Returns for each part the first pixel that it covers, and the weights of that
/// pixel and the following ones.
fn shares(from: usize, to: usize) -> Vec<(usize, Vec<f64>)> {
    let size = from as f64 / to as f64;
    let part = |at: usize| {
        let (start, end) = (at as f64 * size, ((at + 1) as f64 * size).min(from as f64));
        let first = (start as usize).min(from - 1);
        let last = (end.ceil() as usize).clamp(first + 1, from);
        let covered = |pixel: usize| ((pixel + 1) as f64).min(end) - (pixel as f64).max(start);
        (first, (first..last).map(|pixel| covered(pixel).max(0.0) / (end - start)).collect())
    };
    (0..to).map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width_px: u32, height_px: u32, light: impl Fn(u32, u32) -> f32) -> DisplayPicture {
        let rgb =
            (0..height_px).flat_map(|y| (0..width_px).map(move |x| (x, y))).map(|(x, y)| [light(x, y); 3]).collect();
        DisplayPicture { width_px, height_px, rgb }
    }

    /// A checkerboard of black and white averages to half the light, code value 188, not 128.
    #[test]
    fn light_is_averaged_and_not_code_values() {
        let board = picture(40, 20, |x, y| ((x + y) % 2) as f32);
        let small = Thumbnail::of(&board, [10, 10]);
        assert_eq!((small.width_px, small.height_px), (10, 5));
        assert!(small.rgb.iter().all(|p| *p == [188; 3]), "{:?}", small.rgb);
        // Values that a screen clips count as clipped.
        let bright = picture(4, 4, |x, _| if x % 2 == 0 { 9.0 } else { -1.0 });
        assert!(Thumbnail::of(&bright, [2, 2]).rgb.iter().all(|p| *p == [188; 3]));
    }

    #[test]
    fn parts_cover_all_pixels_once() {
        for (from, to) in [(7, 3), (3, 3), (1000, 7), (5, 1), (480, 479)] {
            let mut sum = vec![0.0; from];
            for (first, shares) in shares(from, to) {
                assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
                shares.iter().enumerate().for_each(|(i, share)| sum[first + i] += share);
            }
            let wanted = to as f64 / from as f64;
            assert!(sum.iter().all(|s| (s - wanted).abs() < 1e-9), "{from} {to}: {sum:?}");
        }
    }

    #[test]
    fn small_pictures_are_not_blown_up() {
        let small = Thumbnail::of(&picture(3, 2, |_, _| 1.0), [480, 320]);
        assert_eq!((small.width_px, small.height_px), (3, 2));
    }

    #[test]
    fn values_are_shown_in_few_figures() {
        for (value, shown) in [
            ("f/2.82842712474619", "f/2.828"),
            ("1234.56789012 mm", "1235 mm"),
            ("0.000123456789", "0.0001235"),
            ("f/5.6", "f/5.6"),
            ("kodak-tri-x-400", "kodak-tri-x-400"),
            ("1/1000 s", "1/1000 s"),
            ("1/10000000 s", "1/10000000 s"),
            ("\"a: b\"", "a: b"),
        ] {
            assert_eq!(rounded(value), shown);
        }
    }
}

use super::super::drawing::{Align, Drawing, text_width_mm};
use super::super::shape::Rectangle;
use super::parts::{BLACK, WHITE};

/// Text with every letter several times; it continues from line to line.
const READING: &str = "SPECTRA 1234567890 Sphinx of black quartz, judge my vow. PACK MY BOX WITH FIVE DOZEN JUGS. \
    The five boxing wizards jump quickly; how vexingly quick daft zebras jump! WALTZ, BAD NYMPH, FOR QUICK JIGS VEX. \
    A quick brown fox jumps over the lazy dog: f/1.4 at 50 mm, 1/125 s. Glib jocks quiz nymph to vex dwarf; \
    jackdaws love my big sphinx of quartz. Grumpy wizards make toxic brew for the evil queen and jack. \
    FIVE HEXING WIZARD BOTS JUMP QUICKLY (0 + 1 = 1). Amazingly few discotheques provide jukeboxes. \
    Six big devils from Japan quickly forgot how to waltz.";

/// Largest length of a line, mm.
const MEASURE_MM: f64 = 645.0;

/// Draws lines of text in decreasing sizes: black on white in the left half of the sheet, white on black in the right half.
pub fn text(_seed: u64) -> Drawing {
    let mut drawing = Drawing::new(1500.0, 1000.0, WHITE);
    drawing.add(Rectangle::between([0.0, -500.0], [750.0, 500.0]), BLACK);
    for (left_mm, ink) in [(-695.0, BLACK), (55.0, WHITE)] {
        let mut top_mm = 445.0;
        for (line, height_mm) in lines() {
            drawing.text(&line, [left_mm, top_mm - height_mm], height_mm, Align::Left, ink);
            top_mm -= 1.8 * height_mm;
        }
    }
    drawing
}

/// Breaks the text into lines, each with the height of its capitals, mm. The height is halved every three lines.
fn lines() -> Vec<(String, f64)> {
    let mut lines = vec![(String::new(), 100.0)];
    for word in READING.split(' ') {
        let (line, height_mm) = lines.last_mut().expect("there is a first line");
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if line.is_empty() || text_width_mm(&longer, *height_mm) <= MEASURE_MM {
            *line = longer;
        } else {
            let next_mm = *height_mm * libm::cbrt(0.5);
            lines.push((word.to_owned(), next_mm));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::super::super::font;
    use super::*;

    #[test]
    fn every_character_of_the_reading_has_its_letter() {
        for character in READING.chars() {
            assert!(font::has(character), "{character}");
        }
    }

    #[test]
    fn reading_stays_on_its_half_of_the_sheet() {
        for (line, height_mm) in lines() {
            let width_mm = text_width_mm(&line, height_mm);
            assert!(width_mm <= MEASURE_MM, "{line}: {width_mm} mm");
        }
        let total_mm: f64 = lines().iter().map(|(_, height_mm)| 1.8 * height_mm).sum();
        assert!(total_mm < 900.0, "{total_mm} mm");
        assert_eq!(lines().iter().map(|(line, _)| line.split(' ').count()).sum::<usize>(), READING.split(' ').count());
    }
}

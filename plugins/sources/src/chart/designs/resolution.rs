use super::super::drawing::{Align, Drawing};
use super::super::ink::Ink;
use super::super::shape::{Polygon, Rectangle};
use super::parts::{BLACK, FRAME, Narrowing, WHITE, field_target, line_pair, patch_block, slanted_square, star, wedge};

const HEIGHT: f64 = 1000.0;
/// Pitch of the grid in the background, mm; half of it is the width of the border.
const NET: f64 = 50.0;
const LINE: f64 = 1.2;
/// Unit of the numbers at wedges and line groups.
const UNIT: &str = "x 100 LW/PH";

/// Draws the photographic test chart, 1500 x 1000: a grid within a border of black and white blocks, six field targets, and
/// three panels in the middle.
pub fn resolution(_seed: u64) -> Drawing {
    let mut drawing = Drawing::new(1500.0, HEIGHT, WHITE);
    border(&mut drawing);
    net(&mut drawing);
    for x in [-550.0, 550.0] {
        for y in [300.0, 0.0, -300.0] {
            field_target(&mut drawing, [x, y], 135.0);
        }
    }
    upper_panel(&mut drawing);
    middle_panel(&mut drawing);
    lower_panel(&mut drawing);
    drawing
}

/// Draws the border: alternating black and white blocks as long as the grid pitch, and an arrow to the edge in the middle of each
/// side.
fn border(drawing: &mut Drawing) {
    let reach = [750.0, 500.0];
    for (axis, teeth, odd) in [(0, 14, 0), (1, 9, 1)] {
        for k in -teeth..=teeth {
            if (k + odd) % 2 != 0 {
                continue;
            }
            let along = NET * f64::from(k);
            for side in [-1.0, 1.0] {
                let across = side * (reach[1 - axis] - 0.25 * NET);
                let (center, size) =
                    if axis == 0 { ([along, across], [NET, 0.5 * NET]) } else { ([across, along], [0.5 * NET, NET]) };
                drawing.add(Rectangle::new(center, size[0], size[1]), BLACK);
            }
        }
    }
    for side in [-1.0, 1.0] {
        let tip = |x: f64, y: f64| if side > 0.0 { [x, y] } else { [-x, -y] };
        drawing.add(Polygon::new(&[tip(0.0, 500.0), tip(-16.0, 478.0), tip(16.0, 478.0)]), WHITE);
        drawing.add(Polygon::new(&[tip(750.0, 0.0), tip(728.0, 16.0), tip(728.0, -16.0)]), BLACK);
    }
}

/// Draws the thin grid with its frame.
fn net(drawing: &mut Drawing) {
    for k in -14..=14 {
        drawing.add(Rectangle::new([NET * f64::from(k), 0.0], LINE, 950.0), BLACK);
    }
    for k in -9..=9 {
        drawing.add(Rectangle::new([0.0, NET * f64::from(k)], 1450.0, LINE), BLACK);
    }
    for side in [-1.0, 1.0] {
        drawing.add(Rectangle::new([723.5 * side, 0.0], 3.0, 950.0), BLACK);
        drawing.add(Rectangle::new([0.0, 473.5 * side], 1450.0, 3.0), BLACK);
    }
}

/// Draws a white ground between two corners, framed by the lines of the grid.
fn panel(drawing: &mut Drawing, low: [f64; 2], high: [f64; 2]) {
    let inset = 0.5 * LINE;
    drawing.add(Rectangle::between([low[0] + inset, low[1] + inset], [high[0] - inset, high[1] - inset]), WHITE);
}

/// Draws the upper panel: a row of grays, and wedges.
fn upper_panel(drawing: &mut Drawing) {
    panel(drawing, [-350.0, 100.0], [350.0, 450.0]);
    drawing.add(Rectangle::new([0.0, 412.5], 14.0 * 45.0 + 2.4, 47.4), BLACK);
    for step in 0..14_u32 {
        let x = 45.0 * (f64::from(step) - 6.5);
        let density = 0.05 + 0.11 * f64::from(step);
        drawing.add(Rectangle::new([x, 412.5], 45.0, 45.0), Ink::density(density));
        drawing.mark(format!("density {density:.2}"), [x, 412.5], 22.5);
        drawing.text(&format!("{density:.2}"), [x, 376.0], 8.0, Align::Center, BLACK);
    }
    let coarse = [2, 3, 4, 5, 6, 7, 8, 9, 10];
    let fine = [8, 12, 16, 20, 24, 28, 32, 36, 40];
    wedge(drawing, [-48.0, 345.0], 205.0, Narrowing::Down, &coarse, HEIGHT);
    wedge(drawing, [66.0, 345.0], 205.0, Narrowing::Down, &fine, HEIGHT);
    for (x, narrowing) in [(-325.0, Narrowing::Right), (325.0, Narrowing::Left)] {
        wedge(drawing, [x, 281.0], 190.0, narrowing, &coarse, HEIGHT);
        wedge(drawing, [x, 171.0], 190.0, narrowing, &fine, HEIGHT);
    }
    for x in [-230.0, 0.0, 230.0] {
        drawing.text(UNIT, [x, 113.0], 8.0, Align::Center, BLACK);
    }
}

/// Draws the middle panel: a star between slanted squares of high and of low contrast.
fn middle_panel(drawing: &mut Drawing) {
    panel(drawing, [-350.0, -100.0], [350.0, 100.0]);
    star(drawing, [0.0, 0.0], 90.0, 72);
    let faint = Ink::Gray(0.225);
    for (x, degrees, ink, label) in [
        (-160.0, 5.0, BLACK, "+5\u{b0}  30:1"),
        (-285.0, 5.0, faint, "+5\u{b0}  4:1"),
        (160.0, -5.0, BLACK, "-5\u{b0}  30:1"),
        (285.0, -5.0, faint, "-5\u{b0}  4:1"),
    ] {
        slanted_square(drawing, [x, 8.0], 90.0, degrees, ink);
        drawing.text(label, [x, -72.0], 8.0, Align::Center, BLACK);
    }
}

/// Draws the lower panel: color patches between groups of lines, and the title.
fn lower_panel(drawing: &mut Drawing) {
    panel(drawing, [-350.0, -450.0], [350.0, -100.0]);
    let center = [0.0, -252.0];
    drawing.add(Rectangle::new(center, 6.0 * 65.0 + 5.0, 4.0 * 65.0 + 5.0), FRAME);
    patch_block(drawing, center, 60.0, 65.0);

    for (side, align) in [(-1.0, Align::Right), (1.0, Align::Left)] {
        let mut top = -119.5;
        for hundreds in [2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 15.0, 20.0] {
            let size = 90.0 / hundreds;
            line_pair(drawing, [side * 308.0, top], side * -52.0, hundreds, HEIGHT);
            drawing.text(&format!("{hundreds}"), [side * 316.0, top - 0.5 * size - 4.0], 8.0, align, BLACK);
            top -= size + 14.5;
        }
        drawing.text(UNIT, [side * 272.0, -386.0], 8.0, Align::Center, BLACK);
    }
    drawing.text("SPECTRA", [-330.0, -432.0], 16.0, Align::Left, BLACK);
    drawing.text("RESOLUTION 3:2", [330.0, -432.0], 16.0, Align::Right, BLACK);
}

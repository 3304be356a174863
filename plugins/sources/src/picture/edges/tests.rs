//! Tests with pictures that are drawn with and without mixed pixels.

use super::*;

const WIDTH: usize = 48;
const HEIGHT: usize = 32;
const FINE: usize = 16;
const NEAR_MM: f32 = 1000.0;
const FAR_MM: f32 = 8000.0;

struct Plate {
    rgb: Vec<[f32; 3]>,
    depth_mm: Vec<f32>,
    share: Vec<f32>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Color is antialiased, depth is that of the pixel's center.
    Sampled,
    /// Color and depth are antialiased.
    Averaged,
    /// Color and depth are those of the pixel's center.
    Hard,
}

/// Draws a near object of one color in front of a far one.
fn plate(kind: Kind, near: impl Fn(f64, f64) -> bool, front: [f32; 3], back: impl Fn(usize) -> [f32; 3]) -> Plate {
    let cell = |cell: usize| {
        let at = |k: usize, fine: usize| k as f64 + (fine as f64 + 0.5) / FINE as f64;
        let (column, row) = (cell % WIDTH, cell / WIDTH);
        let middle = near(column as f64 + 0.5, row as f64 + 0.5);
        let count = (0..FINE * FINE).filter(|k| near(at(column, k % FINE), at(row, k / FINE))).count();
        let share = if kind == Kind::Hard { f32::from(middle) } else { count as f32 / (FINE * FINE) as f32 };
        let part = if kind == Kind::Averaged { share } else { f32::from(middle) };
        let rgb = [0, 1, 2].map(|k| share * front[k] + (1.0 - share) * back(cell)[k]);
        (rgb, part * NEAR_MM + (1.0 - part) * FAR_MM, share)
    };
    let all: Vec<_> = (0..WIDTH * HEIGHT).map(cell).collect();
    Plate {
        rgb: all.iter().map(|(rgb, ..)| *rgb).collect(),
        depth_mm: all.iter().map(|(_, depth, _)| *depth).collect(),
        share: all.iter().map(|(.., share)| *share).collect(),
    }
}

const WHITE: [f32; 3] = [1.0, 0.9, 0.8];
const DARK: [f32; 3] = [0.05, 0.06, 0.1];

fn slanted(x: f64, y: f64) -> bool {
    x < 20.0 + 0.31 * y
}

fn thread(x: f64, y: f64) -> bool {
    (x - 20.0 - 0.31 * y).abs() < 0.35
}

/// Separates a picture, and checks pixel by pixel that foreground and background together give its colors.
fn parted(plate: &Plate) -> (Plate, Mixed) {
    let (mut rgb, mut depth_mm) = (plate.rgb.clone(), plate.depth_mm.clone());
    let mixed = part(&mut rgb, &mut depth_mm, WIDTH, 0.05).expect("mixed pixels");
    for (cell, own) in rgb.iter().enumerate() {
        let whole = mixed.cells.place(cell).map_or(*own, |place| {
            let behind = &mixed.behind[place];
            [0, 1, 2].map(|k| behind.opacity * own[k] + (1.0 - behind.opacity) * behind.rgb[k])
        });
        for k in 0..3 {
            assert!((whole[k] - plate.rgb[cell][k]).abs() < 1e-5, "{cell}: {whole:?} {:?}", plate.rgb[cell]);
        }
    }
    (Plate { rgb, depth_mm, share: plate.share.clone() }, mixed)
}

#[test]
fn an_edge_is_two_pure_sides_and_a_share() {
    for kind in [Kind::Sampled, Kind::Averaged] {
        let (front, mixed) = parted(&plate(kind, slanted, WHITE, |_| DARK));
        // Depths that averaging shifted by less than a step may stay.
        let side = |mm: f32| [NEAR_MM, FAR_MM].into_iter().find(|side| (side / mm - 1.0).abs() < 0.06);
        for (cell, share) in front.share.iter().enumerate() {
            let Some(place) = mixed.cells.place(cell) else {
                // A pixel that is not mixed belongs wholly to one side.
                let share = &share.round();
                assert!((share - front.share[cell]).abs() < 0.03, "{cell}: {share}");
                assert_eq!(side(front.depth_mm[cell]), Some(if *share == 1.0 { NEAR_MM } else { FAR_MM }));
                continue;
            };
            let behind = &mixed.behind[place];
            assert!((behind.opacity - share).abs() < 0.05, "{cell}: {} {share}", behind.opacity);
            let sides = (side(front.depth_mm[cell]), side(behind.depth_mm));
            assert_eq!(sides, (Some(NEAR_MM), Some(FAR_MM)), "{cell}");
            for k in 0..3 {
                let off = (front.rgb[cell][k] - WHITE[k], behind.rgb[k] - DARK[k]);
                assert!(off.0.abs() < 0.04 && off.1.abs() < 0.01, "{cell}: {off:?}");
            }
        }
    }
}

/// The thread darkens no pixel at the depth of the wall, whatever the pixel's depth in the file.
#[test]
fn a_thread_leaves_the_wall() {
    for kind in [Kind::Sampled, Kind::Averaged] {
        let (front, mixed) = parted(&plate(kind, thread, DARK, |_| WHITE));
        for (cell, mm) in front.depth_mm.iter().enumerate() {
            let behind = mixed.cells.place(cell).map(|place| &mixed.behind[place]);
            // The pixels that differ most from the wall count wholly as thread.
            if behind.is_none() && front.share[cell] > 0.6 {
                continue;
            }
            let (color, mm) = behind.map_or((front.rgb[cell], *mm), |behind| (behind.rgb, behind.depth_mm));
            assert!((mm / FAR_MM - 1.0).abs() < 0.06, "{cell}: {mm}");
            assert!(color[0] > 0.96, "{cell}: {color:?}");
        }
        assert!(mixed.behind.iter().map(|behind| behind.opacity).sum::<f32>() > 0.6 * front.share.iter().sum::<f32>());
    }
}

/// Mixed pixels beside a small lamp contain its light, not the dark wall around it.
#[test]
fn a_small_lamp_behind_stays_behind() {
    let lamp = |cell: usize| if (27..31).contains(&(cell % WIDTH)) && cell / WIDTH == 24 { [500.0; 3] } else { DARK };
    let (front, _) = parted(&plate(Kind::Sampled, slanted, WHITE, lamp));
    let near = front.rgb.iter().zip(&front.depth_mm).filter(|(_, mm)| **mm == NEAR_MM);
    let brightest = near.fold(0.0_f32, |a, (rgb, _)| a.max(rgb[0]));
    assert!(brightest < 2.0, "{brightest}");
}

/// Smooth colors, textures, slopes and floors without mixed pixels do not change.
#[test]
fn what_is_not_mixed_stays() {
    let noise = |cell: usize| 0.2 + 0.5 * ((cell * 7919 % 613) as f32 / 613.0);
    let textured = |mut plate: Plate| {
        plate.rgb.iter_mut().enumerate().for_each(|(cell, rgb)| *rgb = rgb.map(|v| v * noise(cell)));
        plate
    };
    let mut floor = plate(Kind::Hard, |_, _| false, WHITE, |_| DARK);
    floor
        .depth_mm
        .iter_mut()
        .enumerate()
        .for_each(|(cell, mm)| *mm = 900.0 / (1.02 - (cell / WIDTH) as f32 / HEIGHT as f32));
    for (name, plate) in [
        ("hard", plate(Kind::Hard, slanted, WHITE, |_| DARK)),
        ("hard thread", plate(Kind::Hard, |x, y| (x - 20.0 - 0.31 * y).abs() < 1.2, WHITE, |_| DARK)),
        ("one color", plate(Kind::Sampled, slanted, WHITE, |_| WHITE)),
        ("texture", textured(plate(Kind::Hard, slanted, WHITE, |_| DARK))),
        ("texture alone", textured(plate(Kind::Hard, slanted, WHITE, |_| WHITE))),
        ("floor", textured(floor)),
    ] {
        let (mut rgb, mut depth_mm) = (plate.rgb.clone(), plate.depth_mm.clone());
        assert!(part(&mut rgb, &mut depth_mm, WIDTH, 0.05).is_none(), "{name}");
        assert!(rgb == plate.rgb && depth_mm == plate.depth_mm, "{name}");
    }
}

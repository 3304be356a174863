//! Checks the guarantees of [`Shape::coverage`] at points, on random shapes and cells.

use super::*;

/// A linear congruential generator, which is random enough to place shapes.
struct Dice(u64);

impl Dice {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn point(&mut self) -> [f64; 2] {
        [self.between(-10.0, 10.0), self.between(-10.0, 10.0)]
    }
}

fn any_shape(kind: usize, dice: &mut Dice) -> Shape {
    let [a, b] = [dice.point(), dice.point()];
    let turn = dice.between(-7.0, 7.0);
    match kind {
        0 => Rectangle::new(a, dice.between(0.1, 12.0), dice.between(0.1, 12.0)).turned(turn).into(),
        1 => Ring::disk(a, dice.between(0.1, 8.0)).into(),
        2 => Ring::new(a, dice.between(0.1, 8.0), dice.between(0.1, 6.0)).into(),
        3 => {
            let corners: Vec<[f64; 2]> = (0..5).map(|_| dice.point()).collect();
            Polygon::new(&corners).into()
        }
        4 => Wedge::new(a, b, 5, [dice.between(0.1, 1.0), dice.between(0.1, 1.0)]).into(),
        5 => SiemensStar::new(a, dice.between(1.0, 12.0), 2 + (dice.between(0.0, 9.0) as u32), turn).into(),
        6 => Stroke::new(a, b, dice.between(0.1, 6.0)).into(),
        _ => Arc::new(a, dice.between(0.1, 8.0), turn, dice.between(-6.2, 6.2), dice.between(0.1, 4.0)).into(),
    }
}

#[test]
fn coverage_keeps_its_promises() {
    let mut dice = Dice(1);
    for kind in 0..8 {
        let mut seen = [0; 3];
        for _ in 0..400 {
            let shape = any_shape(kind, &mut dice);
            for _ in 0..30 {
                let cell =
                    Cell { center_mm: dice.point(), half_mm: [dice.between(0.01, 1.0), dice.between(0.01, 1.0)] };
                let coverage = shape.coverage(&cell);
                seen[coverage as usize] += 1;
                for sample in 0..40 {
                    let mut part = || dice.between(-1.0, 1.0);
                    let (mut u, mut v) = (part(), part());
                    if sample < 4 {
                        (u, v) = ([-1.0, 1.0][sample & 1], [-1.0, 1.0][sample >> 1]);
                    }
                    let [x, y] = [cell.center_mm[0] + u * cell.half_mm[0], cell.center_mm[1] + v * cell.half_mm[1]];
                    let inside = shape.contains(x, y);
                    assert!(
                        coverage == Coverage::Partial || inside == (coverage == Coverage::Full),
                        "{shape:?} is {coverage:?} in {cell:?} but contains ({x}, {y}): {inside}"
                    );
                }
            }
        }
        // The test would prove nothing if a shape always returned `Partial`.
        assert!(seen.iter().all(|&count| count > 100), "kind {kind}: {seen:?}");
    }
}

#[test]
fn coverage_is_seldom_in_doubt_without_need() {
    let mut dice = Dice(2);
    for kind in 0..8 {
        let (mut doubted, mut needless) = (0, 0);
        for _ in 0..4000 {
            let shape = any_shape(kind, &mut dice);
            let cell = Cell { center_mm: dice.point(), half_mm: [0.2, 0.2] };
            if shape.coverage(&cell) == Coverage::Partial {
                doubted += 1;
                let mut count = 0;
                for i in 0..441 {
                    let [u, v] = [f64::from(i % 21) / 10.0 - 1.0, f64::from(i / 21) / 10.0 - 1.0];
                    count += usize::from(shape.contains(cell.center_mm[0] + 0.2 * u, cell.center_mm[1] + 0.2 * v));
                }
                needless += usize::from(count == 0 || count == 441);
            }
        }
        // Pen strokes use half a diagonal as a bound, 1.41 times as much as a border parallel to a side needs. The other
        // undecided cells have covered corners that are too small for 21 x 21 points.
        assert!(needless * 3 < doubted, "kind {kind}: {needless} of {doubted}");
    }
}

#[test]
fn scaling_keeps_what_is_inside() {
    let mut dice = Dice(3);
    for kind in 0..8 {
        for _ in 0..200 {
            let shape = any_shape(kind, &mut dice);
            let large = shape.clone().scaled(8.0);
            for _ in 0..50 {
                let [x, y] = dice.point();
                assert_eq!(shape.contains(x, y), large.contains(8.0 * x, 8.0 * y), "{shape:?} ({x}, {y})");
            }
        }
    }
}

#[test]
fn star_sectors_follow_the_angle() {
    // Compare with the arc tangent, at least 1e-9 of a sector away from the borders.
    let mut dice = Dice(4);
    for cycles in [2, 3, 7, 36, 144] {
        for angle in [0.0, 0.3, -2.0, 5.0] {
            let star = SiemensStar::new([1.0, -2.0], 5.0, cycles, angle);
            for _ in 0..5000 {
                let [dx, dy] = [dice.between(-3.5, 3.5), dice.between(-3.5, 3.5)];
                let turns = (libm::atan2(dy, dx) - angle) * f64::from(cycles) / std::f64::consts::TAU;
                let from_middle = (turns - turns.round()).abs();
                if (from_middle - 0.25).abs() > 1e-9 {
                    assert_eq!(star.contains(1.0 + dx, dy - 2.0), from_middle < 0.25, "{cycles} {angle} {dx} {dy}");
                }
            }
        }
    }
}

#[test]
fn star_is_filled_at_its_angle_and_by_half() {
    let star = SiemensStar::new([0.0, 0.0], 10.0, 36, 0.0);
    assert!(star.contains(9.9, 0.0) && star.contains(0.0, 9.9) && star.contains(-9.9, 0.0) && star.contains(0.0, -9.9));
    assert!(!star.contains(10.1, 0.0));
    let steps = 72_000;
    let inside: Vec<bool> = (0..steps)
        .map(|k| {
            let a = std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(steps);
            star.contains(5.0 * libm::cos(a), 5.0 * libm::sin(a))
        })
        .collect();
    let borders = (0..inside.len()).filter(|&k| inside[k] != inside[(k + 1) % inside.len()]).count();
    assert_eq!(borders, 72);
    assert_eq!(inside.iter().filter(|&&v| v).count(), steps as usize / 2);
}

#[test]
fn wedge_borders_are_hyperbolas() {
    // Frequencies from 1 to 4 cycles per mm over 30 mm, 3 lines: the outer border lies where 2 u f = 5 / 2.
    let wedge = Wedge::new([2.0, 1.0], [32.0, 1.0], 3, [1.0, 4.0]);
    for along in [0.0, 3.0, 10.0, 25.0, 30.0] {
        let frequency = 1.0 + 3.0 * along / 30.0;
        let stripe = 0.5 / frequency;
        for k in -4..=4_i32 {
            let middle = 1.0 + stripe * f64::from(k);
            let expected = k % 2 == 0 && k.abs() <= 2;
            assert_eq!(wedge.contains(2.0 + along, middle), expected, "{along} {k}");
            assert_eq!(wedge.contains(2.0 + along, middle + 0.49 * stripe), expected, "{along} {k}");
            assert_eq!(wedge.contains(2.0 + along, middle - 0.49 * stripe), expected, "{along} {k}");
        }
    }
    assert!(!wedge.contains(1.999, 1.0) && !wedge.contains(32.001, 1.0));
}

#[test]
fn arcs_end_where_they_should() {
    // The arc from +x through +y to -x, drawn in either direction.
    for (start, sweep) in [(0.0, 180.0_f64), (180.0, -180.0_f64)] {
        let arc = Arc::new([0.0, 0.0], 5.0, f64::to_radians(start), sweep.to_radians(), 1.0);
        assert!(arc.contains(5.4, 0.0) && arc.contains(0.0, 4.6) && arc.contains(-5.4, 0.1));
        assert!(arc.contains(5.0, -0.49) && !arc.contains(5.0, -0.51) && !arc.contains(0.0, -5.0));
        assert!(!arc.contains(0.0, 0.0) && !arc.contains(0.0, 5.51));
    }
    let most = Arc::new([0.0, 0.0], 5.0, 0.0, f64::to_radians(270.0), 1.0);
    assert!(most.contains(-3.5, -3.5) && !most.contains(3.5, -3.5) && most.contains(0.49, -5.0));
}

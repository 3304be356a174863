//! Names beside points, none on top of another.

use crate::geometry::{Point, Rect};
use crate::text::{TextStyle, text_width};

/// Places names near their points, clear of what is taken already.
#[derive(Clone, Debug)]
pub struct Labels {
    within: Rect,
    taken: Vec<Rect>,
}

/// Ways from a point to its name, the best first.
const WAYS: [Point; 8] =
    [[1.0, 0.0], [-1.0, 0.0], [0.7, -0.7], [0.7, 0.7], [-0.7, -0.7], [-0.7, 0.7], [0.0, -1.0], [0.0, 1.0]];

impl Labels {
    /// Names that stay `within` a rectangle.
    #[must_use]
    pub fn new(within: Rect) -> Self {
        Self { within, taken: Vec::new() }
    }

    /// Keeps names off a rectangle: a mark, a legend.
    pub fn keep_clear(&mut self, rect: Rect) {
        self.taken.push(rect);
    }

    /// Takes a rectangle where it is free; whether it was.
    pub fn claim(&mut self, rect: Rect) -> bool {
        let free = self.within.holds(&rect) && self.taken.iter().all(|other| !other.overlaps(&rect.grown(2.0)));
        if free {
            self.taken.push(rect);
        }
        free
    }

    /// Beginning of the base line for `text` near `point`, `distance` off its edge; `None` where there is no room.
    ///
    /// Nearer places are taken first, the right hand side before the left, and that before those above and below.
    pub fn place(&mut self, point: Point, text: &str, style: &TextStyle, distance: f64) -> Option<Point> {
        let (width, height) = (text_width(text, style.size), 2.0 * style.half_cap());
        let far = [1.0, 2.2, 4.0, 6.5];
        let found = far.into_iter().flat_map(|f| WAYS.map(|w| (w, f))).find_map(|([x, y], far)| {
            // The name's middle lies so that its nearest edge is at the distance.
            let middle = [
                point[0] + x * distance * far + 0.5 * width * sign(x),
                point[1] + y * distance * far + 0.5 * height * sign(y),
            ];
            let left = middle[0] - 0.5 * width;
            let rect = Rect::new(left, middle[1] - 0.5 * height, left + width, middle[1] + 0.5 * height);
            self.claim(rect).then_some(rect)
        })?;
        Some([found.left, found.bottom])
    }
}

fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_apart_until_there_is_no_room() {
        let within = Rect::new(0.0, 0.0, 200.0, 100.0);
        let mut labels = Labels::new(within);
        let style = TextStyle::new(12.0);
        let mut rects: Vec<Rect> = Vec::new();
        while let Some(at) = labels.place([100.0, 50.0], "name", &style, 6.0) {
            let rect = style.bounds(at, "name");
            assert!(within.holds(&rect) && rects.iter().all(|r| !r.overlaps(&rect)));
            rects.push(rect);
        }
        assert!((6..20).contains(&rects.len()), "{}", rects.len());
        assert!(rects[0].left > 100.0);
    }
}

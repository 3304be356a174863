//! Placement of labels next to points, without overlap.

use crate::geometry::{Point, Rect};
use crate::text::{TextStyle, text_width};

/// A placer of labels near their points, clear of areas that are already taken.
#[derive(Clone, Debug)]
pub struct Labels {
    within: Rect,
    taken: Vec<Rect>,
}

/// Directions from a point to its label, in descending order of preference.
const WAYS: [Point; 8] =
    [[1.0, 0.0], [-1.0, 0.0], [0.7, -0.7], [0.7, 0.7], [-0.7, -0.7], [-0.7, 0.7], [0.0, -1.0], [0.0, 1.0]];

impl Labels {
    /// Creates a label placer for labels that stay `within` a rectangle.
    #[must_use]
    pub fn new(within: Rect) -> Self {
        Self { within, taken: Vec::new() }
    }

    /// Keeps labels off a rectangle, such as a mark or a legend.
    pub fn keep_clear(&mut self, rect: Rect) {
        self.taken.push(rect);
    }

    /// Reserves a rectangle if it is free; returns whether it was.
    pub fn claim(&mut self, rect: Rect) -> bool {
        let free = self.within.holds(&rect) && self.taken.iter().all(|other| !other.overlaps(&rect.grown(2.0)));
        if free {
            self.taken.push(rect);
        }
        free
    }

    /// Finds room for `text` near `point` and reserves it. Returns the start of the text's baseline; `None` if there is no room. `distance`
    /// is the gap between point and text.
    ///
    /// Closer positions are tried first; of these, the right side before the left, and both before positions above and below.
    pub fn place(&mut self, point: Point, text: &str, style: &TextStyle, distance: f64) -> Option<Point> {
        let (width, height) = (text_width(text, style.size), 2.0 * style.half_cap());
        let far = [1.0, 2.2, 4.0, 6.5];
        let found = far.into_iter().flat_map(|f| WAYS.map(|w| (w, f))).find_map(|([x, y], far)| {
            // Center the label so that its nearest edge is at the distance.
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

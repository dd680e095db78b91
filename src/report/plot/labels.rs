//! Places labels beside points so that they cover neither each other nor the points: greedy over a ring of
//! places around each point, then passes that let each label move again. Deterministic.

/// An upright rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Left edge.
    pub x: f64,
    /// Top edge.
    pub y: f64,
    /// Extent to the right.
    pub width: f64,
    /// Extent downwards.
    pub height: f64,
}

impl Rect {
    /// The square about a point.
    pub fn around((x, y): (f64, f64), radius: f64) -> Self {
        Self { x: x - radius, y: y - radius, width: 2.0 * radius, height: 2.0 * radius }
    }

    /// Area shared with `other`.
    pub fn overlap(&self, other: &Self) -> f64 {
        let along = |a: f64, a_len: f64, b: f64, b_len: f64| ((a + a_len).min(b + b_len) - a.max(b)).max(0.0);
        along(self.x, self.width, other.x, other.width) * along(self.y, self.height, other.y, other.height)
    }

    /// The point of the rectangle nearest to another.
    pub fn nearest(&self, (x, y): (f64, f64)) -> (f64, f64) {
        // `clamp` panics where the rectangle has no place, as one beside a figure that is no number.
        (x.max(self.x).min(self.x + self.width), y.max(self.y).min(self.y + self.height))
    }
}

/// A straight line between two points.
pub type Segment = ((f64, f64), (f64, f64));

/// A label to place.
#[derive(Clone, Copy, Debug)]
pub struct Label {
    /// The point it tells of.
    pub at: (f64, f64),
    /// Width and height of the text.
    pub size: (f64, f64),
}

/// Directions around a point in the order of preference: right, left, above, below, the corners.
const DIRECTIONS: [(f64, f64); 8] =
    [(1.0, 0.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.7, -0.7), (0.7, 0.7), (-0.7, -0.7), (-0.7, 0.7)];
/// Distances from the point; beyond the first a label needs a leader.
const RINGS: [f64; 5] = [8.5, 17.0, 28.0, 42.0, 58.0];

/// A rectangle for each label within `bounds`, clear of `points` (with their radius) and as far as possible
/// of `lines`.
pub fn place(labels: &[Label], points: &[Rect], lines: &[Segment], bounds: Rect) -> Vec<Rect> {
    let mut placed: Vec<Option<Rect>> = vec![None; labels.len()];
    for _ in 0..3 {
        for (index, label) in labels.iter().enumerate() {
            let others = placed.iter().enumerate().filter(|(other, _)| *other != index);
            let others: Vec<Rect> = others.filter_map(|(_, rect)| *rect).collect();
            let cost = |rect: &Rect, preference: f64| {
                let inside = rect.overlap(&bounds);
                let outside = rect.width * rect.height - inside;
                let on = |obstacles: &[Rect]| obstacles.iter().map(|o| rect.overlap(o)).sum::<f64>();
                let crossed = lines.iter().filter(|line| crosses(rect, **line)).count() as f64;
                preference + 20.0 * outside + 8.0 * on(&others) + 4.0 * on(points) + 15.0 * crossed
            };
            let best = candidates(label)
                .map(|(rect, preference)| (cost(&rect, preference), rect))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            placed[index] = best.map(|best| best.1);
        }
    }
    placed.into_iter().flatten().collect()
}

/// All places of a label, each with a penalty relative to the best.
fn candidates(label: &Label) -> impl Iterator<Item = (Rect, f64)> {
    let Label { at: (x, y), size: (width, height) } = *label;
    RINGS.into_iter().enumerate().flat_map(move |(ring, distance)| {
        DIRECTIONS.into_iter().enumerate().map(move |(place, (dx, dy))| {
            let centre =
                (x + dx * distance + dx.signum() * half(dx, width), y + dy * distance + 0.5 * dy * height);
            let rect = Rect { x: centre.0 - 0.5 * width, y: centre.1 - 0.5 * height, width, height };
            (rect, 12.0 * ring as f64 + place as f64)
        })
    })
}

/// Half the width for places beside the point, nothing for those above or below.
fn half(direction: f64, width: f64) -> f64 {
    if direction == 0.0 { 0.0 } else { 0.5 * width }
}

/// True if the segment passes through the rectangle, by its sampled points.
fn crosses(rect: &Rect, ((x0, y0), (x1, y1)): Segment) -> bool {
    (0..=40).any(|i| {
        let t = f64::from(i) / 40.0;
        let (x, y) = (x0 + t * (x1 - x0), y0 + t * (y1 - y0));
        x > rect.x && x < rect.x + rect.width && y > rect.y && y < rect.y + rect.height
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Rect = Rect { x: 0.0, y: 0.0, width: 400.0, height: 300.0 };

    #[test]
    fn labels_of_a_crowd_do_not_overlap() {
        let at: Vec<(f64, f64)> =
            (0..10u8).map(|i| (200.0 + 9.0 * f64::from(i % 4), 150.0 + 7.0 * f64::from(i / 4))).collect();
        let labels: Vec<Label> = at.iter().map(|&at| Label { at, size: (60.0, 12.0) }).collect();
        let points: Vec<Rect> = at.iter().map(|&at| Rect::around(at, 4.0)).collect();
        let placed = place(&labels, &points, &[], BOUNDS);
        assert_eq!(placed.len(), 10);
        for (i, a) in placed.iter().enumerate() {
            assert!(placed[..i].iter().all(|b| a.overlap(b) == 0.0), "{placed:?}");
            assert!((a.overlap(&BOUNDS) - 720.0).abs() < 1e-9, "{a:?}");
        }
        assert_eq!(place(&labels, &points, &[], BOUNDS), placed);
    }

    #[test]
    fn a_lone_label_stands_right_of_its_point_and_at_the_edge_left() {
        let label = |x| Label { at: (x, 50.0), size: (40.0, 10.0) };
        assert!(place(&[label(100.0)], &[], &[], BOUNDS)[0].x > 100.0);
        let at_edge = place(&[label(395.0)], &[Rect::around((395.0, 50.0), 4.0)], &[], BOUNDS)[0];
        assert!(at_edge.x + at_edge.width < 395.0, "{at_edge:?}");
    }

    #[test]
    fn a_figure_that_is_no_number_ends_nothing() {
        let nowhere = place(&[Label { at: (f64::NAN, 50.0), size: (40.0, 10.0) }], &[], &[], BOUNDS)[0];
        assert_eq!(nowhere.nearest((1.0, f64::INFINITY)), (1.0, nowhere.y + nowhere.height));
    }
}

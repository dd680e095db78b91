//! Places labels beside points so that they cover neither each other nor the points, and stand on no line, as far as
//! there is room: greedy over rings of places around each point, then passes that let each label move again.
//! Deterministic.

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

    /// True if the segment passes through the inside.
    fn is_crossed(&self, ((x0, y0), (x1, y1)): Segment) -> bool {
        // The part of the segment between the edges across, then that part between the edges upwards.
        let within = |(low, high): (f64, f64), from: f64, to: f64, (least, most): (f64, f64)| {
            if from == to {
                return if from > least && from < most { (low, high) } else { (1.0, 0.0) };
            }
            let ends = ((least - from) / (to - from), (most - from) / (to - from));
            (low.max(ends.0.min(ends.1)), high.min(ends.0.max(ends.1)))
        };
        let across = within((0.0, 1.0), x0, x1, (self.x, self.x + self.width));
        let (low, high) = within(across, y0, y1, (self.y, self.y + self.height));
        low < high
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

/// Distance of a label from its point beyond which a line leads to it.
const LEADER: f64 = 11.0;

/// The line from a point to its label, where the label is not beside it.
pub fn leader(at: (f64, f64), label: &Rect) -> Option<Segment> {
    let near = label.nearest(at);
    ((at.0 - near.0).hypot(at.1 - near.1) > LEADER).then_some((at, near))
}

/// Directions around a point in the order of preference: right, left, above, below, the corners.
const DIRECTIONS: [(f64, f64); 8] =
    [(1.0, 0.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (0.7, -0.7), (0.7, 0.7), (-0.7, -0.7), (-0.7, 0.7)];
/// Distances from the point; beyond the first a label needs a leader.
const RINGS: [f64; 6] = [8.5, 17.0, 28.0, 42.0, 58.0, 76.0];

/// What labels are to keep clear of.
#[derive(Clone, Copy, Debug, Default)]
pub struct Obstacles<'a> {
    /// Points, with their extent.
    pub points: &'a [Rect],
    /// Lines through points.
    pub lines: &'a [Segment],
    /// Paler lines: a label stands on one sooner than far from its point.
    pub bars: &'a [Segment],
}

/// A rectangle for each label within `bounds`, clear of the other labels, their leaders and `obstacles` as far as
/// possible.
pub fn place(labels: &[Label], obstacles: Obstacles<'_>, bounds: Rect) -> Vec<Rect> {
    let mut placed: Vec<Option<Rect>> = vec![None; labels.len()];
    for _ in 0..3 {
        for (index, label) in labels.iter().enumerate() {
            let others = labels.iter().zip(&placed).enumerate().filter(|(other, _)| *other != index);
            let (others, leaders): (Vec<Rect>, Vec<Option<Segment>>) =
                others.filter_map(|(_, (other, rect))| Some(((*rect)?, leader(other.at, &(*rect)?)))).unzip();
            let leaders: Vec<Segment> = leaders.into_iter().flatten().collect();
            let cost = |rect: &Rect, preference: f64| {
                let inside = rect.overlap(&bounds);
                let outside = rect.width * rect.height - inside;
                let on = |others: &[Rect]| others.iter().map(|other| rect.overlap(other)).sum::<f64>();
                let crossed = |lines: &[Segment]| lines.iter().filter(|line| rect.is_crossed(**line)).count();
                let own = leader(label.at, rect);
                let across = own.map_or(0, |own| others.iter().filter(|other| other.is_crossed(own)).count());
                preference
                    + 20.0 * outside
                    + 40.0 * on(&others)
                    + 12.0 * on(obstacles.points)
                    + 200.0 * (crossed(obstacles.lines) + crossed(&leaders) + across) as f64
                    + 14.0 * crossed(obstacles.bars) as f64
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
        let obstacles = Obstacles { points: &points, ..Obstacles::default() };
        let placed = place(&labels, obstacles, BOUNDS);
        assert_eq!(placed.len(), 10);
        for (i, a) in placed.iter().enumerate() {
            assert!(placed[..i].iter().all(|b| a.overlap(b) == 0.0), "{placed:?}");
            assert!((a.overlap(&BOUNDS) - 720.0).abs() < 1e-9, "{a:?}");
        }
        assert_eq!(place(&labels, obstacles, BOUNDS), placed);
    }

    #[test]
    fn a_lone_label_stands_right_of_its_point_and_at_the_edge_left() {
        let label = |x| Label { at: (x, 50.0), size: (40.0, 10.0) };
        assert!(place(&[label(100.0)], Obstacles::default(), BOUNDS)[0].x > 100.0);
        let points = [Rect::around((395.0, 50.0), 4.0)];
        let at_edge =
            place(&[label(395.0)], Obstacles { points: &points, ..Obstacles::default() }, BOUNDS)[0];
        assert!(at_edge.x + at_edge.width < 395.0, "{at_edge:?}");
    }

    #[test]
    fn a_line_is_seen_wherever_it_crosses() {
        let rect = Rect { x: 200.0, y: 100.0, width: 60.0, height: 10.0 };
        let crossed = [
            ((0.0, 0.0), (1000.0, 470.0)),
            ((230.0, 0.0), (230.0, 300.0)),
            ((0.0, 105.0), (400.0, 105.0)),
            ((210.0, 102.0), (220.0, 104.0)),
        ];
        assert!(crossed.iter().all(|&line| rect.is_crossed(line)));
        let beside =
            [((0.0, 0.0), (1000.0, 200.0)), ((230.0, 0.0), (230.0, 90.0)), ((0.0, 111.0), (400.0, 111.0))];
        assert!(!beside.iter().any(|&line| rect.is_crossed(line)));
    }

    #[test]
    fn labels_keep_clear_of_lines_and_leaders() {
        // A crowd along a line between its points: some labels need leaders.
        let at: Vec<(f64, f64)> =
            (0..7u8).map(|i| (180.0 + 9.0 * f64::from(i), 130.0 + 5.0 * f64::from(i))).collect();
        let labels: Vec<Label> = at.iter().map(|&at| Label { at, size: (90.0, 12.0) }).collect();
        let points: Vec<Rect> = at.iter().map(|&at| Rect::around(at, 4.0)).collect();
        let lines: Vec<Segment> = at.windows(2).map(|pair| (pair[0], pair[1])).collect();
        let placed = place(&labels, Obstacles { points: &points, lines: &lines, bars: &[] }, BOUNDS);
        let leaders: Vec<Segment> =
            at.iter().zip(&placed).filter_map(|(&at, rect)| leader(at, rect)).collect();
        assert!(!leaders.is_empty());
        for rect in &placed {
            assert!(!lines.iter().chain(&leaders).any(|&line| rect.is_crossed(line)), "{rect:?}");
        }
    }

    #[test]
    fn a_figure_that_is_no_number_ends_nothing() {
        let label = Label { at: (f64::NAN, 50.0), size: (40.0, 10.0) };
        let nowhere = place(&[label], Obstacles::default(), BOUNDS)[0];
        assert_eq!(nowhere.nearest((1.0, f64::INFINITY)), (1.0, nowhere.y + nowhere.height));
    }
}

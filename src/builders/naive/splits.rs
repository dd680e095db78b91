//! Object and spatial splits by their definitions.

use crate::builders::split::cost::Weight;
use crate::geometry::Aabb;

/// The members of the left side of the object split of least cost (paper 4.2, equation 1).
pub struct Object {
    pub cost: f32,
    pub is_left: Vec<bool>,
}

/// Sweeps along all three axes over the members sorted by centroid, each of which counts as many as `counts` says.
/// `None` if nothing is gained.
pub fn object(boxes: &[Aabb], counts: &[usize], weight: Weight) -> Option<Object> {
    let n = boxes.len();
    let all: usize = counts.iter().sum();
    let mut least = weight.limit(union(boxes).half_area(), all);
    let mut best = None;
    for axis in 0..3 {
        let center = |i: usize| boxes[i].min[axis] + boxes[i].max[axis];
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| center(a).partial_cmp(&center(b)).expect("centroids are finite"));
        let sorted: Vec<Aabb> = order.iter().map(|&i| boxes[i]).collect();
        let left = unions(sorted.iter());
        let right = unions(sorted.iter().rev());
        for i in 1..n {
            let on_left = order[..i].iter().map(|&member| counts[member]).sum::<usize>();
            let cost = left[i].half_area() * weight.of(on_left)
                + right[n - i].half_area() * weight.of(all - on_left);
            if cost < least {
                least = cost;
                let mut is_left = vec![false; n];
                order[..i].iter().for_each(|&member| is_left[member] = true);
                best = Some(Object { cost, is_left });
            }
        }
    }
    best
}

/// The unions of the first 0, 1, 2, ... boxes.
pub(crate) fn unions<'a>(boxes: impl Iterator<Item = &'a Aabb>) -> Vec<Aabb> {
    let mut all = vec![Aabb::EMPTY];
    for bounds in boxes {
        all.push(all[all.len() - 1].union(*bounds));
    }
    all
}

fn union(boxes: &[Aabb]) -> Aabb {
    boxes.iter().copied().collect()
}

/// A plane normal to an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    pub axis: usize,
    pub at: f32,
}

impl Plane {
    /// Both sides of a box, either of which may be empty.
    pub fn sides(&self, bounds: Aabb) -> [Aabb; 2] {
        let (mut left, mut right) = (bounds, bounds);
        left.max[self.axis] = bounds.max[self.axis].min(self.at);
        right.min[self.axis] = bounds.min[self.axis].max(self.at);
        [left, right]
    }

    /// The parts of a box on both sides. What lies in the plane is on the left.
    pub fn cut(&self, bounds: Aabb) -> [Option<Aabb>; 2] {
        let (min, max) = (bounds.min[self.axis], bounds.max[self.axis]);
        let [left, right] = self.sides(bounds);
        [(min < self.at || max <= self.at).then_some(left), (max > self.at).then_some(right)]
    }
}

/// The spatial split of least cost (paper 4.4, equation 3): at every boundary of every box, all boxes are cut and
/// the parts on each side merged. `None` if there is no plane.
///
/// The union of the parts on a side is that side of the union of their boxes, to the bit: both take the same least
/// and largest coordinates. The boxes on a side are the first ones of an order, whose unions are found once.
pub fn spatial(boxes: &[Aabb], counts: &[usize], weight: Weight) -> Option<(f32, Plane)> {
    let bounds = union(boxes);
    let mut best: Option<(f32, Plane)> = None;
    for axis in 0..3 {
        let mut planes: Vec<f32> = boxes.iter().flat_map(|b| [b.min[axis], b.max[axis]]).collect();
        planes.retain(|&at| bounds.min[axis] < at && at < bounds.max[axis]);
        planes.sort_by(f32::total_cmp);
        planes.dedup();
        let left = FirstOf::new(boxes, counts, |b| [b.min[axis], b.max[axis]]);
        let right = FirstOf::new(boxes, counts, |b| [-b.max[axis], -b.min[axis]]);
        for at in planes {
            let plane = Plane { axis, at };
            let cost = left.cost(&plane, 0, weight) + right.cost(&plane, 1, weight);
            if boxes.len() <= BY_DEFINITION {
                assert_eq!(cost, plane.cost(boxes, counts, weight), "{plane:?}");
            }
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, plane));
            }
        }
    }
    best
}

/// So many boxes are cut at every plane; their number times that of planes would take long for more.
const BY_DEFINITION: usize = 100;

/// Boxes in an order, their unions and how many the first 0, 1, 2, ... count together.
struct FirstOf {
    boxes: Vec<Aabb>,
    unions: Vec<Aabb>,
    counted: Vec<usize>,
}

impl FirstOf {
    fn new(boxes: &[Aabb], counts: &[usize], key: impl Fn(&Aabb) -> [f32; 2]) -> Self {
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        order.sort_by(|&a, &b| key(&boxes[a]).partial_cmp(&key(&boxes[b])).expect("planes are finite"));
        let boxes: Vec<Aabb> = order.iter().map(|&i| boxes[i]).collect();
        let unions = unions(boxes.iter());
        let mut counted = vec![0];
        order.iter().for_each(|&i| counted.push(counted[counted.len() - 1] + counts[i]));
        Self { boxes, unions, counted }
    }

    /// What the parts on a side of a plane cost.
    fn cost(&self, plane: &Plane, side: usize, weight: Weight) -> f32 {
        let first = self.boxes.partition_point(|b| plane.cut(*b)[side].is_some());
        // A plane inside the union has something on both sides.
        assert!(self.counted[first] > 0);
        plane.sides(self.unions[first])[side].half_area() * weight.of(self.counted[first])
    }
}

impl Plane {
    /// What both sides cost by the definition.
    fn cost(&self, boxes: &[Aabb], counts: &[usize], weight: Weight) -> f32 {
        let mut sides = [Aabb::EMPTY; 2];
        let mut counted = [0; 2];
        for (bounds, count) in boxes.iter().zip(counts) {
            for (side, part) in self.cut(*bounds).into_iter().enumerate() {
                if let Some(part) = part {
                    sides[side] = sides[side].union(part);
                    counted[side] += count;
                }
            }
        }
        sides[0].half_area() * weight.of(counted[0]) + sides[1].half_area() * weight.of(counted[1])
    }
}

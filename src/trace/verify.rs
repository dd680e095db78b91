//! Compares the answers of two tracers: both hit or both miss, distances within 1e-5, the same triangle or
//! another one at the same distance. Differences that rounding explains ([`oracle`](super::oracle)) are
//! counted separately, and too many of them fail a benchmark; any other is a [`Mismatch`].

use super::oracle::{Crossing, Model, T_TOLERANCE};
use crate::geometry::{Hit, Mesh, Ray, Tracer};
use rayon::prelude::*;

/// Two answers to one ray that rounding does not explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// Index of the ray in its batch.
    pub ray: usize,
    /// Hit of the reference. For any-hit queries: the hit in question if it says "occluded", else a miss;
    /// a miss on both sides if one says "occluded" although nothing is there.
    pub reference: Hit,
    /// Hit of the tracer under test, likewise.
    pub hit: Hit,
}

impl std::fmt::Display for Mismatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let name = |hit: Hit| {
            if hit.is_hit() { format!("triangle {} at {:e}", hit.prim, hit.t) } else { "nothing".to_owned() }
        };
        if !self.reference.is_hit() && !self.hit.is_hit() {
            return write!(f, "ray {}: called occluded by one, but nothing is there", self.ray);
        }
        write!(f, "ray {}: reference hit {}, not {}", self.ray, name(self.reference), name(self.hit))
    }
}

/// How a batch of answers compares with the reference's. Every ray is in exactly one of the counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// Rays compared.
    pub rays: usize,
    /// The same triangle within 1e-5 of the distance, or both a miss.
    pub equal: usize,
    /// The same distance but another triangle, which also lies there: coplanar or adjacent faces.
    pub ties: usize,
    /// Only rounding decides: the nearer hit (or the only one) is in the band along its triangle's border,
    /// at an end of the ray's interval, or at grazing incidence, or its triangle has no area but that band.
    pub edge: usize,
    /// Exact arithmetic finds one answer wrong by more than that, but single precision gives it: the computed normal
    /// of a thin triangle is off, or of one without area is a mere rounding error.
    pub near_misses: usize,
    /// Everything else.
    pub mismatched: usize,
    /// The first [`Verdict::KEPT`] mismatches, in order of rays.
    pub mismatches: Vec<Mismatch>,
}

impl Verdict {
    /// Mismatches kept as examples.
    pub const KEPT: usize = 256;

    /// True if no answer is wrong.
    pub fn is_ok(&self) -> bool {
        self.mismatched == 0
    }

    /// The verdict on both batches together; ray indices of `other` continue after this one's.
    #[must_use]
    pub fn and(mut self, other: &Self) -> Self {
        let shifted = other.mismatches.iter().map(|m| Mismatch { ray: m.ray + self.rays, ..*m });
        self.mismatches.extend(shifted);
        self.mismatches.truncate(Self::KEPT);
        self.rays += other.rays;
        self.equal += other.equal;
        self.ties += other.ties;
        self.edge += other.edge;
        self.near_misses += other.near_misses;
        self.mismatched += other.mismatched;
        self
    }
}

/// Largest share of the rays that may differ at an edge or be a near miss, where triangles are tested by the
/// reference's arithmetic.
pub const SAME_TEST: f64 = 1e-4;
/// The same where they are tested otherwise: somewhat above the 1.4e-3 of rays that bounce by which Embree's two tests
/// differ (bodo_arch, AVX2).
pub const OTHER_TEST: f64 = 2e-3;

/// Why answers to `rays` rays cannot be accepted although none is wrong: `edges` differ where only rounding decides,
/// `near_misses` on thin triangles, more than the share `excused` together, rounded up to whole rays.
pub fn excess(rays: u64, edges: u64, near_misses: u64, excused: f64) -> Option<String> {
    let most = (excused * rays as f64).ceil() as u64;
    (edges + near_misses > most).then(|| {
        format!(
            "{edges} answers differ at edges, {near_misses} on thin triangles, of {rays}: more than {most}"
        )
    })
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { rays, equal, ties, edge, near_misses, mismatched, .. } = self;
        write!(f, "{rays} rays: {equal} equal, {ties} ties, {edge} at edges, {near_misses} near misses, ")?;
        write!(f, "{mismatched} mismatches")?;
        self.mismatches.first().map_or(Ok(()), |first| write!(f, " ({first})"))
    }
}

#[derive(PartialEq, Eq)]
enum Class {
    Equal,
    Tie,
    Edge,
    NearMiss,
    Mismatch,
}

/// Rays a thread compares at once.
const CHUNK: usize = 1 << 14;

/// Classifies every ray with `class`, in parallel, keeping the order.
fn verdict(rays: &[Ray], class: impl Fn(usize) -> (Class, Hit, Hit) + Sync) -> Verdict {
    let parts: Vec<Verdict> = (0..rays.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let first = chunk * CHUNK;
            let mut part = Verdict { rays: CHUNK.min(rays.len() - first), ..Verdict::default() };
            for ray in 0..part.rays {
                let (class, reference, hit) = class(first + ray);
                match class {
                    Class::Equal => part.equal += 1,
                    Class::Tie => part.ties += 1,
                    Class::Edge => part.edge += 1,
                    Class::NearMiss => part.near_misses += 1,
                    Class::Mismatch => {
                        part.mismatched += 1;
                        if part.mismatches.len() < Verdict::KEPT {
                            part.mismatches.push(Mismatch { ray, reference, hit });
                        }
                    }
                }
            }
            part
        })
        .collect();
    parts.iter().fold(Verdict::default(), Verdict::and)
}

/// Compares closest hits of `rays` with those of a reference.
///
/// # Panics
/// If the slices differ in length.
pub fn compare_closest(mesh: &Mesh, rays: &[Ray], reference: &[Hit], hits: &[Hit]) -> Verdict {
    assert!(rays.len() == reference.len() && rays.len() == hits.len(), "one hit per ray on both sides");
    verdict(rays, |i| {
        let class = judged(|model| classify(mesh, &rays[i], &reference[i], &hits[i], model));
        (class, reference[i], hits[i])
    })
}

/// The class by rounded coordinates alone; a near miss if only the errors on thin triangles explain the difference.
fn judged(class: impl Fn(Model) -> Class) -> Class {
    match class(Model::RoundedCoordinates) {
        Class::Mismatch if class(Model::ThinTriangles) != Class::Mismatch => Class::NearMiss,
        class => class,
    }
}

/// The order of arguments does not matter. A hit whose distance is infinite or NaN is none: in scenes of some 1e13 the
/// products of the test overflow, in Embree's as in ours, and of such hits all are as near.
fn classify(mesh: &Mesh, ray: &Ray, a: &Hit, b: &Hit, model: Model) -> Class {
    let (a, b) = (&a.measured(), &b.measured());
    let (near, far) = if a.t <= b.t || !b.is_hit() { (a, b) } else { (b, a) };
    if !near.is_hit() {
        return if far.is_hit() { Class::Mismatch } else { Class::Equal };
    }
    // One or both hit something. Is it there?
    let same_distance =
        far.is_hit() && f64::from(far.t) - f64::from(near.t) <= T_TOLERANCE * f64::from(near.t);
    if same_distance && near.prim == far.prim {
        return Class::Equal;
    }
    let crossing =
        |hit: &Hit| Crossing::new(mesh, hit.prim, ray, model).filter(|crossing| crossing.allows(hit.t));
    let Some(nearer) = crossing(near) else { return Class::Mismatch };
    let farther = crossing(far);
    if far.is_hit() && farther.is_none() {
        return Class::Mismatch;
    }
    if same_distance {
        return Class::Tie;
    }
    // May the nearer one be missed, or found as far away as the other? Where nothing bounds the other's distance, it
    // counts as reported: no distance of its own excuses that a nearer, certain hit was passed over.
    let blurred = farther.is_some_and(|farther| {
        let from = if farther.t_slack.is_finite() { farther.t - farther.t_slack } else { far.t.into() };
        from <= nearer.t + nearer.t_slack
    });
    if blurred || !nearer.is_certain() { Class::Edge } else { Class::Mismatch }
}

/// Compares any-hit answers. A dispute is settled by `witness`, the closest hit of a ray by a tracer that
/// sees what the tracers compared see ([`witness`] makes one of both): it is asked again behind each hit that
/// rounding may hide, until a certain hit shows that "not occluded" is wrong, or none is left.
///
/// # Panics
/// If the slices differ in length.
pub fn compare_any(
    mesh: &Mesh,
    rays: &[Ray],
    reference: &[bool],
    occluded: &[bool],
    witness: impl Fn(&Ray) -> Hit + Sync,
) -> Verdict {
    assert!(
        rays.len() == reference.len() && rays.len() == occluded.len(),
        "one answer per ray on both sides"
    );
    verdict(rays, |i| {
        if reference[i] == occluded[i] {
            return (Class::Equal, Hit::MISS, Hit::MISS);
        }
        let settled = |model| settle(mesh, &rays[i], &witness, model);
        let (class, hit) = (judged(|model| settled(model).0), settled(Model::RoundedCoordinates).1);
        if reference[i] { (class, hit, Hit::MISS) } else { (class, Hit::MISS, hit) }
    })
}

/// Whether a ray may be called occluded as well as not, and the hit that says so.
fn settle(mesh: &Mesh, ray: &Ray, witness: impl Fn(&Ray) -> Hit, model: Model) -> (Class, Hit) {
    /// Faces in a row that a ray may graze; more is no rounding error.
    const PATIENCE: usize = 64;
    let mut rest = *ray;
    let mut last = None;
    for _ in 0..PATIENCE {
        let hit = witness(&rest);
        if !hit.is_hit() {
            // Without any hit, "occluded" was wrong.
            return last.map_or((Class::Mismatch, Hit::MISS), |hit| (Class::Edge, hit));
        }
        let crossing = Crossing::new(mesh, hit.prim, ray, model).filter(|crossing| crossing.allows(hit.t));
        if crossing.is_none_or(|crossing| crossing.is_certain()) {
            return (Class::Mismatch, hit);
        }
        last = Some(hit);
        // Strictly behind it: another triangle at the very same distance is not asked for.
        rest.tnear = hit.t.max(rest.tnear.next_up());
    }
    (Class::Mismatch, Hit::MISS)
}

/// A witness for [`compare_any`]: the closest hit that any of `tracers` sees.
pub fn witness<'a>(tracers: &'a [&'a dyn Tracer]) -> impl Fn(&Ray) -> Hit + Sync + 'a {
    move |ray| {
        let mut closest = Hit::MISS;
        for tracer in tracers {
            let mut hit = [Hit::MISS];
            tracer.closest(std::slice::from_ref(ray), &mut hit);
            if hit[0].t < closest.t {
                closest = hit[0];
            }
        }
        closest
    }
}

/// A hash of the hits' distances, in order, each cut to its 12 leading bits of mantissa; triangles do not
/// count, as they differ on coplanar faces. Equal for repeated runs of the same kernel over the same tree,
/// and mostly for kernels that agree to the last bits.
///
/// Its weakness: whatever the rounding, some distances lie at its steps. Two correct tracers whose distances
/// differ by an ulp disagree on about one ray in two thousand, so that unequal hashes prove nothing by
/// themselves; [`compare_closest`] does.
pub fn hit_hash(hits: &[Hit]) -> u64 {
    const DROPPED: u32 = 11;
    hits.iter().fold(0xcbf2_9ce4_8422_2325, |hash: u64, hit| {
        // Rounded to nearest, so that 1 and the number just below it agree.
        let bits =
            if hit.is_hit() { hit.t.to_bits().wrapping_add(1 << (DROPPED - 1)) >> DROPPED } else { u32::MAX };
        let mixed = (hash ^ u64::from(bits)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ (mixed >> 29)
    })
}

/// Number of hits that have a distance.
pub fn hit_count(hits: &[Hit]) -> usize {
    hits.iter().filter(|hit| hit.measured().is_hit()).count()
}

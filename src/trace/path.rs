//! The path tracer whose rays are recorded, after the paper's trace-time program (Embree's path tracer):
//! diffuse surfaces, one shadow ray per vertex, at most eight segments, no Russian roulette, a path ends
//! when less than 1 % of its light is left. Tiles run in parallel; within a tile all paths advance segment by
//! segment, so that a tracer gets whole batches.

use super::lights::Lights;
use super::pixel_random::PixelRandom;
use super::{Camera, Image, RayBatches, RayKind};
use crate::geometry::{Hit, Mesh, Ray, Tracer};
use crate::scene::View;
use glam::Vec3;
use rayon::prelude::*;

/// How a frame is traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PathSettings {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Most segments of a path, the one from the camera included.
    pub max_depth: u32,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for PathSettings {
    /// As in the paper: 1024 x 1024 pixels, eight segments.
    fn default() -> Self {
        Self { width: 1024, height: 1024, max_depth: 8, seed: 1 }
    }
}

/// A recorded frame.
#[derive(Clone, Debug)]
pub struct Recording {
    /// All rays that were traced.
    pub batches: RayBatches,
    /// The rendered image.
    pub image: Image,
    /// Rays left out because Embree does not accept them ([`Ray::is_valid`]); their paths ended there.
    pub invalid: usize,
}

/// Traces a frame of `view` and keeps its rays. Image and rays do not depend on the number of threads.
pub fn record(tracer: &dyn Tracer, mesh: &Mesh, view: &View, settings: &PathSettings) -> Recording {
    let (image, tiles) = frame::<RayBatches>(tracer, mesh, view, settings);
    let mut batches = RayBatches::default();
    for kind in RayKind::ALL {
        batches.get_mut(kind).reserve_exact(tiles.iter().map(|tile| tile.rays.get(kind).len()).sum());
    }
    let mut invalid = 0;
    for tile in tiles {
        for kind in RayKind::ALL {
            batches.get_mut(kind).extend_from_slice(tile.rays.get(kind));
        }
        invalid += tile.invalid;
    }
    Recording { batches, image, invalid }
}

/// Traces a frame of `view`, one sample per pixel, on the current rayon pool.
pub fn render(tracer: &dyn Tracer, mesh: &Mesh, view: &View, settings: &PathSettings) -> Image {
    frame::<()>(tracer, mesh, view, settings).0
}

/// Records the rays as they are traced, or ignores them.
trait RaySink: Default + Send {
    fn take(&mut self, kind: RayKind, rays: &[Ray]);
}

impl RaySink for () {
    fn take(&mut self, _: RayKind, _: &[Ray]) {}
}

impl RaySink for RayBatches {
    fn take(&mut self, kind: RayKind, rays: &[Ray]) {
        self.get_mut(kind).extend_from_slice(rays);
    }
}

/// Pixels per tile edge.
const TILE: u32 = 32;
/// Light that a surface reflects.
const ALBEDO: Vec3 = Vec3::new(0.72, 0.7, 0.67);
/// Throughput below which a path ends.
const DARK: f32 = 0.01;

/// All tiles of a frame, in order, and the image put together from them.
fn frame<S: RaySink>(
    tracer: &dyn Tracer,
    mesh: &Mesh,
    view: &View,
    settings: &PathSettings,
) -> (Image, Vec<Tile<S>>) {
    let scene = Scene {
        tracer,
        mesh,
        camera: Camera::new(view, settings.width, settings.height),
        lights: Lights::new(tracer, view),
        settings: *settings,
    };
    let (columns, rows) = (settings.width.div_ceil(TILE), settings.height.div_ceil(TILE));
    let mut tiles: Vec<Tile<S>> = (0..columns * rows)
        .into_par_iter()
        .map(|tile| scene.trace_tile(tile % columns * TILE, tile / columns * TILE))
        .collect();
    let mut image = Image::new(settings.width, settings.height);
    for tile in &mut tiles {
        for (pixel, radiance) in std::mem::take(&mut tile.pixels) {
            image.rgb[pixel as usize] = radiance.into();
        }
    }
    (image, tiles)
}

struct Tile<S> {
    /// Pixel index and radiance.
    pixels: Vec<(u32, Vec3)>,
    rays: S,
    invalid: usize,
}

/// A path under way.
#[derive(Clone, Copy)]
struct Path {
    /// Index into the tile's pixels.
    slot: u32,
    random: PixelRandom,
    throughput: Vec3,
}

struct Scene<'a> {
    tracer: &'a dyn Tracer,
    mesh: &'a Mesh,
    camera: Camera,
    lights: Lights,
    settings: PathSettings,
}

impl Scene<'_> {
    /// Traces the paths of the tile whose upper left pixel is (`left`, `top`).
    fn trace_tile<S: RaySink>(&self, left: u32, top: u32) -> Tile<S> {
        let PathSettings { width, height, max_depth, seed } = self.settings;
        let mut tile = Tile { pixels: Vec::new(), rays: S::default(), invalid: 0 };
        let mut wave = Wave::default();
        for y in top..(top + TILE).min(height) {
            for x in left..(left + TILE).min(width) {
                let pixel = y * width + x;
                let random = PixelRandom::new(seed, pixel);
                let slot = tile.pixels.len() as u32;
                tile.pixels.push((pixel, Vec3::ZERO));
                let ray = self.camera.ray(x, y, random.pair(0));
                wave.push(Path { slot, random, throughput: Vec3::ONE }, ray, &mut tile.invalid);
            }
        }
        let mut hits = Vec::new();
        let mut occluded = Vec::new();
        for segment in 0..max_depth {
            if wave.rays.is_empty() {
                break;
            }
            // Where do the paths go?
            let kind = if segment == 0 { RayKind::Primary } else { RayKind::Bounce };
            tile.rays.take(kind, &wave.rays);
            hits.clear();
            hits.resize(wave.rays.len(), Hit::MISS);
            self.tracer.closest(&wave.rays, &mut hits);
            // Which light could reach them there, and where do they go next?
            let (mut shadows, mut next) = (Wave::default(), Wave::default());
            for ((path, ray), hit) in wave.paths.iter().zip(&wave.rays).zip(&hits) {
                if !hit.is_hit() {
                    tile.pixels[path.slot as usize].1 += path.throughput * self.lights.sky(ray.dir);
                    continue;
                }
                let Some(surface) = Surface::new(self.mesh, ray, hit) else { continue };
                self.scatter(segment, path, &surface, &mut shadows, &mut next, &mut tile.invalid);
            }
            // Does it?
            tile.rays.take(RayKind::Shadow, &shadows.rays);
            occluded.clear();
            occluded.resize(shadows.rays.len(), false);
            self.tracer.any(&shadows.rays, &mut occluded);
            for (path, occluded) in shadows.paths.iter().zip(&occluded) {
                if !occluded {
                    tile.pixels[path.slot as usize].1 += path.throughput;
                }
            }
            wave = next;
        }
        tile
    }

    /// Sends the shadow ray and the bounce of one path's vertex.
    fn scatter(
        &self,
        segment: u32,
        path: &Path,
        surface: &Surface,
        shadows: &mut Wave,
        next: &mut Wave,
        invalid: &mut usize,
    ) {
        let dimension = 4 * segment;
        let [choice, _] = path.random.pair(dimension + 1);
        let on_lamp = on_sphere(path.random.pair(dimension + 2));
        let reflected = path.throughput * ALBEDO;
        if let Some(light) = self.lights.sample(surface.point, choice, on_lamp) {
            let cosine = surface.normal.dot(light.dir);
            if cosine > 0.0 {
                let throughput = reflected * light.irradiance * (cosine / std::f32::consts::PI);
                let ray = Ray { org: surface.point, tnear: 0.0, dir: light.dir, tfar: light.distance };
                shadows.push(Path { throughput, ..*path }, ray, invalid);
            }
        }
        // The last segment's bounce would not be traced.
        if segment + 1 < self.settings.max_depth && reflected.max_element() >= DARK {
            let toward = surface.normal + on_sphere(path.random.pair(dimension + 3));
            let dir = toward.try_normalize().unwrap_or(surface.normal);
            let ray = Ray { org: surface.point, tnear: 0.0, dir, tfar: f32::INFINITY };
            next.push(Path { throughput: reflected, ..*path }, ray, invalid);
        }
    }
}

/// Paths and their rays, in the same order.
#[derive(Default)]
struct Wave {
    paths: Vec<Path>,
    rays: Vec<Ray>,
}

impl Wave {
    /// Adds a ray, or counts it if it is invalid.
    fn push(&mut self, path: Path, ray: Ray, invalid: &mut usize) {
        if ray.is_valid() {
            self.paths.push(path);
            self.rays.push(ray);
        } else {
            *invalid += 1;
        }
    }
}

/// Where rays leave a surface: just off the triangle, on the side they came from.
struct Surface {
    point: Vec3,
    /// Unit normal towards the ray's origin.
    normal: Vec3,
}

impl Surface {
    /// `None` if the triangle has no normal (its corners are on a line in double precision).
    fn new(mesh: &Mesh, ray: &Ray, hit: &Hit) -> Option<Self> {
        let corners = mesh.corners(hit.prim).map(|corner| corner.as_dvec3());
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize()?.as_vec3();
        let normal = if normal.dot(ray.dir) > 0.0 { -normal } else { normal };
        let travelled = hit.t * ray.dir;
        let point = ray.org + travelled;
        // A hundred times the rounding error of the point, so that the ray does not meet its own triangle.
        let offset = 1e-5 * point.abs().max(ray.org.abs()).max(travelled.abs()).max_element();
        Some(Self { point: point + offset * normal, normal })
    }
}

/// The point of the unit sphere for two numbers in [0, 1).
fn on_sphere([a, b]: [f32; 2]) -> Vec3 {
    let z = 1.0 - 2.0 * a;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (std::f32::consts::TAU * b).sin_cos();
    Vec3::new(radius * cos, radius * sin, z)
}

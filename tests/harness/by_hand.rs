//! What all rows made by hand say.

use phr::bench::row::{ALL, FRESH, Row, SCHEMA};

/// A verified row of a 4-wide tree with two threads and a million rays, without times.
pub fn row(scene: &str, builder: &str, kernel: &str) -> Row {
    Row {
        schema: SCHEMA,
        run_id: "by-hand".into(),
        utc: "2026-01-02T03:04:05Z".into(),
        git_rev: "0123456789ab".into(),
        scene: scene.into(),
        scene_sha: format!("sha of {scene}"),
        triangles: 331_000,
        builder: builder.into(),
        engine: "made 1.0".into(),
        width: 4,
        threads: 2,
        regime: FRESH.into(),
        rounds: 4,
        view: ALL.into(),
        kernel: kernel.into(),
        ray_kind: ALL.into(),
        rays: Some(1_000_000),
        verified: Some(true),
        ..Row::default()
    }
}

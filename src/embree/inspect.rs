//! Embree's report of a build: an untimed commit with `verbose=2`, whose output is parsed and checked.
//!
//! Unknown keys of a device string are skipped without an error and some combinations run another builder
//! than the one named, so the harness trusts only the printed name.

use super::{Config, Device, EmbreeBuilder, EmbreeError, Prepared, capture};
use crate::geometry::Mesh;

/// A build as Embree reports it. For a mesh without triangles nothing is built: names are "none" and all
/// numbers 0.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Inspection {
    /// The builder's class, e.g. "avx::BVH4BuilderSAH".
    pub builder: String,
    /// Tree and leaf type, e.g. `BVH4<triangle4>`.
    pub accel: String,
    /// The kernel of `rtcIntersect1`, e.g. "avx2::BVH4Triangle4Intersector1Moeller".
    pub intersector: String,
    /// SAH cost with unit weights and leaves counted in blocks of four, six digits.
    pub sah: f64,
    /// Bytes of nodes and leaves.
    pub bytes: u64,
    /// Inner levels.
    pub depth: u64,
    /// Inner nodes.
    pub nodes: u64,
    /// Leaves.
    pub leaves: u64,
    /// Share of the inner nodes' slots that is used, 0 to 1.
    pub node_fill: f64,
    /// Share of the leaf blocks' lanes that is used, 0 to 1.
    pub leaf_fill: f64,
    /// Share of the leaves with 1, 2, ... 8 blocks, 0 to 1.
    pub leaf_blocks: [f64; 8],
    /// The compiler that made the library, e.g. "GCC 12.2.0".
    pub compiler: String,
    /// The tasking system, e.g. "TBB2021.5 TBB_header_interface_12050 TBB_lib_interface_12080".
    pub tasking: String,
    /// Instruction sets in use for kernels.
    pub targets: String,
}

/// Builds `mesh` once, with `verbose=2`, and returns Embree's report. Takes the process's standard output
/// for the time of the build.
///
/// # Errors
/// [`EmbreeError::WrongBuilder`] if another builder or accel ran than `config` asks for, and those of
/// [`Device::new`], [`Device::prepare`] and [`Prepared::commit`].
pub fn inspect(mesh: &Mesh, config: &Config) -> Result<Inspection, EmbreeError> {
    let (inspection, output) = inspect_device(mesh, &config.device_string(), |_| ())?;
    if !mesh.is_empty() {
        verify(config, &inspection, &output)?;
    }
    Ok(inspection)
}

/// Whether the accel, the builder's class and the builder's name as Embree understood it are those asked for.
/// The name matters for Morton: that builder works per geometry, under a two-level builder that SAH shares.
fn verify(config: &Config, inspection: &Inspection, output: &str) -> Result<(), EmbreeError> {
    let lanes = config.width.lanes();
    let class = match config.builder {
        EmbreeBuilder::Morton => "TwoLevel",
        EmbreeBuilder::Sah => "SAH",
        EmbreeBuilder::FastSpatial => "FastSpatialSAH",
    };
    let report = |accel: &str, class: &str, name: &str| format!("{accel} by {class} (tri_builder={name})");
    let wanted = report(
        &format!("BVH{lanes}<triangle4>"),
        &format!("BVH{lanes}Builder{class}"),
        config.builder.option(),
    );
    let class = inspection.builder.rsplit("::").next().unwrap_or_default();
    let name = section(output, "triangles:").and_then(|lines| value(lines, "builder", '='));
    let found = report(&inspection.accel, class, name.unwrap_or("unknown"));
    if found == wanted { Ok(()) } else { Err(EmbreeError::WrongBuilder { wanted, found }) }
}

/// Builds with any device string, `adjust` setting the scene up; returns the inspection and all output.
fn inspect_device(
    mesh: &Mesh,
    device: &str,
    adjust: impl FnOnce(&mut Prepared<'_>),
) -> Result<(Inspection, String), EmbreeError> {
    // `benchmark=1` prints the cost with six digits.
    let device = format!("{device},verbose=2,benchmark=1");
    let (result, output) = capture::stdout_of(|| {
        let device = Device::from_string(device)?;
        let mut prepared = device.prepare(mesh)?;
        adjust(&mut prepared);
        prepared.commit().map(drop)
    })?;
    result?;
    let inspection = parse(&output, mesh.is_empty())?;
    Ok((inspection, output))
}

fn parse(output: &str, nothing_built: bool) -> Result<Inspection, EmbreeError> {
    let must = |what: &'static str, found: Option<&str>| {
        found.map(str::to_owned).ok_or(EmbreeError::Unreadable(what))
    };
    let mut inspection = Inspection {
        builder: "none".to_owned(),
        accel: "none".to_owned(),
        intersector: must("intersector1", value(output, "intersector1", '='))?,
        sah: 0.0,
        bytes: 0,
        depth: 0,
        nodes: 0,
        leaves: 0,
        node_fill: 0.0,
        leaf_fill: 0.0,
        leaf_blocks: [0.0; 8],
        compiler: must("compiler", value(output, "Compiler", ':'))?,
        tasking: must("tasking", value(output, "Tasking", ':'))?,
        targets: must("targets", value(output, "Targets", ':'))?,
    };
    if nothing_built {
        return Ok(inspection);
    }
    let building = output.lines().find_map(|line| line.strip_prefix("building ")?.strip_suffix(" ..."));
    let (accel, builder) =
        building.and_then(|line| line.split_once(" using ")).ok_or(EmbreeError::Unreadable("builder"))?;
    inspection.accel = accel.to_owned();
    inspection.builder = builder.to_owned();

    let record = output.lines().find_map(|line| line.strip_prefix("BENCHMARK_BUILD "));
    let mut numbers = record.unwrap_or_default().split_whitespace().skip(2);
    inspection.sah = number("SAH cost", numbers.next())?;
    inspection.bytes = number("bytes", numbers.next())?;

    let depth = output.lines().find(|line| line.trim_start().starts_with("primitives = "));
    inspection.depth = number("depth", depth.and_then(|line| after(line, "depth = ")))?;
    let leaves = row(output, "leaves").ok_or(EmbreeError::Unreadable("leaves"))?;
    inspection.leaves = number("leaves", after(leaves, "#nodes = "))?;
    inspection.leaf_fill = fill(leaves)?;
    // A root that is a leaf has no line of inner nodes.
    if let Some(inner) = row(output, "getAABBNodes") {
        inspection.nodes = number("nodes", after(inner, "#nodes = "))?;
        inspection.node_fill = fill(inner)?;
    }
    let histogram = row(output, "histogram").ok_or(EmbreeError::Unreadable("histogram"))?;
    let shares = histogram.split('%').map(str::trim).filter(|share| !share.is_empty());
    for (slot, share) in inspection.leaf_blocks.iter_mut().zip(shares) {
        *slot = number::<f64>("histogram", Some(share))? / 100.0;
    }
    Ok(inspection)
}

/// The rest of the first line `key : rest`.
fn row<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    value(text, key, ':')
}

/// The value of the first line `key <separator> value`.
fn value<'a>(text: &'a str, key: &str, separator: char) -> Option<&'a str> {
    text.lines().find_map(|line| {
        let (name, value) = line.split_once(separator)?;
        (name.trim() == key).then(|| value.trim())
    })
}

/// The text after the line `title`.
fn section<'a>(text: &'a str, title: &str) -> Option<&'a str> {
    text.find(&format!("\n{title}\n")).map(|start| &text[start + title.len() + 2..])
}

/// The word after `label`; blanks between are padding.
fn after<'a>(line: &'a str, label: &str) -> Option<&'a str> {
    let start = line.find(label)? + label.len();
    line[start..].split_whitespace().next()
}

/// `... ( 70.58% filled) ...` as 0.7058.
fn fill(line: &str) -> Result<f64, EmbreeError> {
    let share = line.split_once("% filled").and_then(|(before, _)| before.rsplit('(').next());
    Ok(number::<f64>("fill", share.map(str::trim))? / 100.0)
}

fn number<T: std::str::FromStr>(what: &'static str, text: Option<&str>) -> Result<T, EmbreeError> {
    text.and_then(|text| text.parse().ok()).ok_or(EmbreeError::Unreadable(what))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embree::Width;
    use crate::embree::test_meshes::soup;
    use embree_sys as sys;

    #[test]
    fn each_builder_runs_at_each_width() {
        let mesh = soup(3000);
        for width in Width::ALL {
            for builder in EmbreeBuilder::ALL {
                let config = Config { builder, width, threads: 2 };
                let inspection = inspect(&mesh, &config).unwrap();
                assert!(inspection.sah > 1.0 && inspection.leaves >= 750, "{inspection:?}");
                let node_bytes = 32 * width.lanes() as u64;
                let blocks: f64 = (1..).zip(inspection.leaf_blocks).map(|(n, share)| n as f64 * share).sum();
                let bytes =
                    (node_bytes * inspection.nodes) as f64 + 176.0 * blocks * inspection.leaves as f64;
                assert!((bytes / inspection.bytes as f64 - 1.0).abs() < 1e-3, "{bytes}: {inspection:?}");
                let morton = builder == EmbreeBuilder::Morton;
                assert!(!morton || inspection.leaf_blocks[0] == 1.0, "{inspection:?}");
            }
        }
    }

    #[test]
    fn a_changed_scene_is_built_again_as_before() {
        let mesh = soup(3000);
        let configs = Width::ALL.into_iter().flat_map(|width| {
            EmbreeBuilder::ALL.map(|builder| Config { builder, width, threads: 2 }.device_string())
        });
        for (device, is_dynamic) in configs.flat_map(|device| [(device.clone(), false), (device, true)]) {
            let (built, output) = capture::stdout_of(|| {
                let device = Device::from_string(format!("{device},verbose=2,benchmark=1"))?;
                let prepared = device.prepare(&mesh)?;
                let prepared = if is_dynamic { prepared.dynamic() } else { prepared };
                prepared.commit()?.modified()?.commit().map(drop)
            })
            .unwrap();
            built.unwrap();
            // The seconds differ, cost, bytes and tree do not.
            let records = output.lines().filter_map(|line| line.strip_prefix("BENCHMARK_BUILD "));
            let trees: Vec<Vec<&str>> =
                records.map(|record| record.split_whitespace().skip(2).collect()).collect();
            assert_eq!(trees.len(), 2, "{output}");
            assert_eq!(trees[0][0], trees[1][0], "{device}: {output}");
        }
    }

    #[test]
    fn the_forced_8_wide_tree_is_the_default_one() {
        let mesh = soup(5000);
        for (builder, quality) in [
            (EmbreeBuilder::Sah, sys::RTC_BUILD_QUALITY_MEDIUM),
            (EmbreeBuilder::FastSpatial, sys::RTC_BUILD_QUALITY_HIGH),
        ] {
            let forced = inspect(&mesh, &Config { builder, width: Width::Eight, threads: 2 }).unwrap();
            let set = |prepared: &mut Prepared<'_>| prepared.set_quality(quality);
            let (default, _) = inspect_device(&mesh, "threads=2", set).unwrap();
            // CPUs that Embree clocks as simd128 have 4-wide trees by default.
            if default.accel == forced.accel {
                assert_eq!(default, forced);
            }
        }
    }

    #[test]
    fn another_builder_is_an_error() {
        let config = Config { builder: EmbreeBuilder::FastSpatial, width: Width::Four, threads: 1 };
        // Without `tri_builder` the quality is ignored and SAH is built.
        let high = |prepared: &mut Prepared<'_>| prepared.set_quality(sys::RTC_BUILD_QUALITY_HIGH);
        let (inspection, output) = inspect_device(&soup(100), "tri_accel=bvh4.triangle4", high).unwrap();
        let error = verify(&config, &inspection, &output).unwrap_err().to_string();
        assert!(
            error.starts_with("Embree built BVH4<triangle4> by BVH4BuilderSAH (tri_builder=default)"),
            "{error}"
        );
        let (inspection, output) = inspect_device(&soup(100), &config.device_string(), |_| ()).unwrap();
        verify(&config, &inspection, &output).unwrap();
    }

    #[test]
    fn empty_and_tiny_meshes_are_inspected() {
        let config = Config { builder: EmbreeBuilder::Sah, width: Width::Four, threads: 1 };
        let empty = inspect(&soup(0), &config).unwrap();
        assert_eq!((empty.builder.as_str(), empty.leaves), ("none", 0));
        let one = inspect(&soup(1), &config).unwrap();
        assert_eq!((one.sah, one.nodes, one.leaves, one.bytes), (1.0, 0, 1, 176));
    }

    #[test]
    fn errors_keep_embrees_text() {
        let device = "tri_accel=bvh4.triangle4,tri_builder=bogus";
        let error = inspect_device(&soup(10), device, |_| ()).unwrap_err().to_string();
        assert!(error.contains("unknown builder bogus for BVH4<Triangle4>"), "{error}");
        let error = inspect_device(&soup(10), "threads=many", |_| ()).unwrap_err().to_string();
        assert!(error.contains("threads=many"), "{error}");
    }
}

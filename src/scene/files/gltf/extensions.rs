//! What a file requires of its reader.

use crate::scene::files::error::Fault;
use crate::scene::model::Contents;
use gltf::json::Root;

/// Extensions that do not move a triangle, by the beginnings of their names: materials, textures, lights, and positions
/// as small integers, which are read as any others.
const HARMLESS: [&str; 9] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_mesh_quantization",
    "KHR_xmp",
    "ADOBE_materials_",
];

/// Extensions under which bytes are compressed.
const COMPRESSED: [&str; 3] =
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Extensions that place or hide geometry: remarked where they are in use, but not required.
const PLACING: [&str; 3] = ["EXT_mesh_gpu_instancing", "MSFT_lod", "KHR_node_visibility"];

/// Refuses files with geometry that only an extension tells.
pub(super) fn check(root: &Root, contents: &mut Contents) -> Result<(), Fault> {
    for name in &root.extensions_required {
        if COMPRESSED.contains(&name.as_str()) {
            let problem = format!("compressed by {name}, which is not read");
            return Err(Fault::new(
                "extensionsRequired",
                &problem,
                "decompress it, as `gltf-transform copy` does",
            ));
        }
        if !HARMLESS.iter().any(|known| name.starts_with(known)) {
            let problem = format!("needs {name}, which is not read");
            return Err(Fault::new("extensionsRequired", &problem, "export it without this extension"));
        }
    }
    for name in PLACING.iter().filter(|&&name| root.extensions_used.iter().any(|used| used == name)) {
        contents.remarks.push(format!("the extension {name} is not applied"));
    }
    Ok(())
}

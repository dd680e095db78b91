//! What `phr bench --dry-run` prints.

use crate::bench::plan::Plan;
use crate::report::table::counted_rounds;
use std::path::Path;

/// The plan in words, its files checked: before that their triangles are an estimate.
pub fn outline(plan: &Plan, folder: &Path) -> String {
    let settings = &plan.settings;
    let mut text = String::new();
    let mut visits = 0;
    for (scene, cells) in &plan.scenes {
        visits += cells.len() * settings.rounds;
        text += &format!(
            "{}: {}, {} triangles, {} trees\n",
            scene.name,
            scene.origin(),
            scene.triangles,
            cells.len()
        );
    }
    let rays = if settings.build_only {
        "builds only".to_owned()
    } else {
        format!("{} views of {} x {} pixels", settings.views, settings.width, settings.height)
    };
    let (rounds, threads) = (counted_rounds(&settings.rounds.to_string()), settings.threads);
    let more = match settings.seconds {
        0 => String::new(),
        seconds => format!(", more where a scene takes less than {seconds} seconds"),
    };
    text + &format!("{visits} visits in {rounds}{more}, {threads} threads, {rays}, into {}", folder.display())
}

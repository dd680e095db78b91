//! Why a run could not be planned, made or reduced: one line each, with the remedy.

use super::files::RecordsError;
use crate::builders::RecipeError;
use crate::scene::SceneError;
use std::path::PathBuf;

/// Why a request cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// Neither a file nor a generated scene.
    #[error("{0}: no such file, nor a generated scene of that name; `phr scenes` lists those")]
    NoSuchScene(String),
    /// A folder in place of a file.
    #[error("{}: is a directory; name a scene file in it (.ply, .obj, .stl, .gltf or .glb, plain, .gz or .zst)", .0.display())]
    Directory(PathBuf),
    /// Two scenes of the same name.
    #[error("two scenes are called {0}; leave one out or rename its file")]
    SameName(String),
    /// A scene file that cannot be used.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A scene so large or small that rays lose their hits.
    #[error("{scene}: {why}")]
    Size {
        /// The scene.
        scene: String,
        /// Its size and the remedy.
        why: String,
    },
    /// Not a builder.
    #[error("no builder is called {name}; there are {known}")]
    NoSuchBuilder {
        /// The name given.
        name: String,
        /// The builders of this program.
        known: String,
    },
    /// A builder with its width behind a slash, as tables name trees.
    #[error(
        "no builder is called {name}; give --builder {builder} --width {width}, the latter where the command has it"
    )]
    WidthInName {
        /// The name given.
        name: String,
        /// The builder in it.
        builder: String,
        /// The width behind it.
        width: u32,
    },
    /// Not a builder of that width.
    #[error("--width {width}: {builder} builds trees of width {widths}; give one of these")]
    NoSuchWidth {
        /// The builder.
        builder: String,
        /// The width asked for.
        width: u32,
        /// Its widths.
        widths: String,
    },
    /// A builder that cannot be changed so.
    #[error(transparent)]
    Recipe(#[from] RecipeError),
    /// Two changed builders of the same name.
    #[error("two changed builders are called {0}; leave one out")]
    SameBuilder(String),
    /// A file that is no builder's configuration.
    #[error(
        "{}: {reason}; write {{\"name\": NAME, \"base\": BUILDER, \"fields\": {{\"FIELD\": VALUE}}}}", path.display()
    )]
    Config {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A count that must be positive.
    #[error("--{0} 0: nothing would be measured; give 1 or more")]
    Zero(&'static str),
    /// A count above its limit.
    #[error("--{option} {value}: more than {most}; give fewer")]
    TooMuch {
        /// The option's name.
        option: &'static str,
        /// Its value.
        value: usize,
        /// The most it may be.
        most: usize,
    },
    /// `--one-thread` beside `--threads 1`, or without `--build-only`.
    #[error("--one-thread {0}")]
    OneThread(&'static str),
    /// The filter and the width match nothing.
    #[error("{0}: matches no \"scene builder width kernel\"; see `phr bench --list`")]
    NothingLeft(String),
    /// More shards than scenes.
    #[error(
        "--shard: {shard} shards of {most} scenes, some without any; scenes are not divided, give {most} or fewer"
    )]
    EmptyShard {
        /// Shards.
        shard: usize,
        /// Scenes.
        most: usize,
    },
    /// `--scenes` does not name a folder.
    #[error("{}: not a folder; --scenes takes the folder that holds the paper's scene files", .0.display())]
    NotAFolder(PathBuf),
}

/// Why a run could not be made or finished.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The results cannot be read or written.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// A scene cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The reference tree cannot be built.
    #[error("{scene}: no reference hits: {reason}")]
    Reference {
        /// The scene.
        scene: String,
        /// Embree's message.
        reason: String,
    },
    /// The threads cannot be started.
    #[error("--threads {threads}: {reason}; give fewer")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// The system's message.
        reason: String,
    },
    /// A folder that holds a run already.
    #[error(
        "{}: holds the results of a run; --resume goes on with it, --out DIR writes elsewhere, --replace removes it",
        .0.display()
    )]
    Taken(PathBuf),
    /// A folder that another run writes to.
    #[error("{}: another run is writing there; wait for its end, or give another folder with --out", .0.display())]
    Held(PathBuf),
    /// `--resume` with other settings.
    #[error("{}: made with another {what}; give the same, or another folder with --out", folder.display())]
    Resume {
        /// The folder.
        folder: PathBuf,
        /// The setting that differs.
        what: String,
    },
}

/// Why a folder cannot be reduced.
#[derive(Debug, thiserror::Error)]
pub enum ReduceError {
    /// The records cannot be read or written.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// The reduced rows would take the place of the whole ones, or be read along with them.
    #[error("{}: in the folder that is reduced; give another place", .0.display())]
    Inside(PathBuf),
    /// A run with all its samples, which the rows of another would be mixed with.
    #[error("{}: holds a run that can be resumed; give another folder", .0.display())]
    Taken(PathBuf),
}

//! The threads of a run.

use crate::bench::settings::Settings;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// The thread pools: our builders build with them and every kernel traces with them. Embree starts as many threads of
/// its own.
pub struct Pools {
    /// As many threads as the settings say.
    pub all: ThreadPool,
    /// One thread, where builds are timed on one thread too.
    pub one: Option<ThreadPool>,
}

impl Pools {
    /// Starts the threads.
    ///
    /// # Errors
    /// The system's, if it has no more threads.
    pub fn new(settings: &Settings) -> Result<Self, ThreadPoolBuildError> {
        let pool = |threads| {
            let builder = ThreadPoolBuilder::new().num_threads(threads);
            builder.thread_name(|index| format!("phr-{index}")).build()
        };
        let one = settings.one_thread.then(|| pool(1)).transpose()?;
        Ok(Self { all: pool(settings.threads)?, one })
    }
}

impl From<ThreadPool> for Pools {
    fn from(all: ThreadPool) -> Self {
        Self { all, one: None }
    }
}

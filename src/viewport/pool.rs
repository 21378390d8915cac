//! Threads of the view alone: the shared ones may be busy for long with generating or exporting, and the window must
//! not wait for them.

use std::sync::OnceLock;

use rayon::ThreadPool;

/// Runs work that rayon divides on the view's threads, or in the calling thread where the system gives none.
pub(super) fn run<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static POOL: OnceLock<Option<ThreadPool>> = OnceLock::new();
    let start = || {
        // As many threads as the shared pool has, whatever number the environment asks for.
        rayon::ThreadPoolBuilder::new()
            .num_threads(rayon::current_num_threads())
            .thread_name(|i| format!("view-{i}"))
            .build()
            .ok()
    };
    match POOL.get_or_init(start) {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

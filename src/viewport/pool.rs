//! Threads of the view's own: those that all share may be busy for long, generating or exporting, and the window must not
//! wait for them.

use std::sync::OnceLock;

use rayon::ThreadPool;

/// Runs work that is parted by rayon on the view's threads; in this one where the system gives none.
pub(super) fn run<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static POOL: OnceLock<Option<ThreadPool>> = OnceLock::new();
    let start = || {
        // As many as those that all share, however many the environment asks for.
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

//! Threads of the view's own: those that all share may be busy for long, generating or exporting, and the window must not
//! wait for them.

use std::sync::OnceLock;

use rayon::ThreadPool;

/// Runs work that is parted by rayon on the view's threads; in this one where the system gives none.
pub(super) fn run<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static POOL: OnceLock<Option<ThreadPool>> = OnceLock::new();
    let name = |i| format!("view-{i}");
    match POOL.get_or_init(|| rayon::ThreadPoolBuilder::new().thread_name(name).build().ok()) {
        Some(pool) => pool.install(work),
        None => work(),
    }
}

//! Threads: guards against panics, workers that make the newest of what is asked for, and the pool that shares heavy
//! work.

pub mod guard;
pub mod pool;
pub mod worker;

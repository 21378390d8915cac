//! Batches: many variants of a scene by a plan, each a folder of files; resumable, in shards, packed into tars, with one index.
//!
//! A variant is made in a folder beside its final name and renamed when it is whole, so a run that is killed leaves nothing
//! half done and the next one goes on. Its bytes depend on the plan and its number alone.

mod deep_pictures;
pub mod index;
pub mod make;
pub mod marks;
pub mod pack;
pub mod plan;
pub mod queue;
pub mod record;
pub mod run;
mod thumb;

pub use plan::Plan;
pub use queue::Queue;
pub use run::{Batch, Progress, Report, Shard};

//! Batches: many variants of a scene by a plan, each a folder of files; resumable, in shards, packed into tars, with one index.
//!
//! A variant is made in a folder beside its final name and renamed when it is complete. A run that is killed therefore
//! leaves no half-made variant, and the next run goes on. The bytes of a variant depend on the plan and the variant's
//! number alone.

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

pub use plan::BatchPlan;
pub use queue::Queue;
pub use run::{Batch, BatchProgress, BatchReport, Shard};

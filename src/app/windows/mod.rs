//! Windows and dialogs that lie over the panes.

pub mod batch_plan;
pub mod batches;
pub mod capture;
pub mod export;
mod lens;
pub mod open;
pub mod palette;
pub mod performance;
pub mod place_picker;
mod radar;
pub mod recovery;
pub mod repairs;
pub mod row;
pub mod sensors;
pub mod settings;
pub mod shortcuts;
pub mod start;
pub mod tour;
pub mod unsaved;

//! Rows of the extremes table (`tests/README.md`) that public functions can show; others stand beside private code.

mod metrics;
mod networks;
mod sampling;
mod scenes;
mod window;

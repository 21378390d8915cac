//! The window driven as a user drives it: by labels, pointer and keys, with a scripted pipeline.

mod batches;
mod bench;
mod beside;
mod checks;
mod day;
mod desk;
mod editing;
mod files;
mod guests;
mod light;
mod linked;
mod objects;
mod overdraw;
mod perception;
mod places;
mod recovery;
mod sensors;
mod shell;
mod space;
mod staged;
mod timeline;
mod tools;
mod trade;
mod views;
mod words;

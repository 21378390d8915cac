//! A small network that perceives a scene from one LiDAR sweep: what stands in each column of the window, and boxes of things.

pub mod standing;

//! Scene graphs and layouts: graphs of scenes, placement of a graph's objects by diffusion, repair, a memory of scenes.

pub mod graph_of;

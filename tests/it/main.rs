//! All integration tests in one program, so that the rooms are linked once.

mod appearance_gpu;
mod bounded_memory;
mod camera_files;
mod candle;
mod cli;
mod cli_tools;
mod diffusion;
mod fuzz;
mod inferred;
mod opendrive;
mod parity;
mod pipeline;
mod project;
mod prompt;
mod random_commands;
mod recovery;
mod rows;
mod sensor_scene;
mod sensors;
mod shaders;
mod splat_gpu;
mod splat_reference;
mod threads;
mod viewport;
mod window;

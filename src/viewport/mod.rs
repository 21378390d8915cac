//! How a scene is drawn: wgpu.

//! The trait of a drawable, and the table of all drawables.
//!
//! A new drawable is one file here with a type that implements [`Drawable`], one shader of the same name, and one line in
//! [`all`].

use std::fmt::Debug;

use glam::DMat4;

use super::change::PictureChange;
use super::marks::Marks;
use super::shared::{DrawableResources, FrameUniforms};
use super::{ViewCamera, ViewOptions, ViewScene};

/// Every drawable. Those of one layer are drawn in this order: near opaque things before far ones, since a software
/// rasteriser then shades little that is covered later.
pub(super) fn all() -> Vec<Box<dyn Drawable>> {
    vec![
        Box::new(super::ego::Ego::default()),
        Box::new(super::points::Points::default()),
        Box::new(super::voxels::VoxelDrawable::new()),
        Box::new(super::background::Backdrop::default()),
        Box::new(super::ground::LayoutDrawable::default()),
        Box::new(super::lines::Lines::default()),
        Box::new(super::faces::Faces::default()),
    ]
}

/// Layer in which a thing is drawn. A drawable may draw in several layers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum DrawLayer {
    /// First of all, if only a part of a picture is drawn again: clears that part.
    Erase,
    /// Opaque things.
    Opaque,
    /// The background, where no opaque thing is.
    Backdrop,
    /// The plane on the ground.
    Ground,
    /// Lines behind opaque things, faintly.
    Covered,
    /// Translucent rectangles.
    Fills,
    /// Lines in front.
    Lines,
}

impl DrawLayer {
    /// Every layer, first to last.
    pub const ALL: [DrawLayer; 7] = [
        DrawLayer::Erase,
        DrawLayer::Opaque,
        DrawLayer::Backdrop,
        DrawLayer::Ground,
        DrawLayer::Covered,
        DrawLayer::Fills,
        DrawLayer::Lines,
    ];
}

/// The device, and what all drawables share on it.
#[derive(Clone, Copy)]
pub(super) struct Gpu<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub shared: &'a DrawableResources,
}

/// The scene of a picture, and values of it that several drawables need.
#[derive(Clone, Copy)]
pub(super) struct DrawInput<'a> {
    pub scene: &'a ViewScene<'a>,
    /// Lines and fills over the voxels.
    pub marks: &'a Marks,
    /// Fingerprint of the layout's cells.
    pub bev: u64,
}

/// How a picture is drawn.
#[derive(Clone, Copy)]
pub(super) struct DrawContext<'a> {
    pub camera: &'a ViewCamera,
    /// Maps the ego frame to clip space (-1 to 1) of the part that is drawn, with room for the discs of LiDAR returns.
    pub clip: DMat4,
    pub uniforms: &'a FrameUniforms,
    pub options: &'a ViewOptions,
    pub shared: &'a DrawableResources,
    /// Samples per pixel, 1 or 4.
    pub samples: u32,
    /// True if only a part of the picture is drawn again.
    pub part: bool,
}

/// A thing that is drawn into the 3D view.
pub(super) trait Drawable: Debug + Send + Sync {
    /// Its name, which is that of its file and of its shader.
    fn name(&self) -> &'static str;

    /// Takes over the scene and uploads the parts that differ from the last one. Returns which part of the picture
    /// changes. Parts that did not change must cost no more than a comparison.
    fn prepare(&mut self, gpu: Gpu<'_>, shown: DrawInput<'_>) -> PictureChange;

    /// Makes its pipelines for a number of samples per pixel, if they are not there yet.
    fn build(&mut self, gpu: Gpu<'_>, samples: u32);

    /// Draws its part of a layer.
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &DrawContext<'_>, layer: DrawLayer);

    /// Memory of its vertices on the device, bytes.
    fn memory_bytes(&self) -> u64;

    /// Rectangles that it holds, seen or not.
    fn quads(&self) -> usize {
        0
    }
}

/// A pipeline for 1 sample per pixel and one for 4, made when they are needed.
#[derive(Debug, Default)]
pub(super) struct Pipelines([Option<wgpu::RenderPipeline>; 2]);

impl Pipelines {
    /// Makes the pipeline for a number of samples, if it is not there yet.
    pub fn build(&mut self, samples: u32, make: impl FnOnce() -> wgpu::RenderPipeline) {
        self.0[usize::from(samples > 1)].get_or_insert_with(make);
    }

    /// Sets the pipeline for the view's samples; false if it was never made.
    pub fn set(&self, pass: &mut wgpu::RenderPass<'_>, view: &DrawContext<'_>) -> bool {
        match &self.0[usize::from(view.samples > 1)] {
            Some(pipeline) => {
                pass.set_pipeline(pipeline);
                true
            }
            None => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shaders::SHADERS;

    #[test]
    fn every_drawable_has_a_shader_of_its_name() {
        let drawables = all();
        for drawable in &drawables {
            let named = SHADERS.iter().any(|s| s.name == drawable.name());
            assert!(named, "no shader {}", drawable.name());
        }
        // Shaders of the 3D view without a drawable draw nothing.
        let unused = |name: &&str| *name != "ui_mesh" && drawables.iter().all(|d| d.name() != *name);
        let unused: Vec<&str> = SHADERS.iter().map(|s| s.name).filter(unused).collect();
        assert!(unused.is_empty(), "{unused:?}");
    }
}

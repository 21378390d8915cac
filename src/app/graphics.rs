//! A graphics card for sensor views: camera maps by splats and camera pictures, drawn on a real card if there is one.
//! The sensor thread has a device of its own, so the window never waits for it. The processor draws the rest.

use scene::{Camera, CameraMaps};
use sensors::cameras::Card;
use sensors::pictures::appearance::{Appearance, CameraImage, Quality};
use sensors::raycast::rays::CameraRays;
use sensors::splat::SplatOptions;
use sensors::splat::cloud::GaussianCloud;
use viewport::{AppearanceRenderer, SplatRenderer, headless_device};

/// Environment variable: 1 allows software drivers too, for tests; 0 allows no card.
const SWITCH: &str = "SCENELOOM_GPU_VIEWS";

/// Renderers on one device. A renderer that failed is not used again.
pub struct Graphics {
    adapter: String,
    splats: Option<SplatRenderer>,
    appearance: Option<AppearanceRenderer>,
}

/// True if an adapter is to be used: by the switch, and by whether it is a software driver.
fn wanted(switch: Option<&str>, software: bool) -> bool {
    match switch {
        Some("0") => false,
        Some("1") => true,
        _ => !software,
    }
}

impl Graphics {
    /// The best adapter that is not a software driver. `None` without one.
    pub fn find() -> Option<Self> {
        Self::find_with(std::env::var(SWITCH).ok().as_deref())
    }

    /// The best adapter, software or not, if the switch is 1.
    pub fn forced() -> Option<Self> {
        let switch = std::env::var(SWITCH).ok().filter(|s| s == "1")?;
        Self::find_with(Some(&switch))
    }

    fn find_with(switch: Option<&str>) -> Option<Self> {
        if !wanted(switch, false) {
            return None;
        }
        // Without a device, for any reason, the processor draws; `sceneloom doctor` reports the reason.
        let (info, device, queue) = headless_device().ok()?;
        let software = info.device_type == wgpu::DeviceType::Cpu;
        if !wanted(switch, software) {
            return None;
        }
        Some(Self {
            adapter: info.name,
            splats: SplatRenderer::new(&device, &queue).ok(),
            appearance: AppearanceRenderer::new(&device, &queue).ok(),
        })
    }

    /// Name of the adapter.
    pub fn adapter(&self) -> &str {
        &self.adapter
    }
}

impl Card for Graphics {
    fn set_cloud(&mut self, cloud: &GaussianCloud) -> bool {
        let set = self.splats.as_mut().map(|s| s.set_cloud(cloud.gaussians()));
        self.splats = self.splats.take().filter(|_| matches!(set, Some(Ok(()))));
        self.splats.is_some()
    }

    fn maps(&mut self, camera: &Camera, [width, height]: [u32; 2]) -> Option<CameraMaps> {
        // The shaders support straight lines only.
        if !is_plain(camera) {
            return None;
        }
        let options = SplatOptions::default();
        let drawn = self
            .splats
            .as_mut()?
            .render_raw(std::slice::from_ref(camera), [width, height], &options);
        let Ok(mut maps) = drawn else {
            self.splats = None;
            return None;
        };
        let maps = maps.pop()?;
        Some(maps.into_camera_maps(&camera.name, &options))
    }

    fn set_appearance(&mut self, appearance: &Appearance) -> bool {
        let set = self
            .appearance
            .as_mut()
            .map(|l| l.set_appearance(&appearance.data()));
        self.appearance = self.appearance.take().filter(|_| matches!(set, Some(Ok(()))));
        self.appearance.is_some()
    }

    fn picture(
        &mut self,
        appearance: &Appearance,
        camera: &Camera,
        [width, height]: [u32; 2],
        quality: Quality,
    ) -> Option<CameraImage> {
        if !is_plain(camera) {
            return None;
        }
        let edges = quality == Quality::Full;
        match self.appearance.as_mut()?.light(camera, [width, height], edges) {
            Ok(light) => Some(appearance.picture(camera, width, height, &light)),
            Err(_) => {
                self.appearance = None;
                None
            }
        }
    }
}

/// True for a pinhole camera with a global shutter.
fn is_plain(camera: &Camera) -> bool {
    CameraRays::new(camera, camera.width, camera.height).is_plain()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera_views::camera_input;
    use scene::{Frame, Scene, draft};
    use sensors::cameras::{self, CameraPicture, Detail, PreparedSource, RenderContext, RenderOptions};
    use world::World;

    /// Views by a card (software here) equal those of the processor: labels of splats to 0.1 %, pictures to 2/255 on
    /// average.
    #[test]
    fn views_by_card_are_those_by_processor() {
        let mut card = Graphics::find_with(Some("1")).expect("an adapter, software or not");
        assert!(!card.adapter().is_empty());
        let world = World::random(3);
        let occupancy = draft::draft(&world.layout, world.boxes.values());
        let frame = Frame::new(world.layout.clone(), world.boxes.clone(), occupancy);
        let scene = Scene::single("test", frame, Default::default(), 3);
        let options = RenderOptions {
            size: [96, 54],
            quality: Quality::Preview,
        };
        let mut drawn_by_card = Vec::new();
        for source in cameras::all() {
            let ready = PreparedSource::new(*source, &camera_input(&scene, Detail::Live));
            if !ready.upload_to(|| Some(&mut card)) {
                continue;
            }
            drawn_by_card.push(source.id().name());
            let camera = &scene.rig.cameras[1];
            let by = |card| {
                let context = RenderContext {
                    card,
                    ..RenderContext::processor()
                };
                ready.render(camera, &options, context).expect("a small picture")
            };
            match (by(Some(&mut card)), by(None)) {
                (CameraPicture::Maps(a), CameraPicture::Maps(b)) => {
                    let gaps = a.semantic.iter().zip(&b.semantic).filter(|(a, b)| a != b);
                    assert!(gaps.count() * 1000 <= a.semantic.len());
                }
                (CameraPicture::Picture(a), CameraPicture::Picture(b)) => {
                    let gaps = a.rgba.iter().zip(&b.rgba).map(|(a, b)| f64::from(a.abs_diff(*b)));
                    assert!(gaps.sum::<f64>() / a.rgba.len() as f64 <= 2.0);
                }
                _ => panic!("of two kinds"),
            }
        }
        assert_eq!(drawn_by_card, ["splats", "pictures"]);
        assert!(
            card.splats.is_some() && card.appearance.is_some(),
            "nothing failed"
        );
    }

    #[test]
    fn the_switch_decides_over_software() {
        assert!(wanted(None, false) && !wanted(None, true));
        assert!(wanted(Some("1"), true) && wanted(Some("1"), false));
        assert!(!wanted(Some("0"), false) && !wanted(Some(""), true));
    }
}

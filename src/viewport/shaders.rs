//! The shaders as text, each with the shared part in front.

/// A shader as it is given to the device.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Name of its file in `shaders/`, without the ending.
    pub name: &'static str,
    /// WGSL, with `shaders/shared/frame.wgsl` in front.
    pub source: &'static str,
}

macro_rules! shader {
    ($name:literal) => {
        Shader {
            name: $name,
            source: concat!(
                include_str!("../../shaders/shared/frame.wgsl"),
                include_str!(concat!("../../shaders/", $name, ".wgsl"))
            ),
        }
    };
}

/// Every shader of the viewport.
pub const SHADERS: &[Shader] = &[
    shader!("background"),
    shader!("ego"),
    shader!("faces"),
    shader!("ground"),
    shader!("lines"),
    shader!("points"),
    shader!("voxels"),
];

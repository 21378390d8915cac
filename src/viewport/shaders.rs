//! The shaders as text, each with the part it shares in front.

/// A shader as it is given to the device.
#[derive(Clone, Copy, Debug)]
pub struct Shader {
    /// Name of its file in `shaders/`, without the ending.
    pub name: &'static str,
    /// WGSL, with `shaders/shared/frame.wgsl` or `splat.wgsl` in front.
    pub source: &'static str,
}

macro_rules! shader {
    ($name:literal) => {
        shader!($name, "frame")
    };
    ($name:literal, $shared:literal) => {
        Shader {
            name: $name,
            source: concat!(
                include_str!(concat!("../../shaders/shared/", $shared, ".wgsl")),
                include_str!(concat!("../../shaders/", $name, ".wgsl"))
            ),
        }
    };
}

/// Every shader that draws.
pub const SHADERS: &[Shader] = &[
    shader!("background"),
    shader!("ego"),
    shader!("faces"),
    shader!("ground"),
    shader!("lines"),
    shader!("points"),
    Shader {
        name: "ui_mesh",
        source: include_str!("../../shaders/ui_mesh.wgsl"),
    },
    shader!("voxels"),
];

/// Every shader that computes: the splat renderer's.
pub const COMPUTE_SHADERS: &[Shader] = &[
    shader!("splat_blend", "splat"),
    shader!("splat_project", "splat"),
    shader!("splat_sort", "splat"),
    shader!("splat_tiles", "splat"),
];

/// The shader that computes camera pictures, with constants in front.
pub fn appearance() -> Shader {
    Shader {
        name: "appearance",
        source: super::appearance::appearance_source(),
    }
}

//! glTF 2.0 and its container GLB: code that reading and writing share.
//!
//! A file of ours holds a node with extras of ours (`SceneExtras`), under it a node for each class with the mesh of its voxels, and a
//! node for each box with the mesh of the voxels that are the box's own. glTF has y up: that node turns
//! the scene's axes (x forward, y left, z up) to those of glTF (x, z, -y), and everything below it is in metres of the ego frame.

pub(crate) mod accessor;
pub(crate) mod class_words;
pub(crate) mod columns;
pub(crate) mod container;
pub(crate) mod document;
pub(crate) mod foreign;
pub(crate) mod mesh;
pub(crate) mod model;
pub(crate) mod own;
pub(crate) mod paint;
pub(crate) mod single;
pub(crate) mod solid;
pub(crate) mod surface;
#[cfg(test)]
mod tests;
mod work;

use glam::{DMat3, DQuat, DVec2, DVec3};
use scene::{BoxId, BoxLabel, Class, Extent, SceneBox};
use serde::{Deserialize, Serialize};

/// Version of the extras that are written, and the newest that is read.
pub(crate) const VERSION: u32 = 1;
/// Name of the numbering of the classes.
pub(crate) const CLASS_MAP: &str = "occ3d-nuscenes";

/// Turns axes with z up to those of glTF: a quarter turn about x.
pub(crate) fn y_up_from_z_up() -> DQuat {
    DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2)
}

/// Turns the axes of glTF to ours.
pub(crate) fn z_up_from_y_up() -> DMat3 {
    DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y)
}

/// Extras of the node that holds a scene of ours.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SceneExtras {
    pub(crate) sceneloom: ExtrasHeader,
    /// How the file came to be: a [`crate::recipe::Recipe`]. Programs may round its numbers.
    #[serde(default)]
    pub(crate) recipe: serde_json::Value,
}

/// Description of the scene in a file that this program wrote. Unknown keys are passed over.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ExtrasHeader {
    pub(crate) version: u32,
    /// In digits: programs that read numbers as f64 would round it.
    pub(crate) seed: String,
    /// Name of the numbering of the classes.
    pub(crate) class_map: String,
    pub(crate) extent: ExtentExtras,
    /// Edge of a voxel, m.
    pub(crate) voxel_m: f64,
    /// The axes below this node, in words.
    pub(crate) frame: String,
}

/// An [`Extent`] in a file.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ExtentExtras {
    /// Column at the lower corner, counted from the ego frame's origin.
    pub(crate) from: [i32; 2],
    /// Columns along x and y.
    pub(crate) columns: [usize; 2],
}

impl From<Extent> for ExtentExtras {
    fn from(extent: Extent) -> Self {
        Self {
            from: extent.from(),
            columns: [extent.nx(), extent.ny()],
        }
    }
}

/// Extras of a node that holds voxels of a class.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ClassExtras {
    pub(crate) class: Class,
    pub(crate) class_id: u8,
}

/// Extras of a node that is a box: its numbers as they were, which the node's transform holds in 32 bits only.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct BoxExtras {
    pub(crate) class: Class,
    pub(crate) class_id: u8,
    pub(crate) id: BoxId,
    /// Length, width, height, m.
    pub(crate) size_m: DVec3,
    pub(crate) center_m: DVec3,
    pub(crate) yaw_rad: f64,
    #[serde(default)]
    pub(crate) velocity_mps: DVec2,
    #[serde(default, skip_serializing_if = "BoxLabel::is_empty")]
    pub(crate) label: BoxLabel,
    /// The mesh is a cuboid in place of voxels, of which the box has none.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(crate) placeholder: bool,
}

impl BoxExtras {
    /// The extras of a box; `has_voxels` says whether it has voxels of its own.
    pub(crate) fn from_box(b: &SceneBox, has_voxels: bool) -> Self {
        Self {
            class: b.class,
            class_id: b.class.id(),
            id: b.id,
            size_m: b.size_m,
            center_m: b.center_m,
            yaw_rad: b.yaw_rad,
            velocity_mps: b.velocity_mps,
            label: b.label,
            placeholder: !has_voxels,
        }
    }

    /// The box that the extras describe.
    pub(crate) fn scene_box(&self) -> SceneBox {
        SceneBox {
            id: self.id,
            class: self.class,
            center_m: self.center_m,
            size_m: self.size_m,
            yaw_rad: self.yaw_rad,
            velocity_mps: self.velocity_mps,
            label: self.label,
        }
    }
}

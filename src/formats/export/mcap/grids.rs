//! The map and the voxels as grids of Foxglove's schemas.

use glam::{DQuat, DVec3};
use scene::{BevLayer, BevLayout, Class, Extent, Pose, Scene, Window};

use super::messages::{Grid, Numeric, PackedElementField, Time, Vector2, VoxelGrid, fields};
use super::{BASE, MAP};

/// 1 where one drives, once for the clip.
pub(super) fn drivable_area(layout: &BevLayout, timestamp: Option<Time>) -> Grid {
    let cell = |cell: u32| [u8::from(cell & BevLayer::DrivableArea.bit() != 0)];
    grid(layout, timestamp, &[("drivable_area", Numeric::Uint8)], cell)
}

/// Colour of the uppermost layer of each column, transparent where there is none, and all layers as bits
/// ([`BevLayer::bit`]).
pub(super) fn semantic_map(layout: &BevLayout, timestamp: Option<Time>) -> Grid {
    let cell = |cell: u32| {
        let upper = BevLayer::MAP
            .into_iter()
            .rev()
            .find(|layer| cell & layer.bit() != 0);
        let [r, g, b] = upper.map_or([0; 3], BevLayer::color);
        [
            r,
            g,
            b,
            if upper.is_some() { 255 } else { 0 },
            (cell & 0xff) as u8,
        ]
    };
    grid(layout, timestamp, &colors_and("layers"), cell)
}

/// Red, green, blue, alpha and one more.
const fn colors_and(last: &str) -> [(&str, Numeric); 5] {
    [
        ("red", Numeric::Uint8),
        ("green", Numeric::Uint8),
        ("blue", Numeric::Uint8),
        ("alpha", Numeric::Uint8),
        (last, Numeric::Uint8),
    ]
}

/// Rows along y, columns along x; the lower corner is the origin.
fn grid<const N: usize>(
    layout: &BevLayout,
    timestamp: Option<Time>,
    names: &[(&str, Numeric)],
    cell: impl Fn(u32) -> [u8; N],
) -> Grid {
    let extent = layout.extent();
    let [nx, ny] = [extent.nx(), extent.ny()];
    let mut data = Vec::with_capacity(nx * ny * N);
    for (x, y) in (0..ny).flat_map(|y| (0..nx).map(move |x| (x, y))) {
        data.extend(cell(layout.cell(x, y)));
    }
    let at = Pose {
        rotation: DQuat::IDENTITY,
        translation_m: extent.min_m().with_z(0.0),
    };
    Grid {
        timestamp,
        frame_id: MAP.into(),
        pose: Some(at.into()),
        column_count: nx as u32,
        cell_size: Some(Vector2 {
            x: Window::VOXEL_M,
            y: Window::VOXEL_M,
        }),
        row_stride: (nx * N) as u32,
        cell_stride: N as u32,
        fields: fields(names),
        data,
    }
}

/// The voxels of the moment in the ego frame, 80 m by 80 m: colour, transparent where free, and class. Slices along z, rows
/// along y, columns along x. Ground lies two bins lower than it is, as in the labels.
pub(super) fn occupancy(now: &Scene, timestamp: Option<Time>) -> VoxelGrid {
    let ego = now.in_ego();
    let voxels = ego.frame().occupancy.crop(Extent::WINDOW);
    let extent = voxels.extent();
    let [nx, ny, nz] = extent.shape();
    let names: Vec<PackedElementField> = fields(&colors_and("class"));
    let stride = names.len();
    let mut data = vec![0; nx * ny * nz * stride];
    let free = [0, 0, 0, 0, Class::FREE];
    data.as_chunks_mut::<5>().0.fill(free);
    for (x, y, z, label) in voxels.iter_set() {
        let [r, g, b] = Class::from_id(label).unwrap_or(Class::Others).color();
        let at = ((z * ny + y) * nx + x) * stride;
        data[at..at + stride].copy_from_slice(&[r, g, b, 255, label]);
    }
    let at = Pose {
        rotation: DQuat::IDENTITY,
        translation_m: extent.min_m(),
    };
    VoxelGrid {
        timestamp,
        frame_id: BASE.into(),
        pose: Some(at.into()),
        row_count: ny as u32,
        column_count: nx as u32,
        cell_size: Some(DVec3::splat(Window::VOXEL_M).into()),
        slice_stride: (nx * ny * stride) as u32,
        row_stride: (nx * stride) as u32,
        cell_stride: stride as u32,
        fields: names,
        data,
    }
}

//! Data that the shader of camera pictures reads besides the words of an appearance, field by field as in
//! `shaders/appearance.wgsl`, and the constants that stand in front of it.

use std::fmt::Write as _;
use std::sync::OnceLock;

use scene::appearance::{
    AppearanceData, BIN_COLUMNS, BLOCK, BLOCK_M, CONTRAST, FAR_M, FieldShape, HEAD_NEAR_M2, HIGHEST_M,
    KERB_EDGE_M, KERB_M, KERB_SEEN_M, LAMP_CLEAR_M, LAMP_SHADOW_LIGHT, LAMP_STEP_M, LEAVES, MIRROR_M, NZ,
    PART_WORDS, SECTIONS, SHADOW_M, SKYLINE_M, SURFACE, THING_WORDS, TRUNK,
};
use scene::{BevLayer, Camera, Class, Lattice, PolylineKind};

/// The uniform, see `View` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct GpuView {
    at: [u32; SECTIONS],
    air: [[f32; 4]; 8],
    turn: [f32; 4],
    shift: [f32; 4],
    vehicle: [f32; 4],
    field: [u32; 4],
    bins: [u32; 4],
    low: [f32; 4],
    middle: [f32; 4],
    columns: [[f32; 4]; 3],
    place: [f32; 4],
    lens: [f32; 4],
    size: [u32; 4],
}

/// Bytes of the uniform.
pub const APPEARANCE_UNIFORM_BYTES: usize = size_of::<GpuView>();

impl GpuView {
    /// `None` for a camera without a place or direction: it sees nothing.
    pub fn new(appearance: &AppearanceData, camera: &Camera, [width, height]: [u32; 2]) -> Option<GpuView> {
        let camera = camera.resized(width.max(1), height.max(1));
        let pose = camera.ego_from_camera();
        let rotation = glam::DMat3::from_quat(pose.rotation);
        let column = |i: usize| rotation.col(i).as_vec3().extend(0.0).to_array();
        let pixel = (1.0 / camera.focal_px[0].max(1e-3)) as f32;
        let [[fx, fy], [cx, cy]] = [camera.focal_px, camera.center_px];
        let [x, y, z] = appearance.shift_m;
        let shape = FieldShape::from_extent(appearance.extent);
        let ([blocks_x, blocks_y], [bins_x, bins_y]) = (shape.blocks, shape.bins);
        let view = GpuView {
            at: appearance.at,
            air: appearance.air,
            turn: appearance.turn,
            shift: [x, y, z, 0.0],
            vehicle: [
                appearance.vehicle_m[0],
                appearance.vehicle_m[1],
                appearance.lowest_m,
                0.0,
            ],
            field: [shape.nx, shape.ny, blocks_x, blocks_y].map(|n| n as u32),
            bins: [bins_x as u32, bins_y as u32, 0, 0],
            low: [
                shape.low_m.x,
                shape.low_m.y,
                shape.blocks_from_m.x,
                shape.blocks_from_m.y,
            ],
            middle: shape.middle_m.extend(shape.skyline).extend(0.0).to_array(),
            columns: [column(0), column(1), column(2)],
            place: pose.translation_m.as_vec3().extend(pixel).to_array(),
            lens: [fx, fy, cx, cy].map(|v| v as f32),
            size: [width, height, appearance.seed, 0],
        };
        let numbers = [view.columns.as_flattened(), &view.place, &view.lens].concat();
        (numbers.iter().all(|v| v.is_finite()) && fx != 0.0 && fy != 0.0).then_some(view)
    }

    /// Makes the drawing begin at this row.
    pub fn starting_at_row(mut self, row: u32) -> GpuView {
        self.size[3] = row;
        self
    }
}

/// The shader, with the constants of Rust in front.
pub fn appearance_source() -> &'static str {
    static SOURCE: OnceLock<String> = OnceLock::new();
    SOURCE.get_or_init(|| {
        let mut out = String::new();
        let counts = [
            ("NZ", NZ),
            ("BLOCK", BLOCK),
            ("THING_WORDS", THING_WORDS),
            ("PART_WORDS", PART_WORDS),
            ("TRUNK", usize::from(TRUNK)),
            ("VEGETATION", usize::from(Class::Vegetation.id())),
            ("MANMADE", usize::from(Class::Manmade.id())),
            ("CAR", usize::from(Class::Car.id())),
            ("BICYCLE", usize::from(Class::Bicycle.id())),
            ("TRAFFIC_CONE", usize::from(Class::TrafficCone.id())),
            ("BIT_PED_CROSSING", BevLayer::PedCrossing.bit() as usize),
            ("BIT_LANE_DIVIDER", BevLayer::LaneDivider.bit() as usize),
            ("BIT_ROAD_DIVIDER", BevLayer::RoadDivider.bit() as usize),
            ("BIT_STOP_LINE", BevLayer::StopLine.bit() as usize),
            ("LINE_LANE_CENTER", PolylineKind::LaneCenter.drawn_as() as usize),
            ("LINE_LANE_DIVIDER", PolylineKind::LaneDivider.drawn_as() as usize),
            ("LINE_ROAD_DIVIDER", PolylineKind::RoadDivider.drawn_as() as usize),
            ("LINE_STOP_LINE", PolylineKind::StopLine.drawn_as() as usize),
            ("KIND_NONE", 0),
            ("KIND_GROUND", 1),
            ("KIND_VOXEL", 2),
            ("KIND_THING", 3),
        ];
        let numbers = [
            ("BLOCK_M", BLOCK_M),
            ("BOTTOM_M", Lattice::OCC3D.bottom_m() as f32),
            ("VOXEL_M", Lattice::OCC3D.voxel_m() as f32),
            ("BIN_M", (BIN_COLUMNS as f64 * Lattice::OCC3D.voxel_m()) as f32),
            ("SKYLINE_0_M", SKYLINE_M[0]),
            ("SKYLINE_1_M", SKYLINE_M[1]),
            ("SKYLINE_2_M", SKYLINE_M[2]),
            ("SURFACE", SURFACE),
            ("LEAVES", LEAVES),
            ("KERB_M", KERB_M),
            ("KERB_EDGE_M", KERB_EDGE_M),
            ("KERB_SEEN_M", KERB_SEEN_M),
            ("HIGHEST_M", HIGHEST_M),
            ("SHADOW_M", SHADOW_M),
            ("HEAD_NEAR_M2", HEAD_NEAR_M2),
            ("LAMP_SHADOW_LIGHT", LAMP_SHADOW_LIGHT),
            ("LAMP_CLEAR_M", LAMP_CLEAR_M),
            ("LAMP_STEP_M", LAMP_STEP_M),
            ("MIRROR_M", MIRROR_M),
            ("FAR_M", FAR_M),
            ("CONTRAST", CONTRAST),
            // Farther than anything; WGSL has no infinity.
            ("INFINITE", 1e30),
        ];
        // Writing to a string cannot fail.
        for (name, value) in counts {
            let _ = writeln!(out, "const {name}: u32 = {value}u;");
        }
        for (name, value) in numbers {
            let _ = writeln!(out, "const {name}: f32 = {value:?};");
        }
        // One module; a file for each job.
        let parts = [
            include_str!("../../../shaders/appearance.wgsl"),
            include_str!("../../../shaders/appearance/field.wgsl"),
            include_str!("../../../shaders/appearance/ground.wgsl"),
            include_str!("../../../shaders/appearance/sky.wgsl"),
            include_str!("../../../shaders/appearance/things.wgsl"),
            include_str!("../../../shaders/appearance/trace.wgsl"),
            include_str!("../../../shaders/appearance/paint.wgsl"),
            include_str!("../../../shaders/appearance/material.wgsl"),
            include_str!("../../../shaders/appearance/scenery_material.wgsl"),
            include_str!("../../../shaders/appearance/thing_material.wgsl"),
            include_str!("../../../shaders/appearance/shade.wgsl"),
            include_str!("../../../shaders/appearance/render.wgsl"),
        ];
        out + &parts.concat()
    })
}

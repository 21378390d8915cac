//! A frame prepared for camera pictures, as plain numbers: the data that the renderers on the processor and on the
//! graphics card share. `sensors::pictures::appearance` fills it, `viewport::appearance` draws from it.

use glam::{Vec2, Vec3};

use super::{Extent, Lattice};

/// Edge of the voxels that pictures are drawn of, m, and number of them in a metre.
pub const VOXEL_M: f32 = Lattice::OCC3D.voxel_m() as f32;
/// See [`VOXEL_M`].
pub const PER_M: f32 = Lattice::OCC3D.per_m() as f32;
/// Heights of the bottom of the lowest of them and of the top of the highest, m.
pub const BOTTOM_M: f32 = Lattice::OCC3D.bottom_m() as f32;
/// See [`BOTTOM_M`].
pub const TOP_M: f32 = Lattice::OCC3D.top_m() as f32;

/// Voxels of the field along z, with room above the grid.
pub const NZ: usize = 46;
/// Columns and rows of cells in a block.
pub const BLOCK: usize = 8;
/// Edge of a block, m.
pub const BLOCK_M: f32 = (BLOCK as f64 * Lattice::OCC3D.voxel_m()) as f32;
/// Columns along a side of a bin of lines: 2 m.
pub const BIN_COLUMNS: usize = 5;
/// The field's surface.
pub const SURFACE: f32 = 0.5;
/// Roughness of leaves, in units of the field.
pub const LEAVES: f32 = 0.85;
/// Label of trunks: plants that carry a crown.
pub const TRUNK: u8 = 100;
/// Height of a sidewalk, m.
pub const KERB_M: f32 = 0.13;
/// Height that no ground exceeds, m.
pub const HIGHEST_M: f32 = 0.2;
/// Width of kerbstones where they are drawn, m.
pub const KERB_SEEN_M: f32 = 0.2;
/// Least softness of a kerb's edge, m.
pub const KERB_EDGE_M: f32 = 0.008;
/// Farthest shadow caster, m.
pub const SHADOW_M: f32 = 45.0;
/// Added to the squared distance to a head lamp, m^2: its light falls off with 1 / (distance^2 + this). The reflector
/// is wide and aims ahead, so that near surfaces are not overexposed.
pub const HEAD_NEAR_M2: f32 = 60.0;
/// Least light of a lamp on a surface, times exposure, at which its shadows are traced.
pub const LAMP_SHADOW_LIGHT: f32 = 0.02;
/// Distance from a lamp within which nothing casts a shadow in its light, m: a head lamp sits in a vehicle, a street
/// lamp hangs beside its post.
pub const LAMP_CLEAR_M: f32 = 0.6;
/// Step between the places along a ray to a lamp that are tested for shadow casters, m: posts near a lamp throw long
/// shadows.
pub const LAMP_STEP_M: f32 = 0.05;
/// Farthest mirrored thing, m.
pub const MIRROR_M: f32 = 60.0;
/// Farthest distance from which the map is seen, m.
pub const FAR_M: f32 = 400.0;
/// A pixel gets more samples if its tone differs from a neighbour's by more than this.
pub const CONTRAST: f32 = 0.10;
/// Number of words of a thing in [`AppearanceData::words`].
pub const THING_WORDS: usize = 23;
/// Number of words of a part; see [`THING_WORDS`].
pub const PART_WORDS: usize = 14;

/// Radii of the circles around a map on which the skyline stands, m; larger for a larger map, see
/// [`FieldShape::skyline`].
pub const SKYLINE_M: [f32; 3] = [72.0, 150.0, 320.0];
/// Distance from the middle to a corner of the map that [`SKYLINE_M`] is made for, m.
const SKYLINE_AROUND_M: f64 = 40.0 * std::f64::consts::SQRT_2;

/// How the field and the lists of an appearance cover a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldShape {
    /// The map.
    pub extent: Extent,
    /// Voxels of the field along x, with a ring of free voxels around.
    pub nx: usize,
    /// Along y.
    pub ny: usize,
    /// Blocks along x and along y.
    pub blocks: [usize; 2],
    /// Bins of lines along x and along y, from the map's lower corner.
    pub bins: [usize; 2],
    /// Lower corner of the map, m.
    pub low_m: Vec3,
    /// Corner of the blocks, m: half a voxel and the ring outside the map.
    pub blocks_from_m: Vec2,
    /// Middle of the map, m.
    pub middle_m: Vec2,
    /// Factor for [`SKYLINE_M`].
    pub skyline: f32,
}

impl FieldShape {
    /// The shape for a map.
    pub fn from_extent(extent: Extent) -> Self {
        let [nx, ny] = [extent.nx() + 2, extent.ny() + 2];
        let (low, high) = (extent.min_m(), extent.max_m());
        let corner_m = (high - low).truncate().length() / 2.0;
        Self {
            extent,
            nx,
            ny,
            blocks: [nx, ny].map(|n| (n - 1).div_ceil(BLOCK)),
            bins: [extent.nx(), extent.ny()].map(|n| n.div_ceil(BIN_COLUMNS)),
            low_m: low.as_vec3(),
            blocks_from_m: (low.truncate() - extent.voxel_m() / 2.0).as_vec2(),
            middle_m: ((low + high) / 2.0).truncate().as_vec2(),
            skyline: (corner_m / SKYLINE_AROUND_M).max(1.0) as f32,
        }
    }

    /// Index of a voxel in arrays `[x][y][z]` of the field.
    #[inline(always)]
    pub fn at(&self, x: usize, y: usize, z: usize) -> usize {
        (x * self.ny + y) * NZ + z
    }
}

/// Sections of [`AppearanceData::words`], in the order of [`AppearanceData::at`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AppearanceSection {
    /// Softened occupancy `[x][y][z]`, four bytes a word.
    Weight,
    /// Labels `[x][y][z]`, four bytes a word.
    Label,
    /// Cells that may hold a surface, bits along z, two words a column.
    Mask,
    /// Union of the masks of each block, two words each.
    Blocks,
    /// Structure of each column: 0 for none, else its number + 1.
    StructureOf,
    /// Axis (2), columns, height, id, thin, 2 unused.
    Structures,
    /// Shares of the four kinds of ground, `[x][y]`, four words.
    Share,
    /// 1 where there is only road around, `[x][y]`.
    Level,
    /// Class, id, lamps, first part, parts, foot (3), heading (2), size (3), paint (3), circle in m^2, height of the floor,
    /// 1 for scenery, first cut times 16 and number of cuts.
    Things,
    /// Kind, material, colour (3), six numbers of the shape.
    Parts,
    /// Normal and reach of half spaces; corners of cuts, with 0.
    Planes,
    /// Where the list of each block begins; one more at the end.
    ListStarts,
    /// Things near a block.
    Lists,
    /// Where the lines of each bin begin, `[x][y]`; one more at the end.
    BinStarts,
    /// From (2), to (2), kind, length before it.
    Segments,
    /// First point, points, low (2), high (2), direction (2).
    Crossings,
    /// Points of outlines (2).
    Outlines,
    /// Layers that lines may show, `[x][y]`.
    Allowed,
    /// Layers without a line, `[x][y]`.
    Orphans,
    /// Place (3), range, axis (3), kind, light (3), unused.
    Lamps,
    /// Not a section: how many lamps there are.
    LampCount,
    /// Not a section: how many crossings there are.
    CrossingCount,
    /// Linear colour of each class, three words.
    Calm,
    /// 1 if the ground is not level, then its heights `[x][y]`, then the lowest and highest of each block.
    Relief,
}

/// How many entries [`AppearanceData::at`] has.
pub const SECTIONS: usize = 24;

/// A frame under given conditions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AppearanceData {
    /// The map that it covers.
    pub extent: Extent,
    /// Arrays that are looked up by place, section by section.
    pub words: Vec<u32>,
    /// Start of each [`AppearanceSection`] in `words`; the last two entries are the counts.
    pub at: [u32; SECTIONS],
    /// to_sun, clouds | sun, haze per m | zenith, wet | horizon, snow | ambient, dust | bounce, lamps | haze, exposure
    /// | to_sun in the ego frame, greatest height in m.
    pub air: [[f32; 4]; 8],
    /// Rotation from the ego frame to the frame in which textures are fixed (x, y, z, w).
    pub turn: [f32; 4],
    /// Translation from the ego frame to the frame in which textures are fixed, m.
    pub shift_m: [f32; 3],
    /// Place of the vehicle, m: rain and snow fall around it.
    pub vehicle_m: [f32; 2],
    /// Height below which nothing is, m.
    pub lowest_m: f32,
    /// Seed that varies textures.
    pub seed: u32,
}

impl AppearanceData {
    /// Puts a section at the end.
    pub fn push(&mut self, section: AppearanceSection, words: impl IntoIterator<Item = u32>) {
        self.at[section as usize] = self.words.len() as u32;
        self.words.extend(words);
    }

    /// Puts bytes at the end, four to a word, the first one lowest.
    pub fn push_bytes(&mut self, section: AppearanceSection, bytes: &[u8]) {
        let word = |four: &[u8]| four.iter().rev().fold(0, |w, b| w << 8 | u32::from(*b));
        self.push(section, bytes.chunks(4).map(word));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shape of a window equals the constants from before maps had an extent.
    #[test]
    fn a_window_has_the_shape_it_always_had() {
        let shape = FieldShape::from_extent(Extent::WINDOW);
        assert_eq!(
            (shape.nx, shape.ny, shape.blocks, shape.bins),
            (202, 202, [26; 2], [40; 2])
        );
        assert_eq!(shape.low_m, Vec3::new(-40.0, -40.0, -1.0));
        assert_eq!(
            (shape.blocks_from_m, shape.middle_m),
            (Vec2::splat(-40.2), Vec2::ZERO)
        );
        assert_eq!(shape.skyline, 1.0);
        let map = FieldShape::from_extent(Extent::new([-150, -110], [480, 321]).expect("sound"));
        assert_eq!((map.blocks, map.bins), ([61, 41], [96, 65]));
        assert!(map.skyline * SKYLINE_M[0] > 120.0);
    }

    #[test]
    fn bytes_are_found_where_the_shader_looks() {
        let mut data = AppearanceData::default();
        data.push(AppearanceSection::Weight, [7]);
        data.push_bytes(AppearanceSection::Label, &[1, 2, 3, 4, 250]);
        let at = data.at[AppearanceSection::Label as usize];
        let byte = |i: u32| data.words[(at + i / 4) as usize] >> (i % 4 * 8) & 255;
        assert_eq!([0, 1, 2, 3, 4].map(byte), [1, 2, 3, 4, 250]);
        assert!((AppearanceSection::Calm as usize) < SECTIONS);
    }
}

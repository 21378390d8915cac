//! A frame made ready for camera pictures, as plain numbers: what the renderers on processor and graphics card share.
//! `sensors::appearance` fills it, `viewport::appearance` draws from it.

use super::grid::Window;

/// Voxels of the field along x, with a free ring around.
pub const NX: usize = Window::NX + 2;
/// Along y.
pub const NY: usize = Window::NY + 2;
/// Along z, with room above the grid.
pub const NZ: usize = 46;
/// Columns and rows of cells in a block.
pub const BLOCK: usize = 8;
/// Blocks along x and along y.
pub const BLOCKS: usize = (NX - 1).div_ceil(BLOCK);
/// Edge of a block, m.
pub const BLOCK_M: f32 = (BLOCK as f64 * Window::VOXEL_M) as f32;
/// Corner of the blocks, m: half a voxel and the ring outside the grid.
pub const BLOCKS_FROM_M: f32 = -40.2;
/// The field's surface.
pub const SURFACE: f32 = 0.5;
/// Roughness of leaves, in units of the field.
pub const LEAVES: f32 = 0.85;
/// Label of trunks: plants that carry a crown.
pub const TRUNK: u8 = 100;
/// Height of a sidewalk, m.
pub const KERB_M: f32 = 0.13;
/// Nothing of the ground is higher, m.
pub const HIGHEST_M: f32 = 0.2;
/// Width of kerbstones, m, for when they are seen.
pub const KERB_SEEN_M: f32 = 0.2;
/// A kerb's edge is at least this soft, m.
pub const KERB_EDGE_M: f32 = 0.008;
/// Farthest shadow caster, m.
pub const SHADOW_M: f32 = 45.0;
/// Light of a head lamp falls off with 1 / (distance^2 + this), m^2: its reflector is wide and aims ahead, so that it
/// does not burn out what is near.
pub const HEAD_NEAR_M2: f32 = 60.0;
/// Light of a lamp on a surface, times exposure, from which on its shadow is looked for.
pub const LAMP_SHADOW_LIGHT: f32 = 0.02;
/// Nothing this near to a lamp keeps its light back, m: it sits in a vehicle.
pub const LAMP_CLEAR_M: f32 = 0.6;
/// What keeps a lamp's light back is looked for this often along the way, m: posts near a lamp throw long shadows.
pub const LAMP_STEP_M: f32 = 0.05;
/// Farthest mirrored thing, m.
pub const MIRROR_M: f32 = 60.0;
/// Nothing of the grid lies beyond, m.
pub const FAR_M: f32 = 400.0;
/// A pixel gets more samples if its tone differs from a neighbour's by more than this.
pub const CONTRAST: f32 = 0.10;
/// Words of a thing and of a part in [`AppearanceData::words`].
pub const THING_WORDS: usize = 20;
/// See [`THING_WORDS`].
pub const PART_WORDS: usize = 12;

/// Sections of [`AppearanceData::words`], in the order of [`AppearanceData::at`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// Softened occupancy `[x][y][z]`, four bytes a word.
    Weight,
    /// Labels, the same.
    Label,
    /// Cells that may hold a surface, bits along z, two words a column.
    Mask,
    /// Their union by block, two words each.
    Blocks,
    /// Structure of each column, 0 for none, else its number + 1.
    StructureOf,
    /// Axis (2), columns, height, id, thin, 2 unused.
    Structures,
    /// Shares of the four kinds of ground, `[x][y]`, four words.
    Share,
    /// 1 where there is only road around, `[x][y]`.
    Level,
    /// Class, id, lamps, first part, parts, foot (3), heading (2), size (3), paint (3), circle in m^2.
    Things,
    /// Kind, material, colour (3), six numbers of the shape.
    Parts,
    /// Normal and reach of half spaces.
    Planes,
    /// Where the list of each block begins; one more at the end.
    ListStarts,
    /// Things near a block.
    Lists,
    /// Where the lines of each bin of 2 m begin; one more at the end.
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
}

/// How many entries [`AppearanceData::at`] has.
pub const SECTIONS: usize = 24;

/// A frame under certain conditions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AppearanceData {
    /// Everything that is looked up by place.
    pub words: Vec<u32>,
    /// Where each [`Section`] begins in `words`; the two counts.
    pub at: [u32; SECTIONS],
    /// to_sun, clouds | sun, haze per m | zenith, wet | horizon, snow | ambient, dust | bounce, lamps | haze, exposure
    /// | to_sun in the ego frame, greatest height in m.
    pub air: [[f32; 4]; 8],
    /// Rotation from the ego frame to where textures stay (x, y, z, w).
    pub turn: [f32; 4],
    /// And the way, m.
    pub shift_m: [f32; 3],
    /// Varies textures.
    pub seed: u32,
}

impl AppearanceData {
    /// Puts a section at the end.
    pub fn push(&mut self, section: Section, words: impl IntoIterator<Item = u32>) {
        self.at[section as usize] = self.words.len() as u32;
        self.words.extend(words);
    }

    /// Puts bytes at the end, four to a word, the first one lowest.
    pub fn push_bytes(&mut self, section: Section, bytes: &[u8]) {
        let word = |four: &[u8]| four.iter().rev().fold(0, |w, b| w << 8 | u32::from(*b));
        self.push(section, bytes.chunks(4).map(word));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_found_where_the_shader_looks() {
        let mut data = AppearanceData::default();
        data.push(Section::Weight, [7]);
        data.push_bytes(Section::Label, &[1, 2, 3, 4, 250]);
        let at = data.at[Section::Label as usize];
        let byte = |i: u32| data.words[(at + i / 4) as usize] >> (i % 4 * 8) & 255;
        assert_eq!([0, 1, 2, 3, 4].map(byte), [1, 2, 3, 4, 250]);
        assert!((Section::Calm as usize) < SECTIONS);
    }
}

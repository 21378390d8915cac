//! The models of a `.vox` file, each where the nodes put it, as one map.

use std::collections::BTreeMap;

use scene::classes::Palette;
use scene::{Class, Extent, VoxelGrid};

use super::read::{Model, NO_TURN, VoxFile, VoxNode};
use super::{OWN_NAME, middle};

/// Most nodes that are visited: one that lies in itself, or in many others, would never end.
const MOST_VISITS: usize = 1 << 16;
/// Most voxels that are placed, models that are shown several times counted each time.
const MOST_VOXELS: usize = 1 << 26;
/// Columns that a map may have however little it holds, and how many more for each voxel.
const MOST_COLUMNS: usize = 1 << 20;
const COLUMNS_PER_VOXEL: usize = 256;

/// A map, and counts of the parts of the file that it leaves out.
#[derive(Debug)]
pub(crate) struct VoxMap {
    pub grid: VoxelGrid,
    pub skipped: BTreeMap<String, usize>,
}

/// Where a model stands.
struct Stand<'a> {
    model: &'a Model<'a>,
    turn: [[i64; 3]; 3],
    at: [i64; 3],
}

impl Stand<'_> {
    /// A place of the model, in halves of a voxel from its lower corner, in the map.
    fn place(&self, halves: [i64; 3]) -> [i64; 3] {
        let from_middle: [i64; 3] =
            std::array::from_fn(|axis| halves[axis] - 2 * middle(self.model.size[axis]));
        std::array::from_fn(|row| {
            let turned: i64 = (0..3).map(|axis| self.turn[row][axis] * from_middle[axis]).sum();
            turned + 2 * self.at[row]
        })
    }

    /// The voxel of the map that a voxel of the model becomes.
    fn voxel(&self, voxel: [i64; 3]) -> [i64; 3] {
        self.place(voxel.map(|v| 2 * v + 1))
            .map(|half| half.div_euclid(2))
    }

    /// First columns and the ones after the last.
    fn columns(&self) -> ([i64; 2], [i64; 2]) {
        let (a, b) = (self.place([0; 3]), self.place(self.model.size.map(|n| 2 * n)));
        let low = |axis: usize| a[axis].min(b[axis]).div_euclid(2);
        let high = |axis: usize| a[axis].max(b[axis]).div_euclid(2);
        ([low(0), low(1)], [high(0), high(1)])
    }
}

/// The map that a file shows. Its columns are those of the networks' window and of the models around it. In a file that
/// this program wrote they are those of the models alone.
pub(crate) fn place(file: &VoxFile<'_>) -> Result<VoxMap, String> {
    let mut skipped = BTreeMap::new();
    let mut count = |what: &str, n: usize| {
        if n > 0 {
            *skipped.entry(what.to_owned()).or_default() += n;
        }
    };
    file.unused
        .iter()
        .for_each(|(name, n)| count(&format!("chunk {name}"), *n));
    let stands = stands(file, &mut count)?;
    let voxels: usize = stands.iter().map(|stand| stand.model.voxels.len() / 4).sum();
    if voxels > MOST_VOXELS {
        return Err(format!(
            "{voxels} voxels, models shown several times counted each time, expected at most {MOST_VOXELS}"
        ));
    }
    let is_own = file
        .nodes
        .values()
        .any(|node| matches!(node, VoxNode::Transform { name: Some(name), .. } if name == OWN_NAME));
    let extent = extent(&stands, is_own, voxels)?;
    let classes = file.colors.as_deref().map(classes).unwrap_or_default();
    let mut grid = VoxelGrid::over(extent);
    let (mut outside, mut beyond, mut unknown) = (0, 0, 0);
    for stand in &stands {
        for voxel in stand.model.voxels.chunks_exact(4) {
            let of_model = [voxel[0], voxel[1], voxel[2]].map(i64::from);
            if voxel[3] == 0 || (0..3).any(|axis| of_model[axis] >= stand.model.size[axis]) {
                outside += 1;
                continue;
            }
            let [x, y, z] = stand.voxel(of_model);
            let [x, y] = [x - i64::from(extent.from()[0]), y - i64::from(extent.from()[1])];
            let (Ok(x), Ok(y), Ok(z)) = (usize::try_from(x), usize::try_from(y), usize::try_from(z)) else {
                beyond += 1;
                continue;
            };
            if !extent.holds(x, y) || z >= extent.nz() {
                beyond += 1;
                continue;
            }
            let class = classes.get(usize::from(voxel[3]) - 1).copied().flatten();
            unknown += usize::from(class.is_none());
            grid.set(x, y, z, class.unwrap_or(Class::Others).id());
        }
    }
    count("voxels outside their model", outside);
    count("voxels above or below the map", beyond);
    count("voxels of colours that no class has, taken as others", unknown);
    match grid.count_set() {
        0 if !is_own => Err(format!("none of {voxels} voxels is from 0 to 15 high")),
        _ => Ok(VoxMap { grid, skipped }),
    }
}

/// Models and where they stand, in the order of the nodes.
fn stands<'a>(file: &'a VoxFile<'a>, count: &mut impl FnMut(&str, usize)) -> Result<Vec<Stand<'a>>, String> {
    if file.nodes.is_empty() {
        // As the editor shows them: each in the middle, on the ground.
        let stand = |model: &'a Model<'a>| Stand {
            model,
            turn: NO_TURN,
            at: [0, 0, middle(model.size[2])],
        };
        return Ok(file.models.iter().map(stand).collect());
    }
    let mut stands = Vec::new();
    let root = file.nodes.keys().next().copied().unwrap_or(0);
    let mut open = vec![(root, NO_TURN, [0; 3])];
    let mut visits = 0;
    while let Some((number, turn, at)) = open.pop() {
        visits += 1;
        if visits > MOST_VISITS || open.len() > MOST_VISITS {
            return Err(format!(
                "nodes within nodes without end, expected at most {MOST_VISITS}"
            ));
        }
        match file.nodes.get(&number) {
            Some(VoxNode::Transform { layer, is_hidden, .. })
                if *is_hidden || file.hidden_layers.contains(layer) =>
            {
                count("hidden parts", 1);
            }
            Some(VoxNode::Transform {
                child,
                turn: own,
                move_by,
                moments,
                ..
            }) => {
                count(
                    "moments of an animation after the first",
                    moments.saturating_sub(1) as usize,
                );
                open.push((*child, product(&turn, own), moved(&turn, move_by, &at)));
            }
            Some(VoxNode::Group(children)) => {
                open.extend(children.iter().rev().map(|child| (*child, turn, at)));
            }
            Some(VoxNode::Shape(models)) => {
                count(
                    "models of an animation after the first",
                    models.len().saturating_sub(1),
                );
                let model = models
                    .first()
                    .and_then(|m| file.models.get(usize::try_from(*m).ok()?));
                match model {
                    Some(model) => stands.push(Stand { model, turn, at }),
                    None => count("parts without a model", 1),
                }
            }
            None => count("nodes that are not there", 1),
        }
    }
    Ok(stands)
}

fn product(a: &[[i64; 3]; 3], b: &[[i64; 3]; 3]) -> [[i64; 3]; 3] {
    std::array::from_fn(|row| std::array::from_fn(|column| (0..3).map(|k| a[row][k] * b[k][column]).sum()))
}

fn moved(turn: &[[i64; 3]; 3], by: &[i64; 3], at: &[i64; 3]) -> [i64; 3] {
    std::array::from_fn(|row| at[row] + (0..3).map(|k| turn[row][k] * by[k]).sum::<i64>())
}

fn extent(stands: &[Stand<'_>], is_own: bool, voxels: usize) -> Result<Extent, String> {
    let window = Extent::WINDOW;
    let from = window.from().map(i64::from);
    let mut all = (!is_own).then(|| (from, [from[0] + window.nx() as i64, from[1] + window.ny() as i64]));
    for (low, high) in stands.iter().map(Stand::columns) {
        let (l, h) = all.get_or_insert((low, high));
        for axis in 0..2 {
            l[axis] = l[axis].min(low[axis]);
            h[axis] = h[axis].max(high[axis]);
        }
    }
    let Some((low, high)) = all else {
        return Err("no model is shown".into());
    };
    let size = [0, 1].map(|axis| (high[axis] - low[axis]) as usize);
    let columns = size[0].saturating_mul(size[1]);
    let most = MOST_COLUMNS.saturating_add(voxels.saturating_mul(COLUMNS_PER_VOXEL));
    if columns > most {
        return Err(format!(
            "{voxels} voxels on a map of {} x {} columns, expected at most {most} columns for so few",
            size[0], size[1]
        ));
    }
    let low = low.map(|v| v.clamp(i32::MIN.into(), i32::MAX.into()) as i32);
    Extent::new(low, size)
}

/// The class of each colour, in either of the palettes.
fn classes(colors: &[[u8; 3]]) -> Vec<Option<Class>> {
    let class_of = |color: &[u8; 3]| {
        let palettes = [Palette::Standard, Palette::ColorBlindSafe].into_iter();
        let mut pairs = palettes.flat_map(|palette| Class::ALL.map(|class| (class.color_in(palette), class)));
        let found = pairs.find(|(of_class, class)| of_class == color && *class != Class::Free);
        found.map(|(_, class)| class)
    };
    colors.iter().map(class_of).collect()
}

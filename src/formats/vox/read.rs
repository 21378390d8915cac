//! The chunks of a `.vox` file. All of them lie in one list, so no function here is recursive; the size that a chunk
//! gives is checked against the bytes that are there.

use std::collections::{BTreeMap, BTreeSet};

use scene::message::quoted;

use super::LONGEST;

/// The parts of a file that are used here.
#[derive(Debug, Default)]
pub(crate) struct VoxFile<'a> {
    pub models: Vec<Model<'a>>,
    pub nodes: BTreeMap<i32, VoxNode>,
    /// Red, green, blue of colours 1 to 255.
    pub colors: Option<Vec<[u8; 3]>>,
    pub hidden_layers: BTreeSet<i32>,
    /// Chunks that are not used, by name.
    pub unused: BTreeMap<String, usize>,
}

/// A box of voxels.
#[derive(Debug)]
pub(crate) struct Model<'a> {
    /// Voxels along x, y and z.
    pub size: [i64; 3],
    /// x, y, z and the number of the colour of each.
    pub voxels: &'a [u8],
}

/// A node of the graph.
#[derive(Debug, PartialEq)]
pub(crate) enum VoxNode {
    /// Turns and moves its child.
    Transform {
        name: Option<String>,
        child: i32,
        layer: i32,
        is_hidden: bool,
        /// Rows of a turn onto the axes: each has one 1 or -1.
        turn: [[i64; 3]; 3],
        move_by: [i64; 3],
        /// Moments of an animation; the first one counts.
        moments: u32,
    },
    /// Several nodes.
    Group(Vec<i32>),
    /// Models, the first one of them shown.
    Shape(Vec<i32>),
}

/// The turn that leaves everything in place.
pub(crate) const NO_TURN: [[i64; 3]; 3] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// A chunk: its name, its content and its children.
type Chunk<'a> = ([u8; 4], &'a [u8], &'a [u8]);

impl<'a> VoxFile<'a> {
    /// Reads the chunks of a file.
    pub fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let mut all = Bytes { left: bytes };
        if all.take(4).ok() != Some(b"VOX ") {
            return Err("no .vox file: it does not begin with \"VOX \"".into());
        }
        let _version = all.u32()?;
        let (id, content, children) = all.chunk()?;
        if id != *b"MAIN" || !content.is_empty() {
            return Err(format!("a first chunk {}, expected MAIN", name(&id)));
        }
        let mut file = VoxFile::default();
        let mut size = None;
        let mut chunks = Bytes { left: children };
        while !chunks.left.is_empty() {
            let (id, content, _) = chunks.chunk()?;
            let mut of = Bytes { left: content };
            let within = |e: String| format!("chunk {}: {e}", name(&id));
            match &id {
                b"SIZE" => size = Some(of.size().map_err(within)?),
                b"XYZI" => {
                    let size = size.take().ok_or_else(|| within("no SIZE before it".into()))?;
                    let count = of.u32().map_err(within)?;
                    let voxels = of.take(count as usize * 4).map_err(within)?;
                    file.models.push(Model { size, voxels });
                }
                b"RGBA" => {
                    let colors = of.take(1024).map_err(within)?;
                    file.colors = Some(colors.chunks_exact(4).map(|c| [c[0], c[1], c[2]]).collect());
                }
                b"nTRN" | b"nGRP" | b"nSHP" => {
                    let (number, node) = of.node(&id).map_err(within)?;
                    file.nodes.insert(number, node);
                }
                b"LAYR" => {
                    let layer = of.i32().map_err(within)?;
                    if of.dict().map_err(within)?.is_hidden {
                        file.hidden_layers.insert(layer);
                    }
                }
                // Names of colours, and how the editor sorts them: the colours tell.
                b"NOTE" | b"IMAP" | b"PACK" => {}
                _ => *file.unused.entry(name(&id)).or_default() += 1,
            }
        }
        match file.models.is_empty() {
            true => Err("no model, expected chunks SIZE and XYZI".into()),
            false => Ok(file),
        }
    }
}

/// A chunk's name for a message.
fn name(id: &[u8; 4]) -> String {
    quoted(&String::from_utf8_lossy(id), 8)
}

/// The entries of a dictionary that are used.
#[derive(Default)]
struct Dict {
    name: Option<String>,
    is_hidden: bool,
    turn: Option<u8>,
    move_by: Option<[i64; 3]>,
}

/// Bytes that have not been read yet.
struct Bytes<'a> {
    left: &'a [u8],
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let found = self.left.len();
        let Some((taken, left)) = self.left.split_at_checked(count) else {
            return Err(format!("{found} bytes, expected {count}"));
        };
        self.left = left;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32, String> {
        let bytes = self.take(4)?;
        Ok(bytes.first_chunk().map_or(0, |b| u32::from_le_bytes(*b)))
    }

    fn i32(&mut self) -> Result<i32, String> {
        Ok(self.u32()? as i32)
    }

    /// Name, content and children of a chunk.
    fn chunk(&mut self) -> Result<Chunk<'a>, String> {
        let id = *self.take(4)?.first_chunk().unwrap_or(b"    ");
        let within = |e: String| format!("chunk {}: {e}", name(&id));
        let [content, children] = [self.u32().map_err(within)?, self.u32().map_err(within)?];
        let content = self.take(content as usize).map_err(within)?;
        let children = self.take(children as usize).map_err(within)?;
        Ok((id, content, children))
    }

    fn size(&mut self) -> Result<[i64; 3], String> {
        let size = [self.u32()?, self.u32()?, self.u32()?];
        match size.iter().all(|n| (1..=LONGEST as u32).contains(n)) {
            true => Ok(size.map(i64::from)),
            false => Err(format!(
                "{size:?} voxels, expected 1 to {LONGEST} along each side"
            )),
        }
    }

    /// The number of a node and the node.
    fn node(&mut self, id: &[u8; 4]) -> Result<(i32, VoxNode), String> {
        let number = self.i32()?;
        let dict = self.dict()?;
        let node = match id {
            b"nTRN" => {
                let [child, _reserved, layer] = [self.i32()?, self.i32()?, self.i32()?];
                let moments = self.u32()?;
                let first = if moments > 0 {
                    self.dict()?
                } else {
                    Dict::default()
                };
                VoxNode::Transform {
                    name: dict.name,
                    child,
                    layer,
                    is_hidden: dict.is_hidden,
                    turn: first.turn.map_or(Ok(NO_TURN), turn)?,
                    move_by: first.move_by.unwrap_or_default(),
                    moments,
                }
            }
            b"nGRP" => VoxNode::Group(self.numbers(4)?),
            _ => {
                // Behind each number a dictionary, of 4 bytes at least.
                let count = self.counted(8)?;
                let mut models = Vec::with_capacity(count);
                for _ in 0..count {
                    models.push(self.i32()?);
                    self.dict()?;
                }
                VoxNode::Shape(models)
            }
        };
        Ok((number, node))
    }

    /// A count of entries of at least `bytes` bytes each. Errors if the bytes left cannot hold so many.
    fn counted(&mut self, bytes: usize) -> Result<usize, String> {
        let count = self.u32()? as usize;
        match count <= self.left.len() / bytes {
            true => Ok(count),
            false => Err(format!("{} bytes, expected {count} entries", self.left.len())),
        }
    }

    fn numbers(&mut self, bytes: usize) -> Result<Vec<i32>, String> {
        let count = self.counted(bytes)?;
        (0..count).map(|_| self.i32()).collect()
    }

    fn string(&mut self) -> Result<&'a [u8], String> {
        let length = self.u32()?;
        self.take(length as usize)
    }

    fn dict(&mut self) -> Result<Dict, String> {
        let mut dict = Dict::default();
        for _ in 0..self.counted(8)? {
            let (key, value) = (self.string()?, self.string()?);
            match key {
                b"_name" => dict.name = Some(quoted(&String::from_utf8_lossy(value), 80)),
                b"_hidden" => dict.is_hidden = value == b"1",
                b"_r" => dict.turn = Some(number(value)?),
                b"_t" => {
                    let words: Vec<&[u8]> = value.split(|b| *b == b' ').filter(|w| !w.is_empty()).collect();
                    let &[x, y, z] = words.as_slice() else {
                        return Err(format!("_t is {}, expected three numbers", shown(value)));
                    };
                    let [x, y, z]: [i32; 3] = [number(x)?, number(y)?, number(z)?];
                    dict.move_by = Some([x, y, z].map(i64::from));
                }
                _ => {}
            }
        }
        Ok(dict)
    }
}

fn shown(bytes: &[u8]) -> String {
    format!("{:?}", quoted(&String::from_utf8_lossy(bytes), 40))
}

fn number<T: std::str::FromStr>(bytes: &[u8]) -> Result<T, String> {
    let text = std::str::from_utf8(bytes).ok();
    let number = text.and_then(|text| text.trim().parse().ok());
    number.ok_or_else(|| format!("{}, expected a whole number", shown(bytes)))
}

/// The rows of a turn: bits 0 and 1 say where the first row has its 1, bits 2 and 3 the second; bits 4 to 6 are the signs.
fn turn(bits: u8) -> Result<[[i64; 3]; 3], String> {
    let (first, second) = (usize::from(bits & 3), usize::from(bits >> 2 & 3));
    if first > 2 || second > 2 || first == second {
        return Err(format!("_r is {bits}, expected a turn onto the axes"));
    }
    let mut rows = [[0; 3]; 3];
    for (row, at) in [first, second, 3 - first - second].into_iter().enumerate() {
        rows[row][at] = if bits >> (4 + row) & 1 == 1 { -1 } else { 1 };
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_rows_with_a_sign() {
        assert_eq!(turn(4), Ok(NO_TURN));
        // As in the specification: the rows 0 1 0, 0 0 -1, -1 0 0.
        let example = 1 | 2 << 2 | 1 << 5 | 1 << 6;
        assert_eq!(turn(example), Ok([[0, 1, 0], [0, 0, -1], [-1, 0, 0]]));
        assert!(turn(0).is_err() && turn(3).is_err() && turn(12).is_err());
    }
}

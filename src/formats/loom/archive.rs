//! The zip of a project: entries of known size, in and out, none larger than it may be.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Cursor, Read, Seek, Write};
use std::sync::Arc;

use serde::Serialize;
use serde::de::DeserializeOwned;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use scene::grid::{BrickGrid, NOT_PAINTED};
use scene::message::{one_line, quoted};
use scene::{BevLayer, BevLayout, Class, Extent, Polyline, VoxelGrid};

use super::{LARGEST_FILE, ProjectError};

/// Largest JSON entry, bytes.
pub(super) const MAX_JSON: u64 = 64 << 20;
/// Largest sum of all entries, unpacked, bytes.
const MAX_UNPACKED: u64 = 4 << 30;

/// Writes entries one after the other.
pub(super) struct Writer {
    zip: ZipWriter<Cursor<Vec<u8>>>,
    unpacked: u64,
}

impl Writer {
    pub(super) fn new() -> Self {
        Self {
            zip: ZipWriter::new(Cursor::new(Vec::new())),
            unpacked: 0,
        }
    }

    pub(super) fn put(&mut self, entry: &str, bytes: &[u8]) -> Result<(), ProjectError> {
        self.entry(entry, bytes, CompressionMethod::Deflated)
    }

    /// Bytes that are packed already.
    pub(super) fn packed(&mut self, entry: &str, bytes: &[u8]) -> Result<(), ProjectError> {
        self.entry(entry, bytes, CompressionMethod::Stored)
    }

    fn entry(&mut self, entry: &str, bytes: &[u8], method: CompressionMethod) -> Result<(), ProjectError> {
        self.unpacked += bytes.len() as u64;
        within("the size of the unpacked project", self.unpacked, MAX_UNPACKED)?;
        // The bytes must not depend on the machine or the moment.
        let options = SimpleFileOptions::default()
            .compression_method(method)
            .compression_level((method == CompressionMethod::Deflated).then_some(6))
            .last_modified_time(DateTime::default())
            .system(zip::System::Unix)
            .unix_permissions(0o644);
        let failed = |e: ZipError| ProjectError::Io(io::Error::other(e));
        self.zip.start_file(entry, options).map_err(failed)?;
        Ok(self.zip.write_all(bytes)?)
    }

    pub(super) fn json(&mut self, entry: &str, value: &impl Serialize) -> Result<(), ProjectError> {
        let bytes = serde_json::to_vec(value).map_err(|e| ProjectError::Json {
            entry: entry.into(),
            detail: e.to_string(),
        })?;
        within(&format!("the size of {entry}"), bytes.len() as u64, MAX_JSON)?;
        self.put(entry, &bytes)
    }

    pub(super) fn labels<const FILL: u8>(
        &mut self,
        entry: &str,
        grid: &BrickGrid<FILL>,
    ) -> Result<(), ProjectError> {
        let dense = grid.to_dense();
        check_labels(entry, grid.extent(), &dense, FILL)?;
        self.put(entry, &dense)
    }

    pub(super) fn finish(self) -> Result<Vec<u8>, ProjectError> {
        let bytes = self.zip.finish().map_err(io::Error::other)?.into_inner();
        within("the size of the project file", bytes.len() as u64, LARGEST_FILE)?;
        Ok(bytes)
    }
}

/// Reads entries by name and keeps a list of those that were not read.
pub(super) struct Reader<R> {
    zip: ZipArchive<R>,
    unread: BTreeSet<String>,
    /// Entries that a migration made; they go before those of the zip.
    made: BTreeMap<String, Vec<u8>>,
}

impl<R: Read + Seek> Reader<R> {
    pub(super) fn new(reader: R) -> Result<Self, ProjectError> {
        let zip = ZipArchive::new(reader).map_err(|e| match e {
            ZipError::Io(e) if e.kind() != io::ErrorKind::UnexpectedEof => ProjectError::Io(e),
            e => ProjectError::NotAProject(one_line(&e)),
        })?;
        let broken = |e: ZipError| ProjectError::NotAProject(one_line(&e));
        if zip.has_duplicate_names() {
            return Err(ProjectError::NotAProject("an entry is there twice".into()));
        }
        let (mut unread, mut unpacked) = (BTreeSet::new(), 0u64);
        for index in 0..zip.len() {
            let entry = zip.by_index_data(index).map_err(broken)?;
            unpacked = unpacked.saturating_add(entry.size());
            unread.insert(String::from_utf8_lossy(entry.name_raw()).into_owned());
        }
        within("the size of the unpacked project", unpacked, MAX_UNPACKED)?;
        Ok(Self {
            zip,
            unread,
            made: BTreeMap::new(),
        })
    }

    /// True if the entry is there and was not read.
    pub(super) fn has(&self, entry: &str) -> bool {
        self.unread.contains(entry)
    }

    /// Counts the entries of a folder as read, whether or not they were.
    pub(super) fn forget(&mut self, folder: &str) {
        self.unread.retain(|entry| !entry.starts_with(folder));
    }

    /// Reads all of an entry, unpacked, if that is at most `limit` bytes. The size that the zip declares is checked
    /// first, but memory grows only with the bytes that are really there.
    pub(super) fn bytes(&mut self, entry: &str, limit: u64) -> Result<Vec<u8>, ProjectError> {
        self.unread.remove(entry);
        if let Some(bytes) = self.made.remove(entry) {
            within(&format!("the size of {entry}"), bytes.len() as u64, limit)?;
            return Ok(bytes);
        }
        let damaged = |detail: String| ProjectError::Damaged {
            entry: entry.into(),
            detail,
        };
        let mut file = self.zip.by_name(entry).map_err(|e| match e {
            ZipError::FileNotFound => ProjectError::MissingEntry { entry: entry.into() },
            e => damaged(one_line(&e)),
        })?;
        let what = format!("the size of {entry}");
        within(&what, file.size(), limit)?;
        let mut bytes = Vec::new();
        // One byte more, so that a longer stream shows and the check sum is compared at its end.
        let read = (&mut file).take(limit + 1).read_to_end(&mut bytes);
        read.map_err(|e| damaged(one_line(&e)))?;
        within(&what, bytes.len() as u64, limit)?;
        Ok(bytes)
    }

    /// Puts an entry in place of one of that name, if there is one.
    pub(super) fn put(&mut self, entry: &str, bytes: Vec<u8>) {
        self.unread.insert(entry.to_owned());
        self.made.insert(entry.to_owned(), bytes);
    }

    /// Reads all of an entry of known size: `count` units of `unit_bytes` bytes.
    pub(super) fn exactly(
        &mut self,
        entry: &str,
        count: usize,
        unit_bytes: usize,
        unit: &'static str,
    ) -> Result<Vec<u8>, ProjectError> {
        let wrong = |bytes: u64| ProjectError::Size {
            entry: entry.into(),
            expected: count as u64,
            found: bytes / unit_bytes as u64,
            unit,
        };
        let expected = (count * unit_bytes) as u64;
        match self.bytes(entry, expected) {
            Ok(bytes) if bytes.len() as u64 == expected => Ok(bytes),
            Ok(bytes) => Err(wrong(bytes.len() as u64)),
            Err(ProjectError::TooLarge { found, .. }) => Err(wrong(found)),
            Err(e) => Err(e),
        }
    }

    pub(super) fn layout(
        &mut self,
        entry: &str,
        extent: Extent,
        polylines: Arc<Vec<Polyline>>,
    ) -> Result<BevLayout, ProjectError> {
        let bytes = self.exactly(entry, extent.columns(), 4, "cells")?;
        let words = bytes.chunks_exact(4);
        let cells: Vec<u32> = words
            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        let known = BevLayer::MAP.iter().fold(0, |bits, layer| bits | layer.bit());
        if let Some(at) = cells.iter().position(|c| c & !known != 0) {
            let [x, y] = extent.column(at);
            return Err(ProjectError::Cell {
                entry: entry.into(),
                cell: format!("cell [{x}, {y}]"),
                found: cells[at],
                expected: "bits of the eight map layers only",
            });
        }
        let mut layout =
            BevLayout::from_cells_over(extent, cells, Vec::new()).map_err(|found| ProjectError::Size {
                entry: entry.into(),
                expected: extent.columns() as u64,
                found: found as u64,
                unit: "cells",
            })?;
        layout.polylines = polylines;
        Ok(layout)
    }

    pub(super) fn labels(&mut self, entry: &str, extent: Extent, fill: u8) -> Result<Vec<u8>, ProjectError> {
        let dense = self.exactly(entry, extent.voxels(), 1, "voxels")?;
        check_labels(entry, extent, &dense, fill)?;
        Ok(dense)
    }

    /// An occupancy grid of the extent of `like` that shares the bricks of `like` wherever the two are equal.
    pub(super) fn occupancy(&mut self, entry: &str, like: &VoxelGrid) -> Result<VoxelGrid, ProjectError> {
        let extent = like.extent();
        let dense = self.labels(entry, extent, Class::FREE)?;
        let mut grid = like.clone();
        for ([x, y], column) in extent.all_columns().zip(dense.chunks_exact(extent.nz())) {
            if grid.column(x, y) != column {
                grid.column_mut(x, y).copy_from_slice(column);
            }
        }
        Ok(grid)
    }

    pub(super) fn expect_all_read(&self) -> Result<(), ProjectError> {
        match self.unread.first() {
            Some(entry) => Err(ProjectError::UnknownEntry {
                entry: quoted(entry, 80),
            }),
            None => Ok(()),
        }
    }
}

pub(super) fn parse<T: DeserializeOwned>(entry: &str, bytes: &[u8]) -> Result<T, ProjectError> {
    serde_json::from_slice(bytes).map_err(|e| ProjectError::Json {
        entry: entry.into(),
        detail: one_line(&e),
    })
}

pub(super) fn within(what: &str, found: u64, limit: u64) -> Result<(), ProjectError> {
    if found <= limit {
        return Ok(());
    }
    Err(ProjectError::TooLarge {
        what: what.into(),
        found,
        limit,
    })
}

pub(super) fn wrong_voxels(entry: &str, extent: Extent, found: u64) -> ProjectError {
    ProjectError::Size {
        entry: entry.into(),
        expected: extent.voxels() as u64,
        found,
        unit: "voxels",
    }
}

pub(super) fn check_labels(entry: &str, extent: Extent, dense: &[u8], fill: u8) -> Result<(), ProjectError> {
    let wrong = |v: &u8| usize::from(*v) >= Class::COUNT && *v != fill;
    let Some(at) = dense.iter().position(wrong) else {
        return Ok(());
    };
    let ([x, y], z) = (extent.column(at / extent.nz()), at % extent.nz());
    Err(ProjectError::Cell {
        entry: entry.into(),
        cell: format!("voxel [{x}, {y}, {z}]"),
        found: u32::from(dense[at]),
        expected: if fill == NOT_PAINTED {
            "0 to 17 or 255"
        } else {
            "0 to 17"
        },
    })
}

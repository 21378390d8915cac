//! Formats that are not read, recognised by their first bytes: what a file is, and what readable format to make of it.
//! One table; [`super::format_of`] consults it when no format that is read claims the file.

use std::path::Path;

use crate::FormatError;

/// A format that is not read.
struct Foreign {
    /// Name of the format, with its article.
    what: &'static str,
    /// Advice on what to do instead.
    instead: &'static str,
    /// True for the first bytes of such a file.
    is: fn(&Head<'_>) -> bool,
}

/// The parts of a file that tell its format.
struct Head<'a> {
    bytes: &'a [u8],
    /// The bytes as text, from the first character on that is neither space nor byte order mark.
    text: &'a str,
    /// In small letters; empty without one.
    extension: &'a str,
}

impl Head<'_> {
    fn begins(&self, magic: &[u8]) -> bool {
        self.bytes.starts_with(magic)
    }

    fn at(&self, place: usize, magic: &[u8]) -> bool {
        self.bytes.get(place..).is_some_and(|b| b.starts_with(magic))
    }

    fn says(&self, words: &[&str]) -> bool {
        words.iter().all(|w| self.text.contains(w))
    }

    fn named(&self, extensions: &[&str]) -> bool {
        extensions.contains(&self.extension)
    }

    /// A JSON object or list with these words.
    fn json(&self, words: &[&str]) -> bool {
        self.text.starts_with(['{', '[']) && self.says(words)
    }

    /// An XML file with this element.
    fn xml(&self, element: &str) -> bool {
        self.text.starts_with('<') && self.says(&[element])
    }
}

/// Ways to files that are read.
const SWEEPS: &str = "take its sweeps out as .pcd, .ply or .bin files";
const UNPACK: &str = "unpack it and open what it holds";
const MODEL: &str = "convert it to .glb, with Blender for example";
const ROADS: &str = "convert it to OpenDRIVE (.xodr), Lanelet2 (.osm) or CommonRoad (.xml)";
const CLOUD: &str = "convert it to .pcd, .ply or .las, with PDAL or CloudCompare for example";
const PICTURE: &str = "pictures are read as .png files that Sceneloom wrote";
const DRIVE: &str = "convert the drive to nuScenes tables, or its sweeps to .pcd, .ply or .bin files";
const TEXT_ROADS: &str = "roads are read from <OpenDRIVE>, Lanelet2's <osm> and <commonRoad>";

/// Every one; the first that knows a file counts, so the particular stands before the general.
const TABLE: &[Foreign] = &[
    Foreign {
        what: "a pointer of Git LFS, not the file itself",
        instead: "fetch it with git lfs pull",
        is: |h| h.begins(b"version https://git-lfs"),
    },
    Foreign {
        what: "a web page",
        instead: "download the file itself",
        is: |h| {
            h.text
                .get(..9)
                .is_some_and(|t| t.eq_ignore_ascii_case("<!doctype") && h.says(&["html"]))
                || h.xml("<html")
        },
    },
    // Recordings.
    Foreign {
        what: "an MCAP recording",
        instead: SWEEPS,
        is: |h| h.begins(b"\x89MCAP"),
    },
    Foreign {
        what: "a ROS 1 bag",
        instead: SWEEPS,
        is: |h| h.begins(b"#ROSBAG"),
    },
    Foreign {
        what: "the description of a ROS 2 bag",
        instead: SWEEPS,
        is: |h| h.says(&["rosbag2_bagfile_information"]),
    },
    Foreign {
        what: "a recording of CARLA's recorder",
        instead: "replay it in CARLA and write its sweeps as .ply files",
        is: |h| h.bytes.windows(14).take(8).any(|w| w == b"CARLA_RECORDER"),
    },
    Foreign {
        what: "records of TensorFlow (TFRecord), as Waymo's drives",
        instead: DRIVE,
        is: |h| h.extension.contains("tfrecord") || is_tfrecord(h.bytes),
    },
    Foreign {
        what: "an SQLite database: a ROS 2 bag, a log of nuPlan or a map as GeoPackage",
        instead: DRIVE,
        is: |h| h.begins(b"SQLite format 3\0"),
    },
    Foreign {
        what: "a packet capture",
        instead: SWEEPS,
        is: |h| {
            [&b"\xd4\xc3\xb2\xa1"[..], b"\xa1\xb2\xc3\xd4", b"\x0a\x0d\x0d\x0a"]
                .iter()
                .any(|m| h.begins(m))
        },
    },
    Foreign {
        what: "an Ouster recording (OSF)",
        instead: SWEEPS,
        is: |h| h.at(4, b"OSF!") || h.named(&["osf"]),
    },
    // Tables and arrays.
    Foreign {
        what: "an Arrow or feather table, as of Argoverse 2",
        instead: DRIVE,
        is: |h| h.begins(b"ARROW1") || h.begins(b"FEA1"),
    },
    Foreign {
        what: "a parquet table, as of Waymo's drives",
        instead: DRIVE,
        is: |h| h.begins(b"PAR1"),
    },
    Foreign {
        what: "an HDF5 file",
        instead: "write its labels as .npz of Occ3D, its points as .pcd",
        is: |h| h.begins(b"\x89HDF\r\n\x1a\n"),
    },
    Foreign {
        what: "a pickle, which is a program and never run",
        instead: "write its arrays as .npz or .npy, its drives as JSON or nuScenes tables",
        is: |h| {
            (matches!(h.bytes, [0x80, 2..=5, ..]) && !h.named(&["bin", "label"]))
                || h.named(&["pkl", "pickle"])
        },
    },
    Foreign {
        what: "a part of nuScenes' tables",
        instead: "open the folder of the tables, or its scene.json",
        is: |h| h.text.starts_with('[') && h.says(&["\"token\""]),
    },
    Foreign {
        what: "GeoJSON",
        instead: ROADS,
        is: |h| h.json(&["\"type\""]) && (h.says(&["\"FeatureCollection\""]) || h.says(&["\"Feature\""])),
    },
    Foreign {
        what: "OpenLABEL annotations",
        instead: "write the boxes as JSON with \"format\": \"sceneloom_boxes\"",
        is: |h| h.json(&["\"openlabel\""]),
    },
    // Maps.
    Foreign {
        what: "OpenStreetMap as PBF",
        instead: ROADS,
        is: |h| h.at(4, b"\x0a\x09OSMHeader"),
    },
    Foreign {
        what: "a shapefile",
        instead: ROADS,
        is: |h| h.begins(b"\x00\x00\x27\x0a"),
    },
    Foreign {
        what: "an OpenSCENARIO file",
        instead: "open the road network that it names",
        is: |h| h.xml("<OpenSCENARIO") || h.named(&["osc"]),
    },
    Foreign {
        what: "a road network of SUMO",
        instead: "write it as OpenDRIVE with netconvert --opendrive-output",
        is: |h| h.xml("<net "),
    },
    Foreign {
        what: "a CityGML model",
        instead: MODEL,
        is: |h| h.xml("CityModel"),
    },
    Foreign {
        what: "a KML map",
        instead: ROADS,
        is: |h| h.xml("<kml"),
    },
    // Clouds.
    Foreign {
        what: "an E57 point cloud",
        instead: CLOUD,
        is: |h| h.begins(b"ASTM-E57"),
    },
    Foreign {
        what: "rows of numbers as text, as of a point cloud",
        instead: CLOUD,
        is: |h| h.named(&["xyz", "pts", "asc", "csv", "txt"]) && is_rows_of_numbers(h.text),
    },
    // Models.
    Foreign {
        what: "a USD stage",
        instead: MODEL,
        is: |h| h.begins(b"PXR-USDC") || h.begins(b"#usda") || h.named(&["usdz"]),
    },
    Foreign {
        what: "an FBX model",
        instead: MODEL,
        is: |h| h.begins(b"Kaydara FBX") || h.begins(b"; FBX"),
    },
    Foreign {
        what: "a file of Blender",
        instead: "export it from Blender as .glb",
        is: |h| h.begins(b"BLENDER"),
    },
    Foreign {
        what: "a COLLADA model",
        instead: MODEL,
        is: |h| h.xml("<COLLADA"),
    },
    Foreign {
        what: "an STL model",
        instead: MODEL,
        is: |h| h.named(&["stl"]) || (h.begins(b"solid ") && h.says(&["facet"])),
    },
    Foreign {
        what: "an OBJ model",
        instead: MODEL,
        is: |h| h.named(&["obj"]) || h.text.lines().any(|l| l.starts_with("mtllib ")),
    },
    Foreign {
        what: "an IFC or STEP model",
        instead: MODEL,
        is: |h| h.begins(b"ISO-10303-21"),
    },
    // Pictures and papers.
    Foreign {
        what: "a JPEG picture",
        instead: PICTURE,
        is: |h| h.begins(b"\xff\xd8\xff"),
    },
    Foreign {
        what: "a GIF picture",
        instead: PICTURE,
        is: |h| h.begins(b"GIF8"),
    },
    Foreign {
        what: "a WebP picture",
        instead: PICTURE,
        is: |h| h.begins(b"RIFF") && h.at(8, b"WEBP"),
    },
    Foreign {
        what: "a TIFF picture",
        instead: PICTURE,
        is: |h| h.begins(b"II*\0") || h.begins(b"MM\0*"),
    },
    Foreign {
        what: "an EXR picture",
        instead: PICTURE,
        is: |h| h.begins(b"\x76\x2f\x31\x01"),
    },
    Foreign {
        what: "a BMP picture",
        instead: PICTURE,
        is: |h| h.begins(b"BM") && h.at(6, &[0; 4]),
    },
    Foreign {
        what: "a video",
        instead: PICTURE,
        is: |h| h.at(4, b"ftyp") || h.begins(b"\x1a\x45\xdf\xa3") || (h.begins(b"RIFF") && h.at(8, b"AVI ")),
    },
    Foreign {
        what: "a PDF document",
        instead: "open the data that it describes",
        is: |h| h.begins(b"%PDF"),
    },
    // Archives.
    Foreign {
        what: "a tar archive",
        instead: UNPACK,
        is: |h| h.at(257, b"ustar"),
    },
    Foreign {
        what: "a zip archive",
        instead: UNPACK,
        is: |h| (h.begins(b"PK\x03\x04") || h.begins(b"PK\x05\x06")) && !h.named(&["loom", "npz"]),
    },
    Foreign {
        what: "a gzip archive",
        instead: UNPACK,
        is: |h| h.begins(b"\x1f\x8b\x08"),
    },
    Foreign {
        what: "a packed archive",
        instead: UNPACK,
        is: |h| {
            [
                &b"BZh"[..],
                b"\xfd7zXZ\0",
                b"\x28\xb5\x2f\xfd",
                b"7z\xbc\xaf\x27\x1c",
                b"Rar!",
                b"\x04\x22\x4d\x18",
            ]
            .iter()
            .any(|m| h.begins(m))
        },
    },
    // The general.
    Foreign {
        what: "JSON of a kind that is not known",
        instead: "JSON is read as boxes (\"format\": \"sceneloom_boxes\"), as glTF, and as nuScenes' scene.json",
        is: |h| h.json(&[]) && !h.says(&["\"boxes\""]),
    },
    Foreign {
        what: "XML of a kind that is not known",
        instead: TEXT_ROADS,
        is: |h| h.text.starts_with('<') && is_element(h.text) && !h.named(&["xodr"]),
    },
];

/// Names the kind of a file that no format claims: an error in one line, without the file's name. `None` for an unknown
/// kind.
pub(super) fn told(path: &Path, head: &[u8]) -> Option<FormatError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let text = String::from_utf8_lossy(head);
    let head = Head {
        bytes: head,
        text: text.trim_start_matches(|c: char| c.is_whitespace() || c == '\u{feff}'),
        extension: extension.as_deref().unwrap_or_default(),
    };
    let found = TABLE.iter().find(|f| (f.is)(&head))?;
    Some(FormatError::new(format!(
        "{}, which is not read: {}",
        found.what, found.instead
    )))
}

/// Records of a length in eight bytes that is no longer than any file, a checksum of it, and a message of protocol buffers.
fn is_tfrecord(bytes: &[u8]) -> bool {
    let length = bytes.first_chunk().map_or(0, |b| u64::from_le_bytes(*b));
    let sum = bytes
        .get(8..12)
        .and_then(|b| b.first_chunk())
        .map(|b| u32::from_le_bytes(*b));
    let masked = |sum: u32| sum.rotate_right(15).wrapping_add(0xa282_ead8);
    length > 0
        && bytes
            .first_chunk::<8>()
            .is_some_and(|b| sum == Some(masked(crc32c(b))))
}

/// The checksum of Castagnoli.
fn crc32c(bytes: &[u8]) -> u32 {
    let bit = |sum: u32| (sum >> 1) ^ (0x82f6_3b78 & 0u32.wrapping_sub(sum & 1));
    !bytes
        .iter()
        .fold(!0, |sum, b| (0..8).fold(sum ^ u32::from(*b), |sum, _| bit(sum)))
}

/// Lines of at least three numbers each, after at most two that name the columns; the last line may be cut.
fn is_rows_of_numbers(text: &str) -> bool {
    let lines: Vec<&str> = text.lines().collect();
    let whole = &lines[..lines.len().saturating_sub(1)];
    let is_row = |line: &str| {
        let mut words = line.split([' ', ',', ';', '\t']).filter(|w| !w.is_empty());
        let numbers = words.by_ref().take_while(|w| w.parse::<f64>().is_ok()).count();
        numbers >= 3
    };
    let rows = whole.iter().filter(|l| is_row(l)).count();
    rows > 0 && rows + 2 >= whole.len()
}

/// True if a text that begins with `<` is an element of a format that is not read; the others are claimed by their
/// names.
fn is_element(text: &str) -> bool {
    let name = text.trim_start_matches("<?").trim_start_matches('<');
    name.starts_with(|c: char| c.is_alphabetic() || c == '!' || c == '_')
        && !["<OpenDRIVE", "<osm", "<commonRoad"]
            .iter()
            .any(|element| text.contains(element))
}

#[cfg(test)]
#[path = "foreign_tests.rs"]
mod tests;

//! Tests of the table of formats that are not read.

use super::*;

/// Each with the word that its line must say.
const KNOWN: &[(&str, &[u8], &str)] = &[
    (
        "a.npz",
        b"version https://git-lfs.github.com/spec/v1\noid sha256:1",
        "Git LFS",
    ),
    ("a.pcd", b"<!DOCTYPE html><html>", "web page"),
    ("a.mcap", b"\x89MCAP0\r\n", "MCAP"),
    ("a.bag", b"#ROSBAG V2.0\n", "ROS 1 bag"),
    (
        "metadata.yaml",
        b"rosbag2_bagfile_information:\n  version: 5",
        "ROS 2 bag",
    ),
    ("a.log", b"\x01\x00\x0e\x00CARLA_RECORDER", "CARLA"),
    ("segment.tfrecord", b"", "TFRecord"),
    ("a.db3", b"SQLite format 3\0", "SQLite"),
    ("a.pcap", b"\xd4\xc3\xb2\xa1\x02\0", "packet capture"),
    ("a.osf", b"", "OSF"),
    ("a.feather", b"ARROW1\0\0", "feather"),
    ("a.parquet", b"PAR1", "parquet"),
    ("a.h5", b"\x89HDF\r\n\x1a\n", "HDF5"),
    ("a.pkl", b"\x80\x04\x95", "pickle"),
    (
        "sample.json",
        b"[\n{\n\"token\": \"ca9a\",\n\"timestamp\": 1",
        "scene.json",
    ),
    (
        "a.geojson",
        b"{\"type\": \"FeatureCollection\", \"features\": [",
        "GeoJSON",
    ),
    ("a.json", b"{\"openlabel\": {", "OpenLABEL"),
    ("a.pbf", b"\0\0\0\x0d\x0a\x09OSMHeader", "PBF"),
    ("a.shp", b"\x00\x00\x27\x0a\0", "shapefile"),
    ("a.xosc", b"<?xml version=\"1.0\"?><OpenSCENARIO>", "OpenSCENARIO"),
    (
        "a.net.xml",
        b"<?xml version=\"1.0\"?><net version=\"1.9\">",
        "netconvert",
    ),
    ("a.gml", b"<core:CityModel>", "CityGML"),
    ("a.kml", b"<kml>", "KML"),
    ("a.e57", b"ASTM-E57\x01", "E57"),
    ("a.xyz", b"1.0 2.0 3.0\n1.5 2.5 -3.5\n1.", "as text"),
    ("a.csv", b"x,y,z\n1.0,2.0,3.0\n1.5,2.5,-3.5\n1.", "as text"),
    ("a.usdc", b"PXR-USDC", "USD"),
    ("a.fbx", b"Kaydara FBX Binary", "FBX"),
    ("a.blend", b"BLENDER-v402", "Blender"),
    ("a.dae", b"<COLLADA>", "COLLADA"),
    ("a.stl", b"\0\0", "STL"),
    ("a.obj", b"# cube\nv 1 1 1", "OBJ"),
    ("a.ifc", b"ISO-10303-21;", "IFC"),
    ("a.jpg", b"\xff\xd8\xff\xe0", "JPEG"),
    ("a.gif", b"GIF89a", "GIF"),
    ("a.webp", b"RIFF\0\0\0\0WEBP", "WebP"),
    ("a.tif", b"II*\0", "TIFF"),
    ("a.exr", b"\x76\x2f\x31\x01", "EXR"),
    ("a.bmp", b"BM\x10\0\0\0\0\0\0\0", "BMP"),
    ("a.mp4", b"\0\0\0\x18ftypisom", "video"),
    ("a.pdf", b"%PDF-1.7", "PDF"),
    ("a.zip", b"PK\x03\x04", "zip"),
    ("a.tar.gz", b"\x1f\x8b\x08", "gzip"),
    ("a.zst", b"\x28\xb5\x2f\xfd", "packed"),
    ("a.json", b"{\"objects\": []}", "sceneloom_boxes"),
    ("a.xml", b"<?xml version=\"1.0\"?>\n<gpx>", "XML"),
];

#[test]
fn each_is_called_what_it_is_and_what_to_do_is_said() {
    let mut kinds = std::collections::BTreeSet::new();
    for (name, head, word) in KNOWN {
        let line = told(Path::new(name), head)
            .unwrap_or_else(|| panic!("{name} is not known"))
            .to_string();
        assert!(
            line.contains(word) && line.contains(", which is not read: "),
            "{name}: {line}"
        );
        assert!(line.chars().count() < 200 && !line.contains('\n'), "{line}");
        kinds.insert(line.split(',').next().unwrap_or_default().to_owned());
    }
    let mut tar = vec![b'a'; 257];
    tar.extend(b"ustar\0");
    assert!(told(Path::new("a"), &tar).is_some_and(|e| e.to_string().contains("tar archive")));
    // Nothing in the table but the tar is left untried.
    assert_eq!(kinds.len() + 1, TABLE.len());
}

/// The sum of RFC 3720, B.4, and a record's head by its own rule.
#[test]
fn records_of_tensorflow_are_known_by_their_checksum() {
    assert_eq!(crc32c(&[0; 32]), 0x8a91_36aa);
    assert_eq!(crc32c(b"123456789"), 0xe306_9283);
    let length = 24u64.to_le_bytes();
    let sum = crc32c(&length).rotate_right(15).wrapping_add(0xa282_ead8);
    let head = [&length[..], &sum.to_le_bytes(), b"\x0a\x16"].concat();
    assert!(told(Path::new("a"), &head).is_some_and(|e| e.to_string().contains("TFRecord")));
    assert!(told(Path::new("a"), &[&length[..], b"\0\0\0\0\x0a\x16"].concat()).is_none());
}

/// What is read is claimed by nobody here, and noise neither.
#[test]
fn what_is_read_is_left_to_its_reader() {
    for importer in super::super::all() {
        let sample = (importer.sample)();
        let head = &sample[..sample.len().min(1024)];
        let extension = importer.extensions.first().copied().unwrap_or("json");
        let name = format!("a.{extension}");
        assert!(
            (importer.recognises)(head) || told(Path::new(&name), head).is_none(),
            "{}",
            importer.id
        );
    }
    for nothing in [&b""[..], b"some words", &[7; 300], b"<", b"< a"] {
        assert!(told(Path::new("a"), nothing).is_none());
    }
}

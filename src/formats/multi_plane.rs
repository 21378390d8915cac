//! Multi-plane images as numpy archives: runs of planes per pixel, or every plane.

use super::npz::{Array, NpzValues, to_bytes};
use scene::MultiPlaneImage;

/// Arrays `starts` (u4, one more than there are pixels), `first`, `end` (u2) and `id` (u1, one per run), `depth_m` (f4, one
/// per plane), `size` (u4: width, height). Pixel p (row-major) holds the runs from start p up to start p + 1; a run shows
/// class `id` on planes `first` to `end` - 1.
pub fn sparse(image: &MultiPlaneImage) -> Vec<u8> {
    let (runs, starts) = ([image.runs.len()], [image.starts.len()]);
    let planes = [usize::from(image.planes.count)];
    let of_u16 = |value: fn(&scene::sensor_data::PlaneRun) -> u16| {
        NpzValues::U16(image.runs.iter().map(value).collect())
    };
    let depths = (0..image.planes.count).map(|p| image.planes.depth_m(p) as f32);
    let array = |name, shape, values| Array { name, shape, values };
    let arrays = [
        array("starts", &starts[..], NpzValues::U32(image.starts.clone())),
        array("first", &runs, of_u16(|r| r.first)),
        array("end", &runs, of_u16(|r| r.end)),
        array(
            "id",
            &runs,
            NpzValues::U8(image.runs.iter().map(|r| r.id).collect()),
        ),
        array("depth_m", &planes, NpzValues::F32(depths.collect())),
        array(
            "size",
            &[2],
            NpzValues::U32(vec![image.width as u32, image.height as u32]),
        ),
    ];
    to_bytes(&arrays).expect("as many values as each shape says, written to memory")
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::sensor_data::{PlaneDepths, PlaneRun};

    #[test]
    fn runs_come_back() {
        let run = |first, end, id| PlaneRun { first, end, id };
        let image = MultiPlaneImage {
            camera: "CAM".into(),
            width: 2,
            height: 1,
            planes: PlaneDepths::default(),
            starts: vec![0, 2, 3],
            runs: vec![run(3, 5, 4), run(9, 256, 15), run(0, 1, 17)],
        };
        let bytes = sparse(&image);
        let mut zip = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("an archive");
        let mut read = |name: &str| {
            let mut bytes = Vec::new();
            std::io::Read::read_to_end(&mut zip.by_name(name).expect(name), &mut bytes).expect("data");
            bytes
        };
        let ends = npyz::NpyFile::new(&read("end.npy")[..])
            .expect("npy")
            .into_vec::<u16>()
            .expect("u16");
        assert_eq!(ends, [5, 256, 1]);
        let depth = npyz::NpyFile::new(&read("depth_m.npy")[..])
            .expect("npy")
            .into_vec::<f32>()
            .expect("f32");
        assert_eq!((depth.len(), depth[0]), (256, 0.2));
        assert!((depth[255] - 51.000_78).abs() < 1e-4);
    }
}

//! Multi-plane images as numpy archives: runs of planes per pixel, or every plane.

use super::npz::{Array, to_bytes};
use scene::MultiPlaneImage;

/// Arrays `starts` (u4, one more than there are pixels), `first`, `end` (u2) and `id` (u1, one per run), `depth_m` (f4, one
/// per plane), `size` (u4: width, height). Pixel p (row-major) holds the runs from start p up to start p + 1; a run shows
/// class `id` on planes `first` to `end` - 1.
pub fn sparse(image: &MultiPlaneImage) -> Vec<u8> {
    let runs = [image.runs.len()];
    let of_u16 = |value: fn(&scene::sensor_data::PlaneRun) -> u16| -> Vec<u8> {
        image.runs.iter().flat_map(|r| value(r).to_le_bytes()).collect()
    };
    let size = [image.width as u32, image.height as u32];
    to_bytes(&[
        Array {
            name: "starts",
            descr: "<u4",
            shape: &[image.starts.len()],
            bytes: image.starts.iter().flat_map(|v| v.to_le_bytes()).collect(),
        },
        Array {
            name: "first",
            descr: "<u2",
            shape: &runs,
            bytes: of_u16(|r| r.first),
        },
        Array {
            name: "end",
            descr: "<u2",
            shape: &runs,
            bytes: of_u16(|r| r.end),
        },
        Array {
            name: "id",
            descr: "|u1",
            shape: &runs,
            bytes: image.runs.iter().map(|r| r.id).collect(),
        },
        Array {
            name: "depth_m",
            descr: "<f4",
            shape: &[usize::from(image.planes.count)],
            bytes: (0..image.planes.count)
                .flat_map(|p| (image.planes.depth_m(p) as f32).to_le_bytes())
                .collect(),
        },
        Array {
            name: "size",
            descr: "<u4",
            shape: &[2],
            bytes: size.iter().flat_map(|v| v.to_le_bytes()).collect(),
        },
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::sensor_data::{PlaneRun, Planes};

    #[test]
    fn runs_come_back() {
        let run = |first, end, id| PlaneRun { first, end, id };
        let image = MultiPlaneImage {
            camera: "CAM".into(),
            width: 2,
            height: 1,
            planes: Planes::default(),
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

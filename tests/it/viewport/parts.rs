//! Only what a change touches is drawn again.

use scene::{BevLayer, Class, SceneBox, SensorRig, Window};
use viewport::{
    LidarColorMode, LidarView, MarkedVoxels, ViewCamera, ViewOptions, ViewPreset, ViewScene, Viewport,
    headless_device, lidar_colors,
};

/// One edit after another, of every kind of thing that is drawn: each picture looks the same as one drawn at once, and
/// most of them draw only a part.
#[test]
fn a_part_drawn_again_gives_the_same_picture_as_all_of_it() {
    let street = super::street::street();
    let rig = SensorRig::default();
    let colors = lidar_colors(&street.sweep, LidarColorMode::Range);
    let options = ViewOptions {
        samples: 1,
        point_px: 1.8,
        ..ViewOptions::default()
    };
    let (_, device, queue) = headless_device().expect("an adapter; apt install mesa-vulkan-drivers");
    let mut kept = Viewport::new(&device, &queue);
    let [w, h] = [480, 300];
    let (mut grid, mut boxes, mut bev) = (street.grid.clone(), street.boxes.clone(), street.bev.clone());
    let (mut sweep, mut brush, mut selected) = (street.sweep.clone(), Vec::new(), Vec::new());
    let mut parts = 0;
    for step in 0..28usize {
        let at = [100 + step * 3 % 40, 80 + step * 7 % 35];
        match step % 7 {
            0 => (0..3).for_each(|z| grid.set(at[0], at[1], z, if step % 2 == 0 { 4 } else { Class::FREE })),
            1 => {
                let i = step % boxes.len();
                boxes[i].center_m.x += 0.4;
            }
            2 => bev[at[0] * Window::NY + at[1]] ^= BevLayer::PedCrossing.bit() | 1,
            3 => sweep
                .points
                .iter_mut()
                .skip(step * 40)
                .take(30)
                .for_each(|p| p.position_in_ego[2] += 0.3),
            4 => brush = vec![[at[0], at[1], 1], [at[0] + 1, at[1], 1]],
            5 => selected = vec![boxes[step % boxes.len()].id],
            _ => {
                sweep.points.truncate(sweep.points.len() - 50);
                let id = boxes[0].id;
                boxes.retain(|b| b.id != id);
            }
        }
        let camera = match step / 14 {
            0 => ViewCamera::default(),
            _ => ViewCamera::preset(ViewPreset::Top),
        };
        let refs: Vec<&SceneBox> = boxes.iter().collect();
        let scene = ViewScene {
            grid: &grid,
            bev: &bev,
            boxes: &refs,
            selected: &selected,
            hovered: None,
            brush: &[MarkedVoxels {
                voxels: &brush,
                color: [120, 220, 255],
            }],
            lidar: Some(LidarView {
                sweep: &sweep,
                colors: &colors[..sweep.points.len()],
            }),
            rig: &rig,
            options: &options,
        };
        kept.render(&device, &queue, &camera, &scene, w, h);
        let [_, _, across, down] = kept.drawn_rect();
        let drawn = across * down;
        parts += usize::from(drawn < w * h * 6 / 10);
        let shown = kept.shown(&device, &queue).expect("read back");
        let mut fresh = Viewport::new(&device, &queue);
        fresh.render(&device, &queue, &camera, &scene, w, h);
        let whole = fresh.shown(&device, &queue).expect("read back");
        // Rectangles of voxels are merged anew around a change: a pixel on the edge of another one of the same brick may
        // fall to either side.
        let differing = shown
            .chunks(4)
            .zip(whole.chunks(4))
            .filter(|(a, b)| a != b)
            .count();
        assert!(
            differing <= 12,
            "step {step}, {drawn} of {} pixels drawn, {differing} differ",
            w * h
        );
    }
    assert!(parts >= 20, "{parts} of 28 steps drew only a part");
}

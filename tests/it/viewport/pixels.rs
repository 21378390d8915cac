//! Pixels that must have a certain colour: projection, occlusion, picking, what is skipped.

use glam::{DVec2, DVec3};
use scene::{BevLayer, BoxId, BoxLabel, Class, SceneBox, SensorRig, VoxelGrid, Window};
use viewport::{
    Background, LayoutPlane, ViewCamera, ViewOptions, ViewPreset, ViewScene, Viewport, ViewportError,
    headless_device,
};

const SIZE: [u32; 2] = [320, 200];

struct Bench {
    device: wgpu::Device,
    queue: wgpu::Queue,
    viewport: Viewport,
    rig: SensorRig,
    options: ViewOptions,
}

impl Bench {
    fn new() -> Self {
        let (_, device, queue) = headless_device().expect("an adapter; apt install mesa-vulkan-drivers");
        let viewport = Viewport::new(&device, &queue);
        let options = ViewOptions {
            grid_lines: false,
            ego: false,
            ..ViewOptions::default()
        };
        Self {
            device,
            queue,
            viewport,
            rig: SensorRig::default(),
            options,
        }
    }

    fn picture(&mut self, camera: &ViewCamera, grid: &VoxelGrid) -> Picture {
        let (options, rig) = (self.options.clone(), self.rig.clone());
        let scene = scene_of(grid, &rig, &options);
        self.picture_of(camera, &scene)
    }

    fn picture_of(&mut self, camera: &ViewCamera, scene: &ViewScene<'_>) -> Picture {
        let rgba = self
            .viewport
            .render_to_image(&self.device, &self.queue, camera, scene, SIZE, 1)
            .expect("a picture");
        assert_eq!(rgba.len(), (SIZE[0] * SIZE[1] * 4) as usize);
        Picture(rgba)
    }
}

/// A scene of voxels alone.
pub fn scene_of<'a>(grid: &'a VoxelGrid, rig: &'a SensorRig, options: &'a ViewOptions) -> ViewScene<'a> {
    ViewScene {
        grid,
        bev: &[],
        boxes: &[],
        selected: &[],
        hovered: None,
        brush: &[],
        lidar: None,
        rig,
        options,
    }
}

struct Picture(Vec<u8>);

impl Picture {
    fn at(&self, pixel: DVec2) -> [u8; 4] {
        let (x, y) = (pixel.x.floor() as usize, pixel.y.floor() as usize);
        let i = (y * SIZE[0] as usize + x) * 4;
        [self.0[i], self.0[i + 1], self.0[i + 2], self.0[i + 3]]
    }
}

/// Angle between two colours, degrees: what shading leaves alone.
pub fn hue_apart(a: [u8; 4], b: [u8; 3]) -> f64 {
    let v = |c: &[u8]| DVec3::new(f64::from(c[0]), f64::from(c[1]), f64::from(c[2]));
    v(&a[..3]).angle_between(v(&b)).to_degrees()
}

fn wall(grid: &mut VoxelGrid, x: usize, class: Class) {
    for y in 80..120 {
        for z in 0..10 {
            grid.set(x, y, z, class.id());
        }
    }
}

fn cameras() -> Vec<ViewCamera> {
    let mut near = ViewCamera::default();
    near.focus(DVec3::new(12.0, 0.0, 1.0), 12.0);
    let mut side = ViewCamera {
        yaw_rad: 0.1,
        pitch_rad: -0.2,
        ortho: true,
        ..near
    };
    side.distance_m = 30.0;
    vec![
        near,
        side,
        ViewCamera {
            yaw_rad: -0.5,
            pitch_rad: -0.8,
            ..near
        },
    ]
}

#[test]
fn a_voxel_has_its_colour_where_it_is_projected_and_the_ray_there_hits_it() {
    let mut bench = Bench::new();
    for class in [Class::Pedestrian, Class::Car, Class::Vegetation] {
        for samples in [1, 4] {
            bench.options.samples = samples;
            let mut grid = VoxelGrid::new();
            wall(&mut grid, 130, class);
            for camera in cameras() {
                let picture = bench.picture(&camera, &grid);
                for (y, z) in [(90, 3), (100, 6), (112, 1)] {
                    let on_face = Window::center(130, y, z) - DVec3::X * 0.2;
                    let pixel = camera.project(on_face, SIZE).expect("in view");
                    let found = picture.at(pixel);
                    assert_eq!(found[3], 255);
                    let apart = hue_apart(found, class.color());
                    assert!(
                        apart < 12.0,
                        "{class:?} {found:?} is {apart:.1} degrees off, {camera:?}"
                    );

                    let (origin, dir) = camera.ray_in_world(pixel, SIZE);
                    let hit = march(&grid, origin, dir).expect("the wall");
                    assert_eq!(hit, [130, y, z]);
                }
            }
        }
    }
}

/// First drawn voxel along a ray, in steps of a millimetre over the grid's reach.
fn march(grid: &VoxelGrid, origin: DVec3, dir: DVec3) -> Option<[usize; 3]> {
    let nearest = (DVec3::ZERO - origin).dot(dir);
    (0..200_000).find_map(|i| {
        let t = nearest - 100.0 + f64::from(i) * 1e-3;
        let [x, y, z] = Window::voxel_at(origin + dir * t.max(0.0))?;
        (grid.get(x, y, z) != Class::FREE).then_some([x, y, z])
    })
}

#[test]
fn the_nearer_wall_hides_the_farther_one() {
    let mut bench = Bench::new();
    // Into both directions, so that the order of drawing cannot be what decides.
    for (near, far, yaw) in [(120, 140, 0.0), (140, 120, std::f64::consts::PI)] {
        let mut grid = VoxelGrid::new();
        wall(&mut grid, near, Class::Pedestrian);
        wall(&mut grid, far, Class::Car);
        for ortho in [false, true] {
            let mut camera = ViewCamera {
                yaw_rad: yaw,
                pitch_rad: -0.05,
                ortho,
                ..ViewCamera::default()
            };
            camera.focus(DVec3::new(12.0, 0.0, 1.0), 9.0);
            let pixel = camera
                .project(Window::center(near, 100, 4), SIZE)
                .expect("in view");
            let found = bench.picture(&camera, &grid).at(pixel);
            assert!(hue_apart(found, Class::Pedestrian.color()) < 12.0, "{found:?}");
            bench.options.hidden_classes = 1 << Class::Pedestrian.id();
            let found = bench.picture(&camera, &grid).at(pixel);
            assert!(hue_apart(found, Class::Car.color()) < 12.0, "{found:?}");
            bench.options.hidden_classes = 0;
        }
    }
}

#[test]
fn heights_above_the_clip_are_hidden() {
    let mut bench = Bench::new();
    let mut grid = VoxelGrid::new();
    for x in 90..110 {
        for y in 90..110 {
            grid.set(x, y, 2, Class::Car.id());
            grid.set(x, y, 9, Class::Bus.id());
        }
    }
    let top = ViewCamera::preset(ViewPreset::Top);
    let pixel = top.project(DVec3::ZERO, SIZE).expect("in view");
    let found = bench.picture(&top, &grid).at(pixel);
    assert!(hue_apart(found, Class::Bus.color()) < 12.0, "{found:?}");
    for z in [1.0, -0.1] {
        bench.options.clip_above_m = Some(z);
        let found = bench.picture(&top, &grid).at(pixel);
        assert!(hue_apart(found, Class::Car.color()) < 12.0, "{found:?}");
    }
    bench.options.clip_above_m = Some(-5.0);
    bench.options.background = Background::Transparent;
    assert_eq!(bench.picture(&top, &grid).at(pixel), [0; 4]);
    bench.options.clip_above_m = Some(f64::NAN);
    let found = bench.picture(&top, &grid).at(pixel);
    assert!(hue_apart(found, Class::Bus.color()) < 12.0, "{found:?}");
}

#[test]
fn markings_lie_on_ground_voxels_and_the_plane_where_there_are_none() {
    let mut bench = Bench::new();
    let mut bev = vec![0; Window::COLUMNS];
    let mut grid = VoxelGrid::new();
    for x in 80..120 {
        for y in 80..120 {
            bev[x * Window::NY + y] = BevLayer::DrivableArea.bit();
            if y < 105 {
                bev[x * Window::NY + y] |= BevLayer::RoadDivider.bit();
            }
            if x >= 100 {
                grid.set(x, y, 0, Class::DriveableSurface.id());
            }
        }
    }
    bench.options.layout_opacity = 1.0;
    let (rig, mut options) = (bench.rig.clone(), bench.options.clone());
    let top = ViewCamera::preset(ViewPreset::Top);
    let at = |x, y| top.project(Window::center(x, y, 0), SIZE).expect("in view");
    let mut pixel_at = |options: &ViewOptions, x, y| {
        let scene = ViewScene {
            bev: &bev,
            ..scene_of(&grid, &rig, options)
        };
        bench.picture_of(&top, &scene).at(at(x, y))
    };
    // On voxels: yellow paint, or bare road without it.
    assert!(hue_apart(pixel_at(&options, 110, 90), BevLayer::RoadDivider.color()) < 15.0);
    assert!(hue_apart(pixel_at(&options, 110, 115), Class::DriveableSurface.color()) < 12.0);
    options.markings = false;
    assert!(hue_apart(pixel_at(&options, 110, 90), Class::DriveableSurface.color()) < 12.0);
    // Beside them: the plane.
    let plane = pixel_at(&options, 90, 90);
    assert_eq!(plane[..3], BevLayer::RoadDivider.color());
    options.layout_plane = LayoutPlane::Off;
    options.background = Background::Transparent;
    assert_eq!(pixel_at(&options, 90, 90), [0; 4]);
}

#[test]
fn unchanged_scenes_cost_nothing_and_every_change_is_drawn() {
    let mut bench = Bench::new();
    let mut grid = VoxelGrid::new();
    wall(&mut grid, 130, Class::Car);
    let camera = ViewCamera::default();
    let b = SceneBox {
        id: BoxId(3),
        class: Class::Car,
        center_m: DVec3::new(8.0, 0.0, 0.8),
        size_m: DVec3::new(4.6, 1.9, 1.7),
        yaw_rad: 0.3,
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    };
    let mut other_rig = bench.rig.clone();
    other_rig.ego_size_m[0] += 0.5;
    let mut edited = grid.clone();
    edited.set(100, 100, 3, 4);
    let bev = vec![1; Window::COLUMNS];
    let (rig, options) = (bench.rig.clone(), bench.options.clone());
    let hidden = ViewOptions {
        hidden_classes: 1 << 4,
        ..options.clone()
    };
    let one = ViewOptions {
        samples: 1,
        ..options.clone()
    };
    let base = scene_of(&grid, &rig, &options);
    let boxes = [&b];
    let mut turned = camera;
    turned.orbit(0.1, 0.0);
    let steps: [(&str, ViewCamera, ViewScene<'_>, [u32; 2]); 10] = [
        ("start", camera, base, SIZE),
        ("camera", turned, base, SIZE),
        (
            "voxel",
            turned,
            ViewScene {
                grid: &edited,
                ..base
            },
            SIZE,
        ),
        ("layout", turned, ViewScene { bev: &bev, ..base }, SIZE),
        (
            "box",
            turned,
            ViewScene {
                boxes: &boxes,
                ..base
            },
            SIZE,
        ),
        (
            "selection",
            turned,
            ViewScene {
                boxes: &boxes,
                selected: &[BoxId(3)],
                ..base
            },
            SIZE,
        ),
        (
            "rig",
            turned,
            ViewScene {
                rig: &other_rig,
                ..base
            },
            SIZE,
        ),
        (
            "hidden class",
            turned,
            ViewScene {
                options: &hidden,
                ..base
            },
            SIZE,
        ),
        (
            "samples",
            turned,
            ViewScene {
                options: &one,
                ..base
            },
            SIZE,
        ),
        ("size", turned, base, [100, 90]),
    ];
    for (what, camera, scene, [w, h]) in steps {
        let mut draw = || {
            bench
                .viewport
                .render(&bench.device, &bench.queue, &camera, &scene, w, h)
        };
        assert!(draw(), "{what} must be drawn");
        assert!(!draw(), "{what} is there already");
        assert_eq!(bench.viewport.size(), [w, h]);
    }
}

/// An equal grid in the same memory is no change; a screenshot in between makes the view draw again.
#[test]
fn an_equal_grid_costs_nothing_and_a_screenshot_is_not_what_is_shown() {
    let mut bench = Bench::new();
    let mut grid = VoxelGrid::new();
    wall(&mut grid, 130, Class::Car);
    let same = grid.clone();
    let (rig, options) = (bench.rig.clone(), bench.options.clone());
    let (camera, mut turned) = (ViewCamera::default(), ViewCamera::default());
    turned.orbit(0.1, 0.0);
    let draw = |bench: &mut Bench, grid: &VoxelGrid| {
        let scene = scene_of(grid, &rig, &options);
        bench
            .viewport
            .render(&bench.device, &bench.queue, &camera, &scene, 64, 64)
    };
    assert!(draw(&mut bench, &grid));
    assert!(!draw(&mut bench, &same));
    bench.picture(&turned, &grid);
    assert!(draw(&mut bench, &same));
}

#[test]
fn edits_one_by_one_give_the_same_picture_as_all_at_once() {
    let mut bench = Bench::new();
    let mut grid = VoxelGrid::new();
    wall(&mut grid, 111, Class::Car);
    let camera = cameras()[2];
    for i in 0..40 {
        grid.set(100 + i * 5 % 33, 90 + i * 7 % 29, i % 16, (i % 17) as u8);
        if i % 4 == 0 {
            grid.set(111, 80 + i, 2, Class::FREE);
        }
        bench.picture(&camera, &grid);
    }
    let step_by_step = bench.picture(&camera, &grid);
    let at_once = Bench::new().picture(&camera, &grid);
    assert!(step_by_step.0 == at_once.0);
}

#[test]
fn odd_input_is_refused_or_drawn_but_never_a_panic() {
    let mut bench = Bench::new();
    let grid = VoxelGrid::new();
    let nan = f64::NAN;
    let broken = ViewCamera {
        target_m: DVec3::splat(nan),
        distance_m: nan,
        yaw_rad: nan,
        pitch_rad: nan,
        fov_y_rad: nan,
        ortho: true,
    };
    bench.picture(&broken, &grid);
    let (rig, options) = (
        bench.rig.clone(),
        ViewOptions {
            frusta: true,
            point_px: f32::NAN,
            pixels_per_point: f32::INFINITY,
            layout_opacity: f32::NAN,
            samples: 77,
            hidden_classes: u32::MAX,
            ..ViewOptions::default()
        },
    );
    let b = SceneBox {
        id: BoxId(1),
        class: Class::Car,
        center_m: DVec3::new(nan, 0.0, 0.0),
        size_m: DVec3::ONE,
        yaw_rad: nan,
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    };
    let sweep = scene::LidarSweep {
        points: vec![scene::LidarPoint {
            position_in_ego: [f32::NAN, 0.0, f32::INFINITY],
            range_m: f32::NAN,
            ring: 0,
            azimuth: 0,
            class: Class::Free,
            intensity: f32::NAN,
            drop_probability: f32::NAN,
            time_s: 0.0,
            velocity_mps: [0.0; 2],
        }],
        rays: 1,
        physical: false,
        provenance: Vec::new(),
    };
    let scene = ViewScene {
        boxes: &[&b],
        bev: &[1, 2, 3],
        selected: &[BoxId(9)],
        brush: &[viewport::MarkedVoxels {
            voxels: &[[usize::MAX; 3], [0; 3]],
            color: [1; 3],
        }],
        lidar: Some(viewport::LidarView {
            sweep: &sweep,
            colors: &[],
        }),
        rig: &rig,
        options: &options,
        ..scene_of(&grid, &rig, &options)
    };
    let (device, queue) = (bench.device.clone(), bench.queue.clone());
    assert!(!bench.viewport.render(&device, &queue, &broken, &scene, 0, 10));
    assert!(!bench.viewport.render(&device, &queue, &broken, &scene, 10, 0));
    assert!(bench.viewport.render(&device, &queue, &broken, &scene, 1, 1));
    assert!(bench.viewport.render(&device, &queue, &broken, &scene, 3, 500));
    let mut image = |size, n| {
        bench
            .viewport
            .render_to_image(&device, &queue, &broken, &scene, size, n)
    };
    assert!(matches!(image([0, 5], 1), Err(ViewportError::Size { .. })));
    assert!(matches!(image([5, u32::MAX], 1), Err(ViewportError::Size { .. })));
    assert!(matches!(image([5, 5], 0), Err(ViewportError::Supersample(0))));
    assert!(matches!(image([5, 5], 99), Err(ViewportError::Supersample(99))));
    assert_eq!(image([67, 3], 2).expect("a picture").len(), 67 * 3 * 4);
    let text = image([0, 5], 1).expect_err("refused").to_string();
    assert!(
        text.starts_with("image size is 0x5, expected 1 to ") && !text.contains('\n'),
        "{text}"
    );
}

#[test]
fn supersampling_and_transparency() {
    let mut bench = Bench::new();
    bench.options.background = Background::Transparent;
    let mut grid = VoxelGrid::new();
    wall(&mut grid, 130, Class::Pedestrian);
    let camera = cameras()[2];
    let scene_options = bench.options.clone();
    let rig = bench.rig.clone();
    let scene = scene_of(&grid, &rig, &scene_options);
    let smooth = bench
        .viewport
        .render_to_image(&bench.device, &bench.queue, &camera, &scene, SIZE, 3)
        .expect("a picture");
    let alphas: std::collections::HashSet<u8> = smooth.chunks_exact(4).map(|p| p[3]).collect();
    assert!(alphas.contains(&0) && alphas.contains(&255));
    assert!(alphas.len() > 4, "edges are soft: {alphas:?}");
    // Straight alpha: an edge texel is as red as the inside, only more transparent.
    for p in smooth.chunks_exact(4).filter(|p| p[3] > 60 && p[3] < 200) {
        let apart = hue_apart([p[0], p[1], p[2], 255], Class::Pedestrian.color());
        assert!(apart < 14.0, "{p:?}");
        assert!(p[0] > 90, "{p:?} is dark");
    }
}

//! Row 61: clocks that stand still or run back, sliders that are no numbers, pictures of no size.

use app::live::{Advice, Live};
use app::open;
use app::recovery::{Recovery, ago};
use editor::{Document, Edit};
use job::{ChosenDensities, GenParams};
use scene::{BoxId, Conditions};
use sensors::pictures::appearance::{Appearance, Quality};
use sensors::splat;
use sensors::splat::cloud::GaussianCloud;

const TIMES: [f64; 9] = [0.0, 0.0, 1.0, 0.5, -1e9, 1e300, f64::INFINITY, f64::NAN, 2.0];

#[test]
fn row_61_clocks() {
    let scene = open::bundled().expect("bundled");
    let id: BoxId = *scene.frame().boxes.keys().next().expect("a box");
    let mut document = Document::new(scene);
    let mut live = Live::new(GenParams::default(), GenParams::default(), true);
    let folder = tempfile::tempdir().expect("a folder");
    let mut recovery = Recovery::start(folder.path(), 30.0, || {}).expect("a session");
    for (i, now_s) in TIMES.into_iter().cycle().take(60).enumerate() {
        if i == 5 {
            document.apply("Remove", &Edit::RemoveBox { id }).expect("there");
        }
        match live.advise(document.scene(), i % 4 == 3, now_s) {
            Advice::Wait(s) => assert!(s >= 0.0, "wait {s}"),
            Advice::Submit(params) | Advice::WarmUp(params) => assert_eq!(params.check(), Ok(())),
            Advice::Rest | Advice::Cancel => {}
        }
        let (again, problem) = recovery.tick(&document, None, scene::Scene::clone, now_s);
        assert_eq!(problem, None);
        assert!(again.is_none_or(|s| s >= 0.0), "{again:?}");
        recovery.wait();
    }
    for s in [0, 1, 89, 5400, u64::MAX] {
        assert!(ago(std::time::Duration::from_secs(s)).ends_with("ago"));
    }
}

#[test]
fn row_61_sliders_and_sizes() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        let changes: [fn(&mut GenParams, f64); 5] = [
            |p, v| p.guidance = v,
            |p, v| p.guidance_rescale = v,
            |p, v| p.strength = v,
            |p, v| p.named.vegetation = Some(v as f32),
            |p, v| {
                p.named = ChosenDensities {
                    clutter: Some(v as f32),
                    ..p.named
                }
            },
        ];
        for change in changes {
            let mut params = GenParams::default();
            change(&mut params, bad);
            let line = params.check().expect_err("refused").to_string();
            assert!(line.contains("expected") && !line.contains('\n'));
            assert_eq!(params, params, "still a key");
        }
    }
    let scene = open::bundled().expect("bundled");
    for size in [[0, 0], [0, 9], [1, 0], [1, 1]] {
        let appearance = Appearance::new(scene.frame(), &scene.rig, &Conditions::default());
        for camera in &scene.rig.cameras {
            let picture = appearance.render(camera, size[0], size[1], Quality::Preview);
            assert_eq!(picture.rgba.len(), 4 * (size[0] * size[1]) as usize);
        }
        let cloud = GaussianCloud::from_grid(&scene.frame().occupancy, &[]);
        let maps = splat::render_rig(&cloud, &scene.rig, size[0], size[1], &Default::default());
        assert!(
            maps.iter()
                .all(|m| m.semantic.len() == (size[0] * size[1]) as usize)
        );
    }
}

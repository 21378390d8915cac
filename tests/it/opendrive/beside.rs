//! Objects and signals of a file as things beside the road.

use formats::opendrive::{self, LayoutImport};
use glam::DVec2;
use scene::Form;
use scene::background::{LineKind, PostKind, TreeKind};

use super::{OWN, own, window_at};

/// A straight road along x from 0 to 200 with these objects and signals, seen from its middle.
fn import(objects: &str, signals: &str) -> LayoutImport {
    let text = format!(
        r#"<OpenDRIVE><road id="1" length="200" junction="-1"><planView>
        <geometry s="0" x="0" y="0" hdg="0" length="200"><line/></geometry></planView>
        <lanes><laneSection s="0"><center><lane id="0" type="none"/></center><right>
        <lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection></lanes>
        <objects>{objects}</objects><signals>{signals}</signals></road></OpenDRIVE>"#
    );
    let network = opendrive::read(text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    let import = window_at(&network, 0, 100.0);
    assert_eq!(import.background.problem(), None);
    import
}

fn forms(import: &LayoutImport) -> Vec<Form> {
    import.background.iter().map(|t| t.form.clone()).collect()
}

fn close(a: DVec2, x: f64, y: f64) -> bool {
    (a - DVec2::new(x, y)).length() < 1e-6
}

#[test]
fn buildings_by_size_and_by_outline() {
    let objects = r#"<object type="building" id="1" s="110" t="15" hdg="1.5707963267948966" length="12" width="8" height="9.5"/>
        <object type="building" id="2" s="90" t="-20" height="6"><outlines><outline>
          <cornerRoad s="80" t="-15" height="7"/><cornerRoad s="100" t="-15" height="7"/><cornerRoad s="90" t="-25" height="7"/>
        </outline></outlines></object>
        <object type="building" id="3" s="100" t="12" length="4" width="4"/>
        <object type="building" id="4" s="100" t="12" length="0" width="4" height="5"/>
        <object type="building" id="5" s="100" t="12" length="4" width="4" height="NaN"/>
        <object type="building" id="6" s="100" t="12" length="4" width="4" height="1e6"/>
        <object type="building" id="7" s="190" t="12" length="4" width="4" height="5"/>"#;
    let import = import(objects, "");
    let all = forms(&import);
    let [Form::Building(a), Form::Building(b)] = &all[..] else {
        panic!("{all:?}");
    };
    // Turned by a quarter: 12 m across the road.
    let min = a.outline_m.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let max = a.outline_m.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    assert!(close(min, 6.0, 9.0) && close(max, 14.0, 21.0), "{min} {max}");
    assert_eq!(a.height_m, 9.5);
    assert!(close(b.outline_m[0], -20.0, -15.0) && close(b.outline_m[2], -10.0, -25.0));
    assert_eq!(b.height_m, 7.0, "that of its corners");
    assert_eq!(
        import.skipped.get("building without a usable size"),
        Some(&3),
        "{:?}",
        import.skipped
    );
    assert_eq!(import.skipped.get("object with an unreadable number"), Some(&1));
    assert_eq!(import.skipped.len(), 2, "{:?}", import.skipped);
}

#[test]
fn trees_poles_and_rows_of_lamps() {
    let objects = r#"<object type="tree" subtype="needle" s="105" t="8" radius="1.5" height="11"/>
        <object type="tree" s="95" t="8" zOffset="6" height="3"/>
        <object type="pole" s="100" t="5" height="4"/>
        <object type="streetLamp" s="0" t="4.5" height="7"><repeat s="70" length="60" distance="20" tStart="4.5" tEnd="5.1"/></object>
        <object type="trafficIsland" s="100" t="0" length="4" width="2"/>
        <object type="vegetation" subtype="bush" s="120" t="10" length="6" width="4" height="1.5"/>
        <object type="obstacle" s="80" t="6" length="2" width="1" height="1.2"/>
        <object type="obstacle" s="82" t="6"/>"#;
    let import = import(objects, "");
    let all = forms(&import);
    let Form::Tree(tree) = &all[0] else {
        panic!("{all:?}")
    };
    assert!(close(tree.position_m, 5.0, 8.0));
    assert_eq!(
        (tree.kind, tree.height_m, tree.crown_radius_m),
        (TreeKind::Conifer, 11.0, 1.5)
    );
    let posts: Vec<_> = all
        .iter()
        .filter_map(|f| match f {
            Form::Post(p) => Some((p.kind, p.position_m, p.height_m)),
            _ => None,
        })
        .collect();
    assert_eq!(posts[0], (PostKind::Pole, DVec2::new(0.0, 5.0), 4.0));
    let lamps: Vec<_> = posts.iter().filter(|p| p.0 == PostKind::StreetLight).collect();
    for (lamp, (x, y)) in lamps
        .iter()
        .zip([(-30.0, 4.5), (-10.0, 4.7), (10.0, 4.9), (30.0, 5.1)])
    {
        assert!(close(lamp.1, x, y) && lamp.2 == 7.0, "{lamp:?}");
    }
    assert_eq!(lamps.len(), 4);
    let arm = all.iter().find_map(|f| match f {
        Form::Post(p) if p.kind == PostKind::StreetLight => Some(p.yaw_rad),
        _ => None,
    });
    assert!(arm.expect("a lamp").sin() < -0.99, "the arm hangs over the road");
    let count = |name: &str| all.iter().filter(|f| f.name() == name).count();
    assert_eq!((count("shrubs"), count("building"), count("bin")), (1, 1, 1));
    assert_eq!(
        import.skipped.get("tree that does not stand on the ground"),
        Some(&1)
    );
    assert_eq!(import.skipped.get("object trafficIsland"), Some(&1));
    assert_eq!(import.skipped.len(), 2, "{:?}", import.skipped);
}

#[test]
fn barriers_run_along_the_road() {
    let objects = r#"<object type="barrier" s="0" t="0"><repeat s="10" length="500" distance="0" tStart="-5" tEnd="-5" heightStart="0.9" heightEnd="0.9"/></object>
        <object type="barrier" s="100" t="9" length="20" width="0.4" height="2.2"/>
        <object type="barrier" subtype="hedge" s="100" t="0"><outline><cornerRoad s="90" t="6"/><cornerRoad s="110" t="6"/><cornerRoad s="110" t="7"/><cornerRoad s="90" t="7"/></outline></object>"#;
    let import = import(objects, "");
    let all = forms(&import);
    let [Form::Line(rail), Form::Line(wall), Form::Line(hedge)] = &all[..] else {
        panic!("{all:?}");
    };
    assert_eq!((rail.kind, rail.height_m), (LineKind::GuardRail, 0.9));
    assert!(
        close(rail.points_m[0], -40.0, -5.0) && close(rail.points_m[rail.points_m.len() - 1], 40.0, -5.0)
    );
    assert_eq!((wall.kind, wall.height_m), (LineKind::Wall, 2.2));
    assert!(
        close(wall.points_m[0], -10.0, 9.0) || close(wall.points_m[0], 10.0, 9.0),
        "{wall:?}"
    );
    assert!((wall.width_m - 0.4).abs() < 1e-9);
    assert_eq!(hedge.kind, LineKind::Hedge);
    assert!((hedge.width_m - 1.0).abs() < 1e-9 && (hedge.points_m[0].y - 6.5).abs() < 1e-9);
}

#[test]
fn signals_face_their_traffic() {
    let signals = r#"<signal type="274" dynamic="no" s="110" t="-5" zOffset="1.8" height="0.7" orientation="+"/>
        <signal type="306" dynamic="no" s="110.1" t="-5" zOffset="2.5" height="0.7" orientation="+"/>
        <signal type="1000001" dynamic="yes" s="120" t="-5" orientation="-"/>
        <signal type="1000001" dynamic="yes" s="120" t="-1.75" zOffset="5" orientation="+"/>
        <signal type="205" dynamic="no" s="x" t="-5"/>"#;
    let import = import(
        "<object type=\"pole\" s=\"110\" t=\"-5.1\" height=\"2\"/>",
        signals,
    );
    let all = forms(&import);
    let [Form::Post(sign), Form::Post(light)] = &all[..] else {
        panic!("{all:?}");
    };
    assert_eq!(
        sign.kind,
        PostKind::Sign,
        "a sign takes its pole over, a second sign hangs on it"
    );
    assert!(
        (sign.height_m - 3.2).abs() < 1e-9 && sign.yaw_rad.cos() < -0.99,
        "{sign:?}"
    );
    assert_eq!(light.kind, PostKind::TrafficLight);
    assert!(light.yaw_rad.cos() > 0.99);
    assert_eq!(import.skipped.get("signal that hangs over the road"), Some(&1));
    assert_eq!(import.skipped.get("signal with an unreadable number"), Some(&1));
}

#[test]
fn too_many_things_are_cut_and_said() {
    let objects =
        r#"<object type="tree" s="100" t="9"><repeat s="100" length="1" distance="0.0001"/></object>"#;
    let import = import(objects, "");
    assert_eq!(import.background.len(), 4000);
    assert!(
        import.skipped.contains_key("thing beyond 4000"),
        "{:?}",
        import.skipped
    );
    for name in OWN {
        assert_eq!(
            window_at(&own(name), 0, 10.0).background.problem(),
            None,
            "{name}"
        );
    }
}

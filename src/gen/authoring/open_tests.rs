//! Tests of imports: an import is a whole world, a furnished file stays as it is.

use super::*;
use scene::{BevLayer, Class, Form, Window};

/// A straight road of one lane on each side with these objects, written for this test.
fn road(dir: &Path, objects: &str) -> PathBuf {
    let path = dir.join("a.xodr");
    let lane = r#"<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>"#;
    let text = format!(
        r#"<OpenDRIVE><road length="300" id="1" junction="-1"><planView>
        <geometry s="0" x="0" y="0" hdg="0" length="300"><line/></geometry></planView>
        <elevationProfile><elevation s="0" a="30" b="0.03" c="0" d="0"/></elevationProfile>
        <lanes><laneSection s="0"><left><lane id="1" type="driving">{lane}</left><center><lane id="0" type="none"/></center>
        <right><lane id="-1" type="driving">{lane}</right></laneSection></lanes><objects>{objects}</objects></road></OpenDRIVE>"#
    );
    std::fs::write(&path, text).unwrap();
    path
}

fn at(bare: bool) -> Placement {
    Placement {
        at_m: Some(DVec2::new(150.0, -1.75)),
        bare,
        ..Placement::default()
    }
}

#[test]
fn an_import_is_a_whole_world_unless_it_is_bare() {
    let dir = tempfile::tempdir().unwrap();
    let house = r#"<object type="building" id="1" s="165" t="-18" length="14" width="9" height="9"/>"#;
    let path = road(dir.path(), house);
    let whole = import(&path, &at(false)).unwrap();
    assert_eq!((whole.things_of_file, whole.bridges), (1, 0));
    assert!(
        whole.scene.background.len() > 8,
        "{} things",
        whole.scene.background.len()
    );
    assert_eq!(whole.scene.background.problem(), None);
    let counts = whole.scene.frame().occupancy.class_counts();
    assert!(counts[Class::Manmade.id() as usize] > 200 && counts[Class::Vegetation.id() as usize] > 200);
    let again = import(&path, &at(false)).unwrap();
    assert_eq!(whole.scene.frame(), again.scene.frame());
    // Drawn scenery keeps clear of the house.
    let house = whole.scene.background.iter().next().unwrap();
    assert!(matches!(house.form, Form::Building(_)));
    let (min, max) = house.form.bounds_m();
    let in_house = |p: &DVec2| p.cmpgt(min).all() && p.cmplt(max).all();
    let others = whole.scene.background.iter().skip(1);
    assert!(others.flat_map(|t| t.form.points_m()).all(|p| !in_house(&p)));

    let bare = import(&path, &at(true)).unwrap();
    assert_eq!(bare.scene.background.len(), 1);
    assert_eq!(bare.scene.frame().layout, whole.scene.frame().layout);
    assert_eq!(bare.scene.frame().boxes, whole.scene.frame().boxes);
    // The road climbs by 3 %, 1 m over 34 m: two bins up in the draft.
    let frame = bare.scene.frame();
    assert!((frame.layout.relief.height_m(DVec2::new(30.0, 0.0)) - 0.9).abs() < 0.01);
    let [x, y] = Window::column_at(30.0, 0.0).unwrap();
    assert!(frame.layout.has(BevLayer::DrivableArea, x, y));
    assert_eq!(frame.occupancy.get(x, y, 0), Class::FREE);
    assert_eq!(frame.occupancy.get(x, y, 2), Class::DriveableSurface.id());
}

#[test]
fn a_furnished_file_gets_no_scenery() {
    let dir = tempfile::tempdir().unwrap();
    let trees = r#"<object type="tree" id="1" s="130" t="8" height="6"><repeat s="130" length="40" distance="10"/></object>"#;
    let imported = import(&road(dir.path(), trees), &at(false)).unwrap();
    assert_eq!(imported.things_of_file, 5);
    assert_eq!(imported.scene.background.len(), 5);
    assert!(imported.scene.background.iter().all(|t| t.form.name() == "tree"));
}

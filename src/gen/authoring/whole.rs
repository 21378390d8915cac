//! Preparations for generating a whole scene, shared by the window, the command line, assistants and batches.

use super::scenery::SceneryWish;
use editor::Edit;
use job::{GenError, GenParams, RegionMode};
use scene::Scene;

/// True if a scene does not show what kind of place it is: no thing shows it (see
/// [`scene::Background::describes_place`]), and none was inferred from voxels.
pub fn leaves_place_open(scene: &Scene) -> bool {
    !scene.background.describes_place() && !scene.frame().inferred.background
}

/// Edits that draw scenery by the seed before a whole generation, if the scene does not show what kind of place it is:
/// scenery that networks invent alone is ragged. Signs, lamps and bridges that are there stay. No edits for a partial
/// generation, and if things show the place.
pub fn scenery_first(scene: &Scene, params: &GenParams) -> Result<Vec<Edit>, GenError> {
    match params.region == RegionMode::Full && leaves_place_open(scene) {
        true => SceneryWish::of_seed(params.seed).edits_around(scene),
        false => Ok(Vec::new()),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::open;
    use editor::apply_all;
    use scene::Form;
    use scene::background::{Building, Post, PostKind};

    fn bare() -> Scene {
        let mut scene = open::from_template("straight", 7).expect("a template");
        scene.background = Default::default();
        scene
    }

    #[test]
    fn a_sign_leaves_the_place_open_and_a_house_does_not() {
        let with = |form: Form| {
            let mut scene = bare();
            let add = Edit::AddThings { forms: vec![form] };
            apply_all(&[add], &mut scene).expect("sound");
            scene
        };
        let at = DVec2::new(12.0, -9.0);
        let sign = with(Form::Post(Post::typical(PostKind::Sign, at, 0.0)));
        let house = Building::rectangle(DVec2::new(0.0, 25.0), DVec2::splat(4.0), DVec2::X, 6.0);
        let house = with(Form::Building(house));
        let whole = GenParams::whole_scene();
        assert!(scenery_first(&house, &whole).expect("rules").is_empty());
        assert!(
            scenery_first(&sign, &GenParams::default())
                .expect("rules")
                .is_empty()
        );
        let mut drawn = sign.clone();
        apply_all(&scenery_first(&sign, &whole).expect("rules"), &mut drawn).expect("sound");
        assert!(drawn.background.describes_place());
        for thing in sign.background.iter() {
            assert_eq!(
                drawn.background.get(thing.id),
                Some(thing),
                "what was there stays"
            );
        }
    }
}

//! Tests of the things: each kind fills its voxels, moves as a whole, and bad ones are refused in one line.

use std::collections::BTreeSet;

use super::*;
use crate::solid::fill::fill;

fn some_of_each() -> Vec<Form> {
    let corner = DVec2::new;
    let outline_m = vec![
        corner(10.0, 5.0),
        corner(20.0, 5.0),
        corner(20.0, 12.0),
        corner(10.0, 12.0),
    ];
    let mut forms = vec![
        Form::Shrubs(Shrubs {
            outline_m: outline_m.clone(),
            height_m: 1.5,
            per_m2: 1.0,
        }),
        Form::Bridge(Bridge {
            points_m: vec![corner(-20.0, -10.0), corner(20.0, -12.0)],
            width_m: 6.0,
            height_m: 5.0,
            thickness_m: 0.8,
            for_vehicles: true,
        }),
    ];
    for roof in [Roof::Flat, Roof::Gabled, Roof::Hipped] {
        for facade in [
            Facade::Plain,
            Facade::Balconies,
            Facade::Bays,
            Facade::Arcade,
            Facade::Glass,
        ] {
            forms.push(Form::Building(Building {
                outline_m: outline_m.clone(),
                height_m: 6.0,
                roof,
                facade,
            }));
        }
    }
    for kind in TreeKind::ALL {
        forms.push(Form::Tree(Tree {
            position_m: corner(3.0, 4.0),
            height_m: 5.0,
            crown_radius_m: 1.6,
            kind,
        }));
    }
    let run = vec![corner(-5.0, 3.0), corner(5.0, 3.0), corner(8.0, 9.0)];
    forms.extend(LineKind::ALL.map(|kind| Form::Line(SceneryLine::typical(kind, run.clone()))));
    forms.extend(PostKind::ALL.map(|kind| Form::Post(Post::typical(kind, corner(-7.0, 2.0), 0.4))));
    forms
}

fn voxels(thing: &Thing, ground_m: f64) -> BTreeSet<[usize; 3]> {
    let mut solids = Vec::new();
    thing.solids(&|_| ground_m, &mut solids);
    let mut out = BTreeSet::new();
    for solid in &solids {
        fill(
            crate::Extent::WINDOW,
            solid,
            |_, _| true,
            |x, y, z, _| {
                out.insert([x, y, z]);
            },
        );
    }
    out
}

fn thing(form: Form) -> Thing {
    Thing {
        id: ThingId(7),
        form,
        look: 7,
        placed: false,
    }
}

#[test]
fn every_kind_is_sound_stands_on_the_ground_and_reaches_its_height() {
    for form in some_of_each() {
        assert_eq!(form.problem(), None, "{form:?}");
        let (height, name) = (form.height_m(), form.name());
        let (lo, hi) = form.bounds_m();
        let on_ground = voxels(&thing(form.clone()), 0.0);
        let raised = voxels(&thing(form), 1.2); // three voxels
        assert!(!on_ground.is_empty(), "{name}");
        let lowest = on_ground.iter().map(|v| v[2]).min().expect("some");
        let highest = on_ground.iter().map(|v| v[2]).max().expect("some");
        assert!(lowest <= 2, "{name} floats: bin {lowest}"); // the ground is in bin 2
        let top = crate::Lattice::OCC3D.bin(height - 0.3);
        // The tip of a crown fills no voxel by a third.
        let tip = if name == "tree" { 3 } else { 1 };
        assert!(highest + tip >= top.min(15), "{name}: {highest} below {top}");
        for [x, y, _] in &on_ground {
            let p = crate::Window::center(*x, *y, 0).truncate();
            assert!(
                p.cmpge(lo - 0.4).all() && p.cmple(hi + 0.4).all(),
                "{name} reaches beyond its bounds at {p}"
            );
        }
        let shifted: BTreeSet<_> = on_ground.iter().map(|v| [v[0], v[1], v[2] + 3]).collect();
        let common = shifted.intersection(&raised).count();
        assert!(
            common * 10 > raised.len() * 8,
            "{name}: {common} of {}",
            raised.len()
        );
    }
}

#[test]
fn json_comes_back_equal_and_unknown_keys_are_refused() {
    for form in some_of_each() {
        let json = serde_json::to_string(&thing(form.clone())).expect("plain data");
        assert_eq!(
            serde_json::from_str::<Thing>(&json).expect("its own"),
            thing(form)
        );
    }
    let wrong = r#"{"tree": {"position_m": [0, 0], "height_m": 4, "crown_radius_m": 1, "colour": 3}}"#;
    assert!(serde_json::from_str::<Form>(wrong).is_err());
}

#[test]
fn another_frame_turns_and_moves_points_and_headings() {
    let pose = Pose::planar(10.0, -4.0, 0.7);
    for form in some_of_each() {
        let there = form.in_frame(&pose.inverse());
        let back = there.in_frame(&pose);
        for (a, b) in form.points_m().iter().zip(back.points_m()) {
            assert!(a.distance(b) < 1e-9);
        }
        if let (Form::Post(a), Form::Post(b)) = (&form, &there) {
            assert!((a.yaw_rad - 0.7 - b.yaw_rad).abs() < 1e-9);
        }
    }
}

#[test]
fn what_is_not_sound_says_why_in_one_line() {
    let square = |s: f64| {
        vec![
            DVec2::ZERO,
            DVec2::new(s, 0.0),
            DVec2::new(s, s),
            DVec2::new(0.0, s),
        ]
    };
    let building = |outline_m: Vec<DVec2>, height_m: f64| {
        Form::Building(Building {
            outline_m,
            height_m,
            roof: Roof::Flat,
            facade: Facade::Plain,
        })
    };
    let mut crossed = square(10.0);
    crossed.swap(1, 2);
    let mut twice = square(5.0);
    twice.extend(square(5.0));
    for (form, says) in [
        (building(crossed, 6.0), "cross"),
        (building(twice, 6.0), "cross"),
        (building(square(0.0), 6.0), "outline_m"),
        (building(square(1e-3), 6.0), "outline_m"),
        (building(vec![DVec2::ZERO; 2], 6.0), "corners"),
        (building(square(10.0), f64::NAN), "height_m is NaN"),
        (building(square(10.0), 1e6), "height_m is 1000000"),
        (building(square(1e6), 6.0), "outline_m"),
        (building(vec![DVec2::NAN; 4], 6.0), "finite"),
    ] {
        let problem = form.problem().expect(says);
        assert!(problem.contains(says) && !problem.contains('\n'), "{problem}");
    }
}

#[test]
fn too_many_things_are_one_problem() {
    let tree = |i: u32| Thing {
        id: ThingId(i),
        look: 0,
        placed: false,
        form: Form::Tree(Tree {
            position_m: DVec2::new(f64::from(i % 300), 0.0),
            height_m: 4.0,
            crown_radius_m: 1.0,
            kind: TreeKind::Broadleaf,
        }),
    };
    let all: Background = (0..100_000).map(tree).collect();
    assert!(all.problem().expect("too many").contains("100000 things"));
}

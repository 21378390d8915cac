//! The JSON of edits, there and back.

use super::*;

#[test]
fn json_forms_are_those_of_the_command_line() {
    let list = json!([
        {"remove_box": {"id": 7}},
        {"add_box": {"class": "traffic_cone", "center_m": [8.0, 0.5, 0.4], "size_m": [0.5, 0.5, 0.8], "yaw_deg": 0}},
        {"paint_bev": {"layer": "drivable_area", "shape": {"disc": {"center_m": [3, -6], "radius_m": 2}}, "value": true}},
        {"paint_voxels": {"cells": [[100, 90, 3]], "class": "barrier"}},
        {"set_prompt": {"prompt": "night, rain"}},
    ]);
    let edits: Vec<Edit> = serde_json::from_value(list).expect("the documented forms");
    assert_eq!(
        edits,
        vec![
            Edit::RemoveBox { id: BoxId(7) },
            Edit::AddBox {
                class: Class::TrafficCone,
                center_m: DVec3::new(8.0, 0.5, 0.4),
                size_m: DVec3::new(0.5, 0.5, 0.8),
                yaw_deg: 0.0,
                velocity_mps: None,
                id: None,
                label: Default::default(),
            },
            Edit::PaintBev {
                layer: BevLayer::DrivableArea,
                shape: Shape::Disc {
                    center_m: DVec2::new(3.0, -6.0),
                    radius_m: 2.0
                },
                value: true,
            },
            Edit::PaintVoxels {
                cells: vec![[100, 90, 3]],
                class: Class::Barrier
            },
            Edit::SetPrompt {
                prompt: "night, rain".into()
            },
        ]
    );
    // Every form, written exactly so and read back the same.
    for form in [
        json!({"remove_box": {"id": 7}}),
        json!({"add_box": {"class": "bus", "center_m": [8.0, 0.5, 0.4], "size_m": [0.5, 0.5, 0.8], "yaw_deg": -30.5}}),
        json!({"add_box": {"class": "bus", "center_m": [8.0, 0.5, 0.4], "size_m": [0.5, 0.5, 0.8], "yaw_deg": 1.0, "velocity_mps": [1.0, 2.0], "id": 9}}),
        json!({"move_box": {"id": 3, "center_m": [1.0, 2.0, 3.0]}}),
        json!({"move_box": {"id": 3, "yaw_deg": 90.0, "size_m": [1.0, 2.0, 3.0]}}),
        json!({"set_box_class": {"id": 3, "class": "truck"}}),
        json!({"label_box": {"id": 3, "label": {"name": "taxi", "paint": "yellow"}}}),
        json!({"label_box": {"id": 3, "label": {}}}),
        json!({"paint_bev": {"layer": "walkway", "shape": {"rect": {"min_m": [0.0, 1.0], "max_m": [2.0, 3.0]}}, "value": false}}),
        json!({"paint_bev": {"layer": "lane_divider", "shape": {"polygon": {"points_m": [[0.0, 1.0], [2.0, 3.0], [0.0, 4.0]]}}, "value": true}}),
        json!({"paint_bev": {"layer": "carpark_area", "shape": {"line": {"points_m": [[0.0, 1.0], [2.0, 3.0]], "width_m": 0.5}}, "value": true}}),
        json!({"paint_bev": {"layer": "ped_crossing", "shape": {"cells": [[1, 2], [3, 4]]}, "value": true}}),
        json!({"paint_voxels": {"cells": [[1, 2, 3]], "class": "free"}}),
        json!({"unlock_voxels": {"cells": [[1, 2, 3]]}}),
        json!({"clear_paint": {}}),
        json!({"set_prompt": {"prompt": ""}}),
        json!({"keep_words": {"words": "remove the bus"}}),
        json!({"set_conditions": {"conditions": {"time": "night", "weather": "rain", "wetness": 0.5, "visibility_m": 400.0,
            "sun": {"azimuth_deg": 20.0, "elevation_deg": 30.0}, "seed": 3}}}),
    ] {
        let edit = parse(form.clone()).expect("a documented form");
        assert_eq!(serde_json::to_value(&edit).expect("plain data"), form);
    }
}

#[test]
fn json_that_is_wrong_is_refused_by_name() {
    let refusal = |value: Value| {
        let text = parse(value).expect_err("refused");
        assert!(!text.contains('\n'));
        text
    };
    let text = refusal(json!({"remove_box": {"id": 7, "colour": 1}}));
    assert!(text.contains("unknown field `colour`"), "{text}");
    let text = refusal(json!({"paint_bev": {"layer": "walkway", "value": true,
        "shape": {"disc": {"center_m": [0, 0], "radius_m": 1, "radius": 2}}}}));
    assert!(text.contains("unknown field `radius`"), "{text}");
    let text = refusal(json!({"explode_box": {"id": 7}}));
    assert!(text.contains("unknown variant `explode_box`"), "{text}");
    let text = refusal(json!({"move_box": {"yaw_deg": 3}}));
    assert!(text.contains("missing field `id`"), "{text}");
    let text = refusal(json!({"paint_voxels": {"cells": [[1, 2, -3]], "class": "car"}}));
    assert!(text.contains("-3"), "{text}");
    let text = refusal(json!({"adopt_result": {"occupancy": []}}));
    assert!(text.contains("unknown variant `adopt_result`"), "{text}");
    let text = refusal(json!({"clear_paint": {"x": 1}}));
    assert!(text.contains("unknown field `x`"), "{text}");
}

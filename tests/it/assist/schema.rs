//! The schema that other programs are made from.

use serde_json::Value;

use super::process::command;

#[test]
fn the_schema_is_whole_and_always_the_same() {
    let print = |args: &[&str]| command(args).output().expect("it runs").stdout;
    let text = print(&["schema"]);
    assert_eq!(text, print(&["schema"]));
    let schema: Value = serde_json::from_slice(&text).expect("JSON");
    let compact: Value = serde_json::from_slice(&print(&["schema", "--compact"])).expect("JSON");
    assert_eq!(schema, compact);
    let calls = schema["x-calls"].as_object().expect("calls");
    assert!(calls.len() >= 20, "{}", calls.len());
    for (name, call) in calls {
        for of in ["args", "receipt"] {
            let to = call[of]["$ref"].as_str().expect("a reference");
            let def = &schema["$defs"][to.trim_start_matches("#/$defs/")];
            assert_eq!(def["type"], "object", "{name} {of}");
            assert!(def["description"].is_string(), "{name} {of}");
            for (key, property) in def["properties"].as_object().into_iter().flatten() {
                assert!(property["description"].is_string(), "{name} {of}: {key}");
            }
        }
    }
    assert!(calls["apply"]["changes_the_scene"] == true && calls["state"]["changes_the_scene"] == false);
}

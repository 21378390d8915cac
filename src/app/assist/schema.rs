//! The JSON Schema of the vocabulary: of all calls in one document, and of each by itself.

use std::collections::BTreeSet;

use schemars::SchemaGenerator;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

use crate::call::{CallDef, table};

/// Start of a reference to a definition.
const DEFS: &str = "#/$defs/";

/// Generator for the schemas of arguments: fields that may be left out are not required.
fn of_arguments() -> SchemaGenerator {
    SchemaSettings::draft2020_12().into_generator()
}

/// Generator for the schemas of receipts: all fields are required.
fn of_receipts() -> SchemaGenerator {
    SchemaSettings::draft2020_12().for_serialize().into_generator()
}

/// Every call with its arguments and its receipt: a document of JSON Schema 2020-12 that a request must meet. `x-calls` says of
/// each call what it does, one example, whether it changes the scene, and where its receipt is defined. The same bytes each
/// time.
pub fn document() -> Value {
    let (mut read, mut written) = (of_arguments(), of_receipts());
    let (mut requests, mut calls, mut receipts) = (Vec::new(), Map::new(), Map::new());
    for def in table() {
        let args = (def.args)(&mut read).to_value();
        receipts.insert(def.name.to_owned(), (def.receipt)(&mut written).to_value());
        requests.push(json!({
            "type": "object",
            "properties": {
                "id": { "description": "Comes back in the reply.", "type": ["integer", "string"] },
                "call": { "const": def.name },
                "args": args,
            },
            "required": required(&def),
            "additionalProperties": false,
        }));
        calls.insert(
            def.name.to_owned(),
            json!({ "about": def.about, "changes_the_scene": def.changes, "args": args }),
        );
    }
    let mut defs = read.take_definitions(true);
    let written = written.take_definitions(true);
    // Types that are read in one shape and written in another have two definitions.
    let two = with_two_shapes(&defs, &written);
    for (name, mut def) in written {
        renamed(&mut def, &two);
        let name = if two.contains(&name) {
            format!("{name}{WRITTEN}")
        } else {
            name
        };
        defs.insert(name, def);
    }
    for (name, mut receipt) in receipts {
        renamed(&mut receipt, &two);
        calls[&name]["receipt"] = receipt;
    }
    let mut document = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Calls of Sceneloom",
        "description": format!("One request a line: {{\"id\": 1, \"call\": \"state\", \"args\": {{}}}}. One reply a line: {{\"id\": 1, \"ok\": true, \"receipt\": …}} or {{\"id\": 1, \"ok\": false, \"error\": \"…\"}}. Lengths in m, angles in degrees counter-clockwise, times in s; x ahead, y left, z up. Version {}.", env!("CARGO_PKG_VERSION")),
        "oneOf": requests,
        "x-calls": calls,
        "$defs": defs,
    });
    tidy(&mut document);
    // (an example is no schema, and stays as it is)
    for def in table() {
        document["x-calls"][def.name]["example"] = example(&def);
    }
    document
}

/// Ending of the name of a type's second definition.
const WRITTEN: &str = "Written";

/// Names of types whose two definitions differ, in themselves or in what they refer to.
fn with_two_shapes(read: &Map<String, Value>, written: &Map<String, Value>) -> BTreeSet<String> {
    let mut two: BTreeSet<String> = BTreeSet::new();
    loop {
        let differs = |(name, def): &(&String, &Value)| {
            let mut refers = Vec::new();
            references(def, &mut refers);
            let to_one = refers.iter().any(|to| two.contains(to));
            read.get(*name).is_some_and(|other| other != *def || to_one)
        };
        let found: BTreeSet<String> = written
            .iter()
            .filter(differs)
            .map(|(name, _)| name.clone())
            .collect();
        if found.len() == two.len() {
            return two;
        }
        two = found;
    }
}

/// Lets references to some definitions lead to their second ones.
fn renamed(value: &mut Value, two: &BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                match value {
                    Value::String(to) if key == "$ref" => {
                        if to.strip_prefix(DEFS).is_some_and(|name| two.contains(name)) {
                            to.push_str(WRITTEN);
                        }
                    }
                    _ => renamed(value, two),
                }
            }
        }
        Value::Array(list) => list.iter_mut().for_each(|v| renamed(v, two)),
        _ => {}
    }
}

/// Keys that a request must have.
fn required(def: &CallDef) -> Vec<&'static str> {
    let [args, _] = of_call(def);
    let any = args
        .get("required")
        .and_then(Value::as_array)
        .is_some_and(|r| !r.is_empty());
    match any {
        true => vec!["call", "args"],
        false => vec!["call"],
    }
}

/// The example of a call's arguments.
pub fn example(def: &CallDef) -> Value {
    serde_json::from_str(def.example).unwrap_or_default()
}

/// Schemas of the arguments and of the receipt of a call, each an object that stands alone.
pub fn of_call(def: &CallDef) -> [Map<String, Value>; 2] {
    [(def.args, of_arguments()), (def.receipt, of_receipts())].map(|(of, mut generator)| {
        let schema = of(&mut generator).to_value();
        let mut defs = Value::Object(generator.take_definitions(true));
        tidy(&mut defs);
        alone(&schema, &defs)
    })
}

/// A schema with the definitions that it needs, and no others.
fn alone(schema: &Value, defs: &Value) -> Map<String, Value> {
    let named = |reference: &str| Some(defs.get(reference.strip_prefix(DEFS)?)?.clone());
    let root = schema.get("$ref").and_then(Value::as_str).and_then(named);
    let mut root = root.unwrap_or_else(|| schema.clone());
    tidy(&mut root);
    let mut needed: BTreeSet<String> = BTreeSet::new();
    let mut open = vec![root.clone()];
    while let Some(value) = open.pop() {
        let mut found = Vec::new();
        references(&value, &mut found);
        for name in found {
            if let Some(def) = defs.get(&name)
                && needed.insert(name)
            {
                open.push(def.clone());
            }
        }
    }
    let mut root = match root {
        Value::Object(root) => root,
        _ => Map::new(),
    };
    if !needed.is_empty() {
        let of = |name: String| (name.clone(), defs.get(&name).cloned().unwrap_or_default());
        root.insert(
            "$defs".into(),
            Value::Object(needed.into_iter().map(of).collect()),
        );
    }
    root
}

/// Names of definitions that a schema refers to.
fn references(value: &Value, out: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                match value {
                    Value::String(to) if key == "$ref" => {
                        out.extend(to.strip_prefix(DEFS).map(str::to_owned))
                    }
                    _ => references(value, out),
                }
            }
        }
        Value::Array(list) => list.iter().for_each(|v| references(v, out)),
        _ => {}
    }
}

/// Takes out parts of no use to a client: numbers of bits, defaults of nothing, links of the documentation.
fn tidy(value: &mut Value) {
    match value {
        Value::Object(map) => {
            // (a key of a schema, not the name of a property, whose value would be an object)
            if map.get("format").is_some_and(Value::is_string) {
                map.remove("format");
            }
            if map.get("default").is_some_and(Value::is_null) {
                map.remove("default");
            }
            if let Some(Value::String(text)) = map.get_mut("description") {
                *text = text.replace("[`", "`").replace("`]", "`").replace('\n', " ");
            }
            map.values_mut().for_each(tidy);
        }
        Value::Array(list) => list.iter_mut().for_each(tidy),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::call::Call;

    #[test]
    fn every_reference_is_defined_and_every_document_is_the_same() {
        let document = document();
        assert_eq!(document, super::document());
        let mut found = Vec::new();
        references(&document, &mut found);
        assert!(found.len() > 40, "{}", found.len());
        for name in found {
            assert!(document["$defs"].get(&name).is_some(), "{name}");
        }
        assert!(document["$defs"]["Edit"]["oneOf"].as_array().map_or(0, Vec::len) > 25);
    }

    #[test]
    fn every_call_is_described_and_its_example_is_read() {
        let mut names = BTreeSet::new();
        for def in table() {
            assert!(names.insert(def.name), "{} twice", def.name);
            assert!((20..=700).contains(&def.about.len()), "{}", def.name);
            let Value::Object(args) = example(&def) else {
                panic!("the example of {} is no object", def.name);
            };
            if let Err(error) = Call::parse(def.name, args.clone()) {
                panic!("{}: {error}", def.name);
            }
            assert_eq!(document()["x-calls"][def.name]["example"], example(&def));
            // Unknown keys are refused by name.
            let mut more = args;
            more.insert("bogus".into(), json!(1));
            let refused = Call::parse(def.name, more).err().unwrap_or_default();
            assert!(refused.contains("bogus"), "{}: {refused}", def.name);
            for schema in of_call(&def) {
                assert_eq!(schema.get("type"), Some(&json!("object")), "{}", def.name);
                let mut found = Vec::new();
                references(&Value::Object(schema.clone()), &mut found);
                for name in found {
                    assert!(schema["$defs"].get(&name).is_some(), "{}: {name}", def.name);
                }
            }
        }
    }

    #[test]
    fn what_is_wrong_is_named_in_one_line() {
        let parse = |name: &str, args: Value| {
            let Value::Object(args) = args else {
                unreachable!("an object")
            };
            Call::parse(name, args).err().expect("refused")
        };
        let error = parse("run_code", json!({}));
        assert!(
            error.starts_with("no call \"run_code\", expected one of state"),
            "{error}"
        );
        let deep = json!({ "edits": [{ "remove_box": { "id": 1 } }, { "move_box": { "id": "x" } }] });
        let error = parse("apply", deep);
        assert!(error.contains("edits[1]") && error.contains("id"), "{error}");
        let error = parse("show", json!({ "time_s": "NaN" }));
        assert!(error.contains("time_s"), "{error}");
        let long = parse("apply", json!({ "edits": "x".repeat(100_000) }));
        assert!(
            long.chars().count() <= 300 && !long.contains('\n'),
            "{}",
            long.len()
        );
    }
}

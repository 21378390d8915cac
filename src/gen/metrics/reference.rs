//! Access to tests/reference/metrics.json.

use serde_json::Value;

pub struct Reference(Value);

impl Reference {
    pub fn open() -> Self {
        let text = include_str!("../../../tests/reference/metrics.json");
        Self(serde_json::from_str(text).expect("the reference file"))
    }

    pub fn array(&self, name: &str) -> &[Value] {
        self.0[name].as_array().expect("a list of cases")
    }

    pub fn list(&self, group: &str, name: &str) -> &[Value] {
        self.0[group][name].as_array().expect("a list of cases")
    }
}

/// A list of lists of numbers.
pub fn rows(value: &Value) -> Vec<Vec<f64>> {
    let rows = value.as_array().expect("rows");
    let numbers = |row: &Value| -> Vec<f64> {
        let row = row.as_array().expect("a row");
        row.iter().map(|v| v.as_f64().expect("a number")).collect()
    };
    rows.iter().map(numbers).collect()
}

//! Options of a tool as a list: the controls that the panel shows, and the values that come back when the user changes
//! one.

use scene::Class;

/// One option, or something between them.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolOption {
    /// Its name, for the tool.
    pub id: &'static str,
    /// Control that shows it, with its current value.
    pub control: Control,
}

/// A choice: name and hint.
pub type Choice = (&'static str, &'static str);

/// Ways to set something.
#[derive(Clone, Debug, PartialEq)]
pub enum Control {
    /// The tool's name above its options.
    Title(&'static str),
    /// A line of small text.
    Text(String),
    /// A line of text that is read.
    Result(String),
    /// A number.
    Number(NumberSlider),
    /// One of several, side by side in rows of `columns`.
    Segments {
        /// The one chosen.
        chosen: usize,
        /// Name and hint of each.
        choices: Vec<Choice>,
        /// How many stand side by side.
        columns: usize,
    },
    /// One of several, in a list that opens.
    List {
        /// Beside it; empty if there is none.
        title: &'static str,
        /// Name for a screen reader.
        label: &'static str,
        /// The one chosen.
        chosen: usize,
        /// Name and hint of each.
        choices: Vec<(String, &'static str)>,
    },
    /// One of several, each in a row; the action of a row is named `verb name`.
    Rows {
        /// The one chosen.
        chosen: usize,
        /// Their names.
        names: Vec<&'static str>,
        /// Verb for the name of a row.
        verb: &'static str,
    },
    /// On or off.
    Toggle {
        /// Is on.
        on: bool,
        /// Beside the box.
        title: &'static str,
        /// More about it.
        hint: &'static str,
    },
    /// A class, in two columns; the action of a row is named `verb class`.
    Class {
        /// The one chosen.
        chosen: Class,
        /// Classes to choose from.
        classes: Vec<Class>,
        /// Verb for the name of a row.
        verb: &'static str,
    },
    /// Does something at once.
    Button {
        /// Text on the button.
        title: &'static str,
        /// More about it.
        hint: &'static str,
        /// Can be pressed.
        enabled: bool,
    },
    /// Several side by side on one line.
    Line(Vec<ToolOption>),
    /// Several side by side, in as many lines as they need.
    Row(Vec<ToolOption>),
    /// A little room.
    Gap,
}

/// A number that is set by a slider.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberSlider {
    /// Beside the slider.
    pub title: &'static str,
    /// Name for a screen reader.
    pub label: &'static str,
    /// More about it.
    pub hint: &'static str,
    /// Now.
    pub value: f64,
    /// Least and most.
    pub range: [f64; 2],
    /// Behind the number, with its space.
    pub unit: &'static str,
    /// Digits behind the point.
    pub decimals: usize,
    /// The slider is finer where the number is small.
    pub logarithmic: bool,
    /// A wide slider on a line of its own.
    pub wide: bool,
}

/// Value that the user set an option to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// Value of a number.
    Number(f64),
    /// Index in segments, lists and rows.
    Index(usize),
    /// State of a toggle.
    On(bool),
    /// Class of a class list.
    Class(Class),
    /// Press of a button.
    Pressed,
}

impl Value {
    /// The number, if it is one.
    pub fn number(self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(number),
            _ => None,
        }
    }

    /// The index, if it is one.
    pub fn index(self) -> Option<usize> {
        match self {
            Self::Index(index) => Some(index),
            _ => None,
        }
    }
}

impl ToolOption {
    /// A setting.
    pub fn new(id: &'static str, control: Control) -> Self {
        Self { id, control }
    }

    /// The name of the tool.
    pub fn title(title: &'static str) -> Self {
        Self::new("", Control::Title(title))
    }

    /// Small text.
    pub fn text(text: impl Into<String>) -> Self {
        Self::new("", Control::Text(text.into()))
    }

    /// A little room.
    pub fn gap() -> Self {
        Self::new("", Control::Gap)
    }

    /// A number with a narrow slider.
    pub fn number(
        id: &'static str,
        title: &'static str,
        value: f64,
        range: [f64; 2],
        decimals: usize,
    ) -> Self {
        Self::new(
            id,
            Control::Number(NumberSlider {
                title,
                label: title,
                hint: "",
                value,
                range,
                unit: "",
                decimals,
                logarithmic: false,
                wide: false,
            }),
        )
    }

    /// The diameter of the brush.
    pub fn brush_size(brush_m: f64) -> Self {
        Self::new(
            "size",
            Control::Number(NumberSlider {
                title: "Size",
                label: "Brush size",
                hint: "[ and ], or Ctrl+wheel",
                value: brush_m,
                range: [*super::Hand::BRUSH_M.start(), *super::Hand::BRUSH_M.end()],
                unit: " m",
                decimals: 1,
                logarithmic: true,
                wide: true,
            }),
        )
    }

    /// One of several, side by side; `all` are value, name and hint.
    pub fn segments<T: Copy + PartialEq>(
        id: &'static str,
        chosen: T,
        all: &[(T, &'static str, &'static str)],
        columns: usize,
    ) -> Self {
        Self::new(
            id,
            Control::Segments {
                chosen: index_in(chosen, all),
                choices: all.iter().map(|c| (c.1, c.2)).collect(),
                columns,
            },
        )
    }

    /// On or off.
    pub fn toggle(id: &'static str, on: bool, title: &'static str, hint: &'static str) -> Self {
        Self::new(id, Control::Toggle { on, title, hint })
    }

    /// A button.
    pub fn button(id: &'static str, title: &'static str, hint: &'static str, enabled: bool) -> Self {
        Self::new(id, Control::Button { title, hint, enabled })
    }
}

/// Index of a value among those to choose from; the first if it is none of them.
pub fn index_in<T: Copy + PartialEq>(chosen: T, all: &[(T, &'static str, &'static str)]) -> usize {
    all.iter().position(|c| c.0 == chosen).unwrap_or(0)
}

/// Takes the value at that index, if there is one.
pub fn take<T: Copy>(into: &mut T, value: Value, all: &[(T, &'static str, &'static str)]) {
    if let Some(chosen) = value.index().and_then(|i| all.get(i)) {
        *into = chosen.0;
    }
}

/// Takes a number.
pub fn take_number(into: &mut f64, value: Value) {
    if let Some(number) = value.number() {
        *into = number;
    }
}

/// Takes on or off.
pub fn take_on(into: &mut bool, value: Value) {
    if let Value::On(on) = value {
        *into = on;
    }
}

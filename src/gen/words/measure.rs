//! Quantities of the numbers in a text: a length, a speed, a time, a rate, an angle, a share, the time of day, or a
//! count. A number is never taken for another quantity than the stated one: "8 km/h" is not 8 m, and "30 km/h" is not
//! thirty things.

use super::tokens::Token;
use place::beside_road::TextSpan;

/// Quantity that a number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeasuredQuantity {
    /// A count, or a number without a unit.
    Count,
    /// m.
    Length,
    /// km/h.
    Speed,
    /// s.
    Time,
    /// m/s².
    Rate,
    /// Degrees.
    Angle,
    /// Percent.
    Share,
    /// Hours after midnight.
    Clock,
    /// Storeys of a building.
    Storeys,
    /// Another quantity, which no slot of a reading holds: tonnes, years, degrees Celsius.
    Foreign,
}

/// A number of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// Quantity that it measures.
    pub kind: MeasuredQuantity,
    /// Value in the unit of its kind.
    pub value: f64,
    /// The number as it was typed.
    pub raw: f64,
    /// The token that it begins with.
    pub from: usize,
    /// The token after its unit.
    pub to: usize,
}

impl Measure {
    /// Bytes of the text that it takes.
    pub fn span(&self, tokens: &[Token]) -> TextSpan {
        let last = tokens[self.to - 1].span;
        tokens[self.from].span.to(last)
    }
}

/// Units that are separate words, with their size in the kind's unit.
const UNITS: [(MeasuredQuantity, f64, &[&str]); 10] = [
    (
        MeasuredQuantity::Time,
        1.0,
        &["s", "sec", "secs", "second", "seconds"],
    ),
    (
        MeasuredQuantity::Time,
        0.001,
        &["ms", "msec", "msecs", "millisecond", "milliseconds"],
    ),
    (
        MeasuredQuantity::Time,
        60.0,
        &["min", "mins", "minute", "minutes"],
    ),
    (
        MeasuredQuantity::Time,
        3600.0,
        &["h", "hr", "hrs", "hour", "hours"],
    ),
    (
        MeasuredQuantity::Angle,
        1.0,
        &["deg", "degs", "degree", "degrees", "°"],
    ),
    (
        MeasuredQuantity::Angle,
        57.295_779_513,
        &["rad", "rads", "radian", "radians"],
    ),
    (MeasuredQuantity::Share, 1.0, &["%", "percent", "pct"]),
    (MeasuredQuantity::Rate, 9.81, &["g"]),
    (
        MeasuredQuantity::Length,
        0.001,
        &["mm", "millimetre", "millimetres", "millimeter", "millimeters"],
    ),
    (
        MeasuredQuantity::Storeys,
        1.0,
        &[
            "storey", "storeys", "story", "stories", "storeyed", "floor", "floors",
        ],
    ),
];

/// Units and other words after a number which show that it does not count things of the road.
const FOREIGN: [&str; 80] = [
    "wheeler",
    "wheelers",
    "kg",
    "kgs",
    "kilo",
    "kilos",
    "kilogram",
    "kilograms",
    "gram",
    "grams",
    "t",
    "ton",
    "tons",
    "tonne",
    "tonnes",
    "lb",
    "lbs",
    "pound",
    "pounds",
    "hp",
    "bhp",
    "horsepower",
    "kw",
    "watt",
    "watts",
    "w",
    "volt",
    "volts",
    "v",
    "amp",
    "amps",
    "litre",
    "litres",
    "liter",
    "liters",
    "l",
    "cc",
    "ml",
    "gallon",
    "gallons",
    "lux",
    "lumen",
    "lumens",
    "hz",
    "khz",
    "mhz",
    "fps",
    "rpm",
    "db",
    "bar",
    "px",
    "pixel",
    "pixels",
    "dpi",
    "year",
    "years",
    "yr",
    "yrs",
    "month",
    "months",
    "week",
    "weeks",
    "day",
    "days",
    "frame",
    "frames",
    "door",
    "doors",
    "seater",
    "seaters",
    "axle",
    "axles",
    "axled",
    "square",
    "cubic",
    "sq",
    "sqm",
    "knots",
    "knot",
    "k",
];

/// Number of tokens after a number within which "per minute" belongs to it: "five cars per minute".
const PER_WITHIN: usize = 3;

/// The numbers of a text, in order.
pub fn measures(tokens: &[Token]) -> Vec<Measure> {
    let mut out: Vec<Measure> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        // ("18 wheeler" is a phrase, not a number)
        let is_number = tokens[i].value.is_some() && tokens[i].senses.is_empty();
        match is_number.then(|| measure(tokens, i)).flatten() {
            Some(m) => {
                i = m.to;
                out.push(m);
            }
            None => i += 1,
        }
    }
    ranges(&mut out, tokens);
    out
}

/// The word that was typed at a place.
fn word(tokens: &[Token], i: usize) -> &str {
    tokens
        .get(i)
        .map_or("", |t| t.typed.as_deref().unwrap_or(t.text.as_str()))
}

fn measure(tokens: &[Token], i: usize) -> Option<Measure> {
    let t = &tokens[i];
    let value = t.value?;
    let made = |kind, value, to| {
        Some(Measure {
            kind,
            value,
            raw: t.raw.unwrap_or(value),
            from: i,
            to,
        })
    };
    let next = word(tokens, i + 1);
    if t.is_length {
        return match power(tokens, i + 1) {
            Some(to) => made(MeasuredQuantity::Foreign, value, to),
            None => made(MeasuredQuantity::Length, value, i + 1),
        };
    }
    if t.is_speed {
        return match power(tokens, i + 1).or(per_second(tokens, i + 1)) {
            Some(to) => made(MeasuredQuantity::Rate, value / 3.6, to),
            None => made(MeasuredQuantity::Speed, value, i + 1),
        };
    }
    // "17:30", "5 pm", "8 o'clock"
    let minutes = tokens.get(i + 2).and_then(|t| t.value).filter(|_| next == ":");
    let touches = |k: usize| {
        tokens
            .get(k)
            .is_some_and(|b| tokens[k - 1].span.end == b.span.start)
    };
    if let Some(minutes) = minutes.filter(|_| touches(i + 1) && touches(i + 2)) {
        let (half, to) = half_of_day(tokens, i + 3).unwrap_or((None, i + 3));
        return made(MeasuredQuantity::Clock, hour(value, half) + minutes / 60.0, to);
    }
    if let Some((half, to)) = half_of_day(tokens, i + 1) {
        return made(MeasuredQuantity::Clock, hour(value, half), to);
    }
    if next == "per" && word(tokens, i + 2) == "cent" {
        return made(MeasuredQuantity::Share, value, i + 3);
    }
    if let Some((kind, times, _)) = UNITS.iter().find(|u| u.2.contains(&next)) {
        let after = word(tokens, i + 2);
        let warm = *kind == MeasuredQuantity::Angle
            && matches!(after, "c" | "f" | "celsius" | "fahrenheit" | "centigrade");
        return match warm {
            true => made(MeasuredQuantity::Foreign, value, i + 3),
            false => made(*kind, value * times, i + 2),
        };
    }
    if FOREIGN.contains(&next) {
        return made(MeasuredQuantity::Foreign, value, i + 2);
    }
    // "five cars per minute" are not five cars
    let per = (i + 1..=i + PER_WITHIN).find(|k| {
        let unit = word(tokens, k + 1);
        word(tokens, *k) == "per"
            && UNITS
                .iter()
                .any(|u| u.0 == MeasuredQuantity::Time && u.2.contains(&unit))
            || word(tokens, *k) == "per" && matches!(unit, "km" | "kilometre" | "kilometer" | "mile")
    });
    match per {
        Some(_) => made(MeasuredQuantity::Foreign, value, i + 1),
        None => made(MeasuredQuantity::Count, value, i + 1),
    }
}

/// The token after a sign of a square or a cube: "²", "^2", a 2 that touches the unit, "squared".
fn power(tokens: &[Token], i: usize) -> Option<usize> {
    let raised = |t: &Token| t.value == Some(2.0) || t.value == Some(3.0);
    match word(tokens, i) {
        "²" | "³" | "squared" | "cubed" => Some(i + 1),
        "^" if tokens.get(i + 1).is_some_and(raised) => Some(i + 2),
        _ => {
            let t = tokens.get(i).filter(|t| raised(t))?;
            (i > 0 && tokens[i - 1].span.end == t.span.start).then_some(i + 1)
        }
    }
}

/// The token after "per second", which makes a rate of a speed.
fn per_second(tokens: &[Token], i: usize) -> Option<usize> {
    let joins = matches!(word(tokens, i), "per" | "/" | "a" | "each" | "every");
    let second = matches!(word(tokens, i + 1), "s" | "sec" | "second");
    (joins && second).then_some(i + 2)
}

/// Morning (false) or afternoon (true), if a token says which of the two, and the token after it.
fn half_of_day(tokens: &[Token], i: usize) -> Option<(Option<bool>, usize)> {
    match (word(tokens, i), word(tokens, i + 1), word(tokens, i + 2)) {
        ("am", ..) => Some((Some(false), i + 1)),
        ("pm", ..) => Some((Some(true), i + 1)),
        ("a", ".", "m") => Some((Some(false), i + 3)),
        ("p", ".", "m") => Some((Some(true), i + 3)),
        ("oclock", ..) => Some((None, i + 1)),
        _ => None,
    }
}

fn hour(value: f64, half: Option<bool>) -> f64 {
    match half {
        Some(true) if value < 12.0 => value + 12.0,
        Some(false) if value == 12.0 => 0.0,
        _ => value,
    }
}

/// "20 to 30 m", "between 5 and 8 s": gives the first number the unit of the second.
fn ranges(all: &mut [Measure], tokens: &[Token]) {
    for k in 1..all.len() {
        let (one, two) = (all[k - 1], all[k]);
        let joint = word(tokens, one.to);
        let between = one.from > 0 && matches!(word(tokens, one.from - 1), "between" | "from");
        let joins = matches!(joint, "to" | "-" | "–" | "or") || joint == "and" && between;
        if one.kind == MeasuredQuantity::Count
            && two.kind != MeasuredQuantity::Count
            && joins
            && two.from == one.to + 1
        {
            let times = if two.raw == 0.0 { 1.0 } else { two.value / two.raw };
            all[k - 1].kind = two.kind;
            all[k - 1].value = one.raw * times;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    /// Every unit that people write, with its quantity.
    #[test]
    fn every_unit_has_its_kind() {
        for (text, kind, value) in [
            ("8 km/h", MeasuredQuantity::Speed, 8.0),
            ("30 mph", MeasuredQuantity::Speed, 48.28),
            ("5 m/s", MeasuredQuantity::Speed, 18.0),
            ("8 m", MeasuredQuantity::Length, 8.0),
            ("80 cm", MeasuredQuantity::Length, 0.8),
            ("800 mm", MeasuredQuantity::Length, 0.8),
            ("30 feet", MeasuredQuantity::Length, 9.144),
            ("5 s", MeasuredQuantity::Time, 5.0),
            ("5s", MeasuredQuantity::Time, 5.0),
            ("five seconds", MeasuredQuantity::Time, 5.0),
            ("500 ms", MeasuredQuantity::Time, 0.5),
            ("2 minutes", MeasuredQuantity::Time, 120.0),
            ("1 hour", MeasuredQuantity::Time, 3600.0),
            ("3 m/s²", MeasuredQuantity::Rate, 3.0),
            ("3 m/s^2", MeasuredQuantity::Rate, 3.0),
            ("3 m/s2", MeasuredQuantity::Rate, 3.0),
            ("3 metres per second squared", MeasuredQuantity::Rate, 3.0),
            ("3 m/s per second", MeasuredQuantity::Rate, 3.0),
            ("0.5 g", MeasuredQuantity::Rate, 4.905),
            ("45 degrees", MeasuredQuantity::Angle, 45.0),
            ("45°", MeasuredQuantity::Angle, 45.0),
            ("2 rad", MeasuredQuantity::Angle, 114.59),
            ("50 %", MeasuredQuantity::Share, 50.0),
            ("50 per cent", MeasuredQuantity::Share, 50.0),
            ("5 pm", MeasuredQuantity::Clock, 17.0),
            ("17:30", MeasuredQuantity::Clock, 17.5),
            ("8 o'clock", MeasuredQuantity::Clock, 8.0),
            ("12 a.m.", MeasuredQuantity::Clock, 0.0),
            ("3 storeys", MeasuredQuantity::Storeys, 3.0),
            ("40 t", MeasuredQuantity::Foreign, 40.0),
            ("3-ton", MeasuredQuantity::Foreign, 3.0),
            ("20 m²", MeasuredQuantity::Foreign, 20.0),
            ("20 square metres", MeasuredQuantity::Foreign, 20.0),
            ("20 °C", MeasuredQuantity::Foreign, 20.0),
            ("5-year-old", MeasuredQuantity::Foreign, 5.0),
            ("5 cars per minute", MeasuredQuantity::Foreign, 5.0),
            ("5 cars", MeasuredQuantity::Count, 5.0),
            ("five", MeasuredQuantity::Count, 5.0),
        ] {
            let found = measures(&tokens(text, None));
            assert_eq!(found.len(), 1, "{text}: {found:?}");
            assert_eq!(found[0].kind, kind, "{text}");
            assert!((found[0].value - value).abs() < 0.01, "{text}: {found:?}");
        }
    }

    #[test]
    fn the_first_of_a_range_has_the_unit_of_the_second() {
        for (text, values) in [
            ("20 to 30 ft", [6.096, 9.144]),
            ("between 20 and 30 m", [20.0, 30.0]),
            ("20-30 m", [20.0, 30.0]),
        ] {
            let found = measures(&tokens(text, None));
            assert!(
                found.iter().all(|m| m.kind == MeasuredQuantity::Length),
                "{text}: {found:?}"
            );
            for (m, v) in found.iter().zip(values) {
                assert!((m.value - v).abs() < 1e-9, "{text}: {found:?}");
            }
        }
        let found = measures(&tokens("two cars and 30 m", None));
        assert_eq!(found[0].kind, MeasuredQuantity::Count);
    }
}

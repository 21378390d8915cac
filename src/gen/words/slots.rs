//! Numbers of a reading, each with its quantity. Numbers that the text states as another quantity are removed, so that
//! none is carried out as something else.

use super::measure::{Measure, MeasuredQuantity};
use super::reading::{
    ActKind, Amount, AnchorPhrase, Destination, ObjectPhrase, PlacePhrase, Quantity, Reading, Relation, Turn,
};
use super::tokens::Token;

/// Quantity of a number in a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotKind {
    /// A quantity that the text measures.
    Of(MeasuredQuantity),
    /// A factor.
    Times,
}

/// A number of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slot {
    /// Its quantity.
    pub kind: SlotKind,
    /// Its value, in the unit of the kind.
    pub value: f64,
}

impl Slot {
    /// True if it is the given number of the text.
    pub fn is(&self, m: &Measure) -> bool {
        self.fits(m.kind) && self.shares(m.kind, m.value).any(|v| near(v, self.value))
    }

    /// True if the kinds fit; a number without a unit fits any kind.
    fn fits(&self, kind: MeasuredQuantity) -> bool {
        match self.kind {
            SlotKind::Of(own) => own == kind || kind == MeasuredQuantity::Count,
            SlotKind::Times => matches!(kind, MeasuredQuantity::Count | MeasuredQuantity::Share),
        }
    }

    /// The values that a number of the text may stand for here: "30 % more" are 1.3 times as many.
    fn shares(&self, kind: MeasuredQuantity, value: f64) -> impl Iterator<Item = f64> {
        let times = [value / 100.0, 1.0 + value / 100.0, 1.0 - value / 100.0];
        let of_share = self.kind == SlotKind::Times && kind == MeasuredQuantity::Share;
        let n = if of_share { 3 } else { 1 };
        let list = if of_share { times } else { [value; 3] };
        list.into_iter().take(n)
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 0.06 + 1e-3 * b.abs()
}

/// All numbers of a reading.
pub fn slots(reading: &Reading) -> Vec<Slot> {
    let mut out = Vec::new();
    let mut copy = reading.clone();
    each(&mut copy, &mut |slot| {
        out.push(slot);
        Verdict::Keep
    });
    out
}

/// Decision on a number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    Keep,
    Replace(f64),
    Clear,
}

/// Words that give a number of things, or a factor, without a numeral in the text.
const WORKED_OUT: [&str; 16] = [
    "another",
    "couple",
    "pair",
    "both",
    "twins",
    "dozen",
    "half",
    "halve",
    "halved",
    "double",
    "doubled",
    "twice",
    "triple",
    "tripled",
    "quadruple",
    "each",
];

/// Removes from a reading every number that its text states as another quantity. A number with the wrong unit ("2
/// minutes" as 2 s) is corrected.
pub fn set_right(reading: &mut Reading, tokens: &[Token], measures: &[Measure]) {
    let works_out = tokens.iter().any(|t| WORKED_OUT.contains(&t.text.as_str()));
    let judge = |slot: Slot| -> Verdict {
        let is_count = slot.kind == SlotKind::Of(MeasuredQuantity::Count);
        let by_words = (is_count || slot.kind == SlotKind::Times) && works_out;
        if measures.iter().any(|m| slot.is(m)) || by_words || is_count && slot.value <= 1.0 {
            return Verdict::Keep;
        }
        let own = |m: &&Measure| SlotKind::Of(m.kind) == slot.kind && near(m.raw, slot.value);
        if let Some(m) = measures.iter().find(own) {
            return Verdict::Replace(m.value);
        }
        let foreign = |m: &Measure| {
            let as_typed = near(m.raw, slot.value);
            // ("7 %" is not seven times as many)
            let is_share = m.kind == MeasuredQuantity::Share;
            (!slot.fits(m.kind) && (as_typed || near(m.value, slot.value))) || is_share && as_typed
        };
        match measures.iter().any(foreign) {
            true => Verdict::Clear,
            false => Verdict::Keep,
        }
    };
    each(reading, &mut |slot| judge(slot));
}

/// Visits every number of a reading and applies the returned decision. An act that has no meaning without its number is
/// removed.
fn each(reading: &mut Reading, visit: &mut dyn FnMut(Slot) -> Verdict) {
    reading.acts.retain_mut(|act| act_stays(&mut act.what, visit));
}

type Visit<'v> = &'v mut dyn FnMut(Slot) -> Verdict;

fn one(kind: SlotKind, value: f64, visit: Visit<'_>) -> Option<f64> {
    match visit(Slot { kind, value }) {
        Verdict::Keep => Some(value),
        Verdict::Replace(other) => Some(other),
        Verdict::Clear => None,
    }
}

fn of(kind: MeasuredQuantity, value: &mut Option<f64>, visit: Visit<'_>) {
    if let Some(v) = *value {
        *value = one(SlotKind::Of(kind), v, visit);
    }
}

fn count(n: u32, visit: Visit<'_>) -> Option<u32> {
    let found = one(SlotKind::Of(MeasuredQuantity::Count), f64::from(n), visit)?;
    Some(found.clamp(0.0, f64::from(u32::MAX)) as u32)
}

fn act_stays(what: &mut ActKind, visit: Visit<'_>) -> bool {
    match what {
        ActKind::Add { things } => each_thing(things, visit),
        ActKind::No { who } | ActKind::Remove { who } | ActKind::Keep { who } | ActKind::Leave { who } => {
            each_thing(who, visit)
        }
        ActKind::Replace { who, things } => {
            each_thing(who, visit);
            each_thing(things, visit);
        }
        ActKind::Move { who, to } => {
            each_thing(who, visit);
            return destination_stays(to, visit);
        }
        ActKind::Turn { who, turn } => {
            each_thing(who, visit);
            match turn {
                Turn::Left(degrees) => {
                    let side = degrees.signum();
                    let found = one(SlotKind::Of(MeasuredQuantity::Angle), degrees.abs(), visit);
                    *degrees = side * found.unwrap_or(90.0);
                }
                Turn::To(places) => each_place(places, visit),
                Turn::Around | Turn::Along => {}
            }
        }
        ActKind::Set { who, traits } => {
            each_thing(who, visit);
            if let Some(of) = &mut traits.paint_of {
                each_thing(std::slice::from_mut(of), visit);
            }
        }
        ActKind::Count { who, amount } => {
            each_thing(who, visit);
            match amount {
                Amount::To(least, most) => {
                    let (a, b) = (count(*least, visit), count(*most, visit));
                    let (Some(a), Some(b)) = (a, b) else { return false };
                    (*least, *most) = (a, b);
                }
                Amount::Times(n) => match one(SlotKind::Times, *n, visit) {
                    Some(found) => *n = found,
                    None => return false,
                },
            }
        }
        ActKind::Swap { one, other } => {
            each_thing(std::slice::from_mut(one), visit);
            each_thing(std::slice::from_mut(other), visit);
        }
        ActKind::Go { who, how } => {
            each_thing(who, visit);
            of(MeasuredQuantity::Time, &mut how.from_s, visit);
            of(MeasuredQuantity::Length, &mut how.gap_m, visit);
            of(MeasuredQuantity::Speed, &mut how.kmh, visit);
        }
        ActKind::Length { seconds } => match one(SlotKind::Of(MeasuredQuantity::Time), *seconds, visit) {
            Some(found) => *seconds = found,
            None => return false,
        },
        ActKind::Lanes { n } => match count(*n, visit) {
            Some(found) => *n = found,
            None => return false,
        },
        ActKind::Has { places, .. } => each_place(places, visit),
        ActKind::Time { .. }
        | ActKind::Weather { .. }
        | ActKind::Road { .. }
        | ActKind::Env { .. }
        | ActKind::Density { .. }
        | ActKind::Lacks { .. }
        | ActKind::OneWay
        | ActKind::Narrow
        | ActKind::Wide
        | ActKind::OwnLane { .. } => {}
    }
    true
}

fn destination_stays(to: &mut Destination, visit: Visit<'_>) -> bool {
    match to {
        Destination::To(places) => {
            each_place(places, visit);
            return !places.is_empty();
        }
        Destination::By { metres, .. } => of(MeasuredQuantity::Length, metres, visit),
        Destination::Lanes(n) => {
            let lanes = count(n.unsigned_abs(), visit).unwrap_or(1).min(20);
            *n = n.signum() * lanes as i32;
        }
        Destination::Times(n) => match one(SlotKind::Times, *n, visit) {
            Some(found) => *n = found,
            None => return false,
        },
    }
    true
}

fn each_thing(things: &mut [ObjectPhrase], visit: Visit<'_>) {
    for t in things {
        t.quantity = match t.quantity {
            Quantity::N(n) => Quantity::N(count(n, visit).unwrap_or(1)),
            Quantity::TheN(n) => count(n, visit).map_or(Quantity::The, Quantity::TheN),
            Quantity::Range(a, b) => match (count(a, visit), count(b, visit)) {
                (Some(a), Some(b)) => Quantity::Range(a, b),
                _ => Quantity::N(1),
            },
            other => other,
        };
        // (ordinals from "first" to "fifth", and "last", are words)
        if let Some(nth) = t.nth.filter(|n| *n > 5) {
            t.nth = count(nth, visit);
        }
        if let Some(id) = t.id {
            t.id = count(id, visit);
        }
        each_place(&mut t.places, visit);
        each_thing(&mut t.except, visit);
    }
}

fn each_place(places: &mut Vec<PlacePhrase>, visit: Visit<'_>) {
    places.retain_mut(|p| {
        let measured = p.metres.is_some();
        of(MeasuredQuantity::Length, &mut p.metres, visit);
        for anchor in [&mut p.to, &mut p.and].into_iter().flatten() {
            if let AnchorPhrase::Thing(t) = anchor {
                each_thing(std::slice::from_mut(t), visit);
            }
        }
        // ("at" has no meaning without its distance)
        !(p.relation == Relation::At && measured && p.metres.is_none())
    });
}

#[cfg(test)]
mod tests {
    use super::super::measure::measures;
    use super::super::notation::{parse, write};
    use super::super::tokens::tokens;
    use super::*;

    fn right(text: &str, line: &str) -> String {
        let mut reading = parse(line).unwrap_or_else(|e| panic!("{line}: {e}"));
        let tokens = tokens(text, None);
        set_right(&mut reading, &tokens, &measures(&tokens));
        write(&reading)
    }

    /// Every kind of number in every slot: it stays where the kinds match, and is removed where they do not.
    #[test]
    fn a_number_stays_only_where_it_is_of_its_kind() {
        // The number is 7 throughout; the slot, the line with it and the line without it.
        let slots = [
            ("length", "add 1 car ( ahead ego 7m )", "add 1 car ( ahead ego )"),
            ("length", "move the car by left 7m", "move the car by left"),
            ("length", "move the car to ( at ego 7m )", ""),
            ("length", "go the car stop gap 7m", "go the car stop"),
            ("speed", "go the car drive speed 7kmh", "go the car drive"),
            ("time", "go the car stop from 7s", "go the car stop"),
            ("time", "length 7s", ""),
            ("angle", "turn the car left 7deg", "turn the car left"),
            ("count", "add 7 car", "add 1 car"),
            ("count", "remove the 7 car", "remove the car"),
            ("count", "count car to 7", ""),
            ("count", "lanes 7", ""),
            ("count", "remove the nth 7 car", "remove the car"),
            ("times", "count car times 7", ""),
            ("times", "move the car by times 7", ""),
        ];
        let units = [
            ("length", "7 m"),
            ("speed", "7 km/h"),
            ("time", "7 s"),
            ("angle", "7 degrees"),
            ("rate", "7 m/s²"),
            ("share", "7 %"),
            ("clock", "7 pm"),
            ("storeys", "7 storeys"),
            ("foreign", "7 t"),
            ("foreign", "7 years"),
            ("foreign", "7 m²"),
        ];
        for (slot, with, without) in slots {
            assert_eq!(right("so 7 of it", with), with, "a bare number fits: {with}");
            for (unit, text) in units {
                let wanted = if slot == unit { with } else { without };
                assert_eq!(right(text, with), wanted, "{text} in {with}");
            }
        }
    }

    #[test]
    fn what_is_only_in_another_unit_is_set_right() {
        assert_eq!(right("after 2 minutes", "length 2s"), "length 120s");
        assert_eq!(
            right("500 ms later", "go the car stop from 500s"),
            "go the car stop from 0.5s"
        );
        assert_eq!(
            right("30 % more cars", "count car times 1.3"),
            "count car times 1.3"
        );
        // Numbers that no numeral of the text says stay.
        assert_eq!(right("a couple of cars after 2 s", "add 2 car"), "add 2 car");
        assert_eq!(right("cars at 30 km/h", "add 4 car"), "add 4 car");
        let third = "go the nth 3 car stop from 3s";
        assert_eq!(right("the third car stops after 3 s", third), third);
        let twice = "count car times 2";
        assert_eq!(right("double the cars after 2 s", twice), twice);
        assert_eq!(right("30 cars at 30 km/h", "add 30 car"), "add 30 car");
    }
}

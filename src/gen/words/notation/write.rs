//! Values to notation.

use super::super::reading::{
    ActKind, Amount, AnchorPhrase, Destination, ObjectPhrase, PaintWish, PlacePhrase, Quantity, Reading,
    Traits, Turn,
};
use super::{PACES, SIZES, STATES, anchors, plain};
use scene::clip::Manoeuvre;
use scene::graph::{ObjectState, SizeHint};

/// The line of a reading; `parse` of it gives the same reading.
pub fn write(reading: &Reading) -> String {
    let acts: Vec<String> = reading.acts.iter().map(|a| act(&a.what)).collect();
    acts.join(" ; ")
}

fn act(what: &ActKind) -> String {
    match what {
        ActKind::Add { things } => format!("add {}", list(things)),
        ActKind::No { who } => format!("no {}", list(who)),
        ActKind::Remove { who } => format!("remove {}", list(who)),
        ActKind::Keep { who } => format!("keep {}", list(who)),
        ActKind::Leave { who } if who.is_empty() => "leave rest".into(),
        ActKind::Leave { who } => format!("leave {}", list(who)),
        ActKind::Replace { who, things } => format!("replace {} with {}", list(who), list(things)),
        ActKind::Move { who, to } => format!("move {} {}", list(who), destination(to)),
        ActKind::Turn { who, turn } => format!("turn {} {}", list(who), turned(turn)),
        ActKind::Set { who, traits } => format!("set {} {}", list(who), traits_in_words(traits)),
        ActKind::Count { who, amount } => format!("count {} {}", list(who), count(*amount)),
        ActKind::Swap { one, other } => format!("swap {} and {}", thing(one), thing(other)),
        ActKind::Go { who, how } if who.is_empty() => format!("go ego {}", manoeuvre(how)),
        ActKind::Go { who, how } => format!("go {} {}", list(who), manoeuvre(how)),
        ActKind::Length { seconds } => format!("length {seconds}s"),
        ActKind::Time { what } => format!("time {}", what.name()),
        ActKind::Weather { what } => format!("weather {}", what.name()),
        ActKind::Road { what } => format!("road {}", plain(what.name())),
        ActKind::Env { what } => format!("env {}", what.name()),
        ActKind::Density { what } => format!("density {}", what.name()),
        ActKind::Has { what, places: at } if at.is_empty() => format!("has {}", what.name()),
        ActKind::Has { what, places: at } => format!("has {} {}", what.name(), places(at)),
        ActKind::Lacks { what } => format!("lacks {}", what.name()),
        ActKind::Lanes { n } => format!("lanes {n}"),
        ActKind::OneWay => "one_way".into(),
        ActKind::Narrow => "narrow".into(),
        ActKind::Wide => "wide".into(),
        ActKind::OwnLane { what } => format!("own_lane {}", what.name()),
    }
}

fn list(things: &[ObjectPhrase]) -> String {
    let things: Vec<String> = things.iter().map(thing).collect();
    things.join(" and ")
}

fn manoeuvre(how: &Manoeuvre) -> String {
    let mut out = how.what.name().to_owned();
    let numbers = [
        ("from", how.from_s, "s"),
        ("gap", how.gap_m, "m"),
        ("speed", how.kmh, "kmh"),
    ];
    for (name, number, unit) in numbers {
        if let Some(n) = number {
            out += &format!(" {name} {n}{unit}");
        }
    }
    if let Some((name, _)) = PACES.into_iter().find(|x| Some(x.1) == how.pace) {
        out += &format!(" {name}");
    }
    out
}

fn destination(to: &Destination) -> String {
    match to {
        Destination::To(at) => format!("to {}", places(at)),
        Destination::By { way, metres } => {
            let far = metres.map_or(String::new(), |m| format!(" {m}m"));
            format!("by {}{far}", way.name())
        }
        Destination::Times(n) => format!("by times {n}"),
        Destination::Lanes(n) => {
            let side = if *n > 0 { "lane_left" } else { "lane_right" };
            match n.unsigned_abs() {
                1 => format!("by {side}"),
                n => format!("by {side} {n}"),
            }
        }
    }
}

fn turned(turn: &Turn) -> String {
    match turn {
        Turn::Around => "around".into(),
        Turn::Along => "along".into(),
        Turn::To(at) => format!("to {}", places(at)),
        Turn::Left(degrees) => {
            let side = if *degrees < 0.0 { "right" } else { "left" };
            match degrees.abs() {
                90.0 => side.into(),
                d => format!("{side} {d}deg"),
            }
        }
    }
}

fn traits_in_words(traits: &Traits) -> String {
    let mut out: Vec<String> = Vec::new();
    out.extend(traits.size.map(|s| size(s).into()));
    out.extend(traits.state.map(|s| state(s).into()));
    out.extend(traits.paint.map(|p| p.name().into()));
    out.extend(traits.paint_of.as_ref().map(|t| format!("paint_of {}", thing(t))));
    out.join(" ")
}

fn count(amount: Amount) -> String {
    match amount {
        Amount::To(a, b) if a == b => format!("to {a}"),
        Amount::To(a, b) => format!("to {a} .. {b}"),
        Amount::Times(n) => format!("times {n}"),
    }
}

/// A thing in notation.
pub fn thing(t: &ObjectPhrase) -> String {
    let mut out: Vec<String> = Vec::new();
    let (before, after): (Vec<String>, Vec<String>) = match t.quantity {
        Quantity::Unsaid => (vec![], vec![]),
        Quantity::The => (vec!["the".into()], vec![]),
        Quantity::TheN(n) => (vec!["the".into()], vec![n.to_string()]),
        Quantity::All => (vec!["all".into()], vec![]),
        Quantity::Each => (vec!["each".into()], vec![]),
        Quantity::Half => (vec!["half".into()], vec![]),
        Quantity::Some => (vec!["some".into()], vec![]),
        Quantity::Many => (vec!["many".into()], vec![]),
        Quantity::N(n) => (vec![], vec![n.to_string()]),
        Quantity::Range(a, b) => (vec![], vec![a.to_string(), "..".into(), b.to_string()]),
    };
    out.extend(before);
    out.extend(t.other.then(|| "other".into()));
    out.extend(after);
    out.extend(t.pick.map(|p| p.name().into()));
    out.extend(t.nth.map(|n| format!("nth {n}")));
    out.extend(t.size.map(|s| size(s).into()));
    out.extend(t.state.map(|s| state(s).into()));
    out.extend(t.paint.map(|p| match p {
        PaintWish::Is(p) => p.name().into(),
        PaintWish::Not(p) => format!("not_{}", p.name()),
    }));
    out.push(t.noun.name().into());
    out.extend(t.id.map(|id| format!("#{id}")));
    if !t.places.is_empty() {
        out.push(places(&t.places));
    }
    if !t.except.is_empty() {
        out.push(format!("( except {} )", list(&t.except)));
    }
    out.join(" ")
}

fn places(at: &[PlacePhrase]) -> String {
    let at: Vec<String> = at.iter().map(place).collect();
    at.join(" ")
}

fn place(p: &PlacePhrase) -> String {
    let mut out = vec!["(".to_string(), p.relation.name().into()];
    out.extend(p.to.as_ref().map(anchor));
    if let Some(second) = &p.and {
        out.push("and".into());
        out.push(anchor(second));
    }
    out.extend(p.metres.map(|m| format!("{m}m")));
    out.push(")".into());
    out.join(" ")
}

fn anchor(a: &AnchorPhrase) -> String {
    match a {
        AnchorPhrase::Thing(t) => thing(t),
        other => anchors()
            .find(|(_, x)| x == other)
            .map_or("ego", |(name, _)| name)
            .into(),
    }
}

fn state(s: ObjectState) -> &'static str {
    STATES.into_iter().find(|x| x.1 == s).map_or("waiting", |x| x.0)
}

fn size(s: SizeHint) -> &'static str {
    SIZES.into_iter().find(|x| x.1 == s).map_or("large", |x| x.0)
}

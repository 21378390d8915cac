//! The answer to a text, in a sentence: "Adds three pedestrians on the crossing; the bus stays; "slowly" has no effect."

use super::account::{Missing, Why};
use super::nouns::Noun;
use super::reading::{
    ActKind, Amount, AnchorPhrase, Destination, Feature, LaneSide, ObjectPhrase, PaintWish, PlacePhrase,
    Quantity, Reading, Relation, Traits, Turn, Way,
};
use super::remark::Remark;
use super::resolve::plural;
use super::stage::ReadingOutcome;
use scene::clip::{Manoeuvre, Pace, Template};
use scene::graph::{LaneRole, ObjectState, SizeHint};

/// Most words in a list of words without effect.
const MOST_WORDS: usize = 6;

/// A sentence on the effect of a reading. `outcome` is the result in an open scene; `remarks` tell by act what could
/// not be done as it was said.
pub fn answer(
    reading: &Reading,
    outcome: Option<&ReadingOutcome>,
    remarks: &[(usize, Remark)],
    missing: &[Missing],
) -> String {
    let asks = outcome.is_some_and(|o| !o.questions.is_empty());
    let mut parts: Vec<String> = Vec::new();
    for (i, act) in reading.acts.iter().enumerate() {
        let said = sentence(&act.what);
        let why: Vec<String> = remarks
            .iter()
            .filter(|(a, _)| *a == i)
            .map(|(_, r)| r.to_string())
            .collect();
        let why = why.join("; ");
        let asked = outcome.and_then(|o| o.questions.iter().find(|q| q.act == i));
        let changes = !matches!(act.what, ActKind::Leave { .. });
        let nothing = changes && outcome.is_some_and(|o| o.done.get(i).is_none_or(|d| d.is_nothing()));
        parts.push(match (asked, why.is_empty()) {
            (Some(q), _) => q.text.clone(),
            (None, false) if nothing => format!("not done: {said} ({why})"),
            (None, true) if nothing => format!("not done: {said}"),
            (None, _) if asks && changes => format!("then: {said}"),
            (None, true) => said,
            (None, false) => format!("{said} ({why})"),
        });
    }
    if parts.is_empty() {
        parts.push("nothing was understood".into());
    }
    let of = |why: Why| -> Vec<String> {
        let mut words: Vec<String> = Vec::new();
        for m in missing.iter().filter(|m| m.why == why) {
            let word = format!("\u{201c}{}\u{201d}", m.words);
            if !words.contains(&word) {
                words.push(word);
            }
        }
        words.truncate(MOST_WORDS);
        words
    };
    let (idle, unknown) = (of(Why::NotCarriedOut), of(Why::Unknown));
    if !idle.is_empty() {
        let has = if idle.len() == 1 { "has" } else { "have" };
        parts.push(format!("{} {has} no effect", idle.join(", ")));
    }
    if !unknown.is_empty() {
        let was = if unknown.len() == 1 { "was" } else { "were" };
        parts.push(format!("{} {was} not understood", unknown.join(", ")));
    }
    if missing.iter().any(|m| m.why == Why::TooLong) {
        parts.push("the text is too long: its end was not read".into());
    }
    let text = parts.join("; ");
    let mut letters = text.chars();
    match letters.next() {
        Some(first) => {
            let end = if text.ends_with('?') { "" } else { "." };
            format!("{}{}{end}", first.to_uppercase(), letters.as_str())
        }
        None => String::new(),
    }
}

/// One act in words: `adds two buses`.
pub fn sentence(what: &ActKind) -> String {
    match what {
        ActKind::Add { things } => format!("adds {}", list(things)),
        ActKind::No { who } => {
            let who: Vec<String> = who
                .iter()
                .map(|t| {
                    if t.other {
                        format!("other {}", many(t))
                    } else {
                        many(t)
                    }
                })
                .collect();
            format!("no {}", join(&who, "or"))
        }
        ActKind::Remove { who } => format!("removes {}", list(who)),
        ActKind::Keep { who } => format!("keeps only {}", list(who)),
        ActKind::Leave { who } if who.is_empty() => "all else stays".into(),
        ActKind::Leave { who } => format!("{} {}", list(who), verb(who, "stays", "stay")),
        ActKind::Replace { who, things } => format!("replaces {} with {}", list(who), list(things)),
        ActKind::Move { who, to } => format!("moves {} {}", list(who), destination(to)),
        ActKind::Turn { who, turn } => format!("turns {} {}", list(who), turned(turn)),
        ActKind::Set { who, traits } => format!("makes {} {}", list(who), traits_in_words(traits)),
        ActKind::Count { who, amount } => {
            let who: Vec<String> = who.iter().map(many).collect();
            match amount {
                Amount::To(a, b) if a == b => format!("makes it {a} {}", join(&who, "and")),
                Amount::To(a, b) => format!("makes it {a} to {b} {}", join(&who, "and")),
                Amount::Times(n) => format!("makes it {n} times as many {}", join(&who, "and")),
            }
        }
        ActKind::Swap { one, other } => format!("swaps {} and {}", thing(one), thing(other)),
        ActKind::Go { who, how } if who.is_empty() => format!("we {}", manoeuvre(how)),
        ActKind::Go { who, how } => format!("lets {} {}", list(who), manoeuvre(how)),
        ActKind::Length { seconds } => format!("lasts {seconds} s"),
        ActKind::Time { what } => format!("time of day: {}", what.name()),
        ActKind::Weather { what } => format!("weather: {}", what.name()),
        ActKind::Road { what } => format!("road: {}", what.name()),
        ActKind::Env { what } => format!("surroundings: {}", what.name()),
        ActKind::Density { what } => format!("traffic: {}", what.name()),
        ActKind::Has { what, places } => format!("a {}{}", feature(*what), at_places(places)),
        ActKind::Lacks { what } => format!("no {}", feature(*what)),
        ActKind::Lanes { n } => format!("{n} lanes"),
        ActKind::OneWay => "one-way traffic".into(),
        ActKind::Narrow => "a narrow road".into(),
        ActKind::Wide => "a wide road".into(),
        ActKind::OwnLane { what } => match what {
            LaneSide::Left => "we drive in the left lane".into(),
            LaneSide::Right => "we drive in the right lane".into(),
            LaneSide::Middle => "we drive in the middle lane".into(),
        },
    }
}

fn manoeuvre(how: &Manoeuvre) -> String {
    let mut text = match how.what {
        Template::Drive => "drive along the lane",
        Template::Follow => "follow whoever is ahead",
        Template::Stop => "brake to a stop",
        Template::CutIn => "cut in",
        Template::Cross => "cross the road",
        Template::PullOut => "pull out",
        Template::Park => "pull over and park",
        Template::TurnLeft => "turn left",
        Template::TurnRight => "turn right",
    }
    .to_owned();
    if let Some(s) = how.from_s {
        text += &format!(" after {s} s");
    }
    match how.gap_m {
        Some(m) if how.what == Template::Follow => text += &format!(" {m} m behind them"),
        Some(m) => text += &format!(" when {m} m are left between us"),
        None => {}
    }
    if let Some(kmh) = how.kmh {
        text += &format!(" at {kmh} km/h");
    }
    match how.pace {
        Some(Pace::Fast) => text += " fast",
        Some(Pace::Slow) => text += " slowly",
        None => {}
    }
    text
}

fn feature(what: Feature) -> &'static str {
    match what {
        Feature::Crossing => "pedestrian crossing",
        Feature::Sidewalk => "sidewalk",
    }
}

fn join(parts: &[String], and: &str) -> String {
    match parts {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} {and} {last}", first.join(", ")),
    }
}

fn list(things: &[ObjectPhrase]) -> String {
    let parts: Vec<String> = things.iter().map(thing).collect();
    join(&parts, "and")
}

fn verb(who: &[ObjectPhrase], one: &str, many: &str) -> String {
    let single = who.len() == 1
        && (matches!(who[0].quantity, Quantity::The | Quantity::N(1)) || who[0].pick.is_some());
    if single { one.into() } else { many.into() }
}

fn bare(t: &ObjectPhrase, several: bool) -> String {
    let mut out: Vec<String> = Vec::new();
    out.extend(t.size.map(|s| match s {
        SizeHint::Small => "small".to_string(),
        SizeHint::Large => "large".into(),
    }));
    out.extend(t.state.map(|s| match s {
        ObjectState::Moving => "moving".to_string(),
        ObjectState::Parked => "parked".into(),
        ObjectState::Waiting => "standing".into(),
    }));
    out.extend(t.paint.map(|p| match p {
        PaintWish::Is(p) => p.name().to_string(),
        PaintWish::Not(p) => format!("not {}", p.name()),
    }));
    let noun = match t.noun {
        Noun::Person if !several => "pedestrian".into(),
        Noun::Person => "pedestrians".into(),
        Noun::Thing => if several { "objects" } else { "object" }.into(),
        Noun::One => if several { "ones" } else { "one" }.into(),
        noun if several => plural(&noun.words()),
        noun => noun.words(),
    };
    out.push(noun);
    out.join(" ")
}

fn many(t: &ObjectPhrase) -> String {
    format!("{}{}", bare(t, true), tail(t))
}

fn tail(t: &ObjectPhrase) -> String {
    let mut out = at_places(&t.places);
    if !t.except.is_empty() {
        out.push_str(&format!(" except {}", list(&t.except)));
    }
    out
}

/// A thing in words: `the two parked red cars on the left`.
pub fn thing(t: &ObjectPhrase) -> String {
    if let Some(id) = t.id {
        return format!("{} #{id}", bare(t, false));
    }
    if t.noun == Noun::It {
        return if t.quantity == Quantity::All { "them" } else { "it" }.into();
    }
    let other = if t.other { "other " } else { "" };
    let pick = match (t.pick, t.nth) {
        (Some(p), _) => format!("{} ", p.name()),
        (_, Some(0)) => "last ".into(),
        (_, Some(n)) => format!(
            "{} ",
            ["first", "second", "third", "fourth", "fifth"]
                .get(n as usize - 1)
                .unwrap_or(&"next")
        ),
        _ => String::new(),
    };
    let words = match t.quantity {
        Quantity::The | Quantity::Unsaid => format!("the {other}{pick}{}", bare(t, false)),
        Quantity::TheN(n) => format!("the {other}{} {pick}{}", number(n), bare(t, n != 1)),
        Quantity::All => format!("all {other}{}", bare(t, true)),
        Quantity::Each => format!("each {other}{}", bare(t, false)),
        Quantity::Half => format!("half of the {}", bare(t, true)),
        Quantity::Some => format!("some {}", bare(t, true)),
        Quantity::Many => format!("many {}", bare(t, true)),
        Quantity::N(n) if pick.is_empty() => format!("{} {other}{}", number(n), bare(t, n != 1)),
        Quantity::N(n) => format!("the {} {pick}{}", number(n), bare(t, n != 1)),
        Quantity::Range(a, b) => format!("{a} to {b} {}", bare(t, true)),
    };
    words + &tail(t)
}

fn number(n: u32) -> String {
    const WORDS: [&str; 13] = [
        "no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven",
        "twelve",
    ];
    WORDS
        .get(n as usize)
        .map_or_else(|| n.to_string(), |w| (*w).to_string())
}

fn at_places(places: &[PlacePhrase]) -> String {
    places.iter().map(|p| format!(" {}", place(p))).collect()
}

fn metres(m: Option<f64>) -> String {
    m.map_or(String::new(), |m| format!("{m} m "))
}

fn place(p: &PlacePhrase) -> String {
    let far = metres(p.metres);
    let Some(to) = &p.to else {
        return match p.relation {
            Relation::InLine => "in a row".into(),
            Relation::SideBySide => "side by side".into(),
            _ => "there".into(),
        };
    };
    let a = anchor(to);
    match p.relation {
        Relation::Ahead if *to == AnchorPhrase::Ego => format!("{far}ahead"),
        Relation::Ahead => format!("{far}in front of {a}"),
        Relation::Behind => format!("{far}behind {a}"),
        Relation::Left if *to == AnchorPhrase::Ego => format!("{far}on the left"),
        Relation::Right if *to == AnchorPhrase::Ego => format!("{far}on the right"),
        Relation::Left => format!("{far}to the left of {a}"),
        Relation::Right => format!("{far}to the right of {a}"),
        Relation::NextTo => format!("next to {a}"),
        Relation::Near => format!("near {a}"),
        Relation::Far => format!("far from {a}"),
        Relation::At => format!("{far}from {a}"),
        Relation::On => format!("{} {a}", preposition(to)),
        Relation::Blocking => format!("blocking {a}"),
        Relation::Crossing => format!("crossing {a}"),
        Relation::Waiting => format!("waiting at {a}"),
        Relation::Between => match &p.and {
            Some(b) => format!("between {a} and {}", anchor(b)),
            None => format!("between {a}"),
        },
        Relation::Following => format!("following {a}"),
        Relation::Across => format!("across the street from {a}"),
        Relation::Oncoming => format!("coming towards {a}"),
        Relation::SameWay => format!("going the same way as {a}"),
        Relation::Facing => format!("facing {a}"),
        Relation::FacingAway => format!("facing away from {a}"),
        Relation::Like => format!("where {a} is"),
        Relation::There | Relation::InLine | Relation::SideBySide => "there".into(),
    }
}

fn preposition(to: &AnchorPhrase) -> &'static str {
    match to {
        AnchorPhrase::Lane(
            LaneRole::Ego
            | LaneRole::Left
            | LaneRole::Right
            | LaneRole::Oncoming
            | LaneRole::Cross
            | LaneRole::Carpark,
        )
        | AnchorPhrase::OtherLane
        | AnchorPhrase::Junction => "in",
        AnchorPhrase::Lane(LaneRole::Roadside | LaneRole::LeftRoadside | LaneRole::RightRoadside) => "at",
        _ => "on",
    }
}

fn anchor(a: &AnchorPhrase) -> String {
    match a {
        AnchorPhrase::Ego => "us".into(),
        AnchorPhrase::Crossing => "the crossing".into(),
        AnchorPhrase::Junction => "the junction".into(),
        AnchorPhrase::OtherSide => "the other side".into(),
        AnchorPhrase::OtherLane => "the other lane".into(),
        AnchorPhrase::EachOther => "each other".into(),
        AnchorPhrase::Thing(t) => thing(t),
        AnchorPhrase::Lane(role) => match role {
            LaneRole::Ego => "our lane",
            LaneRole::Left => "the left lane",
            LaneRole::Right => "the right lane",
            LaneRole::Oncoming => "the oncoming lane",
            LaneRole::Cross => "the cross street",
            LaneRole::Road => "the road",
            LaneRole::Roadside => "the roadside",
            LaneRole::LeftRoadside => "the left kerb",
            LaneRole::RightRoadside => "the right kerb",
            LaneRole::Sidewalk => "the sidewalk",
            LaneRole::LeftSidewalk => "the left sidewalk",
            LaneRole::RightSidewalk => "the right sidewalk",
            LaneRole::Carpark => "the car park",
        }
        .into(),
    }
}

fn destination(to: &Destination) -> String {
    match to {
        Destination::To(places) => at_places(places).trim_start().to_owned(),
        Destination::By { way, metres: m } => {
            let way = match way {
                Way::Left => "to the left",
                Way::Right => "to the right",
                Way::Forward => "forward",
                Way::Back => "back",
                Way::Nearer => "nearer",
                Way::Away => "farther away",
            };
            format!("{}{way}", metres(*m))
        }
        Destination::Lanes(n) => {
            let side = if *n > 0 { "left" } else { "right" };
            match n.unsigned_abs() {
                1 => format!("one lane to the {side}"),
                n => format!("{n} lanes to the {side}"),
            }
        }
        Destination::Times(n) => format!("to {n} times its distance"),
    }
}

fn turned(turn: &Turn) -> String {
    match turn {
        Turn::Around => "around".into(),
        Turn::Along => "along its lane".into(),
        Turn::Left(d) if *d < 0.0 => format!("{}° to the right", -d),
        Turn::Left(d) => format!("{d}° to the left"),
        Turn::To(places) => at_places(places).trim_start().to_owned(),
    }
}

fn traits_in_words(traits: &Traits) -> String {
    let mut out: Vec<String> = Vec::new();
    out.extend(
        traits
            .size
            .map(|s| if s == SizeHint::Large { "larger" } else { "smaller" }.to_string()),
    );
    out.extend(traits.state.map(|s| match s {
        ObjectState::Moving => "move".to_string(),
        ObjectState::Parked => "park".into(),
        ObjectState::Waiting => "stand still".into(),
    }));
    out.extend(traits.paint.map(|p| p.name().to_string()));
    out.extend(
        traits
            .paint_of
            .as_ref()
            .map(|t| format!("the colour of {}", thing(t))),
    );
    out.join(" and ")
}

//! The lexicon: what a run of words may mean, longest first, and the nearest word for a slip of the pen.

use std::collections::{HashMap, HashSet};
use std::hash::BuildHasherDefault;
use std::sync::LazyLock;

use super::description::{Anchor, Count, Density, Environment, Road, TimeOfDay, Weather};
use super::fnv::Fnv;
use super::words::objects::{self, NOUNS, Noun};
use super::words::{edits, phrases, places, plain, style, verbs};
use crate::scene::graph::{LaneRole, ObjectState, RelationKind, SizeHint};

/// What a word or a run of words means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sense {
    /// An object.
    Noun(&'static Noun, bool),
    /// Road works.
    Works,
    /// A number in words.
    Count(Count),
    /// `a`, or `the` (true).
    Article(bool),
    /// A state; true for finite verbs.
    State(ObjectState, bool),
    /// A size.
    Size(SizeHint),
    /// A colour.
    Color(&'static str),
    /// Another attribute.
    Attribute(&'static str),
    /// A relation that needs what follows.
    Rel(RelationKind),
    /// Relations to the ego vehicle.
    EgoRel(&'static [RelationKind]),
    /// A side of what was named: "on its left".
    Possessed(RelationKind),
    /// What follows stands in that relation to what was before.
    Reversed(RelationKind),
    /// A relation and its anchor in one phrase.
    Fixed(RelationKind, Anchor),
    /// Across the street.
    FarSide,
    /// On both sides; true if the count is for each of them.
    BothSides(bool),
    /// `in`, `on`.
    In,
    /// `at`, `by`.
    At,
    /// `across`.
    Across,
    /// A place, and what it says of the road.
    Place(Anchor, Option<Road>),
    /// A kind of road.
    RoadKind(Road, Option<Environment>),
    /// One way.
    OneWay,
    /// Narrow (true) or wide road.
    Width(bool),
    /// The ego vehicle.
    Ego,
    /// Points back.
    Pronoun,
    /// Part of a group; true for all that is left of it.
    Part(bool),
    /// Turns around what follows.
    Not,
    /// No people.
    Nobody,
    /// `and`.
    And,
    /// `or`.
    Or,
    /// `but`, `while`: a new clause.
    But,
    /// Time of day.
    Time(TimeOfDay),
    /// Weather.
    Weather(Weather),
    /// Surroundings.
    Environment(Environment),
    /// How busy.
    Density(Density),
    /// Something of the background.
    Background,
    /// Known, but nothing that a scene can hold.
    Cannot(&'static str),
    /// Metres in a unit.
    Unit(f64),
    /// Half, quarter.
    Fraction(f64),
    /// Away from.
    Away,
    /// At most (true) or at least.
    Bound(bool),
    /// A command to a scene.
    Verb(edits::Verb),
    /// Which one of several.
    Pick(edits::Pick),
    /// Carries no meaning.
    Filler,
}

/// Longest run of words in the lexicon.
pub const LONGEST: usize = 10;

type Table = HashMap<String, Sense, BuildHasherDefault<Fnv>>;

fn words(list: &'static str) -> impl Iterator<Item = &'static str> {
    list.split('|').map(str::trim).filter(|w| !w.is_empty())
}

/// The plural by rule.
pub fn plural(word: &str) -> String {
    let ends = |tails: &[&str]| tails.iter().any(|t| word.ends_with(t));
    if ends(&["s", "x", "z", "ch", "sh"]) {
        return format!("{word}es");
    }
    match word.strip_suffix('y') {
        Some(stem) if !stem.ends_with(['a', 'e', 'i', 'o', 'u']) => format!("{stem}ies"),
        _ => format!("{word}s"),
    }
}

static TABLE: LazyLock<Table> = LazyLock::new(build);

/// Room for all entries: a table that grows moves them again and again.
const ENTRIES: usize = 70_000;

fn build() -> Table {
    let mut t = Table::with_capacity_and_hasher(ENTRIES, BuildHasherDefault::default());
    // What comes first stays: more telling senses before small words.
    let mut put = |word: &str, sense: Sense| {
        if word.split(' ').count() <= LONGEST {
            t.entry(word.to_string()).or_insert(sense);
        }
    };
    for (word, sense) in [
        ("and", Sense::And),
        ("or", Sense::Or),
        ("but", Sense::But),
        ("while", Sense::But),
        ("whereas", Sense::But),
        ("a", Sense::Article(false)),
        ("an", Sense::Article(false)),
        ("the", Sense::Article(true)),
        ("one way", Sense::OneWay),
        ("one way street", Sense::OneWay),
        ("one way road", Sense::OneWay),
        ("each", Sense::Filler),
    ] {
        put(word, sense);
    }
    for word in words(
        "nobody|no one|nobody around|no one around|noone|no people around|nobody else|no one else|not a soul|no person|nobody at all",
    ) {
        put(word, Sense::Nobody);
    }
    for word in words("narrow|narrow road|narrow street|tight street|alley|alleyway|narrow lane|narrow lanes")
    {
        put(word, Sense::Width(true));
    }
    for word in words(
        "wide road|wide street|broad street|broad road|wide lanes|wide avenue|spacious road|wide boulevard",
    ) {
        put(word, Sense::Width(false));
    }
    for word in words(places::EGO) {
        put(word, Sense::Ego);
    }
    for (role_sides, list) in places::SIDED
        .iter()
        .map(|(any, left, right, list)| ((*any, *left, *right), *list))
    {
        let (any, left, right) = role_sides;
        let mut list: Vec<&str> = words(list).collect();
        if any == LaneRole::Roadside {
            list.extend([
                "side of the road",
                "side of the street",
                "side of my road",
                "side of our road",
            ]);
        }
        for noun in list {
            put(noun, Sense::Place(Anchor::Lane(any), None));
            // "a bus stops" is no place
            if !["stop", "stand", "halt"].iter().any(|v| noun.ends_with(v)) {
                put(&plural(noun), Sense::Place(Anchor::Lane(any), None));
            }
            for (side, names) in [(left, places::LEFT), (right, places::RIGHT)] {
                for name in words(names) {
                    let place = Sense::Place(Anchor::Lane(side), None);
                    put(&format!("{name} {noun}"), place);
                    let plain = name.split(' ').next().unwrap_or(name);
                    for tail in [
                        format!("{noun} on the {plain}"),
                        format!("{noun} to the {plain}"),
                        format!("{noun} on my {plain}"),
                        format!("{noun} to my {plain}"),
                        format!("{noun} on our {plain}"),
                        format!("{noun} on the {plain} side"),
                        format!("{noun} on the {plain} hand side"),
                    ] {
                        put(&tail, place);
                    }
                }
            }
        }
    }
    for (anchor, road, list) in places::PLACES {
        for word in words(list) {
            put(word, Sense::Place(*anchor, *road));
            if word.split(' ').count() < 3 && !matches!(anchor, Anchor::Lane(LaneRole::Ego)) {
                put(&plural(word), Sense::Place(*anchor, *road));
            }
        }
    }
    for noun in NOUNS {
        for entry in words(noun.words) {
            let mut forms = entry.split('/');
            let one = forms.next().unwrap_or(entry);
            let mut irregular = false;
            for many in forms {
                irregular = true;
                put(many, Sense::Noun(noun, true));
            }
            put(one, Sense::Noun(noun, false));
            // ("childs" is said, too)
            if !irregular || !one.ends_with("man") {
                put(&plural(one), Sense::Noun(noun, true));
            }
        }
    }
    for (symbol, word) in [
        ("🚗", "car"),
        ("🚙", "suv"),
        ("🚕", "taxi"),
        ("🚘", "car"),
        ("🏎", "car"),
        ("🚓", "car"),
        ("🚐", "van"),
        ("🚑", "ambulance"),
        ("🚚", "truck"),
        ("🚛", "truck"),
        ("🚒", "truck"),
        ("🚌", "bus"),
        ("🚍", "bus"),
        ("🚎", "bus"),
        ("🏍", "motorcycle"),
        ("🛵", "moped"),
        ("🚲", "bicycle"),
        ("🚴", "cyclist"),
        ("🚶", "pedestrian"),
        ("🏃", "jogger"),
        ("🚧", "barrier"),
        ("🚜", "tractor"),
        ("👮", "policeman"),
        ("👷", "worker"),
        ("🧍", "pedestrian"),
    ] {
        if let Some(Sense::Noun(noun, _)) = NOUNS
            .iter()
            .find(|n| words(n.words).any(|w| w.split('/').next() == Some(word)))
            .map(|n| Sense::Noun(n, false))
        {
            put(symbol, Sense::Noun(noun, false));
        }
    }
    for (symbol, sense) in [
        ("🌧", Sense::Weather(Weather::Rain)),
        ("⛈", Sense::Weather(Weather::Rain)),
        ("☔", Sense::Weather(Weather::Rain)),
        ("❄", Sense::Weather(Weather::Snow)),
        ("🌨", Sense::Weather(Weather::Snow)),
        ("☃", Sense::Weather(Weather::Snow)),
        ("🌫", Sense::Weather(Weather::Fog)),
        ("☁", Sense::Weather(Weather::Overcast)),
        ("☀", Sense::Weather(Weather::Clear)),
        ("🌙", Sense::Time(TimeOfDay::Night)),
        ("🌃", Sense::Time(TimeOfDay::Night)),
        ("🌅", Sense::Time(TimeOfDay::Dawn)),
        ("🌇", Sense::Time(TimeOfDay::Dusk)),
    ] {
        put(symbol, sense);
    }
    for word in words(objects::WORKS_WORDS) {
        put(word, Sense::Works);
    }
    for (relation, list) in places::REVERSED {
        words(list).for_each(|w| put(w, Sense::Reversed(*relation)));
    }
    for (relation, anchor, list) in places::FIXED {
        for w in words(list) {
            put(w, Sense::Fixed(*relation, *anchor));
            if w.starts_with("waiting ") {
                for be in ["is", "are", "was", "were"] {
                    put(&format!("{be} {w}"), Sense::Fixed(*relation, *anchor));
                }
            }
        }
    }
    let alone: HashSet<&str> = places::EGO_RELATIONS.iter().flat_map(|(_, l)| words(l)).collect();
    for (relation, list) in places::RELATIONS {
        // "behind" may stand alone.
        words(list)
            .filter(|w| !alone.contains(w))
            .for_each(|w| put(w, Sense::Rel(*relation)));
    }
    for (relations, list) in places::CLOSE {
        words(list).for_each(|w| put(w, Sense::EgoRel(relations)));
    }
    for (relations, list) in places::EGO_RELATIONS {
        words(list).for_each(|w| put(w, Sense::EgoRel(relations)));
    }
    for (relations, phrase) in phrases::sides() {
        put(&phrase, Sense::EgoRel(relations));
    }
    for (relation, phrase) in phrases::possessed() {
        put(&phrase, Sense::Possessed(relation));
    }
    for (relations, phrase) in phrases::clock() {
        put(&phrase, Sense::EgoRel(relations));
    }
    for adverb in words(phrases::ADVERBS) {
        for (relations, list) in places::EGO_RELATIONS.iter().take(phrases::PLACED) {
            words(list).for_each(|w| put(&format!("{adverb} {w}"), Sense::EgoRel(relations)));
        }
        for (relation, list) in places::RELATIONS.iter().take(phrases::PLACED) {
            words(list).for_each(|w| put(&format!("{adverb} {w}"), Sense::Rel(*relation)));
        }
    }
    words(places::FAR_SIDE).for_each(|w| put(w, Sense::FarSide));
    for w in words(places::BOTH_SIDES) {
        put(w, Sense::BothSides(w.contains("each")));
        for tail in [
            "of the road",
            "of the street",
            "of my lane",
            "of me",
            "of the lane",
            "of us",
            "of the carriageway",
        ] {
            let side = w.contains("side");
            if side {
                put(&format!("{w} {tail}"), Sense::BothSides(w.contains("each")));
            }
        }
    }
    for noun in places::SIDED
        .iter()
        .flat_map(|s| words(s.3))
        .filter(|w| !w.contains(' '))
    {
        for prep in ["on", "at", "along"] {
            put(&format!("{prep} both {}", plural(noun)), Sense::BothSides(false));
            for each in ["each", "either"] {
                put(&format!("{prep} {each} {noun}"), Sense::BothSides(each == "each"));
            }
        }
    }
    words(places::IN).for_each(|w| put(w, Sense::In));
    words(places::AT).for_each(|w| put(w, Sense::At));
    words(places::ACROSS).for_each(|w| put(w, Sense::Across));
    for (state, finite, list) in style::STATES {
        words(list).for_each(|w| put(w, Sense::State(*state, *finite)));
    }
    for (density, list) in style::DENSITIES {
        words(list).for_each(|w| put(w, Sense::Density(*density)));
    }
    for (time, list) in style::TIMES {
        words(list).for_each(|w| put(w, Sense::Time(*time)));
    }
    for (weather, list) in style::WEATHERS {
        words(list).for_each(|w| put(w, Sense::Weather(*weather)));
    }
    for (environment, list) in style::ENVIRONMENTS {
        words(list).for_each(|w| put(w, Sense::Environment(*environment)));
    }
    for (road, environment, list) in style::ROADS {
        for w in words(list) {
            put(w, Sense::RoadKind(*road, *environment));
            put(&plural(w), Sense::RoadKind(*road, *environment));
        }
    }
    for (count, list) in style::COUNTS {
        words(list).for_each(|w| put(w, Sense::Count(*count)));
    }
    words(style::COLORS).for_each(|w| put(w, Sense::Color(w)));
    for (size, list) in style::SIZES {
        words(list).for_each(|w| put(w, Sense::Size(*size)));
    }
    words(style::ATTRIBUTES).for_each(|w| put(w, Sense::Attribute(w)));
    words(places::NOT).for_each(|w| put(w, Sense::Not));
    for w in words(places::PARTS) {
        let all = ["rest", "remaining", "others", "the other two", "the other three"]
            .iter()
            .any(|p| w.contains(p))
            || w.starts_with("the other ") && !w.ends_with(" one");
        put(w, Sense::Part(all));
    }
    words(places::PRONOUNS).for_each(|w| put(w, Sense::Pronoun));
    for (metres, list) in places::UNITS {
        words(list).for_each(|w| put(w, Sense::Unit(*metres)));
    }
    for (share, list) in places::FRACTIONS {
        words(list).for_each(|w| put(w, Sense::Fraction(*share)));
    }
    for (weather, list) in verbs::SKY {
        for f in words(list).map(verbs::forms) {
            for w in [&f.base, &f.s, &f.ing, &f.past] {
                put(w, Sense::Weather(*weather));
            }
        }
    }
    for (n, name) in (1..).zip(phrases::HOURS) {
        for (part, pm) in [
            ("in the morning", false),
            ("am", false),
            ("at night", true),
            ("in the evening", true),
            ("in the afternoon", true),
            ("pm", true),
        ] {
            let hour = if n == 12 && part == "at night" { 0 } else { n };
            let time = super::tag::time_of(f64::from(hour), pm && !(part == "at night" && n < 5));
            for tail in ["", " oclock"] {
                put(&format!("{name}{tail} {part}"), Sense::Time(time));
            }
        }
    }
    for (state, list) in verbs::DOING {
        for f in words(list).map(verbs::forms) {
            put(&f.ing, Sense::State(*state, false));
            for w in [&f.base, &f.s, &f.past] {
                put(w, Sense::State(*state, true));
            }
            for have in ["has", "have", "had", "has just", "have just", "having"] {
                put(&format!("{have} {}", f.participle), Sense::State(*state, true));
            }
        }
    }
    for (relation, list) in verbs::RELATING {
        for f in words(list).map(verbs::forms) {
            for by in ["by", "with", "off by", "off with"] {
                put(&format!("{} {by}", f.participle), Sense::Reversed(*relation));
            }
            for w in [&f.base, &f.s, &f.ing, &f.past] {
                put(w, Sense::Rel(*relation));
                // "pointed straight at", "walks slowly across"
                if let Some((verb, tail)) = w.split_once(' ') {
                    for adverb in ["straight", "directly", "right", "slowly", "quickly", "back"] {
                        put(&format!("{verb} {adverb} {tail}"), Sense::Rel(*relation));
                    }
                }
            }
            for have in ["has", "have", "had"] {
                put(&format!("{have} {}", f.participle), Sense::Rel(*relation));
            }
        }
    }
    for f in words(verbs::TOWING).map(verbs::forms) {
        put(
            &format!("{} by", f.participle),
            Sense::Rel(RelationKind::Following),
        );
        put(
            &format!("{} behind", f.participle),
            Sense::Rel(RelationKind::Following),
        );
        for w in [&f.s, &f.ing, &f.past] {
            put(w, Sense::Reversed(RelationKind::Following));
        }
    }
    words(verbs::JOINED).for_each(|w| put(w, Sense::Rel(RelationKind::Following)));
    for (verb, list) in edits::VERBS {
        words(list).for_each(|w| put(w, Sense::Verb(*verb)));
    }
    for (pick, list) in edits::PICKS {
        words(list).for_each(|w| put(w, Sense::Pick(*pick)));
    }
    words(places::AWAY).for_each(|w| put(w, Sense::Away));
    words(places::WITHIN).for_each(|w| put(w, Sense::Bound(true)));
    words(places::BEYOND).for_each(|w| put(w, Sense::Bound(false)));
    for entry in words(objects::BACKGROUND) {
        let mut forms = entry.split('/');
        let one = forms.next().unwrap_or(entry);
        put(one, Sense::Background);
        put(
            &forms.next().map_or_else(|| plural(one), str::to_string),
            Sense::Background,
        );
    }
    for (why, list) in objects::CANNOT {
        for entry in words(list) {
            let mut forms = entry.split('/');
            let one = forms.next().unwrap_or(entry);
            put(one, Sense::Cannot(why));
            put(
                &forms.next().map_or_else(|| plural(one), str::to_string),
                Sense::Cannot(why),
            );
        }
    }
    words(places::FILLERS).for_each(|w| put(w, Sense::Filler));
    t
}

/// What exactly these words mean, single spaces between them.
pub fn look_up(words: &str) -> Option<Sense> {
    TABLE.get(words).copied()
}

/// Single words that a slip may be corrected to, by length.
static SINGLES: LazyLock<Vec<(&'static str, Vec<char>)>> = LazyLock::new(|| {
    let mut singles: Vec<_> = TABLE
        .iter()
        .filter(|(w, s)| {
            let telling = !matches!(
                s,
                Sense::Filler | Sense::Cannot(_) | Sense::Verb(_) | Sense::Attribute(_)
            );
            telling && !w.contains(' ') && w.chars().count() >= 5
        })
        .map(|(w, _)| (w.as_str(), w.chars().collect::<Vec<_>>()))
        .collect();
    singles.sort(); // the table's order is random
    singles
});

static PLAIN: LazyLock<HashSet<&'static str>> = LazyLock::new(|| plain::PLAIN.split_whitespace().collect());

/// The one word of five letters or more that differs from `word` by one letter left out, added, changed
/// (from six letters on) or two neighbours exchanged; `None` if there is none or they differ in meaning.
pub fn nearest(word: &str) -> Option<&'static str> {
    let letters: Vec<char> = word.chars().collect();
    if letters.len() < 5 || letters.len() > 24 || PLAIN.contains(word) {
        return None;
    }
    let mut found: Option<&'static str> = None;
    for (candidate, chars) in SINGLES.iter() {
        if chars.len().abs_diff(letters.len()) <= 1 && chars[0] == letters[0] && is_slip(&letters, chars) {
            match found {
                Some(other) if TABLE.get(other) != TABLE.get(*candidate) => {
                    // "cars" beside "car": singular and plural of one thing are as good.
                    let same = matches!((TABLE.get(other), TABLE.get(*candidate)),
                        (Some(Sense::Noun(a, _)), Some(Sense::Noun(b, _))) if std::ptr::eq(*a, *b));
                    if !same {
                        return None;
                    }
                }
                Some(_) => {}
                None => found = Some(candidate),
            }
        }
    }
    found
}

fn is_slip(a: &[char], b: &[char]) -> bool {
    let same_start = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    let (ra, rb) = (&a[same_start..], &b[same_start..]);
    match a.len() as i64 - b.len() as i64 {
        0 => {
            let changed = a.len() >= 6 && ra.len() > 1 && ra[1..] == rb[1..];
            let swapped = ra.len() >= 2 && ra[0] == rb[1] && ra[1] == rb[0] && ra[2..] == rb[2..];
            changed || swapped
        }
        1 => ra.len() > 1 && ra[1..] == *rb || (ra.len() == 1 && rb.is_empty() && a.len() > 6),
        -1 => rb[1..] == *ra && rb.len() > 1,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Class;

    #[test]
    fn words_and_slips() {
        let class = |w: &str| match look_up(w) {
            Some(Sense::Noun(n, _)) => Some(n.classes[0]),
            _ => None,
        };
        assert_eq!(class("lorries"), Some(Class::Truck));
        assert_eq!(class("people"), Some(Class::Pedestrian));
        assert_eq!(class("jersey barriers"), Some(Class::Barrier));
        assert_eq!(class("buses"), Some(Class::Bus));
        assert_eq!(class("policemen"), Some(Class::Pedestrian));
        assert_eq!(nearest("excavatr"), Some("excavator"));
        assert_eq!(nearest("motorcylce"), Some("motorcycle"));
        assert_eq!(nearest("zzzzzz"), None);
        assert_eq!(nearest("better"), None, "no slip of beater");
        assert!(TABLE.len() > 2500, "{} entries", TABLE.len());
        assert!(
            TABLE.keys().all(|k| k.split(' ').count() <= LONGEST),
            "a run of words is too long"
        );
    }
}

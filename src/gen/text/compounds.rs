//! Nouns that only their neighbours or their ending tell: "in front of my cab" is the ego vehicle, "a trolley collector" is
//! somebody.

use super::lexicon::{Sense, look_up};
use super::tag::{Item, Tag};
use crate::scene::Class;

/// Endings of what somebody is called who does something.
const AGENT: [&str; 12] = [
    "er", "or", "ist", "man", "woman", "eer", "boy", "girl", "lady", "guy", "ian", "ee",
];
/// Words with these endings that are things.
const THINGS: &str = "detector|sensor|container|dumpster|planter|counter|bumper|banner|meter|mixer|roller|charger|printer|speaker|scanner|motor|reactor|error|mirror|floor|sector|vector|corridor|border|shelter|marker|divider|heater|cooler|number|letter|poster|power|tower|timer|trigger|header|chapter|quarter|center|filter|layer|order|paper|factor|color|odor|armor|harbor|elevator|escalator|indicator|reflector|generator|simulator|calculator|locker|sticker|ladder|gutter|hammer|feather|weather|leather|matter|water|tyre|twist|list|mist|exist|human|german|roman|former|latter|outer|inner|upper|lower|proper|super|clever|sober|sinister|minor|major|prior|exterior|interior|anterior|posterior|disaster|encounter|manner|corner|river|summer|winter|computer|controller|parameter|carrier|barrier|transporter|helicopter|character|register|sewer|wiper|buffer|crossover|cover|hover|loader|conveyor|monitor|projector|spoiler|trailer|tanker|stroller|walker|pusher|cluster|chamber|member";

/// Words of one thing as one item.
pub(super) fn joined(items: Vec<Item>) -> Vec<Item> {
    own_vehicle(agents(items))
}

fn is_motor(item: &Item) -> bool {
    matches!(item.tag, Tag::Is(Sense::Noun(n, false)) if matches!(n.classes[0], Class::Car | Class::Truck | Class::Bus | Class::Motorcycle))
}

/// "behind our patrol vehicle", "ahead of my cab": of the ego vehicle.
fn own_vehicle(items: Vec<Item>) -> Vec<Item> {
    let mut out: Vec<Item> = Vec::new();
    let mut i = 0;
    while i < items.len() {
        let whose = matches!(items[i].words.as_str(), "my" | "our" | "your");
        let led = out.last().is_some_and(|b: &Item| {
            matches!(b.tag, Tag::Is(Sense::Rel(_) | Sense::EgoRel(_)))
                || matches!(b.words.as_str(), "from" | "of" | "than")
        });
        let mut k = i + 1;
        while k < items.len()
            && k < i + 4
            && (matches!(
                items[k].tag,
                Tag::Unknown | Tag::Is(Sense::Attribute(_) | Sense::Color(_) | Sense::Size(_))
            ) || is_motor(&items[k]) && items.get(k + 1).is_some_and(is_motor))
        {
            k += 1;
        }
        let vehicle = items.get(k).is_some_and(is_motor)
            && !items
                .get(k + 1)
                .is_some_and(|n| matches!(n.tag, Tag::Is(Sense::Noun(..))));
        if whose && led && vehicle {
            out.push(Item {
                tag: look_up("my car").map_or(Tag::Unknown, Tag::Is),
                words: "my car".into(),
                span: items[i].span.to(items[k].span),
                read_as: None,
            });
            i = k + 1;
        } else {
            out.push(items[i].clone());
            i += 1;
        }
    }
    out
}

/// "a trolley collector is walking about": somebody, told by the ending of an unknown word and by what he does.
fn agents(items: Vec<Item>) -> Vec<Item> {
    let people = |many: bool| {
        let word = if many { "pedestrians" } else { "pedestrian" };
        look_up(word).map_or(Tag::Unknown, Tag::Is)
    };
    let mut out = items;
    for i in 1..out.len() {
        let stem = out[i].words.strip_suffix('s').unwrap_or(&out[i].words);
        let many = stem.len() < out[i].words.len();
        let ending = AGENT
            .iter()
            .any(|e| stem.len() > e.len() + 2 && stem.ends_with(e));
        if out[i].tag != Tag::Unknown || !ending || THINGS.split('|').any(|w| w == stem) {
            continue;
        }
        let before = (0..i).rev().find(|k| {
            !matches!(
                out[*k].tag,
                Tag::Unknown
                    | Tag::Is(Sense::Noun(_, false) | Sense::Attribute(_) | Sense::Color(_) | Sense::Size(_))
            )
        });
        let counted = before.is_some_and(|k| {
            matches!(
                out[k].tag,
                Tag::Number(_) | Tag::Is(Sense::Article(_) | Sense::Count(_))
            ) && i - k < 4
        });
        let mut next = i + 1;
        while out.get(next).is_some_and(|n| {
            matches!(
                n.words.as_str(),
                "is" | "are"
                    | "were"
                    | "was"
                    | "who"
                    | "that"
                    | "has"
                    | "with"
                    | "just"
                    | "in"
                    | "his"
                    | "her"
            )
        }) {
            next += 1;
        }
        let acts = out.get(next).is_some_and(|n| {
            matches!(
                n.tag,
                Tag::Is(Sense::State(..) | Sense::Rel(_) | Sense::EgoRel(_) | Sense::Fixed(..))
            )
        }) || out
            .get(i + 1)
            .is_some_and(|n| matches!(n.tag, Tag::Is(Sense::In | Sense::At)));
        if counted && acts {
            out[i].tag = people(many);
            out[i].read_as = Some("person");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::tag::tag;
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn nouns_told_by_their_neighbours() {
        let read = |t: &str| tag(&tokens(t));
        let ego = |t: &str| read(t).iter().any(|i| i.tag == Tag::Is(Sense::Ego));
        assert!(ego("a bus in front of my cab"));
        assert!(ego("a bus ahead of our patrol vehicle"));
        assert!(!ego("a bus ahead of a patrol vehicle"));
        let person = |t: &str| read(t).iter().any(|i| i.read_as == Some("person"));
        assert!(person("one glass blower walking about"));
        assert!(!person("an edge case for the detector in rain"));
    }
}

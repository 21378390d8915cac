//! Groups that a prompt names more than once or in parts: "two machines, a crane and a digger", "a taxi between the buses",
//! "closed with eight cones and a trailer".

use super::description::{Anchor, Count, Stated};
use super::mention::Mention;
use crate::scene::Class;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};

/// Nouns that only say of what sort the ones are that a list then names.
const SORTS: &str = "vehicle|machine|construction machine|construction vehicle|work machine|site machine|building machine|heavy machine|person|people|pedestrian|road user|two wheeler|thing|object|obstacle|piece of construction equipment|piece of heavy machinery|motor vehicle|large vehicle|heavy vehicle|traffic participant|participant|vru|someone|folk|bike|passerby|passer by|human|individual|figure|adult";

fn is_sort(noun: &str) -> bool {
    use super::lexicon::{Sense, look_up};
    let of = |w: &str| match look_up(w) {
        Some(Sense::Noun(n, _)) => Some(n),
        _ => None,
    };
    let singular = |w: &str| SORTS.split('|').any(|s| s == w || super::lexicon::plural(s) == w);
    singular(noun) || matches!(noun, "people" | "persons") && of(noun).is_some()
}

/// "two machines, a crane and an excavator": the list says which two they are.
pub(super) fn drop_named(mentions: &mut [Mention], prompt: &str) {
    let joined = |a: &Mention, b: &Mention| {
        let gap = prompt.get(a.spec.span.end..b.spec.span.start).unwrap_or("?");
        let gap = gap
            .trim()
            .trim_start_matches([',', ':', '(', '-', '–', '—'])
            .trim();
        matches!(gap, "" | "and" | "plus" | "namely" | "and also" | "i.e." | "viz.")
    };
    for i in 0..mentions.len() {
        let m = &mentions[i];
        if m.gone || !m.plural || m.uncounted || !m.spec.count.is_exact() || m.is_anchor {
            continue;
        }
        let sort = is_sort(&m.spec.noun);
        let apposed = prompt
            .get(m.spec.span.end..)
            .is_some_and(|rest| rest.trim_start().starts_with([',', '(', ':', '-', '–', '—']));
        // "three vehicles ahead: a car in our lane and two vans behind it"
        let start = (i + 1..mentions.len())
            .find(|k| !mentions[*k].is_anchor)
            .unwrap_or(i + 1);
        let listed = mentions.get(start).is_some_and(|next| {
            let gap = prompt.get(m.spec.span.end..next.spec.span.start).unwrap_or(".");
            !gap.contains(['.', ';', '!', '?'])
                && [
                    ":",
                    "namely",
                    " - ",
                    "–",
                    "—",
                    "(",
                    "i.e",
                    "to be exact",
                    "specifically",
                ]
                .iter()
                .any(|w| gap.contains(w))
        });
        let one_sentence = |a: &Mention, b: &Mention| {
            prompt
                .get(a.spec.span.end..b.spec.span.start)
                .is_some_and(|gap| !gap.contains(['.', ';', '!', '?']))
        };
        // "four cars on the road: two black ones, a red one and a white one"
        let told_apart = |part: &Mention| part.spec.color.is_some() || part.spec.noun != m.spec.noun;
        if !sort && !listed {
            continue;
        }
        let apposed = apposed || listed;
        let mut sum = 0;
        // (what only says where they are stands before the list)
        let mut last = if listed { start - 1 } else { i };
        let before = last;
        while last + 1 < mentions.len()
            && sum < mentions[i].spec.count.n
            && (joined(&mentions[last], &mentions[last + 1])
                || listed && one_sentence(&mentions[last], &mentions[last + 1]))
            && mentions[i].classes.contains(&mentions[last + 1].spec.class)
            && (if sort && !listed {
                !is_sort(&mentions[last + 1].spec.noun)
            } else {
                told_apart(&mentions[last + 1])
            })
        {
            last += 1;
            sum += mentions[last].spec.count.n;
        }
        if !apposed || last < before + 2 || sum != mentions[i].spec.count.n {
            continue;
        }
        let theirs = mentions[i].spec.relations.clone();
        let state = mentions[i].spec.state;
        for m in &mut mentions[before + 1..=last] {
            m.spec.state = m.spec.state.or(state);
            if m.spec.relations.is_empty() {
                m.spec.relations.clone_from(&theirs);
            }
        }
        mentions[i].gone = true;
        for m in mentions.iter_mut() {
            for r in &mut m.spec.relations {
                if r.anchor == Anchor::Object(i) {
                    r.anchor = Anchor::Object(before + 1);
                }
            }
        }
    }
}

/// "two buses at the kerb, and a taxi between them": the two apart, with room for it.
pub(super) fn apart_for(mentions: &mut Vec<Mention>) {
    for i in 0..mentions.len() {
        let between = mentions[i].spec.relations.iter().position(|r| {
            r.relation == RelationKind::Between
                && r.and == Some(r.anchor)
                && matches!(r.anchor, Anchor::Object(_))
        });
        let Some((at, a)) = between.and_then(|k| match mentions[i].spec.relations[k].anchor {
            Anchor::Object(a) => Some((k, a)),
            _ => None,
        }) else {
            continue;
        };
        let two = mentions
            .get(a)
            .is_some_and(|m| m.spec.count == Count::exactly(2) && !m.gone && !m.definite && m.both.is_none());
        if !two || a == i || mentions[a].spec.class == Class::Pedestrian {
            continue;
        }
        let length = |m: &Mention| {
            m.spec
                .size_m
                .or(m.spec.class.typical_size_m())
                .map_or(4.5, |s| s[0])
        };
        let gap = length(&mentions[a]) + length(&mentions[i]) * f64::from(mentions[i].spec.count.n) + 4.0;
        let span = mentions[i].spec.span;
        mentions[a].spec.count = Count::exactly(1);
        let mut twin = mentions[a].clone();
        twin.spec.relations.retain(|r| r.distance_m.is_none());
        twin.spec.relations.push(Stated {
            relation: RelationKind::InFrontOf,
            anchor: Anchor::Object(a),
            and: None,
            distance_m: Some(gap),
            span,
        });
        let strip = mentions[a]
            .spec
            .relations
            .iter()
            .find(|r| {
                matches!(r.relation, RelationKind::On | RelationKind::ParkedOn)
                    && matches!(r.anchor, Anchor::Lane(_))
            })
            .copied();
        mentions.push(twin);
        let second = Anchor::Object(mentions.len() - 1);
        let m = &mut mentions[i].spec;
        m.relations[at].and = Some(second);
        let placed = m.relations.iter().any(|r| matches!(r.anchor, Anchor::Lane(_)));
        if let (Some(strip), false, true) = (strip, placed, m.class.is_vehicle()) {
            m.state = m
                .state
                .filter(|s| *s != ObjectState::Moving)
                .or(Some(ObjectState::Waiting));
            m.relations.push(Stated {
                distance_m: None,
                ..strip
            });
        }
    }
}

/// "the cross street is busy: from the left come two cars": on it.
pub(super) fn from_cross_street(mentions: &mut [Mention], prompt: &str) {
    let prompt = prompt.to_lowercase();
    let named = ["cross street", "side street", "crossing road", "crossing street"]
        .iter()
        .any(|w| prompt.contains(w));
    for m in mentions.iter_mut().filter(|m| named && m.spec.class.is_vehicle()) {
        let from = m.spec.relations.iter().find(|r| {
            matches!(r.relation, RelationKind::LeftOf | RelationKind::RightOf)
                && r.anchor == Anchor::Ego
                && r.span.of(&prompt).starts_with("from the ")
        });
        let Some(span) = from.map(|r| r.span) else {
            continue;
        };
        if !m
            .spec
            .relations
            .iter()
            .any(|r| matches!(r.anchor, Anchor::Lane(_) | Anchor::Junction))
        {
            m.spec.relations.push(Stated {
                relation: RelationKind::On,
                anchor: Anchor::Lane(LaneRole::Cross),
                and: None,
                distance_m: None,
                span,
            });
        }
    }
}

/// "workmen have closed the left lane with eight cones and a trailer": these stand in it.
pub(super) fn closed_with(mentions: &mut [Mention], prompt: &str) {
    for i in 1..mentions.len() {
        let Some(h) = mentions[i]
            .host
            .filter(|h| *h < i && mentions[*h].spec.class == Class::Pedestrian)
        else {
            continue;
        };
        let thing = |m: &Mention| m.spec.class != Class::Pedestrian && m.spec.relations.is_empty() && !m.gone;
        let blocks = mentions[h]
            .spec
            .relations
            .iter()
            .position(|r| r.relation == RelationKind::Blocking && matches!(r.anchor, Anchor::Lane(_)));
        let Some(k) = blocks.filter(|_| thing(&mentions[i])) else {
            continue;
        };
        let theirs: Vec<Stated> = mentions[h].spec.relations.clone();
        mentions[h].spec.relations.remove(k);
        let mut j = i;
        loop {
            mentions[j].spec.state = Some(ObjectState::Waiting);
            mentions[j].spec.relations.clone_from(&theirs);
            let next = mentions
                .get(j + 1)
                .filter(|n| thing(n))
                .and_then(|n| prompt.get(mentions[j].spec.span.end..n.spec.span.start));
            if !next.is_some_and(|gap| matches!(gap.trim(), "and" | "," | ", and" | "plus")) {
                break;
            }
            j += 1;
        }
    }
}

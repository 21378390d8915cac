//! Mentions to the description: parts of groups, both sides, contradictions, phrases.

use super::description::{
    Anchor, Became, Count, ObjectSpec, Phrase, Reading, Road, Stated, TimeOfDay, Weather,
};
use super::mention::Mention;
use super::tokens::Span;
use crate::scene::Class;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};

/// Largest number that is tried for one mention.
pub const MOST_OF_ONE: u32 = 400;

/// "seven vehicles in total: four cars, two vans and a bus": what is named one by one is not there twice.
fn drop_totals(mentions: &mut [Mention]) {
    for i in 0..mentions.len() {
        let m = &mentions[i];
        if m.gone || !m.spec.attributes.iter().any(|a| a == "in total") {
            continue;
        }
        let parts: u32 = mentions[i + 1..]
            .iter()
            .filter(|x| !x.gone && m.classes.contains(&x.spec.class))
            .map(|x| x.spec.count.n)
            .sum();
        if parts == m.spec.count.n && parts > 0 {
            mentions[i].gone = true;
        }
        mentions[i].spec.attributes.retain(|a| a != "in total");
    }
}

/// What has stopped on the other side of the road stands at its edge.
fn stopped_across(mentions: &mut [Mention], prompt: &str) {
    for m in mentions.iter_mut() {
        let stands = m.spec.state == Some(ObjectState::Waiting) && m.spec.class.is_vehicle();
        for r in m.spec.relations.iter_mut().filter(|_| stands) {
            let words = r.span.of(prompt).to_lowercase();
            let side = words.contains("side of the") || words.contains("across the");
            if side
                && r.relation == RelationKind::On
                && r.anchor == Anchor::Lane(LaneRole::Oncoming)
                && words.starts_with(['o', 'a'])
            {
                r.relation = RelationKind::ParkedOn;
                r.anchor = Anchor::Lane(LaneRole::LeftRoadside);
            }
        }
    }
}

fn split_sides(mentions: &mut Vec<Mention>) {
    for i in 0..mentions.len() {
        let Some(each) = mentions[i].both.take().filter(|_| !mentions[i].gone) else {
            continue;
        };
        let total = mentions[i].spec.count;
        let (left, right) = if each {
            (total.n, total.n)
        } else {
            (total.n.div_ceil(2), total.n / 2)
        };
        let part = |n: u32| {
            if total.is_exact() {
                Count::exactly(n)
            } else {
                Count::about(total.min.div_ceil(2).min(n), n, total.max)
            }
        };
        let mut other = mentions[i].clone();
        let (span, class, state) = (other.spec.span, other.spec.class, other.spec.state);
        mentions[i].spec.count = part(left);
        other.spec.count = part(right);
        for (spec, is_left) in [(&mut mentions[i].spec, true), (&mut other.spec, false)] {
            add_side(spec, is_left, class, state, span);
        }
        // "two men, one on each pavement, look at each other"
        if other.spec.attributes.iter().any(|a| a == "facetoface") {
            let twin = mentions.len();
            for (spec, whom) in [(&mut mentions[i].spec, twin), (&mut other.spec, i)] {
                spec.attributes.retain(|a| a != "facetoface");
                spec.state = Some(ObjectState::Waiting);
                spec.relations.retain(|r| r.relation != RelationKind::Crossing);
                spec.relations.push(Stated {
                    relation: RelationKind::Facing,
                    anchor: Anchor::Object(whom),
                    and: None,
                    distance_m: None,
                    span,
                });
            }
        }
        mentions.push(other);
        // "two buses on both sides, and behind them two cars": one behind each
        let twin = mentions.len() - 1;
        let by_each = |m: &Mention| {
            !m.gone && m.spec.count == total && m.spec.relations.iter().any(|r| r.anchor == Anchor::Object(i))
        };
        for j in (0..twin).filter(|j| *j != i && !each).collect::<Vec<_>>() {
            if !by_each(&mentions[j]) {
                continue;
            }
            let mut second = mentions[j].clone();
            mentions[j].spec.count = part(left);
            second.spec.count = part(right);
            for r in second
                .spec
                .relations
                .iter_mut()
                .filter(|r| r.anchor == Anchor::Object(i))
            {
                r.anchor = Anchor::Object(twin);
            }
            mentions.push(second);
        }
    }
}

/// "a bus 18 m out in our lane": a distance alone counts ahead.
fn distance_ahead(spec: &mut ObjectSpec) {
    use RelationKind as R;
    // "at a distance of 12 m a car is in front of us"
    let far = spec
        .relations
        .iter()
        .position(|r| r.relation == R::Near && r.anchor == Anchor::Ego && r.distance_m.is_some());
    let side = spec.relations.iter().position(|r| {
        matches!(r.relation, R::InFrontOf | R::Behind) && r.anchor == Anchor::Ego && r.distance_m.is_none()
    });
    let told = spec
        .relations
        .iter()
        .any(|r| matches!(r.relation, R::InFrontOf | R::Behind) && r.distance_m.is_some());
    if let (Some(far), Some(side), false) = (far, side, told) {
        spec.relations[side].distance_m = spec.relations[far].distance_m;
        spec.relations.remove(far);
    }
    let sided = spec.relations.iter().any(|r| {
        r.anchor == Anchor::Ego
            && !matches!(
                r.relation,
                R::Near | R::OppositeDirection | R::SameDirection | R::Facing | R::FacingAway
            )
    });
    let lane = spec.relations.iter().any(|r| {
        r.relation == R::On
            && matches!(
                r.anchor,
                Anchor::Lane(LaneRole::Ego | LaneRole::Left | LaneRole::Right | LaneRole::Oncoming)
            )
    });
    let far = spec
        .relations
        .iter()
        .find(|r| {
            r.anchor == Anchor::Ego
                && matches!(r.relation, R::Facing | R::OppositeDirection)
                && r.distance_m.is_some()
        })
        .copied()
        .filter(|_| lane && !sided);
    if let Some(r) = far {
        spec.relations
            .iter_mut()
            .filter(|x| **x == r)
            .for_each(|x| x.distance_m = None);
        spec.relations.push(Stated {
            relation: R::InFrontOf,
            ..r
        });
    }
    for r in spec.relations.iter_mut().filter(|_| lane && !sided) {
        if r.relation == R::Near && r.anchor == Anchor::Ego && r.distance_m.is_some_and(|d| d > 6.0) {
            r.relation = R::InFrontOf;
        }
    }
}

fn add_side(spec: &mut ObjectSpec, left: bool, class: Class, state: Option<ObjectState>, span: Span) {
    let mut push = |relation, anchor| {
        spec.relations.push(Stated {
            relation,
            anchor,
            and: None,
            distance_m: None,
            span,
        });
    };
    push(
        if left {
            RelationKind::LeftOf
        } else {
            RelationKind::RightOf
        },
        Anchor::Ego,
    );
    let strip = match (class == Class::Pedestrian, left) {
        (true, true) => LaneRole::LeftSidewalk,
        (true, false) => LaneRole::RightSidewalk,
        (false, true) => LaneRole::LeftRoadside,
        (false, false) => LaneRole::RightRoadside,
    };
    if class == Class::Pedestrian {
        push(RelationKind::On, Anchor::Lane(strip));
    } else if state == Some(ObjectState::Parked) {
        push(RelationKind::ParkedOn, Anchor::Lane(strip));
    }
}

/// What was said of road works holds for what they are made of; what stands beside something in a car park stands there, too.
fn share_places(mentions: &mut [Mention]) {
    use LaneRole as L;
    let works = |c: Class| {
        matches!(
            c,
            Class::TrafficCone | Class::Barrier | Class::ConstructionVehicle
        )
    };
    // the parts of works that were named themselves took their place: the first of them, and who works there
    let led: Option<(usize, Vec<Stated>)> = mentions
        .windows(3)
        .position(|w| w.iter().all(|m| m.spec.span == w[0].spec.span) && works(w[0].spec.class))
        .map(|i| (i + 3, mentions[i].spec.relations.clone()))
        .filter(|(i, r)| mentions[i - 3].gone && !r.is_empty());
    if let Some((from, relations)) = led {
        for m in mentions[from..].iter_mut() {
            let part = works(m.spec.class) || m.spec.class == Class::Pedestrian;
            if part && m.spec.relations.is_empty() && !m.gone {
                m.spec.relations.clone_from(&relations);
            }
        }
    }
    // Between two that stand anywhere there must be room.
    for i in 0..mentions.len() {
        let gap = if matches!(
            mentions[i].spec.class,
            Class::Pedestrian | Class::TrafficCone | Class::Barrier
        ) {
            11.0
        } else {
            18.0
        };
        let pair = mentions[i]
            .spec
            .relations
            .iter()
            .find_map(|r| match (r.relation, r.anchor, r.and) {
                (RelationKind::Between, Anchor::Object(a), Some(Anchor::Object(b))) if a != b => {
                    Some((a, b, r.span))
                }
                _ => None,
            });
        if let Some((a, b, span)) = pair
            && mentions.get(a).is_some_and(|m| {
                m.spec.relations.is_empty() && !m.definite && m.spec.state != Some(ObjectState::Parked)
            })
            && mentions.get(b).is_some_and(|m| {
                m.spec.relations.is_empty() && !m.definite && m.spec.state != Some(ObjectState::Parked)
            })
        {
            mentions[b].spec.relations.push(Stated {
                relation: RelationKind::InFrontOf,
                anchor: Anchor::Object(a),
                and: None,
                distance_m: Some(gap),
                span,
            });
        }
    }
    for i in 0..mentions.len() {
        let there: Vec<Stated> = mentions[i].spec.relations.clone();
        for r in &there {
            let (RelationKind::NextTo, Anchor::Object(j)) = (r.relation, r.anchor) else {
                continue;
            };
            let strip = there.iter().find(|x| {
                matches!(x.relation, RelationKind::On | RelationKind::ParkedOn)
                    && matches!(
                        x.anchor,
                        Anchor::Lane(L::Sidewalk | L::LeftSidewalk | L::RightSidewalk | L::Carpark)
                    )
            });
            let Some(strip) = strip else {
                continue;
            };
            let Some(other) = mentions.get_mut(j) else {
                continue;
            };
            let walks = !matches!(strip.anchor, Anchor::Lane(L::Carpark));
            let small = matches!(
                other.spec.class,
                Class::Pedestrian | Class::Bicycle | Class::Motorcycle | Class::TrafficCone | Class::Barrier
            );
            if other.spec.relations.is_empty() && (small || !walks) {
                other.spec.relations.push(Stated {
                    distance_m: None,
                    ..*strip
                });
            }
        }
    }
}

/// What is parked in a scene of a car park stands there, if nothing else was said.
fn in_car_park(mentions: &mut [Mention], reading: &Reading) {
    if reading.description.road.kind != Some(Road::Parking) {
        return;
    }
    for m in mentions.iter_mut() {
        let parked = m.spec.state == Some(ObjectState::Parked) && m.spec.class.is_vehicle();
        if parked && m.spec.relations.is_empty() {
            m.spec.relations.push(Stated {
                relation: RelationKind::ParkedOn,
                anchor: Anchor::Lane(LaneRole::Carpark),
                and: None,
                distance_m: None,
                span: m.spec.span,
            });
        }
    }
}

/// The sun shines by day.
fn sun_shines(reading: &mut Reading) {
    let sunny = reading.phrases.iter().any(|p| {
        let words = p.text.to_lowercase();
        p.became == Became::Weather && words.contains("sun") && !p.meaning.contains("not")
    });
    // "in the afternoon sun"
    let shines = reading.phrases.iter().any(|p| {
        let words = p.text.to_lowercase();
        p.became == Became::Time
            && (words.ends_with(" sun") || words.contains("sunshine"))
            && !words.contains("before")
    });
    if shines && reading.description.weather.is_none() {
        reading.description.weather = Some(Weather::Clear);
    }
    if sunny && reading.description.time_of_day.is_none() {
        reading.description.time_of_day = Some(TimeOfDay::Day);
    }
}

/// Fills the description and the phrases of objects.
pub fn finish(mentions: &mut Vec<Mention>, reading: &mut Reading, prompt: &str) {
    drop_totals(mentions);
    super::finish_groups::drop_named(mentions, prompt);
    super::reciprocal::face(mentions);
    super::reciprocal::abreast(mentions);
    stopped_across(mentions, prompt);
    split_sides(mentions);
    super::finish_groups::apart_for(mentions);
    // Works beside cones or a digger that were named are made of those.
    let works: Vec<Span> = mentions
        .windows(3)
        .filter(|w| w.iter().all(|m| m.spec.span == w[0].spec.span) && w[0].spec.class == Class::TrafficCone)
        .map(|w| w[0].spec.span)
        .collect();
    let counted: Vec<Class> = mentions
        .iter()
        .filter(|m| !m.gone && !works.contains(&m.spec.span))
        .map(|m| m.spec.class)
        .collect();
    // (where two of the three are named, the list is complete)
    let parts = [Class::TrafficCone, Class::Barrier, Class::ConstructionVehicle];
    let listed = parts.iter().filter(|p| counted.contains(p)).count() > 1;
    for m in mentions.iter_mut() {
        if works.contains(&m.spec.span) && (listed || counted.contains(&m.spec.class)) {
            m.gone = true;
        }
    }
    sun_shines(reading);
    in_car_park(mentions, reading);
    share_places(mentions);
    super::finish_groups::from_cross_street(mentions, prompt);
    super::finish_groups::closed_with(mentions, prompt);
    super::inferred_places::infer(mentions);
    let mut index = vec![None; mentions.len()];
    let mut next = 0;
    for (i, m) in mentions.iter().enumerate() {
        if !m.gone && m.spec.count.n > 0 {
            index[i] = Some(next);
            next += 1;
        }
    }
    // A group that its parts used up is represented by the first of them.
    let stand_in = |i: usize| -> Option<usize> {
        index.get(i).copied().flatten().or_else(|| {
            let noun = &mentions.get(i)?.spec.noun;
            (0..mentions.len())
                .find(|&j| mentions[j].spec.noun == *noun && index[j].is_some())
                .and_then(|j| index[j])
        })
    };
    let renumber = |a: Anchor| match a {
        Anchor::Object(i) => stand_in(i).map(Anchor::Object),
        other => Some(other),
    };
    let mut foreground: Vec<ObjectSpec> = Vec::new();
    for (i, m) in mentions.iter().enumerate() {
        let Some(own) = index[i] else {
            continue;
        };
        let mut spec = m.spec.clone();
        distance_ahead(&mut spec);
        spec.relations = spec
            .relations
            .iter()
            .filter_map(|r| {
                let anchor = renumber(r.anchor)?;
                let and = match r.and {
                    Some(a) => Some(renumber(a)?),
                    None => None,
                };
                (anchor != Anchor::Object(own)).then_some(Stated { anchor, and, ..*r })
            })
            .collect();
        if spec.count.n > MOST_OF_ONE {
            reading.notes.push(format!(
                "{} {} were asked for: at most {MOST_OF_ONE} are tried",
                spec.count.n, spec.noun
            ));
        }
        if m.classes.len() > 1
            && m.classes[0] == Class::Car
            && spec.count.n > 1
            && m.spec.noun != "vehicle"
            && !m.spec.noun.starts_with("traffic")
        {
            reading.notes.push(format!("{} are placed as cars", spec.noun));
        }
        if let Some(color) = spec
            .color
            .as_ref()
            .filter(|c| super::names::paint_of(c).is_none())
        {
            reading
                .notes
                .push(format!("{color} is no paint of boxes: it is kept in words only"));
        }
        foreground.push(spec);
    }
    reading.notes.dedup();
    // "no cars and three cars": what is there wins, and it is said.
    let mut kept = Vec::new();
    for a in std::mem::take(&mut reading.description.absent) {
        let clash = foreground.iter().find(|o| {
            let states = a.state.is_none() || o.state == a.state;
            states && a.classes.len() <= 2 && a.classes.contains(&o.class)
        });
        if let Some(o) = clash {
            reading.notes.push(format!(
                "contradiction: {:?} and {:?}: {} {} are placed",
                a.span.of(prompt),
                o.span.of(prompt),
                o.count.n,
                o.noun
            ));
        }
        kept.push(a);
    }
    reading.description.absent = kept;
    for (i, o) in foreground.iter().enumerate() {
        let count = if o.count.is_exact() {
            o.count.n.to_string()
        } else {
            format!("about {}", o.count.n)
        };
        let state = o.state.map_or("", |s| match s {
            ObjectState::Moving => ", moving",
            ObjectState::Parked => ", parked",
            ObjectState::Waiting => ", waiting",
        });
        let colour = o.color.as_ref().map_or(String::new(), |c| format!(", {c}"));
        reading.phrases.push(Phrase {
            span: o.span,
            text: o.span.of(prompt).to_string(),
            became: Became::Object(i),
            meaning: format!("{count} x {}{state}{colour}", o.class.label()),
        });
        for (k, r) in o.relations.iter().enumerate() {
            let far = r.distance_m.map_or(String::new(), |d| format!(" ({d:.1} m)"));
            reading.phrases.push(Phrase {
                span: r.span,
                text: r.span.of(prompt).to_string(),
                became: Became::Relation { object: i, index: k },
                meaning: format!("{} {:?}{far}", r.relation.name().replace('_', " "), r.anchor),
            });
        }
    }
    reading.phrases.sort_by_key(|p| (p.span.start, p.span.end));
    let anchors = foreground.iter().flat_map(|o| &o.relations).map(|r| r.anchor);
    for anchor in anchors {
        match anchor {
            Anchor::Crossing => reading.description.road.crossing = true,
            Anchor::Lane(LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk) => {
                reading.description.road.sidewalk |= !reading.description.road.no_sidewalk;
            }
            _ => {}
        }
    }
    reading.description.foreground = foreground;
    reading.description.summarise();
}

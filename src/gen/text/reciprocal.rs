//! What two are to each other: "two diggers stand face to face", "two lorries drive side by side".

use super::description::{Anchor, Count, Stated};
use super::mention::Mention;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};

/// "two diggers stand face to face": one in front of the other, and turned to it.
pub(super) fn face(mentions: &mut Vec<Mention>) {
    let met: Vec<usize> = (0..mentions.len())
        .filter(|i| !mentions[*i].gone && mentions[*i].spec.attributes.iter().any(|a| a == "facetoface"))
        // (those on both sides of the road are parted there)
        .filter(|i| mentions[*i].both.is_none())
        .collect();
    for i in &met {
        mentions[*i].spec.attributes.retain(|a| a != "facetoface");
    }
    let pair = match met.as_slice() {
        [i] if mentions[*i].spec.count.n >= 2 && mentions[*i].spec.count.is_exact() => {
            let n = mentions[*i].spec.count.n;
            let mut other = mentions[*i].clone();
            mentions[*i].spec.count = Count::exactly(n.div_ceil(2));
            other.spec.count = Count::exactly(n / 2);
            mentions.push(other);
            Some((*i, mentions.len() - 1))
        }
        [a, b] => Some((*a, *b)),
        _ => None,
    };
    let Some((a, b)) = pair else {
        return;
    };
    let span = mentions[b].spec.span;
    let gap = if mentions[a].spec.class.is_vehicle() || mentions[b].spec.class.is_vehicle() {
        13.0
    } else {
        2.5
    };
    for (relation, distance_m) in [(RelationKind::InFrontOf, Some(gap)), (RelationKind::Facing, None)] {
        mentions[b].spec.relations.push(Stated {
            relation,
            anchor: Anchor::Object(a),
            and: None,
            distance_m,
            span,
        });
    }
    if mentions[b].spec.state == Some(ObjectState::Moving) && mentions[b].spec.class.is_vehicle() {
        mentions[b].spec.state = Some(ObjectState::Waiting);
    }
}

/// "two lorries drive side by side": one beside the other.
pub(super) fn abreast(mentions: &mut Vec<Mention>) {
    for i in 0..mentions.len() {
        let m = &mut mentions[i];
        let said = m.spec.attributes.iter().any(|a| a == "sidebyside");
        m.spec.attributes.retain(|a| a != "sidebyside");
        let pair = m.spec.count == Count::exactly(2) && m.both.is_none();
        // two cars find no room beside one another in one lane; at the kerb they stand one behind the other
        let lane = m.spec.relations.iter().any(|r| {
            matches!(
                r.anchor,
                Anchor::Lane(LaneRole::Ego | LaneRole::Left | LaneRole::Right | LaneRole::Oncoming)
            )
        });
        if said && !m.gone && m.spec.count.n == 1 {
            one_beside(mentions, i);
            continue;
        }
        if !said || m.gone || !pair || lane && m.spec.class.is_vehicle() {
            continue;
        }
        m.spec.count = Count::exactly(1);
        let mut other = m.clone();
        other.spec.relations.push(Stated {
            relation: RelationKind::NextTo,
            anchor: Anchor::Object(i),
            and: None,
            distance_m: None,
            span: other.spec.span,
        });
        for r in &mut other.spec.relations {
            if !matches!(r.relation, RelationKind::InFrontOf | RelationKind::Behind) {
                r.distance_m = None; // as far as the first
            }
        }
        mentions.push(other);
    }
}

/// "a motorbike and a scooter stand side by side": the second is beside the first.
fn one_beside(mentions: &mut [Mention], first: usize) {
    let Some(second) = (first + 1..mentions.len())
        .find(|k| !mentions[*k].gone && mentions[*k].spec.attributes.iter().any(|a| a == "sidebyside"))
    else {
        return;
    };
    let m = &mut mentions[second];
    m.spec.attributes.retain(|a| a != "sidebyside");
    m.spec.relations.push(Stated {
        relation: RelationKind::NextTo,
        anchor: Anchor::Object(first),
        and: None,
        distance_m: None,
        span: m.spec.span,
    });
}

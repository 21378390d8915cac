//! The background of a description as scenery: a style for each side of the road, new things where the style brings
//! none, and excluded things removed.

use std::collections::BTreeMap;

use glam::DVec2;

use super::place::FreeGround;
use super::targets::{Meant, is, targets};
use super::{Amount, SceneryClause, SceneryKind, SideOf, Verb};
use place::description::{Description, Environment, Road};
use scene::background::{Building, Post, PostKind, STOREY_M, SceneryLine, Shrubs, Tree, TreeKind};
use scene::{Background, BevLayout, BoxId, Form, SceneBox};
use world::draw::Draw;
use world::scenery::{RoadsideKind, RoadsideStyle, Style, background_of};

/// The scenery that a description asks for on a layout, and the wishes that could not be met, one line each.
pub fn scenery(
    description: &Description,
    layout: &BevLayout,
    boxes: &BTreeMap<BoxId, SceneBox>,
    seed: u64,
) -> (Background, Vec<String>) {
    let style = style(description, layout, seed);
    let mut things = background_of(layout, boxes, &style, seed);
    let mut short = Vec::new();
    for (i, s) in description.background.iter().enumerate() {
        let ground = FreeGround::new(layout, boxes, &things);
        if s.verb == Verb::Remove {
            let lacks = match s.place.near {
                Some(super::NearTo::Crossing) => ground.roads.crossings.is_empty(),
                Some(super::NearTo::Junction) => ground.roads.junctions_m.is_empty(),
                _ => false,
            };
            if lacks {
                short.push(format!("{}: this road has none", s.described()));
            }
            if let Meant::These(ids) = targets(s, &things, &ground) {
                ids.iter().for_each(|id| {
                    things.remove(*id);
                });
            }
            continue;
        }
        let sides: Vec<SideOf> = s
            .place
            .side
            .map_or(vec![SideOf::Left, SideOf::Right], |side| vec![side]);
        for side in sides {
            let mut here = s.clone();
            here.place.side = Some(side);
            if s.place.side.is_none() && !s.place.along && !s.plural && side == SideOf::Right {
                continue; // only one was asked for, on any side
            }
            if s.place.side.is_none() && !s.place.along && !s.plural {
                here.place.side = None;
            }
            let ground = FreeGround::new(layout, boxes, &things);
            if is_there(&here, &things, &ground) {
                continue;
            }
            match forms(&here, ground, seed ^ i as u64) {
                // Things that were asked for are placed: they stay when scenery is drawn anew.
                Ok(forms) => forms.into_iter().for_each(|f| {
                    things.add_as(f, true);
                }),
                Err(why) => short.push(format!("{}: {why}", s.described())),
            }
        }
    }
    (things, short)
}

/// True if the thing that was described is there already.
fn is_there(s: &SceneryClause, things: &Background, ground: &FreeGround) -> bool {
    if s.row || s.place.distance_m.is_some() || s.count.is_some() || s.place.near.is_some() {
        return false;
    }
    let of = |what: SceneryKind| {
        things
            .iter()
            .filter(move |t| is(what, &t.form) && ground.fits(&s.place, t.form.middle_m()))
    };
    match s.what {
        SceneryKind::Place(RoadsideKind::Forest | RoadsideKind::Park) => {
            of(SceneryKind::Tree(None)).count() >= 3
        }
        SceneryKind::Place(RoadsideKind::Country) => true,
        SceneryKind::Place(_) => of(SceneryKind::Building(None)).count() > 0,
        SceneryKind::Building(_) => of(s.what).count() > 0,
        SceneryKind::Line(_) => {
            let length = |t: &scene::Thing| {
                t.form
                    .points_m()
                    .windows(2)
                    .map(|w| w[0].distance(w[1]))
                    .sum::<f64>()
            };
            of(s.what).map(length).sum::<f64>() > 20.0
        }
        what => of(what).count() >= if s.plural { 3 } else { 1 },
    }
}

fn style(description: &Description, layout: &BevLayout, seed: u64) -> Style {
    let mut style = Style::drawn(layout, seed);
    if let Some(setting) = around(description) {
        style = Style::both(RoadsideStyle::usual(setting));
    }
    let sides = [(SideOf::Left, &mut style.left), (SideOf::Right, &mut style.right)];
    for (which, side) in sides {
        let here = description
            .background
            .iter()
            .filter(|s| s.place.side.is_none_or(|of| of == which));
        // Kinds of place first: "trees" among them give a number.
        let (places, rest): (Vec<&SceneryClause>, Vec<&SceneryClause>) =
            here.partition(|s| matches!(s.what, SceneryKind::Place(_)));
        for s in places.into_iter().chain(rest) {
            // Things near a crossing, or counted, are added or removed afterwards.
            if s.place.near.is_none() && s.count.is_none() && !(s.row || s.place.distance_m.is_some()) {
                wish(side, s);
            }
        }
    }
    style
}

/// The kind of place that surroundings and road name.
fn around(description: &Description) -> Option<RoadsideKind> {
    let road = match description.road.kind {
        Some(Road::Highway) => Some(RoadsideKind::Motorway),
        Some(Road::Suburb) => Some(RoadsideKind::Suburb),
        _ => None,
    };
    let environment = description.environment.map(|e| match e {
        Environment::Downtown | Environment::Urban => RoadsideKind::City,
        Environment::Suburban | Environment::Residential => RoadsideKind::Suburb,
        Environment::Rural => RoadsideKind::Country,
        Environment::Highway => RoadsideKind::Motorway,
        Environment::Industrial => RoadsideKind::Industry,
        Environment::Nature => RoadsideKind::Forest,
    });
    environment.or(road)
}

fn wish(side: &mut RoadsideStyle, s: &SceneryClause) {
    let no = s.verb == Verb::Remove;
    let many = match s.dense {
        Some(true) => 1.7,
        Some(false) => 0.4,
        None => 1.0,
    };
    match s.what {
        SceneryKind::Place(RoadsideKind::Forest) if no => side.trees = 0.0,
        SceneryKind::Place(_) if no => {}
        SceneryKind::Place(setting) => {
            *side = RoadsideStyle::usual(setting);
            side.green = many;
        }
        SceneryKind::Building(_) if no => side.built = 0.0,
        SceneryKind::Building(kind) => {
            let bare = matches!(
                side.setting,
                RoadsideKind::Forest | RoadsideKind::Motorway | RoadsideKind::Country | RoadsideKind::Park
            );
            // Houses suit an old town as well, towers do not suit a suburb.
            let fits = matches!(
                (kind, side.setting),
                (Some(RoadsideKind::Suburb), RoadsideKind::OldTown)
            );
            if let Some(setting) = kind.filter(|_| !fits) {
                side.setting = setting;
            } else if bare {
                side.setting = RoadsideKind::City;
            }
            side.built = if s.dense.is_some() {
                many
            } else {
                side.built.max(1.1)
            };
            side.storeys = storeys(s, side.setting).or(side.storeys);
        }
        SceneryKind::Tree(_) => side.trees = if no { 0.0 } else { many.max(0.4) * 1.2 },
        SceneryKind::Shrubs => side.shrubs = if no { 0.0 } else { many * 1.4 },
        SceneryKind::Plants if no => side.green = 0.0,
        SceneryKind::Plants => side.green = many * 1.3,
        SceneryKind::Line(_) | SceneryKind::Post(_) | SceneryKind::Thing => {}
    }
}

fn storeys(s: &SceneryClause, setting: RoadsideKind) -> Option<u32> {
    let said = s.height.map(|h| match h {
        Amount::Storeys(n) => n,
        Amount::Metres(m) => m / STOREY_M,
    });
    let usual = match (s.tall?, setting) {
        (true, RoadsideKind::City) => 9,
        (true, RoadsideKind::OldTown) => 6,
        (true, RoadsideKind::Industry | RoadsideKind::Retail) => 4,
        (true, _) => 4,
        (false, RoadsideKind::City) => 2,
        (false, _) => 1,
    };
    Some(said.map_or(usual, |n| n.round().clamp(1.0, 60.0) as u32))
}

/// New things of a clause, ego frame; an error in words if there is no room or it cannot be made.
pub(super) fn forms(s: &SceneryClause, mut ground: FreeGround, seed: u64) -> Result<Vec<Form>, String> {
    let mut draw = Draw::new(seed, "by words");
    let sides: Vec<SideOf> = s
        .place
        .side
        .map_or(vec![SideOf::Left, SideOf::Right], |side| vec![side]);
    let height = s.height.map(|h| match h {
        Amount::Storeys(n) => n * STOREY_M,
        Amount::Metres(m) => m,
    });
    let scale = match s.tall {
        Some(true) => 1.6,
        Some(false) => 0.6,
        None => 1.0,
    };
    let no_room = || format!("no room for {} beside the road", s.things());
    let mut out = Vec::new();
    if let SceneryKind::Line(kind) = s.what {
        let from_paved = kind.typical_m().1 / 2.0 + 0.7;
        for side in &sides {
            for points_m in ground.lines(&s.place, *side, from_paved) {
                let mut line = SceneryLine::typical(kind, thinned(&points_m));
                line.height_m = height.unwrap_or(line.height_m * scale);
                out.push(Form::Line(line));
            }
        }
        return if out.is_empty() {
            Err(no_room())
        } else {
            Ok(sound(out)?)
        };
    }
    if s.row || s.place.along {
        let spacing = if matches!(s.what, SceneryKind::Tree(_)) {
            8.0
        } else {
            14.0
        };
        for side in &sides {
            for line in ground.lines(&s.place, *side, 1.0) {
                let mut last: Option<DVec2> = None;
                for p in line {
                    if last.is_none_or(|l| l.distance(p) >= spacing) {
                        last = Some(p);
                        out.extend(single(s, p, height, scale, &ground, &mut draw));
                    }
                }
            }
        }
        return if out.is_empty() {
            Err(no_room())
        } else {
            Ok(sound(out)?)
        };
    }
    let (count, spacing) = match s.what {
        SceneryKind::Place(RoadsideKind::Forest) | SceneryKind::Place(RoadsideKind::Park) => {
            (if s.dense == Some(false) { 14 } else { 45 }, 0.0)
        }
        SceneryKind::Place(_) | SceneryKind::Plants | SceneryKind::Thing => {
            return Err(format!(
                "{}: only buildings, trees, shrubs, lines and posts can be put in by words",
                s.things()
            ));
        }
        _ => (s.count.unwrap_or(if s.plural { 4 } else { 1 }), 6.0),
    };
    let sign = if s.place.ahead == Some(false) { -1.0 } else { 1.0 };
    let first = s
        .place
        .distance_m
        .filter(|_| s.place.near.is_none())
        .unwrap_or(8.0);
    for i in 0..count.min(200) {
        let along = match spacing {
            0.0 => draw.range(-38.0, 38.0),
            step => sign * (first + f64::from(i) * step),
        };
        // Far from the road too, in a wood.
        let from_paved = if spacing == 0.0 {
            draw.range(2.0, 16.0)
        } else {
            1.2
        };
        let fits = |p: DVec2| {
            let mut try_draw = Draw::new(seed, "try");
            match single(s, p, height, scale, &ground, &mut try_draw) {
                Some(Form::Building(b)) => ground.has_room_for(&b.outline_m),
                Some(_) => ground.has_room(p, 0.5),
                None => false,
            }
        };
        let Some(p) = ground.place(&s.place, along, from_paved, &fits) else {
            break;
        };
        // A place that was named exactly cannot be replaced by another.
        if s.place.distance_m.is_some() && s.place.near.is_none() && i == 0 {
            let off = (ground.roads.along_ego_lane(p).x - along).abs();
            if off > 5.0 {
                return Err(format!(
                    "no room for {} {first:.0} m away: the nearest is {off:.0} m from there",
                    s.things()
                ));
            }
        }
        if let Some(form) = single(s, p, height, scale, &ground, &mut draw) {
            ground.take(&form);
            out.push(form);
        }
    }
    if out.is_empty() {
        Err(no_room())
    } else {
        sound(out)
    }
}

fn sound(forms: Vec<Form>) -> Result<Vec<Form>, String> {
    match forms.iter().find_map(Form::problem) {
        Some(problem) => Err(problem),
        None => Ok(forms),
    }
}

/// One thing at a place.
fn single(
    s: &SceneryClause,
    p: DVec2,
    height: Option<f64>,
    scale: f64,
    ground: &FreeGround,
    draw: &mut Draw,
) -> Option<Form> {
    let along = ground.roads.ego_direction(p);
    let on_left = ground.roads.along_ego_lane(p).y > 0.0;
    let away = if on_left { along.perp() } else { -along.perp() };
    Some(match s.what {
        SceneryKind::Tree(_) | SceneryKind::Place(_) => {
            let named = if let SceneryKind::Tree(kind) = s.what {
                kind
            } else {
                None
            };
            let kind =
                named.unwrap_or([TreeKind::Broadleaf, TreeKind::Conifer][usize::from(draw.chance(0.25))]);
            let height_m = height.unwrap_or_else(|| draw.range(5.0, 8.0) * scale);
            let slim = match kind {
                TreeKind::Conifer => 0.2,
                TreeKind::Columnar => 0.15,
                TreeKind::Broadleaf | TreeKind::Bare => 0.3,
            };
            Form::Tree(Tree {
                position_m: p,
                height_m,
                crown_radius_m: (height_m * slim).clamp(0.5, 3.4),
                kind,
            })
        }
        SceneryKind::Building(kind) => {
            let (length, depth, storeys) = match kind {
                Some(RoadsideKind::Suburb | RoadsideKind::Country) => (11.0, 9.0, 2.0),
                Some(RoadsideKind::Industry | RoadsideKind::Retail) => (22.0, 14.0, 2.5),
                Some(RoadsideKind::City) => (18.0, 11.0, 5.0),
                _ => (12.0, 9.0, 3.0),
            };
            let height_m = height.unwrap_or(storeys * STOREY_M * scale).max(STOREY_M);
            // Its front, not its middle, stands at the place.
            let middle = p + away * (depth / 2.0);
            Form::Building(Building::rectangle(
                middle,
                DVec2::new(length, depth) / 2.0,
                along,
                height_m,
            ))
        }
        SceneryKind::Shrubs => {
            let radius = 1.6;
            let corner =
                |i: usize| p + away + DVec2::from_angle(i as f64 * std::f64::consts::FRAC_PI_3) * radius;
            Form::Shrubs(Shrubs {
                outline_m: (0..6).map(corner).collect(),
                height_m: height.unwrap_or(1.2 * scale),
                per_m2: 0.9,
            })
        }
        SceneryKind::Post(kind) => {
            let facing = match kind {
                PostKind::Sign | PostKind::TrafficLight => {
                    if on_left {
                        along
                    } else {
                        -along
                    }
                }
                _ => -away,
            };
            let mut post = Post::typical(kind, p, facing.to_angle());
            post.height_m = height.unwrap_or(post.height_m);
            Form::Post(post)
        }
        SceneryKind::Line(_) | SceneryKind::Plants | SceneryKind::Thing => return None,
    })
}

/// The line with fewer vertices: a vertex about every 8 m, and both ends.
fn thinned(points_m: &[DVec2]) -> Vec<DVec2> {
    let last = points_m.len().saturating_sub(1);
    let keep = points_m
        .iter()
        .enumerate()
        .filter(|(i, _)| i % 5 == 0 || *i == last);
    keep.map(|(_, p)| *p).collect()
}

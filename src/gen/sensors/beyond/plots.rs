//! Things beyond the grid: facades and trees along the roads that leave it, cars on them, blocks between them. Each
//! kind is about as frequent, as high and as far from the road as near the edge of the scene.

use glam::{DVec2, DVec3};

use crate::beyond::backdrop::{BackdropSolids, REACH_M};
use crate::beyond::border::Border;
use crate::beyond::road_exits::Exit;
use scene::solid::Solid;
use scene::{BoxId, Class, SceneBox};
use world::draw::{Draw, hash};
use world::objects;

/// Distance from the edge up to which things line the roads, m.
const LINED_M: f64 = 70.0;
/// Length of a plot along a road, and edge of one between the roads, m.
const FRONT_M: [f64; 2] = [9.0, 20.0];
const BLOCK_M: f64 = 12.0;
/// Distance from the edge up to which there are blocks between the roads, m.
const BLOCKS_M: f64 = 52.0;
/// Distance from the road's side within which samples of the edge decide what lines the road, m.
const NEAR_M: f64 = 22.0;
/// Depth of a house, m.
const DEPTH_M: [f64; 2] = [7.0, 12.0];
/// Least distance of a thing from the grid, m.
const CLEAR_M: f64 = 0.4;
/// Share of plots with something on them.
const FILLED: f64 = 0.85;
/// Cars: places along a lane and at the kerb, m, and the share that is taken.
const LANE_GAP_M: f64 = 17.0;
const PARKED_GAP_M: f64 = 6.6;
const DRIVING: f64 = 0.22;
const PARKED: f64 = 0.3;
/// Least width of a road on each side for cars to park on it, m.
const ROOM_TO_PARK_M: f64 = 4.6;

/// Character of a stretch of the edge.
#[derive(Clone, Copy, Debug)]
struct Character {
    built: f64, // share of samples
    green: f64,
    house_m: f64, // usual height
    tree_m: f64,
    setback_m: f64, // from the outer edge of the sidewalk
}

/// Builds all things beyond the grid.
pub(super) fn draw_up(border: &Border, exits: &[Exit], seed: u64, things: &mut BackdropSolids) {
    let usual = character(border, |_| Some(0.0));
    for i in 0..exits.len() {
        let key = hash(seed ^ i as u64);
        for left in [false, true] {
            line(border, exits, i, left, usual, hash(key ^ u64::from(left)), things);
        }
        cars(border, exits, i, key, things);
    }
    blocks(border, exits, usual, seed, things);
}

/// Shares and heights of the things for which `off` gives a distance from the sidewalk.
fn character(border: &Border, off: impl Fn(DVec2) -> Option<f64>) -> Character {
    let (mut all, mut built, mut green) = (0usize, 0usize, 0usize);
    let (mut houses_m, mut trees_m, mut setback_m) = (Vec::new(), Vec::new(), f64::INFINITY);
    for stands in border.stands() {
        let Some(off_m) = off(stands.at) else {
            continue;
        };
        all += 1;
        match stands.class {
            Class::Manmade if stands.height_m > 2.4 => {
                built += 1;
                houses_m.push(stands.height_m);
                setback_m = setback_m.min(off_m);
            }
            Class::Vegetation => {
                green += 1;
                trees_m.push(stands.height_m);
            }
            _ => {}
        }
    }
    let middle = |values: &mut Vec<f64>, none: f64| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(none)
    };
    let share = |n: usize| n as f64 / all.max(1) as f64;
    Character {
        built: share(built),
        green: share(green),
        house_m: middle(&mut houses_m, 7.0).clamp(3.0, 20.0),
        tree_m: middle(&mut trees_m, 5.0).clamp(2.5, 12.0),
        setback_m: if setback_m.is_finite() {
            setback_m.clamp(0.5, 12.0)
        } else {
            4.0
        },
    }
}

/// Kind of a plot: built on, planted, open.
#[derive(Clone, Copy, PartialEq)]
enum Plot {
    House,
    Trees,
    Open,
}

fn plot(c: Character, draw: &mut Draw) -> Plot {
    // A little of either is everywhere; a sample in five on a house means a closed front.
    let (built, green) = (0.08 + c.built, 0.08 + 0.8 * c.green);
    let filled = FILLED * ((built + green) / 0.3).min(1.0);
    match draw.weighted(&[
        filled * built / (built + green),
        filled * green / (built + green),
        1.0 - filled,
    ]) {
        0 => Plot::House,
        1 => Plot::Trees,
        _ => Plot::Open,
    }
}

/// One side of a road.
fn line(
    border: &Border,
    exits: &[Exit],
    own: usize,
    left: bool,
    usual: Character,
    seed: u64,
    things: &mut BackdropSolids,
) {
    let (exit, mut draw) = (&exits[own], Draw::new(seed, "front"));
    let sign = if left { 1.0 } else { -1.0 };
    let here = character(border, |p| {
        let q = exit.local(p);
        let off_m = sign * q.y - exit.reach_m(left);
        (q.x > -18.0 && (0.0..NEAR_M).contains(&off_m)).then_some(off_m)
    });
    // One side has few samples: mixed with the rest.
    let mix = |a: f64, b: f64| 0.6 * a + 0.4 * b;
    let c = Character {
        built: mix(here.built, usual.built),
        green: mix(here.green, usual.green),
        ..here
    };
    let mut along_m = draw.range(0.0, 5.0);
    while along_m < LINED_M {
        let front_m = draw.range(FRONT_M[0], FRONT_M[1]);
        let middle_m = along_m + front_m / 2.0;
        match plot(c, &mut draw) {
            Plot::House => {
                let gap_m = if draw.chance(0.5) {
                    0.2
                } else {
                    draw.range(1.5, 5.0)
                };
                let (depth_m, back_m) = (draw.range(DEPTH_M[0], DEPTH_M[1]), draw.range(0.0, 1.0));
                let off_m = exit.reach_m(left) + c.setback_m + back_m + depth_m / 2.0;
                let at = exit.point(middle_m, sign * off_m);
                let size = DVec2::new(front_m - gap_m, depth_m);
                house(border, exits, at, size, exit.heading, c, &mut draw, things);
            }
            Plot::Trees => {
                for k in 0..2 {
                    let off_m = exit.reach_m(left) + draw.range(0.8, 2.0 + c.setback_m);
                    let at = exit.point(middle_m + front_m * (f64::from(k) - 0.5) / 2.0, sign * off_m);
                    tree(border, exits, at, c, &mut draw, things);
                }
            }
            Plot::Open => {}
        }
        along_m += front_m;
    }
    // Lamp posts stand at the kerb whatever is behind them.
    let mut along_m = draw.range(2.0, 20.0);
    let gap_m = draw.range(18.0, 32.0);
    while along_m < 60.0 {
        let at = exit.point(along_m, sign * (exit.half_m + 0.5));
        if clear(border, exits, at, 0.1) {
            let base = at.extend(border.height_m(at));
            things
                .solids
                .push(Solid::frustum(Class::Manmade, base, 6.0, 0.12, 0.08));
            things.close();
        }
        along_m += gap_m;
    }
}

/// The blocks between the roads.
fn blocks(border: &Border, exits: &[Exit], usual: Character, seed: u64, things: &mut BackdropSolids) {
    let covered = border.covered();
    let reached = covered.wider(REACH_M - BLOCK_M);
    let of = |axis: usize| {
        let at = |m: f64| m / BLOCK_M;
        at(reached.low[axis]).ceil() as i64..=at(reached.high[axis]).floor() as i64
    };
    for (i, j) in of(0).flat_map(|i| of(1).map(move |j| (i, j))) {
        let key = hash(seed ^ hash(i as u64 ^ hash(j as u64)));
        let mut draw = Draw::new(key, "block");
        let at = DVec2::new(i as f64, j as f64) * BLOCK_M
            + DVec2::new(draw.range(-2.0, 2.0), draw.range(-2.0, 2.0));
        let far_m = covered.out_m(at);
        // The farther out, the less is seen: only the first rows are worth it.
        if !(1.0..=BLOCKS_M).contains(&far_m) {
            continue;
        }
        match plot(usual, &mut draw) {
            Plot::House => {
                let size = DVec2::new(draw.range(8.0, 11.5), draw.range(DEPTH_M[0], 10.0));
                let heading = if draw.chance(0.5) { DVec2::X } else { DVec2::Y };
                house(border, exits, at, size, heading, usual, &mut draw, things);
            }
            Plot::Trees => {
                for _ in 0..1 + draw.below(2) {
                    let p = at + DVec2::new(draw.range(-4.0, 4.0), draw.range(-4.0, 4.0));
                    tree(border, exits, p, usual, &mut draw, things);
                }
            }
            Plot::Open => {}
        }
    }
}

/// True if a disc beyond the grid is clear of every road and of the grid.
fn clear(border: &Border, exits: &[Exit], at: DVec2, radius_m: f64) -> bool {
    let out_m = border.covered().out_m(at);
    out_m > radius_m + CLEAR_M
        && out_m < REACH_M - radius_m
        && exits.iter().all(|exit| {
            let q = exit.local(at);
            q.x < -radius_m || q.y.abs() > exit.half_m + radius_m
        })
}

#[expect(clippy::too_many_arguments)]
fn house(
    border: &Border,
    exits: &[Exit],
    at: DVec2,
    size: DVec2,
    heading: DVec2,
    c: Character,
    draw: &mut Draw,
    things: &mut BackdropSolids,
) {
    let height_m = (c.house_m * draw.range(0.7, 1.4)).clamp(2.8, 24.0);
    let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 0.0)];
    let corner = |(u, v): (f64, f64)| at + heading * (u * size.x / 2.0) + heading.perp() * (v * size.y / 2.0);
    if !corners.iter().all(|k| clear(border, exits, corner(*k), 0.3)) {
        return;
    }
    let base = at.extend(border.height_m(at) - 0.1);
    let body = DVec3::new(size.x, size.y, height_m);
    things
        .solids
        .push(Solid::block(Class::Manmade, base, body, heading));
    if height_m < 8.0 && draw.chance(0.6) {
        let eaves = DVec3::new(size.x, size.y, draw.range(1.5, 2.8));
        let roof = Solid::tapered(
            Class::Manmade,
            base + DVec3::Z * height_m,
            eaves,
            DVec2::new(0.95, 0.05),
            heading,
        );
        things.solids.push(roof);
    }
    things.close();
}

fn tree(
    border: &Border,
    exits: &[Exit],
    at: DVec2,
    c: Character,
    draw: &mut Draw,
    things: &mut BackdropSolids,
) {
    let height_m = c.tree_m * draw.range(0.8, 1.4);
    let crown_m = (height_m * draw.range(0.28, 0.42)).min(3.5);
    if !clear(border, exits, at, 0.3) || border.covered().out_m(at) < crown_m + CLEAR_M {
        return;
    }
    let base = at.extend(border.height_m(at) - 0.1);
    let radius_m = draw.range(0.12, 0.28);
    things.solids.push(Solid::frustum(
        Class::Vegetation,
        base,
        height_m - crown_m,
        radius_m,
        radius_m * 0.7,
    ));
    let mut boughs = |dz: f64, wide: f64| {
        let middle = base + DVec3::Z * (height_m - crown_m * dz);
        let radii = DVec3::new(wide, wide * draw.range(0.8, 1.2), 0.8) * crown_m;
        things
            .solids
            .push(Solid::ellipsoid(Class::Vegetation, middle, radii, 0.45));
    };
    boughs(0.9, 1.0);
    boughs(1.5, 0.8);
    things.close();
}

/// Traffic and parked cars.
fn cars(border: &Border, exits: &[Exit], own: usize, seed: u64, things: &mut BackdropSolids) {
    let (exit, mut draw) = (&exits[own], Draw::new(seed, "cars"));
    for sign in [-1.0, 1.0] {
        let mut place = |left_m: f64, gap_m: f64, taken: f64, first_m: f64| {
            let mut along_m = first_m;
            while along_m < LINED_M {
                let jitter_m = draw.range(0.0, 1.2);
                if draw.chance(taken) {
                    let at = exit.point(along_m + jitter_m, left_m);
                    car(border, exits, own, at, sign, &mut draw, things);
                }
                along_m += gap_m;
            }
        };
        place(sign * exit.half_m / 2.0, LANE_GAP_M, DRIVING, 6.0);
        if exit.half_m > ROOM_TO_PARK_M {
            place(sign * (exit.half_m - 1.2), PARKED_GAP_M, PARKED, 4.0);
        }
    }
}

fn car(
    border: &Border,
    exits: &[Exit],
    own: usize,
    at: DVec2,
    sign: f64,
    draw: &mut Draw,
    things: &mut BackdropSolids,
) {
    // A car stands on no other road, where it would stand across.
    let alone = exits.iter().enumerate().all(|(i, exit)| {
        let q = exit.local(at);
        i == own || q.x < -4.0 || q.y.abs() > exit.half_m + 3.0
    });
    let out_m = border.covered().out_m(at);
    if !alone || !(3.0..=REACH_M - 4.0).contains(&out_m) {
        return;
    }
    let heading = exits[own].heading;
    let size_m = DVec3::new(draw.range(4.0, 5.0), draw.range(1.75, 2.0), draw.range(1.45, 1.9));
    let b = SceneBox {
        id: BoxId(things.solids.len() as u32),
        class: Class::Car,
        center_m: at.extend(border.height_m(at) + size_m.z / 2.0),
        size_m,
        // Right-hand traffic: cars on the left of the way out drive inwards.
        yaw_rad: heading.to_angle() + if sign > 0.0 { std::f64::consts::PI } else { 0.0 },
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    };
    objects::object(&b, draw.bits(), &mut things.solids);
    things.close();
}

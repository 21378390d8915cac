//! The voxel tool: dabs, blocks, rows, floods, chosen voxels and pulled faces, in space.

mod choosing;
mod def;
mod options;
mod pulling;
mod stamping;
mod target;

use std::collections::BTreeSet;

use glam::DVec2;

use crate::Edit;
use crate::pick::{self, VoxelHit};
use crate::voxel_ops::{self, VoxelIndex};
use language::tf;
use scene::{Class, Frame};

use super::corners::{PolygonDraft, Set};
use super::rays::on_plane;
use super::saved::Stamp;
use super::setting::{self, ToolOption, Value};
use super::{
    Act, At, Context, Cursor, Event, Hand, Hint, Modifiers, Pointer, ReadonlyContext, Response, Tool, ToolId,
    ToolMark, ViewKind, VoxelMode, VoxelTip, VoxelVerb, Wants, hint_of,
};
pub use choosing::Joins;
use choosing::{SelectionVolume, joins};
pub use def::DEF;
use pulling::pulled;
use stamping::{stamp_at, stamped};
use target::{target, tipped};

/// Its name.
pub const ID: ToolId = ToolId::VOXEL;

/// Colour of voxels that would be removed.
pub(super) const REMOVED: [u8; 3] = [238, 112, 104];
/// Colour of chosen voxels: no class has it.
const CHOSEN: [u8; 3] = [255, 70, 255];
/// Distance between two samples of a quick stroke, points.
const SAMPLE_EVERY: f64 = 3.0;

/// Drag in progress.
#[derive(Clone, Debug, PartialEq)]
enum VoxelDrag {
    /// Follows the pointer.
    Dab {
        cells: BTreeSet<VoxelIndex>,
        verb: VoxelVerb,
        last: DVec2,
    },
    /// A block from the face that was pressed to the corner under the pointer, so many layers high.
    Block {
        first: VoxelHit,
        last: VoxelIndex,
        height: i32,
        verb: VoxelVerb,
    },
    /// A straight row.
    Row { first: VoxelIndex, verb: VoxelVerb },
    /// A face pulled out or pushed in.
    Pull { first: VoxelHit, face: Vec<VoxelIndex> },
    /// Voxels are chosen in it: in place of those chosen, besides them, or taken out of them.
    Choose(SelectionVolume),
}

/// The voxel tool.
#[derive(Clone, Debug, Default)]
pub struct VoxelTool {
    drag: Option<VoxelDrag>,
    /// Corners of an outline.
    corners: PolygonDraft,
}

fn class_of(hand: &Hand, verb: VoxelVerb) -> Class {
    match verb {
        VoxelVerb::Remove => Class::Free,
        _ => hand.voxel_class,
    }
}

fn step_of(verb: VoxelVerb) -> &'static str {
    match verb {
        VoxelVerb::Attach => "Attach voxels",
        VoxelVerb::Remove => "Remove voxels",
        VoxelVerb::Recolour => "Recolour voxels",
    }
}

/// The tip of the brush, its edge across the face, and its height along the normal, voxels.
fn brush(hand: &Hand) -> (VoxelTip, [usize; 2]) {
    let size = [hand.voxel_size, hand.voxel_size.max(hand.voxel_height)];
    match hand.voxel_mode {
        VoxelMode::Brush => (hand.voxel_tip, size),
        _ => (VoxelTip::Block, size),
    }
}

fn normal_axis(hit: &VoxelHit) -> usize {
    (0..3).find(|a| hit.normal[*a] != 0).unwrap_or(2)
}

/// Shows voxels painted, on both sides if symmetry is on, as far as the verb changes them.
fn show(cells: Vec<VoxelIndex>, frame: &Frame, hand: &Hand, verb: VoxelVerb) -> Response {
    let both = hand.both_sides(frame.extent(), cells);
    let cells = voxel_ops::only(&frame.occupancy, both, verb == VoxelVerb::Attach);
    match cells.is_empty() {
        true => Response::none(),
        false => {
            let class = class_of(hand, verb);
            Response::act(Act::Preview(vec![Edit::PaintVoxels { cells, class }]))
        }
    }
}

impl VoxelTool {
    fn press(&mut self, cx: &mut Context<'_>, pointer: &Pointer) -> Response {
        let shift = pointer.held.shift;
        let mode = cx.hand.voxel_mode;
        let verb = match shift && !mode.chooses() {
            true => VoxelVerb::Remove,
            false => cx.hand.verb,
        };
        if mode == VoxelMode::Brush {
            self.drag = Some(VoxelDrag::Dab {
                cells: BTreeSet::new(),
                verb,
                last: pointer.at,
            });
            return Response::hold();
        }
        if mode == VoxelMode::Stamp {
            return stamped(cx, pointer);
        }
        if mode == VoxelMode::ChoosePolygon {
            let set = self.corners.add(cx, pointer);
            closed(cx, set);
            return Response::none();
        }
        if mode.chooses() && mode != VoxelMode::Wand {
            self.drag = SelectionVolume::begin(cx, mode, pointer.at).map(VoxelDrag::Choose);
            return match self.drag {
                Some(_) => Response::hold(),
                None => Response::none(),
            };
        }
        let Some(ray) = cx.view.ray(pointer.at) else {
            return Response::none();
        };
        let frame = cx.frame();
        let hit = pick::ray_voxels(&ray, &frame.occupancy, |_, _| true);
        let first = target(frame, verb, [1, 1], &ray).first().copied();
        self.drag = match mode {
            VoxelMode::ChooseBlock
            | VoxelMode::ChooseSphere
            | VoxelMode::ChooseLasso
            | VoxelMode::ChoosePolygon
            | VoxelMode::Stamp => None,
            VoxelMode::Block | VoxelMode::Brush => first.map(|cell| VoxelDrag::Block {
                first: VoxelHit {
                    cell,
                    normal: hit.map_or([0, 0, 1], |h| h.normal),
                    label: Class::FREE,
                    distance_m: 0.0,
                },
                last: cell,
                height: cx.hand.voxel_height as i32,
                verb,
            }),
            VoxelMode::Row => first.map(|first| VoxelDrag::Row { first, verb }),
            VoxelMode::Extrude => hit.map(|first| VoxelDrag::Pull {
                face: voxel_ops::face(&frame.occupancy, first.cell, first.normal),
                first,
            }),
            VoxelMode::Fill | VoxelMode::Wand => {
                let cells = hit.map_or_else(Vec::new, |h| voxel_ops::connected(&frame.occupancy, h.cell));
                let cells =
                    voxel_ops::only(&frame.occupancy, cx.hand.both_sides(frame.extent(), cells), false);
                if mode == VoxelMode::Wand {
                    cx.hand.choose_voxels(cells, joins(pointer.held));
                    return Response::none();
                }
                return flood(cells, class_of(cx.hand, verb));
            }
        };
        match self.drag {
            Some(_) => Response::hold(),
            None => Response::none(),
        }
    }

    fn drag(&mut self, cx: &Context<'_>, pointer: &Pointer) -> Response {
        let (frame, hand, at) = (cx.frame(), &*cx.hand, pointer.at);
        let extent = frame.extent();
        match &mut self.drag {
            None => Response::none(),
            Some(VoxelDrag::Choose(area)) => {
                area.drag(cx, pointer);
                Response::none()
            }
            Some(VoxelDrag::Dab { cells, verb, last }) => {
                let before = cells.len();
                let samples = (last.distance(at) / SAMPLE_EVERY).ceil().max(1.0) as usize;
                for i in 1..=samples {
                    let between = last.lerp(at, i as f64 / samples as f64);
                    if let Some(ray) = cx.view.ray(between) {
                        cells.extend(tipped(frame, *verb, brush(hand), &ray));
                    }
                }
                *last = at;
                match cells.len() > before {
                    true => show(cells.iter().copied().collect(), frame, hand, *verb),
                    false => Response::none(),
                }
            }
            Some(VoxelDrag::Block { first, last, .. }) => {
                let axis = normal_axis(first);
                let [x, y, z] = first.cell;
                let middle_m = extent.center(x, y, z);
                let ray = cx.view.ray(at);
                if let Some(p) = ray.and_then(|ray| on_plane(extent, &ray, middle_m, axis)) {
                    let limit = extent.shape();
                    let units = extent.to_voxel_units(p);
                    for a in (0..3).filter(|a| *a != axis) {
                        last[a] = units[a].clamp(0.0, limit[a] as f64 - 1.0) as usize;
                    }
                    last[axis] = first.cell[axis];
                }
                self.show_block(frame, hand)
            }
            Some(VoxelDrag::Row { first, verb }) => {
                let Some(ray) = cx.view.ray(at) else {
                    return Response::none();
                };
                match target(frame, *verb, [1, 1], &ray).first() {
                    Some(last) => {
                        let cells = voxel_ops::line(extent, *first, *last, hand.voxel_size);
                        show(cells, frame, hand, *verb)
                    }
                    None => Response::none(),
                }
            }
            Some(VoxelDrag::Pull { first, face }) => {
                let ray = cx.view.ray(at);
                match ray.and_then(|ray| pulled(&ray, frame, hand, first, face)) {
                    Some(edit) => Response::act(Act::Preview(vec![edit])),
                    None => Response::act(Act::Cancel),
                }
            }
        }
    }

    fn show_block(&self, frame: &Frame, hand: &Hand) -> Response {
        let Some(VoxelDrag::Block {
            first,
            last,
            height,
            verb,
        }) = &self.drag
        else {
            return Response::none();
        };
        let axis = normal_axis(first);
        // Attached blocks grow out of the face, others into it.
        let outward = if *verb == VoxelVerb::Attach { 1 } else { -1 };
        let mut far = *last;
        let end = first.cell[axis] as i32 + outward * first.normal[axis] * (height - 1);
        far[axis] = end.max(0) as usize;
        show(
            voxel_ops::between(frame.extent(), first.cell, far),
            frame,
            hand,
            *verb,
        )
    }

    fn scroll(&mut self, cx: &Context<'_>, notches: i32) -> Response {
        if let Some(VoxelDrag::Choose(area)) = &mut self.drag {
            return match area.scroll(cx.frame().extent(), notches) {
                true => Response::taken(),
                false => Response::none(),
            };
        }
        let Some(VoxelDrag::Block { height, .. }) = &mut self.drag else {
            return Response::none();
        };
        *height = (*height + notches).clamp(1, cx.frame().extent().nz() as i32);
        let mut response = self.show_block(cx.frame(), cx.hand);
        response.taken = true;
        response
    }

    fn release(&mut self, cx: &mut Context<'_>, held: Modifiers) -> Response {
        let label = match self.drag.take() {
            None => return Response::none(),
            Some(VoxelDrag::Choose(area)) => {
                area.take(cx, joins(held));
                return Response::none();
            }
            Some(
                VoxelDrag::Dab { verb, .. } | VoxelDrag::Block { verb, .. } | VoxelDrag::Row { verb, .. },
            ) => step_of(verb),
            Some(VoxelDrag::Pull { .. }) => "Pull voxels",
        };
        Response::act(Act::Commit(label.into()))
    }
}

fn flood(cells: Vec<VoxelIndex>, class: Class) -> Response {
    if cells.is_empty() {
        return Response::none();
    }
    let label = match class {
        Class::Free => "Remove voxels",
        _ => "Fill voxels",
    };
    Response::act(Act::Apply(label.into(), vec![Edit::PaintVoxels { cells, class }]))
}

/// Chooses the voxels in an outline that was closed.
fn closed(cx: &mut Context<'_>, set: Set) {
    if let Set::Closed(points, held) = set {
        SelectionVolume::Lasso { points }.take(cx, joins(held));
    }
}

impl Tool for VoxelTool {
    fn event(&mut self, cx: &mut Context<'_>, event: &Event) -> Response {
        match self.corners.event(event) {
            Set::Not => {}
            set => {
                closed(cx, set);
                return Response::taken();
            }
        }
        match event {
            _ if cx.from_above() => Response::none(),
            Event::Press(pointer) => self.press(cx, pointer),
            Event::Pick(pointer) => {
                let ray = cx.view.ray(pointer.at);
                let grid = &cx.frame().occupancy;
                let hit = ray.and_then(|ray| pick::ray_voxels(&ray, grid, |_, _| true));
                if let Some(class) = hit.and_then(|h| Class::from_id(h.label)) {
                    cx.hand.voxel_class = class;
                }
                Response::none()
            }
            Event::Drag(pointer) => self.drag(cx, pointer),
            Event::Release(pointer) => self.release(cx, pointer.held),
            Event::Scroll(notches) => self.scroll(cx, *notches),
            Event::Cancel => {
                self.drag = None;
                Response::none()
            }
            Event::Key(..) | Event::DoubleClick => Response::none(),
        }
    }

    fn hint(&self, hand: &Hand, view: Option<ViewKind>) -> Hint {
        if view != Some(ViewKind::Space) {
            return hint_of(&["The voxel tool works in the 3D view"]);
        }
        let verb = match hand.verb {
            VoxelVerb::Attach => "Drag attaches",
            VoxelVerb::Remove => "Drag removes",
            VoxelVerb::Recolour => "Drag recolours",
        };
        hint_of(&match hand.voxel_mode {
            VoxelMode::Brush => vec![verb, "Shift removes", "Alt picks", "[ ] size"],
            VoxelMode::Block => vec![verb, "wheel sets the height"],
            VoxelMode::Row => vec![verb, "Shift removes"],
            VoxelMode::Fill => vec!["Click floods one class", "Shift removes"],
            VoxelMode::Wand => vec!["Click chooses what is connected", "Shift adds", "Del removes"],
            VoxelMode::ChooseBlock => vec![
                "Drag chooses in a box",
                "wheel sets the height",
                "Shift adds, Ctrl takes out",
            ],
            VoxelMode::ChooseSphere => vec!["Drag chooses in a sphere", "Shift adds, Ctrl takes out"],
            VoxelMode::ChooseLasso => vec!["Draw around voxels to choose them", "Shift adds, Ctrl takes out"],
            VoxelMode::ChoosePolygon => vec![
                "Click sets corners",
                "Enter chooses",
                "Shift adds, Ctrl takes out",
            ],
            VoxelMode::Extrude => vec!["Drag pulls a face out or in"],
            VoxelMode::Stamp => vec!["Click sets the kept voxels down", "Turn them in the options"],
        })
    }

    fn cursor(&self, sight: &ReadonlyContext<'_>) -> Cursor {
        match sight.from_above() {
            true => Cursor::Forbidden,
            false => Cursor::Crosshair,
        }
    }

    fn overlay(&self, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
        let hand = sight.hand;
        if sight.from_above() {
            return Vec::new();
        }
        if let Some(VoxelDrag::Choose(area)) = &self.drag {
            return area.marks(sight.settled.frame(), hand, sight.view, CHOSEN);
        }
        if hand.voxel_mode.chooses() {
            let mut out = vec![ToolMark::Voxels(hand.voxels.clone(), CHOSEN)];
            out.extend(self.corners.marks(sight));
            return out;
        }
        let Some(pointer) = sight.pointer else {
            return Vec::new();
        };
        if hand.voxel_mode == VoxelMode::Stamp {
            let parts = stamp_at(sight.settled.frame(), hand, sight.view, pointer.at);
            return parts
                .into_iter()
                .map(|(class, cells)| ToolMark::Voxels(cells, class.color()))
                .collect();
        }
        let mut out = Vec::new();
        if let Some(ray) = sight.view.ray(pointer.at) {
            let color = match hand.verb {
                VoxelVerb::Remove => REMOVED,
                _ if hand.voxel_class == Class::Free => [200; 3],
                _ => hand.voxel_class.color(),
            };
            let frame = sight.settled.frame();
            let cells = tipped(frame, hand.verb, brush(hand), &ray);
            out.push(ToolMark::Voxels(hand.both_sides(frame.extent(), cells), color));
        }
        if let Some(VoxelDrag::Block {
            first, last, height, ..
        }) = &self.drag
        {
            let flat = (0..3).filter(|a| first.normal[*a] == 0);
            let across: Vec<usize> = flat.map(|a| first.cell[a].abs_diff(last[a]) + 1).collect();
            if let [a, b] = across[..] {
                out.push(ToolMark::Tag(
                    At::Screen(pointer.at),
                    tf!("{a} × {b} × {height} voxels", a = a, b = b, height = height),
                ));
            }
        }
        out
    }

    fn options(&self, hand: &Hand) -> Vec<ToolOption> {
        options::options(hand)
    }

    fn set(&mut self, hand: &mut Hand, frame: &Frame, id: &str, value: Value) -> Vec<Act> {
        let number = value.number().map_or(1, |n| n.round().max(1.0) as usize);
        match (id, value) {
            ("mode", _) => {
                setting::take(&mut hand.voxel_mode, value, &VoxelMode::ALL);
                self.corners.clear();
            }
            ("stamp", _) => match Stamp::from_cells(frame, &hand.voxels) {
                Some(stamp) => (hand.stamp, hand.voxel_mode) = (stamp, VoxelMode::Stamp),
                None => return vec![Act::Note(tf!("A stamp has 1 to {n} voxels", n = Stamp::MOST))],
            },
            ("turn_stamp", _) => hand.stamp = hand.stamp.turned(),
            ("through", _) => setting::take_on(&mut hand.voxels_through, value),
            ("height", _) => hand.voxel_height = number.min(16),
            ("symmetry", _) => setting::take_on(&mut hand.symmetry, value),
            ("tip", _) => setting::take(&mut hand.voxel_tip, value, &VoxelTip::ALL),
            ("verb", _) => setting::take(&mut hand.verb, value, &VoxelVerb::ALL),
            ("size", _) => hand.voxel_size = number.min(Hand::MAX_VOXEL_SIZE),
            ("class", Value::Class(class)) => hand.voxel_class = class,
            ("remove", _) => return hand.paint_chosen_voxels(Class::Free),
            ("recolour", _) => return hand.paint_chosen_voxels(hand.voxel_class),
            ("lock", _) => {
                let edits = voxel_ops::lock(frame, &hand.voxels);
                return match edits.is_empty() {
                    true => Vec::new(),
                    false => vec![Act::Apply("Lock voxels".into(), edits)],
                };
            }
            ("unlock", _) if !hand.voxels.is_empty() => {
                let cells = hand.voxels.clone();
                return vec![Act::Apply(
                    "Unlock voxels".into(),
                    vec![Edit::UnlockVoxels { cells }],
                )];
            }
            _ => {}
        }
        Vec::new()
    }

    fn wants(&self) -> Wants {
        match self.drag {
            Some(VoxelDrag::Block { .. } | VoxelDrag::Choose(SelectionVolume::Block { .. })) => Wants::Wheel,
            _ if !self.corners.is_empty() => Wants::Points,
            _ => Wants::Nothing,
        }
    }

    fn draws_in(&self) -> Option<ViewKind> {
        self.corners.view()
    }

    fn put_down(&mut self) {
        self.corners.clear();
    }

    fn restart(&mut self) {
        self.corners.clear();
    }
}

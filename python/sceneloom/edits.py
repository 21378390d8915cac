"""One function per edit, for the call `apply`. Written by generate.py from `sceneloom schema`; do not edit."""

from __future__ import annotations

from typing import Any, Literal, Sequence, cast

from . import types


def _given(args: dict[str, Any], required: list[str]) -> dict[str, Any]:
    """Without what was left out."""
    return {key: value for key, value in args.items() if value is not None or key in required}


def remove_box(*, id: types.BoxId) -> types.EditRemoveBox:
    """Takes a box out, and its voxels.

    id: The box.
    """
    args = _given({'id': id}, ['id'])
    return cast('types.EditRemoveBox', {"remove_box": args})


def add_box(
    *,
    center_m: Sequence[float],
    class_: types.Class,
    size_m: Sequence[float],
    yaw_deg: float,
    id: types.BoxId | None = None,
    label: types.BoxLabel | None = None,
    velocity_mps: Sequence[float] | None = None,
) -> types.EditAddBox:
    """Puts a box in, and voxels of its class.

    center_m: Centre in the world frame, m.
    class_: One of the ten object classes.
    size_m: Length, width, height, m.
    yaw_deg: Heading, degrees counter-clockwise from x.
    id: Its number; none means the next one free.
    label: Name and paint.
    velocity_mps: Velocity over ground in the world frame's axes, m/s; none means standing.
    """
    args = _given(
        {
            'center_m': center_m,
            'class': class_,
            'size_m': size_m,
            'yaw_deg': yaw_deg,
            'id': id,
            'label': label,
            'velocity_mps': velocity_mps,
        },
        ['center_m', 'class', 'size_m', 'yaw_deg'],
    )
    return cast('types.EditAddBox', {"add_box": args})


def move_box(
    *,
    id: types.BoxId,
    center_m: Sequence[float] | None = None,
    size_m: Sequence[float] | None = None,
    yaw_deg: float | None = None,
) -> types.EditMoveBox:
    """Moves, turns or resizes a box; what is left out stays.

    id: The box.
    center_m: New centre in the world frame, m.
    size_m: New length, width, height, m.
    yaw_deg: New heading, degrees counter-clockwise from x.
    """
    args = _given({'id': id, 'center_m': center_m, 'size_m': size_m, 'yaw_deg': yaw_deg}, ['id'])
    return cast('types.EditMoveBox', {"move_box": args})


def label_box(*, id: types.BoxId, label: types.BoxLabel) -> types.EditLabelBox:
    """Names and paints a box; what is left out of the label is none. No voxel changes, and nothing is
    generated.

    id: The box.
    label: Its name and paint from now on.
    """
    args = _given({'id': id, 'label': label}, ['id', 'label'])
    return cast('types.EditLabelBox', {"label_box": args})


def arrange(
    *,
    how: types.Arrangement,
    boxes: Sequence[types.BoxId] | None = None,
    things: Sequence[types.ThingId] | None = None,
) -> types.EditArrange:
    """Groups, hides or locks boxes and things, or the opposite. No voxel changes, and nothing is
    generated.

    how: Change of their arrangement.
    boxes: The boxes.
    things: The things.
    """
    args = _given({'how': how, 'boxes': boxes, 'things': things}, ['how'])
    return cast('types.EditArrange', {"arrange": args})


def set_box_class(*, class_: types.Class, id: types.BoxId) -> types.EditSetBoxClass:
    """Turns a box into another class; its size and paint stay, its name goes.

    class_: One of the ten object classes.
    id: The box.
    """
    args = _given({'class': class_, 'id': id}, ['class', 'id'])
    return cast('types.EditSetBoxClass', {"set_box_class": args})


def paint_bev(*, layer: types.BevLayer, shape: types.Shape, value: bool) -> types.EditPaintBev:
    """Sets or clears a map layer. Clearing dividers or stop lines cuts the lines behind them there.

    layer: One of the eight map layers.
    shape: Cells to set or clear.
    value: True sets, false clears.
    """
    args = _given({'layer': layer, 'shape': shape, 'value': value}, ['layer', 'shape', 'value'])
    return cast('types.EditPaintBev', {"paint_bev": args})


def add_things(*, forms: Sequence[types.Form]) -> types.EditAddThings:
    """Puts things beside the road, and their voxels. They stay when scenery is drawn anew.

    forms: Kinds and places, world frame.
    """
    args = _given({'forms': forms}, ['forms'])
    return cast('types.EditAddThings', {"add_things": args})


def draw_scenery(*, forms: Sequence[types.Form]) -> types.EditDrawScenery:
    """Puts scenery drawn by a seed beside the road, and its voxels. It goes when scenery is drawn anew.

    forms: Kinds and places, world frame.
    """
    args = _given({'forms': forms}, ['forms'])
    return cast('types.EditDrawScenery', {"draw_scenery": args})


def remove_things(*, ids: Sequence[types.ThingId]) -> types.EditRemoveThings:
    """Takes things out, and their voxels.

    ids: The things.
    """
    args = _given({'ids': ids}, ['ids'])
    return cast('types.EditRemoveThings', {"remove_things": args})


def move_things(
    *,
    by_m: Sequence[float],
    ids: Sequence[types.ThingId],
    turn_deg: float | None = None,
) -> types.EditMoveThings:
    """Moves and turns things together.

    by_m: How far in the world frame, m.
    ids: The things.
    turn_deg: Turn about the middle of them all, degrees counter-clockwise.
    """
    args = _given({'by_m': by_m, 'ids': ids, 'turn_deg': turn_deg}, ['by_m', 'ids'])
    return cast('types.EditMoveThings', {"move_things": args})


def raise_things(*, by_m: float, ids: Sequence[types.ThingId]) -> types.EditRaiseThings:
    """Makes things higher (or, with a negative number, lower).

    by_m: By how much, m; a storey is 3 m.
    ids: The things.
    """
    args = _given({'by_m': by_m, 'ids': ids}, ['by_m', 'ids'])
    return cast('types.EditRaiseThings', {"raise_things": args})


def change_thing(*, form: types.Form, id: types.ThingId) -> types.EditChangeThing:
    """Gives a thing another form.

    form: Its new kind and place, world frame.
    id: The thing.
    """
    args = _given({'form': form, 'id': id}, ['form', 'id'])
    return cast('types.EditChangeThing', {"change_thing": args})


def clear_scenery(*, shape: types.Shape | None = None) -> types.EditClearScenery:
    """Takes man-made and plant voxels out that belong to no thing, and lays the ground where they stood.
    Painted voxels stay.

    shape: Area to clear; everywhere if left out.
    """
    args = _given({'shape': shape}, [])
    return cast('types.EditClearScenery', {"clear_scenery": args})


def add_polylines(*, lines: Sequence[types.Polyline]) -> types.EditAddPolylines:
    """Puts lines on the ground: lane centres, and dividers, stop lines and crossings with the cells of
    their layer.

    lines: Kinds and vertices of the lines, world frame, m; at least two vertices each.
    """
    args = _given({'lines': lines}, ['lines'])
    return cast('types.EditAddPolylines', {"add_polylines": args})


def change_roads(*, change: types.RoadChange) -> types.EditChangeRoads:
    """Changes the road network. What it draws differently from before is drawn anew: layers, lines,
    ground. In a scene that has no network yet, what is painted is recognised first.

    change: Change to apply.
    """
    args = _given({'change': change}, ['change'])
    return cast('types.EditChangeRoads', {"change_roads": args})


def paint_voxels(*, cells: Sequence[Sequence[int]], class_: types.Class) -> types.EditPaintVoxels:
    """Sets voxels to a class (`free` removes them) and locks them.

    cells: Indices `[x, y, z]`.
    class_: Any class.
    """
    args = _given({'cells': cells, 'class': class_}, ['cells', 'class'])
    return cast('types.EditPaintVoxels', {"paint_voxels": args})


def unlock_voxels(*, cells: Sequence[Sequence[int]]) -> types.EditUnlockVoxels:
    """Gives painted voxels back to generation; what they show stays for now.

    cells: Indices `[x, y, z]`.
    """
    args = _given({'cells': cells}, ['cells'])
    return cast('types.EditUnlockVoxels', {"unlock_voxels": args})


def clear_paint() -> types.EditClearPaint:
    """Gives every painted voxel of the frame back to generation.
    """
    args = _given({}, [])
    return cast('types.EditClearPaint', {"clear_paint": args})


def correct(*, edit: types.Edit) -> types.EditCorrect:
    """Corrects what was inferred wrongly when the frame was imported: the box or layer changes, in the
    source too, and no voxel does, so that nothing is generated.

    edit: A change of a box or of a map layer.
    """
    args = _given({'edit': edit}, ['edit'])
    return cast('types.EditCorrect', {"correct": args})


def at(
    *,
    edit: types.Edit,
    frame: int | None = None,
    scope: types.Scope | None = None,
    time_s: float | None = None,
    track: types.BoxId | None = None,
) -> types.EditAt:
    """An edit at another moment than the one that is shown, and what it means for other moments. What
    stands still is changed for all moments anyway. At most one of `frame`, `time_s` and `track` is
    given, and at least one of all keys.

    edit: Edit to apply there.
    frame: Number of the frame.
    scope: For which moments a moving object changes its place; the whole track if left out.
    time_s: Time in the clip, s.
    track: A moving object that the edit is of: the moment is one at which it is there.
    """
    args = _given(
        {
            'edit': edit,
            'frame': frame,
            'scope': scope,
            'time_s': time_s,
            'track': track,
        },
        ['edit'],
    )
    return cast('types.EditAt', {"at": args})


def set_shape(*, cells: Sequence[Sequence[int]], id: types.BoxId) -> types.EditSetShape:
    """Gives a box voxels of its own, in place of those of its class: they go wherever it goes and are not
    generated. Another size or class takes them away again.

    cells: Voxels of 0.4 m that are its class's, as `[ahead, left, up]` from its middle seen from above
        and from its underside: `[0, 0, 0]` is ahead of and left of the middle, and the underside is in
        it. None: its class's again.
    id: The box.
    """
    args = _given({'cells': cells, 'id': id}, ['cells', 'id'])
    return cast('types.EditSetShape', {"set_shape": args})


def set_motion(
    *,
    from_s: float | None = None,
    id: types.BoxId | None = None,
    motion: types.Motion | None = None,
    to_s: float | None = None,
) -> types.EditSetMotion:
    """Lets an object or the ego vehicle move, or (without a motion) stand where it is at the moment that
    is shown.

    from_s: When it appears, s; it is there from the beginning if left out. Not of the ego vehicle.
    id: The box; the ego vehicle if left out.
    motion: How it moves from now on, world frame.
    to_s: When it disappears, s; it is there to the end if left out. Not of the ego vehicle.
    """
    args = _given({'from_s': from_s, 'id': id, 'motion': motion, 'to_s': to_s}, [])
    return cast('types.EditSetMotion', {"set_motion": args})


def forecast(*, seconds: float) -> types.EditForecast:
    """So many seconds more: what moves at the end goes on along its lane and behind whoever is ahead, the
    ego vehicle too, and the map grows to where it comes.

    seconds: How many, s.
    """
    args = _given({'seconds': seconds}, ['seconds'])
    return cast('types.EditForecast', {"forecast": args})


def extend_map(
    *,
    ahead_m: float | None = None,
    behind_m: float | None = None,
    left_m: float | None = None,
    right_m: float | None = None,
) -> types.EditExtendMap:
    """Makes the map larger, in the world frame. Roads go on beyond the edge as they reach it; what is new
    is to be generated.

    ahead_m: So much farther along x, m.
    behind_m: So much farther against x, m.
    left_m: So much farther along y, m.
    right_m: So much farther against y, m.
    """
    args = _given({'ahead_m': ahead_m, 'behind_m': behind_m, 'left_m': left_m, 'right_m': right_m}, [])
    return cast('types.EditExtendMap', {"extend_map": args})


def let_move(
    *,
    template: types.Template,
    from_s: float | None = None,
    gap_m: float | None = None,
    id: types.BoxId | None = None,
    mps: float | None = None,
) -> types.EditLetMove:
    """Lets a box move in a way that has a name, from where it is at the moment that is shown, along the
    lanes of the map. A scene of one moment becomes a clip.

    template: How.
    from_s: When what it is about begins, s; soon if left out.
    gap_m: It begins when so much is between it and the ego vehicle, m, in place of at a time; who
        follows keeps so much to the one ahead. Bumper to bumper.
    id: The box; the ego vehicle if left out.
    mps: Speed, m/s; a usual one of its class if left out.
    """
    args = _given(
        {
            'template': template,
            'from_s': from_s,
            'gap_m': gap_m,
            'id': id,
            'mps': mps,
        },
        ['template'],
    )
    return cast('types.EditLetMove', {"let_move": args})


def let_traffic_drive() -> types.EditLetTrafficDrive:
    """Lets everything that says how fast it is but stands go on along its lane, each at a distance to the
    one ahead. What would come into something, a wall, a parked vehicle or one another, stays where it
    is.
    """
    args = _given({}, [])
    return cast('types.EditLetTrafficDrive', {"let_traffic_drive": args})


def set_length(*, length_s: float, rate_hz: float | None = None) -> types.EditSetLength:
    """Sets how long the scene lasts. What happens later than that stays, and is not shown.

    length_s: Length, s; 0 for a scene of one moment.
    rate_hz: Frames per second of what is written; as before if left out.
    """
    args = _given({'length_s': length_s, 'rate_hz': rate_hz}, ['length_s'])
    return cast('types.EditSetLength', {"set_length": args})


def confirm_inferred() -> types.EditConfirmInferred:
    """Confirms what was inferred when the frame was imported: it is marked as a guess no more.
    """
    args = _given({}, [])
    return cast('types.EditConfirmInferred', {"confirm_inferred": args})


def waive(
    *,
    check: str,
    reason: str,
    where_m: Sequence[float],
    box: types.BoxId | None = None,
) -> types.EditWaive:
    """Lets a finding of the checks stand, with the reason. One that was waived before gets the new reason.

    check: Name of the check.
    reason: Why it may stay; not empty.
    where_m: Place of the finding, world frame, m.
    box: The box it is about, if it is about one.
    """
    args = _given(
        {
            'check': check,
            'reason': reason,
            'where_m': where_m,
            'box': box,
        },
        ['check', 'reason', 'where_m'],
    )
    return cast('types.EditWaive', {"waive": args})


def unwaive(*, check: str, where_m: Sequence[float], box: types.BoxId | None = None) -> types.EditUnwaive:
    """Takes a waiver back: the finding counts again. Nothing if there is none.

    check: Name of the check.
    where_m: Place of the finding, world frame, m.
    box: The box it is about, if it is about one.
    """
    args = _given({'check': check, 'where_m': where_m, 'box': box}, ['check', 'where_m'])
    return cast('types.EditUnwaive', {"unwaive": args})


def set_prompt(*, prompt: str) -> types.EditSetPrompt:
    """Replaces the text that describes the style.

    prompt: The text; empty means none.
    """
    args = _given({'prompt': prompt}, ['prompt'])
    return cast('types.EditSetPrompt', {"set_prompt": args})


def set_conditions(*, conditions: types.Conditions) -> types.EditSetConditions:
    """Replaces light and air. No voxel changes.

    conditions: The new ones.
    """
    args = _given({'conditions': conditions}, ['conditions'])
    return cast('types.EditSetConditions', {"set_conditions": args})


def keep_words(*, words: str) -> types.EditKeepWords:
    """Notes words that were typed to change the scene.

    words: The words.
    """
    args = _given({'words': words}, ['words'])
    return cast('types.EditKeepWords', {"keep_words": args})


def set_rig(*, rig: types.SensorRig) -> types.EditSetRig:
    """Replaces the sensors of the vehicle. No voxel changes.

    rig: The new ones.
    """
    args = _given({'rig': rig}, ['rig'])
    return cast('types.EditSetRig', {"set_rig": args})

"""Types of what calls take and answer. Written by generate.py from `sceneloom schema`; do not edit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Sequence, TypedDict

if TYPE_CHECKING:
    from typing_extensions import NotRequired, TypeAlias

ArrangementGroupArgs = TypedDict(
    'ArrangementGroupArgs',
    {
        # Name of the group; empty means none.
        'name': 'NotRequired[str]',
    },
)

# Chosen and moved together from now on; what was in other groups leaves them.
ArrangementGroup = TypedDict(
    'ArrangementGroup',
    {
        'group': 'ArrangementGroupArgs',
    },
)

# A change of the arrangement of objects.
Arrangement: TypeAlias = "Literal['hide', 'show', 'lock', 'unlock', 'ungroup'] | ArrangementGroup"

# A channel of the bird's-eye-view layout, in UniScene's order; the discriminant is the bit. Layers 0 to 7 are
# map layers that the user paints; 8 to 17 are the footprints of boxes.
BevLayer: TypeAlias = "Literal['drivable_area', 'ped_crossing', 'walkway', 'stop_line', 'carpark_area', 'road_divider', 'lane_divider', 'road_block', 'car', 'truck', 'construction_vehicle', 'bus', 'trailer', 'barrier', 'motorcycle', 'bicycle', 'pedestrian', 'traffic_cone']"

# Names a box; the same id in several frames is one track.
BoxId: TypeAlias = 'int'

# Name and paint.
BoxLabel = TypedDict(
    'BoxLabel',
    {
        # Name of the box; empty means that its class names it.
        'name': 'NotRequired[str]',
        # Its colour; none means that pictures choose one.
        'paint': 'NotRequired[Paint | None]',
    },
)

# A box as it is at the moment that is shown.
BoxState = TypedDict(
    'BoxState',
    {
        # Its middle, world frame, m.
        'center_m': 'Sequence[float]',
        # Its class.
        'class': 'Class',
        # Its number, by which edits name it.
        'id': 'int',
        # Its name and its paint.
        'label': 'BoxLabel',
        # True if it has a track.
        'moves': 'bool',
        # Its place in words, as seen from the ego vehicle.
        'place': 'str',
        # Length, width, height, m.
        'size_m': 'Sequence[float]',
        # Velocity over ground, world frame, m/s.
        'velocity_mps': 'Sequence[float]',
        # Heading, degrees counter-clockwise from x.
        'yaw_deg': 'float',
    },
)

# A bridge. What is below stays as it is.
Bridge = TypedDict(
    'Bridge',
    {
        # True if vehicles drive on it: its surface is road, else sidewalk.
        'for_vehicles': 'NotRequired[bool]',
        # Top of the deck above the ground at the middle of the line, m. The deck is level.
        'height_m': 'float',
        # Middle of the deck, world frame, m; at least two vertices.
        'points_m': 'Sequence[Sequence[float]]',
        # Thickness of the deck, m.
        'thickness_m': 'float',
        # Width of the deck, m.
        'width_m': 'float',
    },
)

# A building.
Building = TypedDict(
    'Building',
    {
        # Facade.
        'facade': 'NotRequired[Facade]',
        # Height of the walls above the ground at its middle, m.
        'height_m': 'float',
        # Corners on the ground, world frame, m; closed without repeating the first, edges do not cross.
        'outline_m': 'Sequence[Sequence[float]]',
        # Roof.
        'roof': 'NotRequired[Roof]',
    },
)

# A camera; optical axes x right, y down, z forward.
Camera = TypedDict(
    'Camera',
    {
        # Principal point in pixels.
        'center_px': 'Sequence[float]',
        # Focal lengths in pixels.
        'focal_px': 'Sequence[float]',
        # Image size in pixels.
        'height': 'int',
        # How the lens bends rays.
        'lens': 'NotRequired[Lens]',
        # Name, as in the data set: `CAM_FRONT`.
        'name': 'str',
        # Optical frame to ego: quaternion w, x, y, z.
        'rotation_wxyz': 'Sequence[float]',
        # How the picture is read; all at one instant if there is none.
        'shutter': 'NotRequired[Shutter | None]',
        # Optical centre in the ego frame, m.
        'translation_m': 'Sequence[float]',
        # Image size in pixels.
        'width': 'int',
    },
)

# How many came, went and changed.
ChangeCounts = TypedDict(
    'ChangeCounts',
    {
        # That came.
        'added': 'int',
        # That are otherwise now.
        'changed': 'int',
        # That went.
        'removed': 'int',
    },
)

# Changes by a call. Of more than 100 boxes the first are named.
ChangeSummary = TypedDict(
    'ChangeSummary',
    {
        # Boxes by what became of them.
        'boxes': 'ChangeCounts',
        # Ids of boxes that came.
        'boxes_added': 'Sequence[int]',
        # Ids of boxes that moved, turned, or changed otherwise.
        'boxes_changed': 'Sequence[int]',
        # Ids of boxes that went.
        'boxes_removed': 'Sequence[int]',
        # Voxels gained and lost, by class that changed.
        'classes': 'dict[str, Gained]',
        # True if time of day, weather or the prompt changed.
        'conditions': 'bool',
        # Cells set and cleared, by layer that changed.
        'layers': 'dict[str, Gained]',
        # Cells of the map, 0.4 x 0.4 m each, in which a layer changed.
        'layout_cells': 'int',
        # True if the length of the scene changed.
        'length': 'bool',
        # True if the map covers another area than before: then cells and voxels are compared where it lies now.
        'map_resized': 'bool',
        # True if cameras or LiDARs changed.
        'rig': 'bool',
        # Things beside the road (buildings, trees, posts) by what became of them.
        'things': 'ChangeCounts',
        # Motions by what became of them; the ego vehicle counts as one.
        'tracks': 'ChangeCounts',
        # Voxels that changed, 0.4 m each way.
        'voxels': 'int',
    },
)

# A finding of a check.
CheckFinding = TypedDict(
    'CheckFinding',
    {
        # The box that it is about.
        'box': 'int | None',
        # Name of the check.
        'check': 'str',
        # Names of repairs, the best first.
        'fixes': 'Sequence[str]',
        # `error`, `warning` or `info`.
        'severity': 'str',
        # The problem, in a line.
        'text': 'str',
        # Time, s; none if it is about the moment that is shown.
        'time_s': 'float | None',
        # Why it may stand, if it was waived.
        'waived': 'str | None',
        # Position, world frame, m.
        'where_m': 'Sequence[float]',
    },
)

# Receipt of `check`.
Checked = TypedDict(
    'Checked',
    {
        # Open findings that are errors.
        'errors': 'int',
        # Findings, errors first; at most 200.
        'findings': 'Sequence[CheckFinding]',
        # Changes by the repairs, if they were asked for.
        'fixed': 'Done | None',
        # Open findings that are worth knowing and no mistakes: boxes that no sensor sees.
        'infos': 'int',
        # Number of the state that was checked.
        'revision': 'int',
        # Findings that were waived: they may stand.
        'waived': 'int',
        # Open findings that are warnings.
        'warnings': 'int',
    },
)

# An Occ3D class; the discriminant is the label value. Names and ids follow nuScenes.
Class: TypeAlias = "Literal['others', 'barrier', 'bicycle', 'bus', 'car', 'construction_vehicle', 'motorcycle', 'pedestrian', 'traffic_cone', 'trailer', 'truck', 'driveable_surface', 'other_flat', 'sidewalk', 'terrain', 'manmade', 'vegetation', 'free']"

# Time.
ClipState = TypedDict(
    'ClipState',
    {
        # True if the ego vehicle moves.
        'ego_moves': 'bool',
        # How long the scene lasts, s; 0 for one moment.
        'length_s': 'float',
        # Frames per second of what is exported.
        'rate_hz': 'float',
        # The moment that is shown, s.
        'time_s': 'float',
        # Objects that move.
        'tracks': 'int',
    },
)

# Light and air of a scene: its look, apart from the objects in it.
Conditions = TypedDict(
    'Conditions',
    {
        # Varies colours, textures and where the sun stands.
        'seed': 'int',
        # Where the sun stands; none: as the time of day and the seed have it.
        'sun': 'NotRequired[Sun | None]',
        # Time of day.
        'time': 'TimeOfDay',
        # How far one sees, m: there 2 % of a contrast is left.
        'visibility_m': 'float',
        # Weather.
        'weather': 'Weather',
        # How wet the ground is, 0 (dry) to 1 (puddles).
        'wetness': 'float',
    },
)

# Receipt of `diff`.
DiffReceipt = TypedDict(
    'DiffReceipt',
    {
        # Name of the version or file it was compared with.
        'against': 'str',
        # From there to the scene as it is now.
        'changed': 'ChangeSummary',
        # Number of the state that the scene is in.
        'revision': 'int',
    },
)

# Result of a call that may change the scene.
Done = TypedDict(
    'Done',
    {
        # Changes, in numbers.
        'changed': 'ChangeSummary',
        # Columns of voxels, 0.4 x 0.4 m each, that only sketch what was edited; `generate` draws them.
        'draft_columns': 'int',
        # Number of the state that the scene is in now. A state that comes back by undo has its old number.
        'revision': 'int',
        # Name of the undo step; empty if nothing changed.
        'step': 'str',
        # Warnings to look at, such as findings of the checks that were not there before.
        'warnings': 'Sequence[str]',
    },
)

EditRemoveBoxArgs = TypedDict(
    'EditRemoveBoxArgs',
    {
        # The box.
        'id': 'BoxId',
    },
)

# Takes a box out, and its voxels.
EditRemoveBox = TypedDict(
    'EditRemoveBox',
    {
        'remove_box': 'EditRemoveBoxArgs',
    },
)

EditAddBoxArgs = TypedDict(
    'EditAddBoxArgs',
    {
        # Centre in the world frame, m.
        'center_m': 'Sequence[float]',
        # One of the ten object classes.
        'class': 'Class',
        # Its number; none means the next one free.
        'id': 'NotRequired[BoxId | None]',
        # Name and paint.
        'label': 'NotRequired[BoxLabel]',
        # Length, width, height, m.
        'size_m': 'Sequence[float]',
        # Velocity over ground in the world frame's axes, m/s; none means standing.
        'velocity_mps': 'NotRequired[Sequence[float] | None]',
        # Heading, degrees counter-clockwise from x.
        'yaw_deg': 'float',
    },
)

# Puts a box in, and voxels of its class.
EditAddBox = TypedDict(
    'EditAddBox',
    {
        'add_box': 'EditAddBoxArgs',
    },
)

EditMoveBoxArgs = TypedDict(
    'EditMoveBoxArgs',
    {
        # New centre in the world frame, m.
        'center_m': 'NotRequired[Sequence[float] | None]',
        # The box.
        'id': 'BoxId',
        # New length, width, height, m.
        'size_m': 'NotRequired[Sequence[float] | None]',
        # New heading, degrees counter-clockwise from x.
        'yaw_deg': 'NotRequired[float | None]',
    },
)

# Moves, turns or resizes a box; what is left out stays.
EditMoveBox = TypedDict(
    'EditMoveBox',
    {
        'move_box': 'EditMoveBoxArgs',
    },
)

EditLabelBoxArgs = TypedDict(
    'EditLabelBoxArgs',
    {
        # The box.
        'id': 'BoxId',
        # Its name and paint from now on.
        'label': 'BoxLabel',
    },
)

# Names and paints a box; what is left out of the label is none. No voxel changes, and nothing is generated.
EditLabelBox = TypedDict(
    'EditLabelBox',
    {
        'label_box': 'EditLabelBoxArgs',
    },
)

EditArrangeArgs = TypedDict(
    'EditArrangeArgs',
    {
        # The boxes.
        'boxes': 'NotRequired[Sequence[BoxId]]',
        # Change of their arrangement.
        'how': 'Arrangement',
        # The things.
        'things': 'NotRequired[Sequence[ThingId]]',
    },
)

# Groups, hides or locks boxes and things, or the opposite. No voxel changes, and nothing is generated.
EditArrange = TypedDict(
    'EditArrange',
    {
        'arrange': 'EditArrangeArgs',
    },
)

EditSetBoxClassArgs = TypedDict(
    'EditSetBoxClassArgs',
    {
        # One of the ten object classes.
        'class': 'Class',
        # The box.
        'id': 'BoxId',
    },
)

# Turns a box into another class; its size and paint stay, its name goes.
EditSetBoxClass = TypedDict(
    'EditSetBoxClass',
    {
        'set_box_class': 'EditSetBoxClassArgs',
    },
)

EditPaintBevArgs = TypedDict(
    'EditPaintBevArgs',
    {
        # One of the eight map layers.
        'layer': 'BevLayer',
        # Cells to set or clear.
        'shape': 'Shape',
        # True sets, false clears.
        'value': 'bool',
    },
)

# Sets or clears a map layer. Clearing dividers or stop lines cuts the lines behind them there.
EditPaintBev = TypedDict(
    'EditPaintBev',
    {
        'paint_bev': 'EditPaintBevArgs',
    },
)

EditAddThingsArgs = TypedDict(
    'EditAddThingsArgs',
    {
        # Kinds and places, world frame.
        'forms': 'Sequence[Form]',
    },
)

# Puts things beside the road, and their voxels. They stay when scenery is drawn anew.
EditAddThings = TypedDict(
    'EditAddThings',
    {
        'add_things': 'EditAddThingsArgs',
    },
)

EditDrawSceneryArgs = TypedDict(
    'EditDrawSceneryArgs',
    {
        # Kinds and places, world frame.
        'forms': 'Sequence[Form]',
    },
)

# Puts scenery drawn by a seed beside the road, and its voxels. It goes when scenery is drawn anew.
EditDrawScenery = TypedDict(
    'EditDrawScenery',
    {
        'draw_scenery': 'EditDrawSceneryArgs',
    },
)

EditRemoveThingsArgs = TypedDict(
    'EditRemoveThingsArgs',
    {
        # The things.
        'ids': 'Sequence[ThingId]',
    },
)

# Takes things out, and their voxels.
EditRemoveThings = TypedDict(
    'EditRemoveThings',
    {
        'remove_things': 'EditRemoveThingsArgs',
    },
)

EditMoveThingsArgs = TypedDict(
    'EditMoveThingsArgs',
    {
        # How far in the world frame, m.
        'by_m': 'Sequence[float]',
        # The things.
        'ids': 'Sequence[ThingId]',
        # Turn about the middle of them all, degrees counter-clockwise.
        'turn_deg': 'NotRequired[float]',
    },
)

# Moves and turns things together.
EditMoveThings = TypedDict(
    'EditMoveThings',
    {
        'move_things': 'EditMoveThingsArgs',
    },
)

EditRaiseThingsArgs = TypedDict(
    'EditRaiseThingsArgs',
    {
        # By how much, m; a storey is 3 m.
        'by_m': 'float',
        # The things.
        'ids': 'Sequence[ThingId]',
    },
)

# Makes things higher (or, with a negative number, lower).
EditRaiseThings = TypedDict(
    'EditRaiseThings',
    {
        'raise_things': 'EditRaiseThingsArgs',
    },
)

EditChangeThingArgs = TypedDict(
    'EditChangeThingArgs',
    {
        # Its new kind and place, world frame.
        'form': 'Form',
        # The thing.
        'id': 'ThingId',
    },
)

# Gives a thing another form.
EditChangeThing = TypedDict(
    'EditChangeThing',
    {
        'change_thing': 'EditChangeThingArgs',
    },
)

EditClearSceneryArgs = TypedDict(
    'EditClearSceneryArgs',
    {
        # Area to clear; everywhere if left out.
        'shape': 'NotRequired[Shape | None]',
    },
)

# Takes man-made and plant voxels out that belong to no thing, and lays the ground where they stood. Painted
# voxels stay.
EditClearScenery = TypedDict(
    'EditClearScenery',
    {
        'clear_scenery': 'EditClearSceneryArgs',
    },
)

EditAddPolylinesArgs = TypedDict(
    'EditAddPolylinesArgs',
    {
        # Kinds and vertices of the lines, world frame, m; at least two vertices each.
        'lines': 'Sequence[Polyline]',
    },
)

# Puts lines on the ground: lane centres, and dividers, stop lines and crossings with the cells of their layer.
EditAddPolylines = TypedDict(
    'EditAddPolylines',
    {
        'add_polylines': 'EditAddPolylinesArgs',
    },
)

EditChangeRoadsArgs = TypedDict(
    'EditChangeRoadsArgs',
    {
        # Change to apply.
        'change': 'RoadChange',
    },
)

# Changes the road network. What it draws differently from before is drawn anew: layers, lines, ground. In a
# scene that has no network yet, what is painted is recognised first.
EditChangeRoads = TypedDict(
    'EditChangeRoads',
    {
        'change_roads': 'EditChangeRoadsArgs',
    },
)

EditPaintVoxelsArgs = TypedDict(
    'EditPaintVoxelsArgs',
    {
        # Indices `[x, y, z]`.
        'cells': 'Sequence[Sequence[int]]',
        # Any class.
        'class': 'Class',
    },
)

# Sets voxels to a class (`free` removes them) and locks them.
EditPaintVoxels = TypedDict(
    'EditPaintVoxels',
    {
        'paint_voxels': 'EditPaintVoxelsArgs',
    },
)

EditUnlockVoxelsArgs = TypedDict(
    'EditUnlockVoxelsArgs',
    {
        # Indices `[x, y, z]`.
        'cells': 'Sequence[Sequence[int]]',
    },
)

# Gives painted voxels back to generation; what they show stays for now.
EditUnlockVoxels = TypedDict(
    'EditUnlockVoxels',
    {
        'unlock_voxels': 'EditUnlockVoxelsArgs',
    },
)

# Gives every painted voxel of the frame back to generation.
EditClearPaint = TypedDict(
    'EditClearPaint',
    {
        'clear_paint': 'dict[str, Any]',
    },
)

EditCorrectArgs = TypedDict(
    'EditCorrectArgs',
    {
        # A change of a box or of a map layer.
        'edit': 'Edit',
    },
)

# Corrects what was inferred wrongly when the frame was imported: the box or layer changes, in the source too,
# and no voxel does, so that nothing is generated.
EditCorrect = TypedDict(
    'EditCorrect',
    {
        'correct': 'EditCorrectArgs',
    },
)

EditAtArgs = TypedDict(
    'EditAtArgs',
    {
        # Edit to apply there.
        'edit': 'Edit',
        # Number of the frame.
        'frame': 'NotRequired[int | None]',
        # For which moments a moving object changes its place; the whole track if left out.
        'scope': 'NotRequired[Scope | None]',
        # Time in the clip, s.
        'time_s': 'NotRequired[float | None]',
        # A moving object that the edit is of: the moment is one at which it is there.
        'track': 'NotRequired[BoxId | None]',
    },
)

# An edit at another moment than the one that is shown, and what it means for other moments. What stands still
# is changed for all moments anyway. At most one of `frame`, `time_s` and `track` is given, and at least one of
# all keys.
EditAt = TypedDict(
    'EditAt',
    {
        'at': 'EditAtArgs',
    },
)

EditSetShapeArgs = TypedDict(
    'EditSetShapeArgs',
    {
        # Voxels of 0.4 m that are its class's, as `[ahead, left, up]` from its middle seen from above and from
        # its underside: `[0, 0, 0]` is ahead of and left of the middle, and the underside is in it. None: its
        # class's again.
        'cells': 'Sequence[Sequence[int]]',
        # The box.
        'id': 'BoxId',
    },
)

# Gives a box voxels of its own, in place of those of its class: they go wherever it goes and are not generated.
# Another size or class takes them away again.
EditSetShape = TypedDict(
    'EditSetShape',
    {
        'set_shape': 'EditSetShapeArgs',
    },
)

EditSetMotionArgs = TypedDict(
    'EditSetMotionArgs',
    {
        # When it appears, s; it is there from the beginning if left out. Not of the ego vehicle.
        'from_s': 'NotRequired[float | None]',
        # The box; the ego vehicle if left out.
        'id': 'NotRequired[BoxId | None]',
        # How it moves from now on, world frame.
        'motion': 'NotRequired[Motion | None]',
        # When it disappears, s; it is there to the end if left out. Not of the ego vehicle.
        'to_s': 'NotRequired[float | None]',
    },
)

# Lets an object or the ego vehicle move, or (without a motion) stand where it is at the moment that is shown.
EditSetMotion = TypedDict(
    'EditSetMotion',
    {
        'set_motion': 'EditSetMotionArgs',
    },
)

EditForecastArgs = TypedDict(
    'EditForecastArgs',
    {
        # How many, s.
        'seconds': 'float',
    },
)

# So many seconds more: what moves at the end goes on along its lane and behind whoever is ahead, the ego
# vehicle too, and the map grows to where it comes.
EditForecast = TypedDict(
    'EditForecast',
    {
        'forecast': 'EditForecastArgs',
    },
)

EditExtendMapArgs = TypedDict(
    'EditExtendMapArgs',
    {
        # So much farther along x, m.
        'ahead_m': 'NotRequired[float]',
        # So much farther against x, m.
        'behind_m': 'NotRequired[float]',
        # So much farther along y, m.
        'left_m': 'NotRequired[float]',
        # So much farther against y, m.
        'right_m': 'NotRequired[float]',
    },
)

# Makes the map larger, in the world frame. Roads go on beyond the edge as they reach it; what is new is to be
# generated.
EditExtendMap = TypedDict(
    'EditExtendMap',
    {
        'extend_map': 'EditExtendMapArgs',
    },
)

EditLetMoveArgs = TypedDict(
    'EditLetMoveArgs',
    {
        # When what it is about begins, s; soon if left out.
        'from_s': 'NotRequired[float | None]',
        # It begins when so much is between it and the ego vehicle, m, in place of at a time; who follows keeps
        # so much to the one ahead. Bumper to bumper.
        'gap_m': 'NotRequired[float | None]',
        # The box; the ego vehicle if left out.
        'id': 'NotRequired[BoxId | None]',
        # Speed, m/s; a usual one of its class if left out.
        'mps': 'NotRequired[float | None]',
        # How.
        'template': 'Template',
    },
)

# Lets a box move in a way that has a name, from where it is at the moment that is shown, along the lanes of the
# map. A scene of one moment becomes a clip.
EditLetMove = TypedDict(
    'EditLetMove',
    {
        'let_move': 'EditLetMoveArgs',
    },
)

# Lets everything that says how fast it is but stands go on along its lane, each at a distance to the one ahead.
# What would come into something, a wall, a parked vehicle or one another, stays where it is.
EditLetTrafficDrive = TypedDict(
    'EditLetTrafficDrive',
    {
        'let_traffic_drive': 'dict[str, Any]',
    },
)

EditSetLengthArgs = TypedDict(
    'EditSetLengthArgs',
    {
        # Length, s; 0 for a scene of one moment.
        'length_s': 'float',
        # Frames per second of what is written; as before if left out.
        'rate_hz': 'NotRequired[float | None]',
    },
)

# Sets how long the scene lasts. What happens later than that stays, and is not shown.
EditSetLength = TypedDict(
    'EditSetLength',
    {
        'set_length': 'EditSetLengthArgs',
    },
)

# Confirms what was inferred when the frame was imported: it is marked as a guess no more.
EditConfirmInferred = TypedDict(
    'EditConfirmInferred',
    {
        'confirm_inferred': 'dict[str, Any]',
    },
)

EditWaiveArgs = TypedDict(
    'EditWaiveArgs',
    {
        # The box it is about, if it is about one.
        'box': 'NotRequired[BoxId | None]',
        # Name of the check.
        'check': 'str',
        # Why it may stay; not empty.
        'reason': 'str',
        # Place of the finding, world frame, m.
        'where_m': 'Sequence[float]',
    },
)

# Lets a finding of the checks stand, with the reason. One that was waived before gets the new reason.
EditWaive = TypedDict(
    'EditWaive',
    {
        'waive': 'EditWaiveArgs',
    },
)

EditUnwaiveArgs = TypedDict(
    'EditUnwaiveArgs',
    {
        # The box it is about, if it is about one.
        'box': 'NotRequired[BoxId | None]',
        # Name of the check.
        'check': 'str',
        # Place of the finding, world frame, m.
        'where_m': 'Sequence[float]',
    },
)

# Takes a waiver back: the finding counts again. Nothing if there is none.
EditUnwaive = TypedDict(
    'EditUnwaive',
    {
        'unwaive': 'EditUnwaiveArgs',
    },
)

EditSetPromptArgs = TypedDict(
    'EditSetPromptArgs',
    {
        # The text; empty means none.
        'prompt': 'str',
    },
)

# Replaces the text that describes the style.
EditSetPrompt = TypedDict(
    'EditSetPrompt',
    {
        'set_prompt': 'EditSetPromptArgs',
    },
)

EditSetConditionsArgs = TypedDict(
    'EditSetConditionsArgs',
    {
        # The new ones.
        'conditions': 'Conditions',
    },
)

# Replaces light and air. No voxel changes.
EditSetConditions = TypedDict(
    'EditSetConditions',
    {
        'set_conditions': 'EditSetConditionsArgs',
    },
)

EditKeepWordsArgs = TypedDict(
    'EditKeepWordsArgs',
    {
        # The words.
        'words': 'str',
    },
)

# Notes words that were typed to change the scene.
EditKeepWords = TypedDict(
    'EditKeepWords',
    {
        'keep_words': 'EditKeepWordsArgs',
    },
)

EditSetRigArgs = TypedDict(
    'EditSetRigArgs',
    {
        # The new ones.
        'rig': 'SensorRig',
    },
)

# Replaces the sensors of the vehicle. No voxel changes.
EditSetRig = TypedDict(
    'EditSetRig',
    {
        'set_rig': 'EditSetRigArgs',
    },
)

# One change of the frame that is shown (or, for the prompt and the sensors, of the scene). As JSON:
# `{"remove_box": {"id": 7}}`; unknown keys are refused by name.
Edit: TypeAlias = 'EditRemoveBox | EditAddBox | EditMoveBox | EditLabelBox | EditArrange | EditSetBoxClass | EditPaintBev | EditAddThings | EditDrawScenery | EditRemoveThings | EditMoveThings | EditRaiseThings | EditChangeThing | EditClearScenery | EditAddPolylines | EditChangeRoads | EditPaintVoxels | EditUnlockVoxels | EditClearPaint | EditCorrect | EditAt | EditSetShape | EditSetMotion | EditForecast | EditExtendMap | EditLetMove | EditLetTrafficDrive | EditSetLength | EditConfirmInferred | EditWaive | EditUnwaive | EditSetPrompt | EditSetConditions | EditKeepWords | EditSetRig'

# Receipt of `export`.
Exported = TypedDict(
    'Exported',
    {
        # The files.
        'files': 'Sequence[FileEntry]',
        # Content of the files.
        'holds': 'str',
        # Content that is lost when they are read again; empty if none is.
        'lost': 'str',
        # Number of the state that was written.
        'revision': 'int',
    },
)

# Look of a facade.
Facade: TypeAlias = "Literal['plain', 'balconies', 'bays', 'arcade', 'glass']"

# A file of the folder.
FileEntry = TypedDict(
    'FileEntry',
    {
        # Its size, bytes.
        'bytes': 'int',
        # Its name from the folder, with `/` between folders.
        'name': 'str',
    },
)

# Receipt of `list_files`.
FileList = TypedDict(
    'FileList',
    {
        # Files of the folder and of folders in it, by name.
        'files': 'Sequence[FileEntry]',
        # True if there are more than are listed.
        'more': 'bool',
    },
)

# An object that fits where one was meant.
Fits = TypedDict(
    'Fits',
    {
        # How to name it: `#12`.
        'name': 'str',
        # Its place, in words.
        'place': 'str',
    },
)

# A building with vertical walls.
FormBuilding = TypedDict(
    'FormBuilding',
    {
        'building': 'Building',
    },
)

# A tree.
FormTree = TypedDict(
    'FormTree',
    {
        'tree': 'Tree',
    },
)

# An area of shrubs and undergrowth.
FormShrubs = TypedDict(
    'FormShrubs',
    {
        'shrubs': 'Shrubs',
    },
)

# A hedge, wall, fence or rail.
FormLine = TypedDict(
    'FormLine',
    {
        'line': 'SceneryLine',
    },
)

# A pole, sign, lamp, stop, bench or bin.
FormPost = TypedDict(
    'FormPost',
    {
        'post': 'Post',
    },
)

# A road or path carried over the ground.
FormBridge = TypedDict(
    'FormBridge',
    {
        'bridge': 'Bridge',
    },
)

# Kind and place of a thing. As JSON: `{"tree": {"position_m": [8, -6], "height_m": 7, …}}`.
Form: TypeAlias = 'FormBuilding | FormTree | FormShrubs | FormLine | FormPost | FormBridge'

# How many came and went.
Gained = TypedDict(
    'Gained',
    {
        # That came.
        'gained': 'int',
        # That went.
        'lost': 'int',
    },
)

# Receipt of `generate`.
Generated = TypedDict(
    'Generated',
    {
        # Changes, in numbers.
        'changed': 'ChangeSummary',
        # Columns of voxels, 0.4 x 0.4 m each, that only sketch what was edited; `generate` draws them.
        'draft_columns': 'int',
        # Calls of the denoising network.
        'network_calls': 'int',
        # Remarks on the generation.
        'notes': 'Sequence[str]',
        # Columns that were generated.
        'region_columns': 'int',
        # Number of the state that the scene is in now. A state that comes back by undo has its old number.
        'revision': 'int',
        # Name of the undo step; empty if nothing changed.
        'step': 'str',
        # Voxels outside of them that changed: 0.
        'untouched_voxels_changed': 'int',
        # Time by stage, s.
        'wall_s': 'dict[str, float]',
        # Warnings to look at, such as findings of the checks that were not there before.
        'warnings': 'Sequence[str]',
    },
)

# A pose at a time.
Key = TypedDict(
    'Key',
    {
        # Centre in the world frame, m.
        'at_m': 'Sequence[float]',
        # Time in the clip, s.
        'time_s': 'float',
        # Heading, degrees counter-clockwise from x.
        'yaw_deg': 'float',
    },
)

# Purpose of a lane.
LaneKind: TypeAlias = "Literal['drive', 'bus', 'bicycle', 'shoulder', 'parking', 'walk', 'verge']"

LensDistortedArgs = TypedDict(
    'LensDistortedArgs',
    {
        # k1, k2, k3, k4, k5, k6. OpenCV's own lists have p1 and p2 after k2.
        'k': 'Sequence[float]',
        # p1, p2.
        'p': 'Sequence[float]',
    },
)

# OpenCV's model: radial k1, k2, k3 over k4, k5, k6 (Brown and Conrady where the last three are 0), tangential
# p1, p2.
LensDistorted = TypedDict(
    'LensDistorted',
    {
        'distorted': 'LensDistortedArgs',
    },
)

LensFisheyeArgs = TypedDict(
    'LensFisheyeArgs',
    {
        # k1, k2, k3, k4.
        'k': 'Sequence[float]',
        # Largest angle from the optical axis that is seen, degrees; at most 180.
        'max_angle_deg': 'float',
    },
)

# OpenCV's fisheye (J. Kannala and S. Brandt, 2006): radius = a + k1 a^3 + k2 a^5 + k3 a^7 + k4 a^9 at the angle
# a, rad, from the optical axis.
LensFisheye = TypedDict(
    'LensFisheye',
    {
        'fisheye': 'LensFisheyeArgs',
    },
)

LensFThetaArgs = TypedDict(
    'LensFThetaArgs',
    {
        # c1 to c6; c1 is 1 where the focal length is that of the middle.
        'c': 'Sequence[float]',
        # Largest angle from the optical axis that is seen, degrees; at most 180.
        'max_angle_deg': 'float',
    },
)

# f-theta: radius = c1 a + c2 a^2 + … + c6 a^6 at the angle a, rad, from the optical axis.
LensFTheta = TypedDict(
    'LensFTheta',
    {
        'f_theta': 'LensFThetaArgs',
    },
)

# A model of a lens. Coefficients are those of the field, without unit.
Lens: TypeAlias = "Literal['pinhole'] | LensDistorted | LensFisheye | LensFTheta"

# How a spinning LiDAR samples directions and time.
LidarPattern = TypedDict(
    'LidarPattern',
    {
        # Pulses that leave the grid meet a continuation of the scene: roads, houses, trees.
        'beyond_grid': 'NotRequired[bool]',
        # Columns follow each other clockwise, seen from above.
        'clockwise': 'NotRequired[bool]',
        # Columns per revolution; column i looks at azimuth first + 2 pi i / n in the sensor frame.
        'columns': 'int',
        # Elevation of each beam in degrees, lowest first; ring i is entry i.
        'elevations_deg': 'Sequence[float]',
        # Azimuth of column 0 in the sensor frame, degrees.
        'first_azimuth_deg': 'NotRequired[float]',
        # Farthest return, m.
        'max_range_m': 'float',
        # Nearest return, m.
        'min_range_m': 'float',
        # Name, as in the data set: `LIDAR_TOP`.
        'name': 'str',
        # The own vehicle's roof is in the way of a sensor above it and sends pulses back, as in real sweeps;
        # else it is looked through.
        'own_body': 'NotRequired[bool]',
        # Sensor frame to ego: quaternion w, x, y, z.
        'rotation_wxyz': 'Sequence[float]',
        # Sector that returns anything, degrees from the first azimuth; 360 is all round.
        'sector_deg': 'NotRequired[float]',
        # Revolutions per second; 0 = the whole sweep at one instant. Otherwise column i is fired when the
        # vehicle was (1 - i / n) of a revolution short of where it stands (see `SensorRig::ego_speed_mps`).
        'spin_hz': 'NotRequired[float]',
        # Origin in the ego frame, m.
        'translation_m': 'Sequence[float]',
    },
)

# Kind of a thing that runs along a line.
LineKind: TypeAlias = "Literal['hedge', 'wall', 'fence', 'guard_rail', 'retaining_wall']"

# Purpose of the words.
Make: TypeAlias = "Literal['change', 'new']"

# The area that a map covers, world frame.
MapArea = TypedDict(
    'MapArea',
    {
        # Cells along x and y, 0.4 m each.
        'cells': 'Sequence[int]',
        # Where the ego vehicle is: x, y, z in m.
        'ego_m': 'Sequence[float]',
        # Its upper corner, m.
        'max_m': 'Sequence[float]',
        # Its lower corner, x and y, m.
        'min_m': 'Sequence[float]',
    },
)

# Lines of the map, world frame, m; long ones are thinned out.
MapLines = TypedDict(
    'MapLines',
    {
        # Outlines of crossings.
        'crossings': 'Sequence[Sequence[Sequence[float]]]',
        # Middles of lanes, in driving direction.
        'lanes': 'Sequence[Sequence[Sequence[float]]]',
        # True if there are more lines than are listed.
        'more': 'bool',
        # Lines between opposite directions.
        'road_dividers': 'Sequence[Sequence[Sequence[float]]]',
        # Stop lines.
        'stop_lines': 'Sequence[Sequence[Sequence[float]]]',
    },
)

# Receipt of `place_model`.
ModelPlaced = TypedDict(
    'ModelPlaced',
    {
        # Number of its box.
        'box': 'BoxId',
        # Its middle, world frame, m.
        'center_m': 'Sequence[float]',
        # Changes, in numbers.
        'changed': 'ChangeSummary',
        # Its class.
        'class': 'Class',
        # Columns of voxels, 0.4 x 0.4 m each, that only sketch what was edited; `generate` draws them.
        'draft_columns': 'int',
        # Its heading, degrees counter-clockwise from x.
        'heading_deg': 'float',
        # Number of the state that the scene is in now. A state that comes back by undo has its old number.
        'revision': 'int',
        # Voxels of its shape.
        'shape_voxels': 'int',
        # Length, width, height, m.
        'size_m': 'Sequence[float]',
        # Name of the undo step; empty if nothing changed.
        'step': 'str',
        # Warnings to look at, such as findings of the checks that were not there before.
        'warnings': 'Sequence[str]',
    },
)

# Through keyframes, smoothly and without overshoot: it stands before the first, after the last, and between two
# that are at the same place.
MotionKeys = TypedDict(
    'MotionKeys',
    {
        'keys': 'Sequence[Key]',
    },
)

# Along a path, with a profile of speeds.
MotionPath = TypedDict(
    'MotionPath',
    {
        'path': 'Path',
    },
)

MotionAttachedArgs = TypedDict(
    'MotionAttachedArgs',
    {
        # Its centre in the other's frame (along its heading, to its left), m.
        'at_m': 'Sequence[float]',
        # Track that it is fixed to.
        'to': 'BoxId',
        # Its heading against the other's, degrees.
        'yaw_deg': 'NotRequired[float]',
    },
)

# Fixed to another track, such as a trailer to its truck or a rider to a bicycle.
MotionAttached = TypedDict(
    'MotionAttached',
    {
        'attached': 'MotionAttachedArgs',
    },
)

# How a thing moves, in the world frame.
Motion: TypeAlias = 'MotionKeys | MotionPath | MotionAttached'

# Receipt of `undo` and `redo`.
Moved = TypedDict(
    'Moved',
    {
        # Changes, in numbers.
        'changed': 'ChangeSummary',
        # Columns of voxels, 0.4 x 0.4 m each, that only sketch what was edited; `generate` draws them.
        'draft_columns': 'int',
        # Number of the state that the scene is in now. A state that comes back by undo has its old number.
        'revision': 'int',
        # Name of the undo step; empty if nothing changed.
        'step': 'str',
        # Names of the steps that were undone or redone, in that order.
        'steps': 'Sequence[str]',
        # Warnings to look at, such as findings of the checks that were not there before.
        'warnings': 'Sequence[str]',
    },
)

# Receipt of `new`.
NewSceneReceipt = TypedDict(
    'NewSceneReceipt',
    {
        # Boxes in it: vehicles, people, barriers, cones.
        'boxes': 'int',
        # Changes, in numbers.
        'changed': 'ChangeSummary',
        # Columns of voxels, 0.4 x 0.4 m each, that only sketch what was edited; `generate` draws them.
        'draft_columns': 'int',
        # Name of the scene.
        'name': 'str',
        # Voxels that are not free.
        'occupied_voxels': 'int',
        # Number of the state that the scene is in now. A state that comes back by undo has its old number.
        'revision': 'int',
        # Name of the undo step; empty if nothing changed.
        'step': 'str',
        # Things beside the road: buildings, trees, posts.
        'things': 'int',
        # Warnings to look at, such as findings of the checks that were not there before.
        'warnings': 'Sequence[str]',
    },
)

# Number of a node in its network.
NodeId: TypeAlias = 'int'

NodeKindPlainArgs = TypedDict(
    'NodeKindPlainArgs',
    {
        # Radius of the kerb at its corners, m.
        'corner_m': 'float',
    },
)

# An end, a joint, or a junction with rounded corners.
NodeKindPlain = TypedDict(
    'NodeKindPlain',
    {
        'plain': 'NodeKindPlainArgs',
    },
)

NodeKindRoundaboutArgs = TypedDict(
    'NodeKindRoundaboutArgs',
    {
        # Radius of the island, m.
        'island_m': 'float',
        # Width of the ring, m.
        'ring_m': 'float',
    },
)

# A ring around an island, driven counter-clockwise.
NodeKindRoundabout = TypedDict(
    'NodeKindRoundabout',
    {
        'roundabout': 'NodeKindRoundaboutArgs',
    },
)

# Kind of a place where roads meet.
NodeKind: TypeAlias = 'NodeKindPlain | NodeKindRoundabout'

# Words that had no effect.
NotUnderstood = TypedDict(
    'NotUnderstood',
    {
        # `unknown` (in no list), `not_carried_out` (understood, and nothing of it was done) or `too_long` (not
        # read).
        'why': 'str',
        # The words.
        'words': 'str',
    },
)

# Receipt of `open`.
OpenReceipt = TypedDict(
    'OpenReceipt',
    {
        # Boxes in it.
        'boxes': 'int',
        # Changes, in numbers.
        'changed': 'ChangeSummary',
        # Columns of voxels, 0.4 x 0.4 m each, that only sketch what was edited; `generate` draws them.
        'draft_columns': 'int',
        # Format of the file.
        'format': 'str',
        # How long it lasts, s; 0 for one moment.
        'length_s': 'float',
        # Name of the scene.
        'name': 'str',
        # Notes on adjustments of the content that were not asked for.
        'notes': 'NotRequired[Sequence[str]]',
        # Number of the state that the scene is in now. A state that comes back by undo has its old number.
        'revision': 'int',
        # Name of the undo step; empty if nothing changed.
        'step': 'str',
        # Things beside the road.
        'things': 'int',
        # Warnings to look at, such as findings of the checks that were not there before.
        'warnings': 'Sequence[str]',
    },
)

# The colour of a box in camera pictures. Nothing else follows from it.
Paint: TypeAlias = "Literal['white', 'silver', 'grey', 'black', 'red', 'orange', 'yellow', 'green', 'blue', 'purple', 'pink', 'brown', 'beige']"

# A path and how fast it is driven. What drives it stands where it starts until the first speed, keeps the last
# one, and stops at the path's ends.
Path = TypedDict(
    'Path',
    {
        # Line of the path, world frame, m; at least two points that differ.
        'points_m': 'Sequence[Sequence[float]]',
        # True if it is driven backwards, with the rear first.
        'rear_first': 'NotRequired[bool]',
        # How fast; at least one.
        'speeds': 'Sequence[Speed]',
        # Where on it the motion starts, m from the first point.
        'start_m': 'NotRequired[float]',
    },
)

# A phrase and what it became.
Phrase = TypedDict(
    'Phrase',
    {
        # Ids of boxes that it put in.
        'added': 'Sequence[int]',
        # Its effect, in words.
        'became': 'str',
        # Ids of boxes that it changed.
        'changed': 'Sequence[int]',
        # How sure the reader is, 0 to 1.
        'confidence': 'float',
        # Parts that could not be done as they were said.
        'remarks': 'Sequence[str]',
        # Ids of boxes that it took away.
        'removed': 'Sequence[int]',
        # The words, if the reader knows them.
        'words': 'str | None',
    },
)

# A line on the ground, world frame.
Polyline = TypedDict(
    'Polyline',
    {
        # Kind of the line.
        'kind': 'PolylineKind',
        # Vertices, m; a closed outline does not repeat its first vertex.
        'points_m': 'Sequence[Sequence[float]]',
    },
)

PolylineKindSpeedLimitArgs = TypedDict(
    'PolylineKindSpeedLimitArgs',
    {
        # The limit, mm/s: whole numbers of km/h and mph come back as they were.
        'mm_per_s': 'int',
    },
)

# A speed limit along the middle of a lane, in driving direction. Not drawn into a layer.
PolylineKindSpeedLimit = TypedDict(
    'PolylineKindSpeedLimit',
    {
        'speed_limit': 'PolylineKindSpeedLimitArgs',
    },
)

# Kind of a polyline.
PolylineKind: TypeAlias = "Literal['lane_center', 'road_divider', 'lane_divider', 'stop_line', 'ped_crossing'] | PolylineKindSpeedLimit"

# A small upright thing.
Post = TypedDict(
    'Post',
    {
        # Height above the ground, m.
        'height_m': 'float',
        # Kind.
        'kind': 'PostKind',
        # Its place on the ground, world frame, m.
        'position_m': 'Sequence[float]',
        # Heading, rad counter-clockwise from world x.
        'yaw_rad': 'NotRequired[float]',
    },
)

# Kind of a small upright thing.
PostKind: TypeAlias = "Literal['pole', 'street_light', 'sign', 'traffic_light', 'bus_stop', 'bench', 'bin', 'bollard', 'stairs']"

# Receipt of `prompt`.
Prompted = TypedDict(
    'Prompted',
    {
        # The answer, in a sentence.
        'answer': 'str',
        # Phrases about things beside the road, as they were read.
        'beside_the_road': 'Sequence[str]',
        # Changes, in numbers.
        'changed': 'ChangeSummary',
        # Columns of voxels, 0.4 x 0.4 m each, that only sketch what was edited; `generate` draws them.
        'draft_columns': 'int',
        # Words that had no effect.
        'not_understood': 'Sequence[NotUnderstood]',
        # The whole reading in a line of notation.
        'notation': 'str',
        # Further remarks.
        'notes': 'Sequence[str]',
        # Phrases, each with its effect.
        'phrases': 'Sequence[Phrase]',
        # Questions that must be answered first: while there is one nothing changes. Say it again and name the
        # box (`#12`).
        'questions': 'Sequence[Question]',
        # Number of the state that the scene is in now. A state that comes back by undo has its old number.
        'revision': 'int',
        # Wishes that were not met, in words.
        'shortfalls': 'Sequence[str]',
        # Name of the undo step; empty if nothing changed.
        'step': 'str',
        # Warnings to look at, such as findings of the checks that were not there before.
        'warnings': 'Sequence[str]',
    },
)

# A question that must be answered first.
Question = TypedDict(
    'Question',
    {
        # Objects that fit.
        'candidates': 'Sequence[Fits]',
        # The question.
        'text': 'str',
    },
)

# A part of a radar's field of view, and how finely it tells targets apart there.
RadarField = TypedDict(
    'RadarField',
    {
        # Difference of azimuth at which two targets are two, degrees.
        'azimuth_step_deg': 'float',
        # Largest azimuth to either side, degrees.
        'half_azimuth_deg': 'float',
        # Farthest return, m.
        'max_range_m': 'float',
        # Difference of range at which two targets are two, m.
        'range_step_m': 'float',
    },
)

# How a radar looks around, and where it is mounted. The frame of the sensor has x ahead, y left, z up.
RadarPattern = TypedDict(
    'RadarPattern',
    {
        # Distance at which a target of 10 m² is found in one of two scans, m.
        'car_range_m': 'float',
        # Difference of elevation at which two targets are two, degrees; 0 for a radar that measures no heights.
        'elevation_step_deg': 'NotRequired[float]',
        # Parts of the field of view; where several hold a target, the first counts.
        'fields': 'Sequence[RadarField]',
        # Elevation at which the antenna's gain has fallen to a half, degrees.
        'half_elevation_deg': 'float',
        # Nearest return, m.
        'min_range_m': 'float',
        # Most returns of a scan; the strongest are kept.
        'most_returns': 'int',
        # Name, as in the data set: `RADAR_FRONT`.
        'name': 'str',
        # Sensor frame to ego: quaternion w, x, y, z.
        'rotation_wxyz': 'Sequence[float]',
        # Scans per second.
        'scan_hz': 'float',
        # Difference of radial speed at which two targets are two, m/s.
        'speed_step_mps': 'float',
        # Lowest and highest radial speed that is measured without doubt, m/s; others come back a whole span
        # away.
        'speeds_mps': 'Sequence[float]',
        # Origin in the ego frame, m.
        'translation_m': 'Sequence[float]',
    },
)

# In which order a rolling shutter reads the picture.
ReadOut: TypeAlias = "Literal['top_to_bottom', 'bottom_to_top', 'left_to_right', 'right_to_left']"

# Receipt of `render`.
RenderReceipt = TypedDict(
    'RenderReceipt',
    {
        # The files.
        'files': 'Sequence[FileEntry]',
        # Rays of the LiDAR and points that came back, if it was asked for.
        'lidar': 'Sequence[int] | None',
        # Returns of all radars, if they were asked for.
        'radar': 'int | None',
        # Number of the state that they show.
        'revision': 'int',
        # The moment that they show, s.
        'time_s': 'float',
        # Time by kind, s.
        'wall_s': 'dict[str, float]',
    },
)

# A road between two nodes, world frame.
Road = TypedDict(
    'Road',
    {
        # Crossings.
        'crossings': 'NotRequired[Sequence[RoadCrossing]]',
        # Nodes at which its reference line begins and ends.
        'ends': 'Sequence[NodeId]',
        # Its number.
        'id': 'RoadId',
        # Lanes left of the line, from the line outward; driven against it.
        'left': 'NotRequired[Sequence[RoadLane]]',
        # Speed limit, km/h.
        'limit_kph': 'NotRequired[float | None]',
        # Lanes are counted from so far to the left of that line, m.
        'offset_m': 'NotRequired[float]',
        # Lanes right of the line, from the line outward; driven along it.
        'right': 'Sequence[RoadLane]',
        # Lines to halt at.
        'stops': 'NotRequired[Sequence[RoadStop]]',
        # Points between, through which the line runs in a smooth curve, m.
        'via_m': 'NotRequired[Sequence[Sequence[float]]]',
    },
)

# Takes what is painted and not in the network yet for roads. No cell changes.
RoadChangeRecognise = TypedDict(
    'RoadChangeRecognise',
    {
        'recognise': 'dict[str, Any]',
    },
)

RoadChangeAddArgs = TypedDict(
    'RoadChangeAddArgs',
    {
        # Lanes left of the line, from the line outward; driven against it.
        'left': 'NotRequired[Sequence[RoadLane]]',
        # Speed limit, km/h.
        'limit_kph': 'NotRequired[float | None]',
        # Its reference line, m; at least two points.
        'points_m': 'Sequence[Sequence[float]]',
        # Lanes right of the line, from the line outward; driven along it.
        'right': 'Sequence[RoadLane]',
    },
)

# Lays a road along points; where it meets or crosses others there are junctions.
RoadChangeAdd = TypedDict(
    'RoadChangeAdd',
    {
        'add': 'RoadChangeAddArgs',
    },
)

RoadChangePutArgs = TypedDict(
    'RoadChangePutArgs',
    {
        # The road of that number from now on; its ends stay.
        'road': 'Road',
    },
)

# Gives a road another course, other lanes, marks or limit.
RoadChangePut = TypedDict(
    'RoadChangePut',
    {
        'put': 'RoadChangePutArgs',
    },
)

RoadChangePutNodeArgs = TypedDict(
    'RoadChangePutNodeArgs',
    {
        # The node of that number from now on.
        'node': 'RoadNode',
    },
)

# Moves a node, or makes it a roundabout or a plain junction.
RoadChangePutNode = TypedDict(
    'RoadChangePutNode',
    {
        'put_node': 'RoadChangePutNodeArgs',
    },
)

RoadChangeSplitArgs = TypedDict(
    'RoadChangeSplitArgs',
    {
        # Near which point of it, m.
        'at_m': 'Sequence[float]',
        # The road.
        'id': 'RoadId',
    },
)

# Makes two roads of one.
RoadChangeSplit = TypedDict(
    'RoadChangeSplit',
    {
        'split': 'RoadChangeSplitArgs',
    },
)

RoadChangeJoinArgs = TypedDict(
    'RoadChangeJoinArgs',
    {
        # The node.
        'node': 'NodeId',
    },
)

# Makes one road of the two that meet at a node; the lanes are those of the longer one.
RoadChangeJoin = TypedDict(
    'RoadChangeJoin',
    {
        'join': 'RoadChangeJoinArgs',
    },
)

RoadChangeConnectArgs = TypedDict(
    'RoadChangeConnectArgs',
    {
        # The node that goes.
        'node': 'NodeId',
        # The node that stays.
        'to': 'NodeId',
    },
)

# Makes two nodes one: their roads meet.
RoadChangeConnect = TypedDict(
    'RoadChangeConnect',
    {
        'connect': 'RoadChangeConnectArgs',
    },
)

RoadChangeStraightenArgs = TypedDict(
    'RoadChangeStraightenArgs',
    {
        # The road.
        'id': 'RoadId',
    },
)

# Lets a road run straight from end to end.
RoadChangeStraighten = TypedDict(
    'RoadChangeStraighten',
    {
        'straighten': 'RoadChangeStraightenArgs',
    },
)

RoadChangeRemoveArgs = TypedDict(
    'RoadChangeRemoveArgs',
    {
        # The road.
        'id': 'RoadId',
    },
)

# Takes a road away.
RoadChangeRemove = TypedDict(
    'RoadChangeRemove',
    {
        'remove': 'RoadChangeRemoveArgs',
    },
)

RoadChangeWishArgs = TypedDict(
    'RoadChangeWishArgs',
    {
        # Place, m: the nearest road is meant.
        'at_m': 'Sequence[float]',
        # Which way one looks there, degrees counter-clockwise from x: right and ahead are meant so.
        'heading_deg': 'NotRequired[float]',
        # The change.
        'wish': 'RoadWish',
    },
)

# A change of the street at a place, independent of the numbers of its roads.
RoadChangeWish = TypedDict(
    'RoadChangeWish',
    {
        'wish': 'RoadChangeWishArgs',
    },
)

RoadChangeRedrawArgs = TypedDict(
    'RoadChangeRedrawArgs',
    {
        # The road.
        'id': 'RoadId',
    },
)

# Draws a road anew: what was painted on it goes.
RoadChangeRedraw = TypedDict(
    'RoadChangeRedraw',
    {
        'redraw': 'RoadChangeRedrawArgs',
    },
)

# A change of the network. Numbers are those of the network as it is; of a scene without one, those of what is
# recognised.
RoadChange: TypeAlias = 'RoadChangeRecognise | RoadChangeAdd | RoadChangePut | RoadChangePutNode | RoadChangeSplit | RoadChangeJoin | RoadChangeConnect | RoadChangeStraighten | RoadChangeRemove | RoadChangeWish | RoadChangeRedraw'

# A crossing over a road.
RoadCrossing = TypedDict(
    'RoadCrossing',
    {
        # Place of its middle, m along the reference line from its beginning.
        'at_m': 'float',
        # How wide it is along the road, m.
        'width_m': 'float',
    },
)

# Number of a road in its network.
RoadId: TypeAlias = 'int'

# One lane of a road.
RoadLane = TypedDict(
    'RoadLane',
    {
        # Purpose.
        'kind': 'LaneKind',
        # How wide it is, m.
        'width_m': 'float',
    },
)

# Where roads end or meet, world frame.
RoadNode = TypedDict(
    'RoadNode',
    {
        # Its place, m.
        'at_m': 'Sequence[float]',
        # Its number.
        'id': 'NodeId',
        # Its kind.
        'kind': 'NotRequired[NodeKind]',
    },
)

# A line at which one side of a road halts.
RoadStop = TypedDict(
    'RoadStop',
    {
        # Place, m along the reference line from its beginning.
        'at_m': 'float',
        # True: the lanes on the right, which are driven along the line.
        'right': 'bool',
    },
)

RoadWishLanesArgs = TypedDict(
    'RoadWishLanesArgs',
    {
        # How many, 1 to 12.
        'count': 'int',
    },
)

# So many lanes for cars in both directions together; as many on the right as on the left, or one more.
RoadWishLanes = TypedDict(
    'RoadWishLanes',
    {
        'lanes': 'RoadWishLanesArgs',
    },
)

# Traffic in the direction in which one looks alone; its lanes stay as many as they are in all.
RoadWishOneWay = TypedDict(
    'RoadWishOneWay',
    {
        'one_way': 'dict[str, Any]',
    },
)

RoadWishWidthsArgs = TypedDict(
    'RoadWishWidthsArgs',
    {
        # How many times.
        'times': 'float',
    },
)

# Lanes for cars so many times as wide, 2.4 to 5 m.
RoadWishWidths = TypedDict(
    'RoadWishWidths',
    {
        'widths': 'RoadWishWidthsArgs',
    },
)

RoadWishBesideArgs = TypedDict(
    'RoadWishBesideArgs',
    {
        # Its kind.
        'kind': 'LaneKind',
        # True: on the right, as one looks; both sides if left out.
        'right': 'NotRequired[bool | None]',
    },
)

# A lane of a kind beside those for cars.
RoadWishBeside = TypedDict(
    'RoadWishBeside',
    {
        'beside': 'RoadWishBesideArgs',
    },
)

RoadWishWithoutArgs = TypedDict(
    'RoadWishWithoutArgs',
    {
        # Its kind.
        'kind': 'LaneKind',
    },
)

# No lane of a kind on either side.
RoadWishWithout = TypedDict(
    'RoadWishWithout',
    {
        'without': 'RoadWishWithoutArgs',
    },
)

# No bends.
RoadWishStraight = TypedDict(
    'RoadWishStraight',
    {
        'straight': 'dict[str, Any]',
    },
)

# A roundabout at the next junction ahead, or on the street where there is none.
RoadWishRoundabout = TypedDict(
    'RoadWishRoundabout',
    {
        'roundabout': 'dict[str, Any]',
    },
)

# A plain junction in place of the next roundabout.
RoadWishJunction = TypedDict(
    'RoadWishJunction',
    {
        'junction': 'dict[str, Any]',
    },
)

# A change of a street as a whole, that is of all roads that continue each other.
RoadWish: TypeAlias = 'RoadWishLanes | RoadWishOneWay | RoadWishWidths | RoadWishBeside | RoadWishWithout | RoadWishStraight | RoadWishRoundabout | RoadWishJunction'

# A kind of place.
RoadsideKind: TypeAlias = "Literal['old-town', 'city', 'suburb', 'industry', 'forest', 'country', 'motorway', 'park', 'retail']"

# Shape of a roof.
Roof: TypeAlias = "Literal['flat', 'gabled', 'hipped']"

# Receipt of `save`.
Saved = TypedDict(
    'Saved',
    {
        # The file.
        'file': 'FileEntry',
        # Number of the state that was saved.
        'revision': 'int',
    },
)

# A thing along a line.
SceneryLine = TypedDict(
    'SceneryLine',
    {
        # Height above the ground, m.
        'height_m': 'float',
        # Kind.
        'kind': 'LineKind',
        # Vertices on the ground, world frame, m; at least two.
        'points_m': 'Sequence[Sequence[float]]',
        # Width, m.
        'width_m': 'float',
    },
)

# Effect that moving an object at one moment has on its other moments.
Scope: TypeAlias = "Literal['whole_track', 'from_here_on', 'moment']"

# All sensors of a vehicle.
SensorRig = TypedDict(
    'SensorRig',
    {
        # Cameras, in any order; bundled rigs have them clockwise from above, beginning on the left.
        'cameras': 'Sequence[Camera]',
        # From the rear axle to the middle of the ego vehicle, m.
        'ego_center_m': 'Sequence[float]',
        # Length, width, height of the ego vehicle, m; its rear axle is the origin.
        'ego_size_m': 'Sequence[float]',
        # Forward speed while a LiDAR spins and a radar measures, m/s.
        'ego_speed_mps': 'NotRequired[float]',
        # LiDARs; the first one is the default.
        'lidars': 'Sequence[LidarPattern]',
        # Name of the rig.
        'name': 'str',
        # Radars, in any order.
        'radars': 'NotRequired[Sequence[RadarPattern]]',
    },
)

ShapeDiscArgs = TypedDict(
    'ShapeDiscArgs',
    {
        # Middle, m.
        'center_m': 'Sequence[float]',
        # Radius, m, at least 0.
        'radius_m': 'float',
    },
)

# A round dab; always at least the cell under its centre.
ShapeDisc = TypedDict(
    'ShapeDisc',
    {
        'disc': 'ShapeDiscArgs',
    },
)

ShapeRectArgs = TypedDict(
    'ShapeRectArgs',
    {
        # Upper corner, m.
        'max_m': 'Sequence[float]',
        # Lower corner, m.
        'min_m': 'Sequence[float]',
    },
)

# An upright rectangle.
ShapeRect = TypedDict(
    'ShapeRect',
    {
        'rect': 'ShapeRectArgs',
    },
)

ShapePolygonArgs = TypedDict(
    'ShapePolygonArgs',
    {
        # At least three vertices, m.
        'points_m': 'Sequence[Sequence[float]]',
    },
)

# A closed polygon (even-odd rule); the first vertex is not repeated.
ShapePolygon = TypedDict(
    'ShapePolygon',
    {
        'polygon': 'ShapePolygonArgs',
    },
)

ShapeLineArgs = TypedDict(
    'ShapeLineArgs',
    {
        # At least one vertex, m.
        'points_m': 'Sequence[Sequence[float]]',
        # Full width, m, at least 0.
        'width_m': 'float',
    },
)

# A stroke with round ends, never thinner than one cell.
ShapeLine = TypedDict(
    'ShapeLine',
    {
        'line': 'ShapeLineArgs',
    },
)

# Cells by index `[x, y]`.
ShapeCells = TypedDict(
    'ShapeCells',
    {
        'cells': 'Sequence[Sequence[int]]',
    },
)

# An area on the ground, world frame, m (cells: grid indices). A cell belongs to a shape if its centre does.
Shape: TypeAlias = 'ShapeDisc | ShapeRect | ShapePolygon | ShapeLine | ShapeCells'

# Receipt of `show`.
ShowReceipt = TypedDict(
    'ShowReceipt',
    {
        # Boxes that are there then.
        'boxes': 'int',
        # Where the ego vehicle is then, world frame: x and y in m, heading in degrees.
        'ego': 'Sequence[float]',
        # Length of the scene, s; 0 for one moment.
        'length_s': 'float',
        # The moment that is shown now, s.
        'time_s': 'float',
    },
)

# An area of shrubs.
Shrubs = TypedDict(
    'Shrubs',
    {
        # Height of the tallest above the ground, m.
        'height_m': 'float',
        # Corners on the ground, world frame, m; closed without repeating the first, edges do not cross.
        'outline_m': 'Sequence[Sequence[float]]',
        # Plants per square metre, 0 to 2.
        'per_m2': 'float',
    },
)

# A rolling shutter. The moment of a picture is that of its middle row or column.
Shutter = TypedDict(
    'Shutter',
    {
        # Order.
        'direction': 'ReadOut',
        # From the first row or column to the last, s.
        'readout_s': 'float',
    },
)

# A speed at a time; between two the speed changes evenly.
Speed = TypedDict(
    'Speed',
    {
        # Speed along the path, m/s; negative goes back along it.
        'mps': 'float',
        # Time in the clip, s.
        'time_s': 'float',
    },
)

# How much of what there is.
StateCounts = TypedDict(
    'StateCounts',
    {
        # Boxes.
        'boxes': 'int',
        # Boxes by class.
        'boxes_by_class': 'dict[str, int]',
        # Area of each map layer, m2.
        'layers_m2': 'dict[str, float]',
        # Voxels that are not free.
        'occupied_voxels': 'int',
        # Things beside the road by kind.
        'things': 'dict[str, int]',
        # Voxels by class.
        'voxels_by_class': 'dict[str, int]',
    },
)

# Receipt of `state`.
StateReceipt = TypedDict(
    'StateReceipt',
    {
        # Boxes, the nearest first.
        'boxes': 'Sequence[BoxState]',
        # Names of the cameras.
        'cameras': 'Sequence[str]',
        # Time.
        'clip': 'ClipState',
        # Light and air.
        'conditions': 'Conditions',
        # How much of what there is.
        'counts': 'StateCounts',
        # Columns of voxels that only sketch what was edited; `generate` draws them.
        'draft_columns': 'int',
        # The area that the map covers.
        'map': 'MapArea',
        # True if there are more boxes than are listed.
        'more_boxes': 'bool',
        # Name of the scene.
        'name': 'str',
        # Text that describes its style; empty when none.
        'prompt': 'str',
        # Name of the step that redo brings back.
        'redo': 'str | None',
        # Number of the state that the scene is in.
        'revision': 'int',
        # Lines of the map, if they were asked for.
        'roads': 'MapLines | None',
        # Name of the step that undo takes back; none if there is none.
        'undo': 'str | None',
        # True if there are changes that no file has.
        'unsaved': 'bool',
        # Words that were typed to make it and to change it.
        'words': 'Sequence[str]',
    },
)

# A step of the history.
Step = TypedDict(
    'Step',
    {
        # Maker: `user`, `assistant`, or another name; none for the state that was opened.
        'author': 'NotRequired[str | None]',
        # True if a later step leaves it out.
        'left_out': 'bool',
        # Its name.
        'name': 'str',
        # Its number; 0 is the state that was opened.
        'step': 'int',
    },
)

# Receipt of `history`.
Steps = TypedDict(
    'Steps',
    {
        # The step whose state is shown; later ones can be redone.
        'shown': 'int',
        # All steps, the oldest first.
        'steps': 'Sequence[Step]',
    },
)

# Where the sun (at night the moon) stands.
Sun = TypedDict(
    'Sun',
    {
        # Degrees counter-clockwise from the x axis of the world frame.
        'azimuth_deg': 'float',
        # Degrees above the horizon, 0 to 90.
        'elevation_deg': 'float',
    },
)

# A way to move.
Template: TypeAlias = "Literal['drive', 'follow', 'stop', 'cut_in', 'cross', 'pull_out', 'park', 'turn_left', 'turn_right']"

# A lie of the land.
Terrain: TypeAlias = "Literal['flat', 'grade', 'crest', 'dip', 'hills', 'embankment', 'cutting', 'terrace', 'viaduct']"

# Names a thing of the background; unique in a scene.
ThingId: TypeAlias = 'int'

# Part of the day.
TimeOfDay: TypeAlias = "Literal['dawn', 'day', 'dusk', 'night']"

# Receipt of `add_track`.
TrackAdded = TypedDict(
    'TrackAdded',
    {
        # Changes, in numbers.
        'changed': 'ChangeSummary',
        # Columns of voxels, 0.4 x 0.4 m each, that only sketch what was edited; `generate` draws them.
        'draft_columns': 'int',
        # How long the scene lasts now, s.
        'length_s': 'float',
        # Number of the state that the scene is in now. A state that comes back by undo has its old number.
        'revision': 'int',
        # Name of the undo step; empty if nothing changed.
        'step': 'str',
        # The track.
        'track': 'TrackState',
        # Warnings to look at, such as findings of the checks that were not there before.
        'warnings': 'Sequence[str]',
    },
)

# Receipt of `list_tracks`.
TrackList = TypedDict(
    'TrackList',
    {
        # How long the scene lasts, s; 0 for one moment.
        'length_s': 'float',
        # The moment that is shown, s.
        'time_s': 'float',
        # All tracks, the ego vehicle's first.
        'tracks': 'Sequence[TrackState]',
    },
)

# A moving object, or the moving ego vehicle.
TrackState = TypedDict(
    'TrackState',
    {
        # The box; none for the ego vehicle.
        'box': 'int | None',
        # Its class; none for the ego vehicle.
        'class': 'Class | None',
        # True while its voxels are a draft that `generate` has not drawn yet.
        'draft': 'bool',
        # `keys` (through keyframes), `path` (along a path) or `attached` (to another box).
        'motion': 'str',
        # Its place at the beginning, the middle and the end of the scene, world frame: time in s, x and y in m,
        # speed in m/s.
        'passes': 'Sequence[Sequence[float]]',
        # When it is there, s: from the first up to the second; none: from the beginning, to the end.
        'there_s': 'Sequence[float | None]',
    },
)

# A tree.
Tree = TypedDict(
    'Tree',
    {
        # Radius of the crown, m.
        'crown_radius_m': 'float',
        # Top of the crown above the ground, m.
        'height_m': 'float',
        # Kind.
        'kind': 'NotRequired[TreeKind]',
        # Middle of the trunk on the ground, world frame, m.
        'position_m': 'Sequence[float]',
    },
)

# Kind of tree.
TreeKind: TypeAlias = "Literal['broadleaf', 'conifer', 'columnar', 'bare']"

# A state that was kept.
Version = TypedDict(
    'Version',
    {
        # Boxes in it.
        'boxes': 'int',
        # Its name.
        'name': 'str',
        # Voxels that are not free.
        'occupied_voxels': 'int',
        # Number of the state.
        'revision': 'int',
    },
)

# Receipt of `keep_version` and `list_versions`.
VersionList = TypedDict(
    'VersionList',
    {
        # Number of the state that the scene is in now.
        'revision': 'int',
        # All versions, the oldest first.
        'versions': 'Sequence[Version]',
    },
)

# What is in the air.
Weather: TypeAlias = "Literal['clear', 'overcast', 'rain', 'snow', 'fog', 'sandstorm']"

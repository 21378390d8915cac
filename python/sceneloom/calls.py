"""One method per call. Written by generate.py from `sceneloom schema`; do not edit."""

from __future__ import annotations

from typing import Any, Literal, Sequence

from . import types


def _given(args: dict[str, Any], required: list[str]) -> dict[str, Any]:
    """Without what was left out."""
    return {key: value for key, value in args.items() if value is not None or key in required}


class Calls:
    """Every call as a method; `call` carries one out."""

    def call(self, name: str, args: dict[str, Any]) -> Any:
        """Carries a call out and returns its receipt."""
        raise NotImplementedError

    def add_track(
        self,
        *,
        template: types.Template,
        box: types.BoxId | None = None,
        from_s: float | None = None,
        gap_m: float | None = None,
        length_s: float | None = None,
        mps: float | None = None,
    ) -> types.TrackAdded:
        """Lets a box or the ego vehicle move in a way that has a name: drive, follow, stop, cut_in (into our
        lane), cross (a pedestrian over the road), pull_out, park, turn_left, turn_right. A scene of one
        moment becomes a clip. A box that has a track gets the new one. Own paths: the edit set_motion of
        apply.

        template: How it moves, along the lanes of the map.
        box: The box that moves from where it is at the moment that is shown; the ego vehicle if left out.
        from_s: When what it is about begins (the cut-in, the crossing, the stop), s; soon if left out.
        gap_m: It begins when so much is left between it and the ego vehicle, m, in place of at a time (only
            if the ego vehicle moves); who follows keeps so much to the one ahead. Bumper to bumper.
        length_s: How long the scene lasts from now on, s; as before if left out, or as long as the motion
            needs if it was one moment.
        mps: Speed, m/s; a usual one of its class if left out.
        """
        args = _given(
            {
                'template': template,
                'box': box,
                'from_s': from_s,
                'gap_m': gap_m,
                'length_s': length_s,
                'mps': mps,
            },
            ['template'],
        )
        receipt: types.TrackAdded = self.call("add_track", args)
        return receipt

    def apply(self, *, edits: Sequence[types.Edit], step: str | None = None) -> types.Done:
        """Applies typed edits as one undo step: put in, move, resize, relabel or remove boxes (vehicles,
        people, cones); paint map layers (drivable_area, ped_crossing, walkway, ...); add or remove trees,
        buildings and posts; paint voxels; set motions, length, weather, sensors. Sizes in m, length first;
        center_m is the middle of a box, so z is half its height on level ground. Voxels of what was edited
        are drafts until generate.

        edits: The edits, carried out in order: all of them, or none. Each is an object with one key, the
            kind of edit. All places are in the world frame (at the start of a scene the ego frame: x ahead,
            y left, z up, origin at the rear axle on the ground), in m; sizes are length, width, height;
            angles are degrees counter-clockwise from x.
        step: Name of the undo step.
        """
        args = _given({'edits': edits, 'step': step}, ['edits'])
        receipt: types.Done = self.call("apply", args)
        return receipt

    def check(self, *, fix: bool | None = None, sensors: bool | None = None) -> types.Checked:
        """Runs the quality checks: boxes that overlap, float, stand off the road or against the lane, voxels
        without a box, boxes that no sensor sees. Call it before export. An edit `waive` lets a finding
        stand.

        fix: Apply the first repair of each finding that has one and is better for it, as one undo step, and
            check again. No repair is done that brings something as bad, or that makes the map larger.
        sensors: Also look with cameras and LiDAR, which takes a few seconds.
        """
        args = _given({'fix': fix, 'sensors': sensors}, [])
        receipt: types.Checked = self.call("check", args)
        return receipt

    def diff(self, *, file: str | None = None, version: str | None = None) -> types.DiffReceipt:
        """Counts what changed from a kept version or a file to the scene as it is now: boxes, cells of the
        map, voxels by class.

        file: A file in the folder of this session, such as `a.loom`.
        version: Name of a version that was kept.
        """
        args = _given({'file': file, 'version': version}, [])
        receipt: types.DiffReceipt = self.call("diff", args)
        return receipt

    def export(
        self,
        *,
        format: str,
        learned_lidar: bool | None = None,
        name: str | None = None,
        replace: bool | None = None,
        size: Sequence[int] | None = None,
    ) -> types.Exported:
        """Writes the scene as files of another format into the folder of this session.

        format: Kind of file; see the description of this call.
        learned_lidar: The LiDAR network instead of exact rays.
        name: File (with the ending of the format) or folder in the folder of this session; the usual name
            of the format if left out.
        replace: Write over files that are there.
        size: Width and height of camera pictures, pixels.
        """
        args = _given(
            {
                'format': format,
                'learned_lidar': learned_lidar,
                'name': name,
                'replace': replace,
                'size': size,
            },
            ['format'],
        )
        receipt: types.Exported = self.call("export", args)
        return receipt

    def generate(
        self,
        *,
        quality: Literal['draft', 'balanced', 'careful', 'reference'] | None = None,
        seed: int | None = None,
        steps: int | None = None,
        whole: bool | None = None,
    ) -> types.Generated:
        """Lets the networks draw the voxels under what was edited since they last did (or of the whole map),
        so that they follow map and boxes. One undo step. Takes from a second to minutes: the quality
        decides.

        quality: A preset of speed against accuracy, the fastest first; a usual one if left out.
        seed: Fixes every random draw.
        steps: Sampling steps instead of the preset's: more are slower and nearer to the reference, which is
            not less invented.
        whole: All of the map from fresh noise; otherwise only what was edited since it was generated, and
            everything else stays bit-identical.
        """
        args = _given({'quality': quality, 'seed': seed, 'steps': steps, 'whole': whole}, [])
        receipt: types.Generated = self.call("generate", args)
        return receipt

    def history(self) -> types.Steps:
        """Lists the steps that led to the scene, with their makers: those of the file it was opened from, of
        this session and of a window. The file keeps them.
        """
        args = _given({}, [])
        receipt: types.Steps = self.call("history", args)
        return receipt

    def keep_version(self, *, name: str) -> types.VersionList:
        """Keeps the scene as it is now under a name, for diff and restore_version; at most 64. save writes
        them into the project file, open brings them back.

        name: A name of 1 to 60 characters; a version of that name is replaced.
        """
        args = _given({'name': name}, ['name'])
        receipt: types.VersionList = self.call("keep_version", args)
        return receipt

    def list_files(self) -> types.FileList:
        """Lists the files in the folder of this session, the only one that calls read and write.
        """
        args = _given({}, [])
        receipt: types.FileList = self.call("list_files", args)
        return receipt

    def list_tracks(self) -> types.TrackList:
        """Lists what moves: the ego vehicle and boxes, with the places that they pass (m) and their speeds
        (m/s).
        """
        args = _given({}, [])
        receipt: types.TrackList = self.call("list_tracks", args)
        return receipt

    def list_versions(self) -> types.VersionList:
        """Lists the versions that were kept.
        """
        args = _given({}, [])
        receipt: types.VersionList = self.call("list_versions", args)
        return receipt

    def new(
        self,
        *,
        template: Literal['straight', 'curve', 't-junction', 'intersection', 'roundabout', 'highway', 'parking', 'suburb'],
        bins: int | None = None,
        seed: int | None = None,
        setting: types.RoadsideKind | None = None,
        terrain: types.Terrain | None = None,
        voxel_m: float | None = None,
    ) -> types.NewSceneReceipt:
        """Replaces the scene by a new one from a procedural world: road, traffic, buildings, trees and voxels
        on a map of 80 x 80 m around the ego vehicle. It can be undone.

        template: Kind of street.
        bins: Voxels above one another, from about 1 m below the road up, at most 64; up to 5.4 m above it
            if left out.
        seed: Fixes every random draw: the same seed gives the same scene.
        setting: Kind of place; one that suits the road if left out.
        terrain: The lie of the land.
        voxel_m: Edge of the voxels, m: 0.05 to 2; 0.4, as the networks have it, if left out.
        """
        args = _given(
            {
                'template': template,
                'bins': bins,
                'seed': seed,
                'setting': setting,
                'terrain': terrain,
                'voxel_m': voxel_m,
            },
            ['template'],
        )
        receipt: types.NewSceneReceipt = self.call("new", args)
        return receipt

    def open(
        self,
        *,
        at_m: Sequence[float] | None = None,
        file: str | None = None,
        heading_deg: float | None = None,
        lift_m: float | None = None,
        resample: bool | None = None,
        size_m: Sequence[float] | None = None,
    ) -> types.OpenReceipt:
        """Replaces the scene by one from a file: a project (.loom), roads (.xodr), occupancy labels (.npz), a
        picture that this program made (.png), or another format that is read. It can be undone. list_files
        tells what is there.

        at_m: For a road file: position of the ego vehicle in the file's frame, m; a good place on a lane if
            left out.
        file: File in the folder of this session, such as `a.loom`, `road.xodr` or `labels.npz`; without it
            the scene that ships with the program.
        heading_deg: For a road file: heading of the ego vehicle, degrees counter-clockwise from x; along
            the lane if left out.
        lift_m: For a point cloud: height by which it is lifted, m, 0 for not at all; if left out, a sweep
            whose ground lies beside the map is lifted onto it, and `notes` says by how much.
        resample: For voxels of a data set: true to take them to those of the networks, 0.4 m and 16 bins,
            in place of their own.
        size_m: For a road file: length and width of the map, m; 80 x 80 if left out.
        """
        args = _given(
            {
                'at_m': at_m,
                'file': file,
                'heading_deg': heading_deg,
                'lift_m': lift_m,
                'resample': resample,
                'size_m': size_m,
            },
            [],
        )
        receipt: types.OpenReceipt = self.call("open", args)
        return receipt

    def place_model(
        self,
        *,
        file: str,
        at_m: Sequence[float] | None = None,
        heading_deg: float | None = None,
        of: types.BoxId | None = None,
        to: types.BoxId | None = None,
    ) -> types.ModelPlaced:
        """Puts an object out of a file (a glTF model, a MagicaVoxel shape, a box of another scene) into the
        scene as a box that keeps the shape of the model wherever it moves, or gives that shape to a box
        that is there. list_files tells what is there.

        file: File in the folder of this session: a glTF model (.glb, .gltf), a MagicaVoxel shape (.vox), or
            a scene (.loom).
        at_m: Position, world frame, m; ahead of the ego vehicle if left out. The nearest free place is
            taken.
        heading_deg: Heading, degrees counter-clockwise from x; as the lane there if left out.
        of: Number of the object's box, of a file that holds several.
        to: Box of the scene that gets the shape and the size, in place of a new one.
        """
        args = _given(
            {
                'file': file,
                'at_m': at_m,
                'heading_deg': heading_deg,
                'of': of,
                'to': to,
            },
            ['file'],
        )
        receipt: types.ModelPlaced = self.call("place_model", args)
        return receipt

    def prompt(
        self,
        *,
        text: str,
        make: types.Make | None = None,
        seed: int | None = None,
    ) -> types.Prompted:
        """Reads plain English and carries it out: make "new" builds a scene from a description ("a T junction
        in the rain, two parked cars, a cyclist ahead"), make "change" edits the scene that is there
        ("remove the nearest car", "three pedestrians on the crossing", "at night"). The receipt tells what
        each phrase became, which words had no effect, and asks if more than one thing fits. One undo step.

        text: Content of the new scene, or changes of this one; plain English.
        make: Purpose of the words.
        seed: Fixes every random draw.
        """
        args = _given({'text': text, 'make': make, 'seed': seed}, ['text'])
        receipt: types.Prompted = self.call("prompt", args)
        return receipt

    def redo(self, *, steps: int | None = None) -> types.Moved:
        """Brings back what undo took away.

        steps: How many steps.
        """
        args = _given({'steps': steps}, [])
        receipt: types.Moved = self.call("redo", args)
        return receipt

    def remove_track(self, *, box: types.BoxId | None = None) -> types.Done:
        """Lets a box or the ego vehicle stand where it is at the moment that is shown. The box itself stays;
        the edit remove_box takes it out.

        box: The box that stands from now on where it is at the moment that is shown; the ego vehicle if
            left out.
        """
        args = _given({'box': box}, [])
        receipt: types.Done = self.call("remove_track", args)
        return receipt

    def render(
        self,
        *,
        what: Sequence[Literal['semantic', 'depth', 'appearance', 'learned', 'perceived', 'mpi', 'perspective', 'normals', 'truth', 'lidar', 'radar', 'bev', 'view']],
        cameras: Sequence[str] | None = None,
        folder: str | None = None,
        learned_lidar: bool | None = None,
        preview: bool | None = None,
        replace: bool | None = None,
        size: Sequence[int] | None = None,
        source: Literal['splats', 'voxels', 'shapes', 'truth'] | None = None,
        time: types.TimeOfDay | None = None,
        weather: types.Weather | None = None,
    ) -> types.RenderReceipt:
        """Renders what cameras, LiDAR and radars of the ego vehicle see at the moment that is shown, or the
        map from above, and writes PNG pictures and data into a folder. Over MCP the first picture comes
        with the answer, at most 640 pixels wide. Look at bev to see where things are. Files that are there
        are written over only with replace: call again with it, or name another folder.

        what: Kinds of output: `bev` is the map and the voxels from above, `view` the 3D view (needs a
            graphics driver), `lidar` the points of a sweep, `radar` the returns of all radars; the others
            are what cameras see, `appearance` as a photograph.
        cameras: Names of cameras, as `state` lists them; all of them if left out.
        folder: Folder in the folder of this session that the files go to.
        learned_lidar: The LiDAR network instead of exact rays.
        preview: `appearance` several times faster, with rougher edges.
        replace: Write over files that are there.
        size: Width and height of camera pictures, pixels; all pictures of a call together have at most 40
            million.
        source: Source that classes and depths are rendered from.
        time: Time of day of `appearance`; the scene's if left out.
        weather: Weather of `appearance`; the scene's if left out.
        """
        args = _given(
            {
                'what': what,
                'cameras': cameras,
                'folder': folder,
                'learned_lidar': learned_lidar,
                'preview': preview,
                'replace': replace,
                'size': size,
                'source': source,
                'time': time,
                'weather': weather,
            },
            ['what'],
        )
        receipt: types.RenderReceipt = self.call("render", args)
        return receipt

    def restore_version(self, *, name: str) -> types.Done:
        """Brings a kept version back, as one undo step.

        name: Its name.
        """
        args = _given({'name': name}, ['name'])
        receipt: types.Done = self.call("restore_version", args)
        return receipt

    def save(self, *, file: str, replace: bool | None = None) -> types.Saved:
        """Writes the scene with everything in it, its history and the kept versions as a project file (.loom),
        whole or not at all.

        file: File in the folder of this session; it ends in `.loom`.
        replace: Write over a file that is there.
        """
        args = _given({'file': file, 'replace': replace}, ['file'])
        receipt: types.Saved = self.call("save", args)
        return receipt

    def show(self, *, time_s: float) -> types.ShowReceipt:
        """Goes to another moment of a scene that lasts. Edits, render, check, state and export look at the
        moment that is shown. It is not an undo step.

        time_s: Moment of the scene, s, from 0 to its length.
        """
        args = _given({'time_s': time_s}, ['time_s'])
        receipt: types.ShowReceipt = self.call("show", args)
        return receipt

    def state(self, *, most_boxes: int | None = None, roads: bool | None = None) -> types.StateReceipt:
        """Tells what is in the scene at the moment that is shown: boxes with id, class and place, lanes and
        crossings of the map, light and air, length, counts of voxels. World frame: x ahead at the start, y
        left, z up, m and degrees. Call it first, and whenever ids or places are needed.

        most_boxes: Boxes that are listed, the nearest to the ego vehicle first; at most 1000.
        roads: List the lanes, dividers, stop lines and crossings too.
        """
        args = _given({'most_boxes': most_boxes, 'roads': roads}, [])
        receipt: types.StateReceipt = self.call("state", args)
        return receipt

    def undo(self, *, step: int | None = None, steps: int | None = None) -> types.Moved:
        """Takes back the last change of the scene, or the last few: each call that changed it is one step. A
        failed call is none. In a window the changes of this session are taken back, and those of the user
        stay.

        step: In place of the last steps this one alone, by its number in `history`: later ones are applied
            again, and warnings name those that cannot be without it.
        steps: How many steps.
        """
        args = _given({'step': step, 'steps': steps}, [])
        receipt: types.Moved = self.call("undo", args)
        return receipt

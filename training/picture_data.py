"""Frames of `sceneloom-worlds --kind pictures --stream`, kept on the device: two moments of six cameras each, and what the voxels tell of every pixel.

Arrays of a shard: rgb u8 [N,2,6,h,w,3], class u8 [N,2,6,h,w] (what the picture shows), told_class u8, told_depth u16 (cm) and told_facing u8
[N,2,6,h,w] (what the voxels tell), intrinsic f32 [N,2,6,3,3], map_from_camera f32 [N,2,6,4,4], sun f32 [N,2,6,3], dense u8 [N,200,200,16], conditions u8
[N,2]. Cameras stand in a ring, clockwise: front left, front, front right, back right, back, back left.
"""
import functools
import json
import os
import queue
import shlex
import subprocess
import threading
from pathlib import Path

import numpy as np
import torch

from data import listen
from models.picture_dit import NOTHING
from models.picture_vae import CELL

DTYPES = {"U8": np.uint8, "U16": np.uint16, "F32": np.float32}
VIEWS, MOMENTS = 6, 2
MIRRORED = [2, 1, 0, 5, 4, 3]  # cameras in the order of the ring, seen in a mirror
DEPTH_M = 0.01
PIXELS = ("rgb", "class", "told_class", "told_depth", "told_facing")


@functools.lru_cache
def constant(values, device):
    """A short tensor kept on the device, so that a step which needs it can be recorded."""
    return torch.tensor(values, device=device)


def shard_arrays(data):
    """The arrays of a shard's bytes by name."""
    length = int.from_bytes(data[:8], "little")
    header = json.loads(data[8 : 8 + length])
    found = {}
    for name, entry in header.items():
        if name != "__metadata__":
            begin = 8 + length + entry["data_offsets"][0]
            count = int(np.prod(entry["shape"]))
            found[name] = np.frombuffer(data, DTYPES[entry["dtype"]], count, begin).reshape(entry["shape"])
    return found


def read_folder(folder, ready):
    """Puts the shards of a folder into a queue; None at the end."""
    try:
        for path in sorted(folder.glob("shard_*.safetensors")):
            ready.put(shard_arrays(path.read_bytes()))
    finally:
        ready.put(None)


class Streams:
    """The shards that some commands write to their outputs, or that lie in folders: each of these is read once."""

    def __init__(self, sources, ahead=64):
        self.ready = queue.Queue(ahead)
        folders = [Path(s) for s in dict.fromkeys(sources) if os.path.isdir(s)]
        for folder in folders:
            if not any(folder.glob("shard_*.safetensors")):
                raise SystemExit(f"{folder}: expected shard_*.safetensors, found none")
            threading.Thread(target=read_folder, args=(folder, self.ready), daemon=True).start()
        commands = [s for s in sources if not os.path.isdir(s)]
        try:
            self.processes = [subprocess.Popen(shlex.split(c), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) for c in commands]
        except OSError as error:
            raise SystemExit(f"{commands[0]}: neither a folder of shards nor a command that runs: {error}") from None
        self.running = len(self.processes) + len(folders)
        for process in self.processes:
            threading.Thread(target=listen, args=(process.stdout, self.ready, shard_arrays), daemon=True).start()

    def take(self, wait_s=0.0):
        """A shard, or None if there is none (within some time)."""
        try:
            shard = self.ready.get(timeout=wait_s) if wait_s else self.ready.get_nowait()
        except queue.Empty:
            return None
        if shard is None:
            self.running -= 1
        return shard

    def stop(self):
        for process in self.processes:
            process.kill()


def ways(poses):
    """map from camera [N,2,6,4,4] f32 -> from a camera of one moment to the same camera of the other [N,2,6,4,4], in double precision inside."""
    poses = poses.astype(np.float64)
    return (np.linalg.inv(poses[:, ::-1]) @ poses).astype(np.float32)


def camera_numbers(poses, intrinsic, sun, width):
    """[N,2,6,7]: where the light comes from, which way is up (both in the optical frame), focal length by the width of the picture."""
    return np.concatenate([sun, poses[..., 2, :3], intrinsic[..., 0, :1] / width], -1).astype(np.float32)


class Pool:
    """Up to `room` frames on a device; once there are so many, new ones take the places of the oldest. `planes`: voxels are kept too."""

    def __init__(self, room, size, device, planes=False):
        width, height = size
        self.room, self.size, self.device, self.count, self.seen = room, size, device, 0, 0
        shapes = {"rgb": (height, width, 3), "class": (height, width), "told_class": (height, width), "told_depth": (height, width),
                  "told_facing": (height, width), "way": (4, 4), "camera": (7,), "intrinsic": (3, 3), "pose": (4, 4)}
        kinds = {"told_depth": torch.int16, "way": torch.float32, "camera": torch.float32, "intrinsic": torch.float32, "pose": torch.float32}
        self.arrays = {name: torch.zeros(room, MOMENTS, VIEWS, *shape, dtype=kinds.get(name, torch.uint8), device=device)
                       for name, shape in shapes.items()}
        for name in ("intrinsic", "way", "pose"):
            self.arrays[name][:] = torch.eye(self.arrays[name].shape[-1], device=device)
        self.arrays["conditions"] = torch.zeros(room, 2, dtype=torch.uint8, device=device)
        if planes:
            self.arrays["dense"] = torch.zeros(room, 200, 200, 16, dtype=torch.uint8, device=device)
        self.known = torch.zeros(2, device=device)  # frames, and those of which latents are known: read by recorded steps
        self.latents = None
        self.encoded = 0  # frames whose latents are known, counted as `seen`

    def add(self, shard):
        """Takes the frames of a shard in."""
        poses, intrinsic = shard["map_from_camera"], shard["intrinsic"]
        made = {"way": ways(poses), "camera": camera_numbers(poses, intrinsic, shard["sun"], self.size[0]), "pose": poses,
                "told_depth": shard["told_depth"].view(np.int16) if shard["told_depth"].flags.aligned
                else shard["told_depth"].copy().view(np.int16)}
        n = len(poses)
        places = [(self.seen + i) % self.room for i in range(n)]
        at = torch.tensor(places, device=self.device)
        for name, kept in self.arrays.items():
            values = made[name] if name in made else shard[name]
            kept[at] = torch.from_numpy(np.array(values)).to(self.device)
        self.seen += n
        self.count = min(self.room, self.seen)
        self.known[0] = self.count

    def take_all(self, streams):
        """Takes in what has come; how many frames."""
        before = self.seen
        while (shard := streams.take()) is not None:
            self.add(shard)
        return self.seen - before

    @torch.no_grad()
    def encode(self, vae, amp, most=64):
        """Latents of up to `most` frames that have none yet, as they are and in a mirror: f16 [room,2 (mirrored),2,6,h/8,w/8,C]."""
        w, h = self.size
        if self.latents is None:
            self.latents = torch.zeros(self.room, 2, MOMENTS, VIEWS, h // CELL, w // CELL, vae.config.latent, dtype=torch.float16,
                                       device=self.device)
        last = min(self.seen, self.encoded + most)
        for begin in range(self.encoded, last, 8):
            places = torch.tensor([i % self.room for i in range(begin, min(last, begin + 8))], device=self.device)
            pictures = as_pictures(self.arrays["rgb"][places].flatten(0, 2))
            with amp():
                both = [vae.encode(p).view(len(places), MOMENTS, VIEWS, h // CELL, w // CELL, -1) for p in (pictures, pictures.flip(-1))]
            self.latents[places, 0], self.latents[places, 1] = both[0].half(), self.mirror(both[1], 2).half()
        self.encoded = last
        self.known[1] = min(self.room, self.encoded)

    def mirror(self, values, axis):
        """Cameras of the ring as a mirror shows them."""
        return values.index_select(axis, constant(tuple(MIRRORED), self.device))

    def random_frames(self, n, encoded=False):
        """Random frames i64 [n]; their number is read on the device."""
        known = self.known[int(encoded)]
        return (torch.rand(n, device=self.device) * known).minimum(known - 1).long().clamp(min=0)

    def pictures(self, n):
        """Random pictures [n,3,h,w], -1 to 1, and what they show u8 [n,h,w]; half of them in a mirror."""
        at = [self.random_frames(n)] + [torch.randint(m, (n,), device=self.device) for m in (MOMENTS, VIEWS)]
        rgb, shown = as_pictures(self.arrays["rgb"][tuple(at)]), self.arrays["class"][tuple(at)]
        half = n // 2
        return torch.cat([rgb[:half], rgb[half:].flip(-1)]), torch.cat([shown[:half], shown[half:].flip(-1)])

    def drawn(self, n):
        """Random latents [n,h/8,w/8,C] and their pictures [n,3,h,w]."""
        frame = self.random_frames(n, encoded=True)
        moment, view = (torch.randint(m, (n,), device=self.device) for m in (MOMENTS, VIEWS))
        side = torch.zeros_like(frame)
        return self.latents[frame, side, moment, view].float(), as_pictures(self.arrays["rgb"][frame, moment, view])

    def moments(self, frames, moment, mirrored):
        """What the transformer learns from, of frames i64 [B] at moments i64 [B], in a mirror where `mirrored` (bool, one for all)."""
        a, other = self.arrays, 1 - moment
        told = {name: a[name][frames, moment] for name in ("told_class", "told_facing")}
        depth, depth_before = (metres(a["told_depth"][frames, m]) for m in (moment, other))
        camera, way, intrinsic = a["camera"][frames, moment], a["way"][frames, moment], a["intrinsic"][frames, moment].clone()
        pose = a["pose"][frames, moment]
        if mirrored:
            depth, depth_before = (self.mirror(d, 1).flip(-1) for d in (depth, depth_before))
            told = {name: self.mirror(v, 1).flip(-1) for name, v in told.items()}
            told["told_facing"] = mirrored_facing(told["told_facing"])
            sign = constant((-1.0, 1.0, 1.0, -1.0, 1.0, 1.0, 1.0), self.device)
            flip = torch.outer(constant((-1.0, 1.0, 1.0, 1.0), self.device), constant((-1.0, 1.0, 1.0, 1.0), self.device))
            camera, way, intrinsic = self.mirror(camera, 1) * sign, self.mirror(way, 1) * flip, self.mirror(intrinsic, 1)
            intrinsic[..., 0, 2] = self.size[0] - intrinsic[..., 0, 2]
        side = torch.full_like(frames, int(mirrored))
        out = {"classes": told["told_class"], "facing": told["told_facing"], "depth_m": depth, "depth_before_m": depth_before, "camera": camera,
               "way": way, "intrinsic": intrinsic, "pose": pose, "time": a["conditions"][frames, 0].long(),
               "weather": a["conditions"][frames, 1].long()}
        if self.latents is not None:
            out |= {"latent": self.latents[frames, side, moment].float(), "before": self.latents[frames, side, other].float()}
        if "dense" in a:
            out["dense"] = a["dense"][frames]
        return out


def silence(part, told):
    """Tells of some frames nothing (`told` bool [B] is False): a network learns what pictures are without being told, and is guided by the difference."""
    for key in ("classes", "facing", "depth_m"):
        part[key] = part[key] * told.view(-1, 1, 1, 1)
    if "dense" in part:
        part["dense"] = part["dense"].masked_fill(~told.view(-1, 1, 1, 1), NOTHING)


def as_pictures(rgb):
    """u8 [...,h,w,3] -> f32 [...,3,h,w], -1 to 1, channels_last."""
    return (rgb.float() / 127.5 - 1).movedim(-1, -3)


def as_bytes(pictures):
    """f32 [...,3,h,w], -1 to 1 -> u8 [...,h,w,3]."""
    return ((pictures.clamp(-1, 1) + 1) * 127.5).round().to(torch.uint8).movedim(-3, -1)


def metres(depth):
    """i16 whose bits are those of a u16, cm -> m."""
    return (depth.int() & 0xFFFF).float() * DEPTH_M


def mirrored_facing(facing):
    """Facings as a mirror shows them: 1 + s becomes 1 + (16 - s) % 16; flags stay."""
    edge, sector = facing & 0x80, (facing & 0x7F).int()
    turned = ((17 - sector) % 16 + 1) * (sector > 0)
    return turned.to(torch.uint8) | edge


def planes_of(dense, pose, intrinsic, size, planes):
    """SyntheOcc's multi-plane images at half the size of pictures: the label at each pixel of planes at depths from 1 to 50 m, evenly in their
    logarithm. dense u8 [B,200,200,16], pose f32 [B,V,4,4], intrinsic [B,V,3,3] in pixels -> u8 [B,V,planes,h/2,w/2], 17 where nothing is."""
    w, h = size[0] // 2, size[1] // 2
    device = dense.device
    v, u = torch.meshgrid(torch.arange(h, device=device) * 2 + 1.0, torch.arange(w, device=device) * 2 + 1.0, indexing="ij")
    fx, fy, cx, cy = (intrinsic[..., i, j, None, None] for i, j in ((0, 0), (1, 1), (0, 2), (1, 2)))
    ray = ((u - cx) / fx, (v - cy) / fy, torch.ones_like(u))
    depth = torch.exp(torch.linspace(0, float(np.log(50)), planes, device=device))
    index, inside = 0, True
    for axis, (low_m, count) in enumerate(((-40.0, 200), (-40.0, 200), (-1.0, 16))):
        turned = sum(pose[..., axis, j, None, None] * ray[j] for j in range(3))
        p = turned[:, :, None] * depth[:, None, None] + pose[:, :, None, None, None, axis, 3]
        cell = p.sub_(low_m).div_(0.4).floor_()
        inside = inside & (cell >= 0) & (cell < count)
        index = index * count + cell.clamp_(0, count - 1).int()
    labels = dense.flatten(1).gather(1, index.flatten(1).long()).view(index.shape)
    return labels.masked_fill(~inside, NOTHING)

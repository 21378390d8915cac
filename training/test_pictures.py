"""python test_pictures.py: shapes, geometry and a toy training of the picture networks, on the processor, in a minute. With the path of
`sceneloom-worlds`, a whole toy run of train_pictures.py too."""
import math
import shlex
import sys
import tempfile
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import save_file

import train_pictures
from models.picture_dit import PictureDit, PictureDitConfig, Told, rows, seen_then, warp
from models.picture_vae import Critic, PictureVae, PictureVaeConfig
from models.segmenter import Segmenter, SegmenterConfig
from picture_data import MIRRORED, Pool, Streams, as_bytes, as_pictures, camera_numbers, mirrored_facing, planes_of, silence, ways

SIZE = (64, 32)
POSE = np.array([[0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 1.5], [0, 0, 0, 1]], np.float32)  # looks along x


def shard(frames):
    """Frames of noise whose cameras look along six directions and drive a metre along x."""
    rng = np.random.default_rng(3)
    w, h = SIZE
    poses = np.zeros((frames, 2, 6, 4, 4), np.float32)
    for view in range(6):
        yaw = math.radians(60 - 60 * view)
        turn = np.array([[math.cos(yaw), -math.sin(yaw), 0, 0], [math.sin(yaw), math.cos(yaw), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], np.float32)
        poses[:, :, view] = turn @ POSE
    poses[:, 1, :, 0, 3] += 1
    pixels = (frames, 2, 6, h, w)
    return {"rgb": rng.integers(0, 256, (*pixels, 3), np.uint8), "class": rng.integers(0, 22, pixels, np.uint8),
            "told_class": rng.integers(0, 20, pixels, np.uint8), "told_depth": rng.integers(0, 5000, pixels).astype(np.uint16),
            "told_facing": rng.integers(0, 17, pixels, np.uint8),
            "intrinsic": np.broadcast_to(np.array([[40, 0, 33], [0, 40, 16], [0, 0, 1]], np.float32), (frames, 2, 6, 3, 3)).copy(),
            "map_from_camera": poses, "sun": rng.standard_normal((frames, 2, 6, 3)).astype(np.float32),
            "dense": rng.integers(0, 18, (frames, 200, 200, 16), np.uint8), "conditions": rng.integers(0, 4, (frames, 2), np.uint8)}


def networks_keep_their_shapes():
    vae, seg, critic = PictureVae(PictureVaeConfig(widths=(8, 12, 16))), Segmenter(SegmenterConfig(widths=(8, 12, 16))), Critic(8)
    pictures = torch.rand(2, 3, 32, 64) * 2 - 1
    latent = vae.encode(pictures)
    assert latent.shape == (2, 4, 8, 8) and vae.decode(latent).shape == pictures.shape
    assert seg(pictures).shape == (2, 22, 32, 64) and seg.likeness(pictures, pictures) == 0
    assert critic(pictures).shape[:2] == (2, 1)
    assert torch.equal(as_pictures(as_bytes(pictures)), as_pictures(as_bytes(as_pictures(as_bytes(pictures)))))
    table = torch.randn(5, 3)
    index = torch.randint(5, (4, 6), dtype=torch.uint8)
    assert torch.equal(rows(index, table), table[index.int()])


def planes_are_summed_as_they_are_convolved():
    for kernel in (1, 3):
        told = Told(PictureDitConfig(told=(4, 8, 16), cells=16, planes=12, plane_kernel=kernel))
        planes = torch.randint(0, 18, (2, 12, 8, 10), dtype=torch.uint8)
        summed = told.of_planes(planes)
        convolved = told.planes[0](rows(planes, told.plane_table.weight).permute(0, 1, 4, 2, 3).flatten(1, 2))
        assert torch.allclose(summed, convolved, atol=1e-5), kernel


def a_surface_is_found_where_it_was():
    """A wall 10 m ahead, seen from a metre nearer: a pixel off the middle moves towards it by a tenth. Sideways, all move by f / d."""
    intrinsic = torch.tensor([[[40.0, 0, 32], [0, 40, 16], [0, 0, 1]]])
    depth = torch.full((1, 32, 64), 10.0)
    way = torch.eye(4)[None].clone()
    way[0, 2, 3] = 1  # the camera stood a metre behind
    u, v, z = seen_then(depth, intrinsic, way)
    assert torch.allclose(z, torch.full_like(z, 11.0)) and torch.allclose(u[0, 0] + 0.5 - 32, (torch.arange(64) + 0.5 - 32) * 10 / 11, atol=1e-4)
    way[0, :3, 3] = torch.tensor([0.5, 0, 0])
    u, v, _ = seen_then(depth, intrinsic, way)
    assert torch.allclose(u[0] - torch.arange(64), torch.full((32, 64), 2.0), atol=1e-4) and torch.allclose(v[0], torch.arange(32)[:, None].expand(32, 64).float(), atol=1e-4)
    latent = torch.randn(1, 32, 64, 2)
    found = warp(latent, depth, depth, intrinsic, way)
    assert found.shape == (1, 32, 64, 11)
    assert found[0, :, :61, -1].all() and torch.allclose(found[0, :, :60, :2], latent[0, :, 2:62], atol=1e-4) and not found[0, :, 63].any()
    hidden = warp(latent, depth, torch.full_like(depth, 2.0), intrinsic, way)
    assert not hidden.any()


def neighbours_hear_each_other():
    """What one camera sees changes what its two neighbours draw, and, of one block across, no other; without such blocks none."""
    torch.manual_seed(0)
    for across, heard in (((0,), {1, 2, 3}), ((), {2})):
        dit = PictureDit(PictureDitConfig(told=(4, 8, 8), cells=16, width=32, depth=1, heads=2, across=across)).eval()
        for p in dit.parameters():
            torch.nn.init.normal_(p, std=0.1)
        told = (torch.randint(20, (1, 6, 32, 64), dtype=torch.uint8), torch.rand(1, 6, 32, 64) * 30, torch.randint(17, (1, 6, 32, 64), dtype=torch.uint8))
        rest = (torch.tensor([1]), torch.tensor([6]), torch.randn(1, 6, 7))
        x = torch.randn(1, 6, 4, 8, 8)
        changed = x.clone()
        changed[:, 2] += 1
        with torch.no_grad():
            a, b = (dit(noisy, torch.tensor([500.0]), dit.condition(*told, *rest)) for noisy in (x, changed))
        assert {i for i in range(6) if not torch.allclose(a[:, i], b[:, i], atol=1e-6)} == heard


def a_mirror_is_a_mirror():
    """Twice mirrored is as before; a mirrored camera finds mirrored places."""
    facing = torch.arange(17, dtype=torch.uint8)
    assert torch.equal(mirrored_facing(mirrored_facing(facing)), facing) and mirrored_facing(facing)[1] == 1 and mirrored_facing(facing)[2] == 16
    pool = Pool(4, SIZE, torch.device("cpu"), planes=True)
    made = shard(2)
    pool.add(made)
    at, moment = torch.tensor([0, 1]), torch.tensor([1, 0])
    plain, mirrored = (pool.moments(at, moment, m) for m in (False, True))
    places = [seen_then(part["depth_m"].flatten(0, 1), part["intrinsic"].flatten(0, 1), part["way"].flatten(0, 1)) for part in (plain, mirrored)]
    u, v, z = (x.view(2, 6, 32, 64) for x in places[0])
    u2, v2, z2 = (x.view(2, 6, 32, 64)[:, MIRRORED].flip(-1) for x in places[1])
    assert torch.allclose(z, z2, atol=1e-3) and torch.allclose(v, v2, rtol=1e-3, atol=1e-2) and torch.allclose(u, 63 - u2, rtol=1e-3, atol=1e-2)
    assert ways(made["map_from_camera"]).shape == (2, 2, 6, 4, 4)
    numbers = camera_numbers(made["map_from_camera"], made["intrinsic"], made["sun"], SIZE[0])
    assert np.allclose(numbers[..., 3:6], [0, -1, 0], atol=1e-6)  # the camera's y axis points down
    planes = planes_of(plain["dense"], plain["pose"], plain["intrinsic"], SIZE, 4)
    assert planes.shape == (2, 6, 4, 16, 32) and (planes <= 17).all() and (planes < 17).any()
    silence(plain, torch.tensor([True, False]))
    assert plain["classes"][0].any() and not plain["classes"][1].any() and not plain["depth_m"][1].any()
    silent = planes_of(plain["dense"], plain["pose"], plain["intrinsic"], SIZE, 4)
    assert torch.equal(silent[0], planes[0]) and (silent[1] == 17).all()


def a_folder_of_shards_is_a_stream():
    with tempfile.TemporaryDirectory() as folder:
        for source in (folder, f"{folder}/nothing"):
            try:
                Streams([source])
                raise AssertionError(source)
            except SystemExit:
                pass
        for i in range(2):
            tensors = {name: torch.from_numpy(values) for name, values in shard(i + 1).items()}
            save_file(tensors, Path(folder) / f"shard_{i:05}.safetensors")
        streams, pool = Streams([folder, folder]), Pool(8, SIZE, "cpu")
        while streams.running:
            pool.take_all(streams)
        assert pool.seen == 3


def toy_run(worlds):
    """All parts of a training, at toy size, on frames of the program."""
    stream = f"{shlex.quote(worlds)} --kind pictures --size 64x32 --stream --threads 1 --per-shard 1 --preview"
    with tempfile.TemporaryDirectory() as folder:
        args = train_pictures.arguments().parse_args(shlex.split(
            f"--stream '{stream} --frames 8 --seed 1 --from {{start}}' --held-stream '{stream} --frames 4 --seed 2' --streams 1 --minutes 0.7 "
            f"--vae-share .5 -o {folder} --size 64x32 --room 16 --first 4 --held-out 4 --pictures 4 --batch 2 --ablation-batch 2 --tiny --note-s 5 "
            "--sampling 2 --ablate all,no_cross_view,no_depth,no_previous,planes_3 --ablation-share .3"))
        trainer = train_pictures.Trainer(args)
        trainer.run()
        assert {p.name for p in Path(folder).iterdir()} == {"vae.safetensors", "dit.safetensors", "segmenter.safetensors", "log.jsonl", "figures.json",
                                                            "sheet_0.jpg", "sheet_1.jpg", "sheet_2.jpg"}
        assert trainer.vae.means()["l1"] < 0.5 and trainer.dit.means()["v"] < 1.2


if __name__ == "__main__":
    networks_keep_their_shapes()
    planes_are_summed_as_they_are_convolved()
    a_surface_is_found_where_it_was()
    neighbours_hear_each_other()
    a_mirror_is_a_mirror()
    a_folder_of_shards_is_a_stream()
    if len(sys.argv) > 1:
        toy_run(sys.argv[1])
    print("ok")

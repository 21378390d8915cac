"""python test_sensors.py: painting of voxels, symmetries and a toy training of the network that tells voxels from LiDAR and cameras, on the processor, in a
minute. With the path of `sceneloom-worlds`, on frames of the program too."""
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import torch

import train_sensor_occupancy
from models.lidar_perceiver import PILLAR, pillars
from models.occ_vae import FREE
from models.sensor_occupancy import UNSEEN, SensorOccupancy, SensorOccupancyConfig, painted, ways
from sensor_data import ARMS, heard, mirrored

AHEAD = torch.tensor([[[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 1.5], [0, 0, 0, 1]]])  # looks along x, 1.5 m above the origin
LENS = torch.tensor([[[32.0, 0, 32], [0, 32, 16], [0, 0, 1]]])


def a_camera_paints_what_it_sees():
    """The left half of its picture shows a building, the right half a road."""
    shown = torch.full((1, 32, 64), 15, dtype=torch.uint8)
    shown[:, :, 32:] = 11
    out = painted(shown, LENS, AHEAD)
    assert out.shape == (200, 200, 16)
    assert out[150, 105, 6] == 15 and out[150, 95, 6] == 11  # y is to the left
    assert (out[:100] == UNSEEN).all() and out[150, 199, 6] == UNSEEN
    both = painted(torch.cat([torch.full_like(shown, 7), shown]), torch.cat([LENS, LENS]), torch.cat([AHEAD, AHEAD]))
    assert both[150, 105, 6] == 7, "of equals the first one counts"


def ways_and_pillars_turn_alike():
    """In a mirror a frame's parts still lie upon each other."""
    rng = np.random.default_rng(0)
    points = np.concatenate([rng.uniform(-39, 39, (500, 2)), np.ones((500, 2))], 1).astype(np.float32)
    solid = np.full((200, 200, 16), FREE, np.uint8)
    at = np.floor((points[:, :2] + 40) / 0.4).astype(int)
    solid[at[:, 0], at[:, 1], 5] = 4
    for symmetry in range(8):
        p, centres, (grid,) = mirrored(points, points[:, :2], [solid], symmetry)
        hit = pillars(torch.from_numpy(p))[15] > 0
        assert (hit.numpy() == (np.ascontiguousarray(grid)[..., 5] == 4)).mean() > 0.999, symmetry
        assert np.array_equal(p[:, :2], centres)
    way = ways()
    assert torch.allclose(way.norm(dim=0), torch.ones(200, 200)) and way[0, 199, 100] > 0.99 and way[1, 100, 199] > 0.99


def silence_is_silent():
    points, paint = np.ones((3, 4), np.float32), np.zeros((200, 200, 16), np.uint8)
    for name, (lidar, cameras) in ARMS.items():
        pillar, way, told = heard(points, paint, lidar, cameras)
        assert bool(pillar[15].any()) == lidar and bool((told != UNSEEN).any()) == cameras, name
    part = heard(points, paint, True, True, (slice(96, 112), slice(96, 112)))
    assert part[0].shape == (PILLAR, 16, 16) and part[1].shape == (2, 16, 16) and part[2].shape == (16, 16, 16)
    assert torch.equal(part[0], heard(points, paint, True, True)[0][:, 96:112, 96:112])


def toy_training():
    """A wall where returns are and where a painted class is: both are learnt."""
    torch.manual_seed(0)
    net = SensorOccupancy(SensorOccupancyConfig(widths=(8, 12, 16)))
    optimizer, first = torch.optim.AdamW(net.parameters(), lr=1e-2), None
    for step in range(60):
        pillar, paint = torch.zeros(2, PILLAR, 32, 32), torch.full((2, 32, 32, 16), UNSEEN, dtype=torch.uint8)
        dense = torch.full((2, 32, 32, 16), FREE, dtype=torch.uint8)
        x, y = np.random.default_rng(step).integers(0, 32, 2)
        pillar[:, 15, x], dense[:, x, :, :4] = 1, 15
        paint[:, :, y, 2], dense[:, :, y, 2] = 4, 4
        loss, entropy = train_sensor_occupancy.loss_of(net(pillar, ways()[None, :, :32, :32].expand(2, -1, -1, -1), paint), dense, 4)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        first = first or entropy.item()
    assert entropy.item() < 0.5 * first, (first, entropy)


def frames_of_the_program(worlds):
    with tempfile.TemporaryDirectory() as folder:
        for part, seed in (("train", 6), ("val", 2)):
            subprocess.run([worlds, "--kind", "sensors", "--preview", "--frames", "2", "--seed", str(seed), "-o", f"{folder}/{part}"], check=True, stderr=subprocess.DEVNULL)
        out = f"{folder}/w.safetensors"
        subprocess.run([sys.executable, "train_sensor_occupancy.py", "--data", folder, "--minutes", "0.2", "-o", out, "--tiny", "--side", "64", "--held-out", "1", "--batch", "2"], check=True,
                       cwd=Path(__file__).parent, stdout=subprocess.DEVNULL)
        assert Path(out).exists() and Path(f"{folder}/train/shard_00000.painted.npy").exists()


if __name__ == "__main__":
    torch.set_num_threads(1)
    a_camera_paints_what_it_sees()
    ways_and_pillars_turn_alike()
    silence_is_silent()
    toy_training()
    if len(sys.argv) > 1:
        frames_of_the_program(str(Path(sys.argv[1]).resolve()))
    print("ok")

"""python test_lidar.py REFERENCE: the learned LiDAR's parts against reference/neus.json, nn.safetensors and closed forms."""
import json
import sys
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import load_file

from lidar_data import active_cells, march
from models.lidar import FREE, Gathered, Lidar, LidarConfig, Sites, index_volume, lookup_of, neighbours, neus_weights, physical, surface


def close(a, b, tolerance):
    worst = (torch.as_tensor(a, dtype=torch.float64) - torch.as_tensor(b, dtype=torch.float64)).abs().max().item()
    assert worst <= tolerance, (worst, tolerance)


def neus(reference):
    for ray in json.loads((reference / "neus.json").read_text())["rays"]:
        f = torch.tensor([ray["sdf_m"]], dtype=torch.float64)
        weights, passed = neus_weights(f, torch.tensor(ray["s"], dtype=torch.float64))
        close(weights[0], ray["weights"], 1e-9)
        close(-torch.expm1(passed[0]), ray["sum"], 1e-9)


def convolution(reference):
    t = load_file(reference / "nn.safetensors")
    coords = np.argwhere(t["sparse.some.active"].numpy())
    around = torch.from_numpy(neighbours(coords, index_volume(coords, (6, 6, 4))))
    x = t["sparse.some.x"].permute(1, 2, 3, 0)[tuple(coords.T)].double().requires_grad_()
    weight = t["sparse.weight"].flatten(2).permute(2, 1, 0).reshape(-1, 5).double().requires_grad_()
    out = Gathered.apply(x, weight, around) + t["sparse.bias"]
    close(out.detach(), t["sparse.some.submanifold"].permute(1, 2, 3, 0)[tuple(coords.T)], 1e-9)
    torch.autograd.gradcheck(lambda x, w: Gathered.apply(x, w, around), (x, weight))


def sites_and_samples():
    grid = np.full((200, 200, 16), FREE, np.uint8)
    grid[100:140, 90:110, 0] = 11  # road, where labels have it
    grid[120, 95:105, 0:8] = 15  # a wall, smeared down
    coords, classes = surface(physical(grid))
    assert coords[:, 2].min() == 2 and (coords[classes == 15][:, 2] >= 2).all()
    assert (physical(grid)[110, 100] != FREE).nonzero()[0].tolist() == [2]
    density = active_cells(coords, classes)
    d = np.array([[1, 0, -0.1], [1, 0, 0.0], [0, 1, 0.5]], np.float32)
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    t, valid, _, _ = march(density, np.array([0.3, 0.1, 1.84], np.float32), d, np.random.default_rng(0), 24)
    assert valid[:2].any(1).all() and not valid[2].any()
    assert all((np.diff(row[ok]) > 0).all() for row, ok in zip(t, valid))
    net = Lidar(LidarConfig(widths=(8, 8, 8)))
    sites = Sites(coords, classes)
    geometry, _ = net.features(sites)
    p = torch.tensor([[0.2, 0.2, 0.1], [39.0, 39.0, 5.0], [1e6, 0.0, 0.0]])
    f = net.sdf(geometry, *lookup_of(sites.volume)(p))
    assert torch.isfinite(f).all() and f[1] == f[2]


if __name__ == "__main__":
    neus(Path(sys.argv[1]))
    convolution(Path(sys.argv[1]))
    sites_and_samples()
    print("ok")

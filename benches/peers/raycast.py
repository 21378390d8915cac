"""One LiDAR revolution, 34,688 rays into the reference grid: ours beside Open3D's ray casting scene (Embree)."""
from common import Ours, arguments, beside, needs

needs("open3d", "numpy", "safetensors")
import sys
import time

import numpy as np
import open3d as o3d

VOXEL_M = 0.4
ORIGIN_M = (40.0, 40.0, 2.24)


def faces(grid):
    """Exposed faces of the voxels as triangles: vertices f32 [n, 3], indices u32 [m, 3]."""
    full = np.pad(grid, 1)
    vertices, count = [], 0
    for axis in range(3):
        for side in (0, 1):
            beyond = np.roll(full, 1 - 2 * side, axis)[1:-1, 1:-1, 1:-1]
            at = np.argwhere(grid & ~beyond).astype(np.float32)
            corner = np.zeros((4, 3), np.float32)
            u, v = [a for a in range(3) if a != axis]
            corner[:, axis] = side
            corner[1:3, u] = 1
            corner[2:4, v] = 1
            vertices.append((at[:, None] + corner).reshape(-1, 3))
            count += len(at)
    quads = np.arange(count * 4, dtype=np.uint32).reshape(-1, 4)
    return np.concatenate(vertices) * VOXEL_M, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def main():
    args = arguments()
    ours = Ours(args.threads)
    x = ours.arrays()
    begun = time.perf_counter()
    vertices, triangles = faces(x["occupied"].astype(bool))
    meshed = time.perf_counter()
    scene = o3d.t.geometry.RaycastingScene(nthreads=args.threads)
    scene.add_triangles(o3d.core.Tensor(vertices), o3d.core.Tensor(triangles))
    rays = np.concatenate([np.broadcast_to(np.float32(ORIGIN_M), x["rays"].shape), x["rays"]], 1)
    rays = o3d.core.Tensor(np.ascontiguousarray(rays, np.float32))
    t = scene.cast_rays(rays, nthreads=args.threads)["t_hit"].numpy()
    built = time.perf_counter()
    print(f"Open3D {o3d.__version__}: {len(triangles)} triangles, meshing {1e3 * (meshed - begun):.0f} ms, build and first cast {1e3 * (built - meshed):.0f} ms")
    hit, own = np.isfinite(t), np.isfinite(x["ranges"])
    gap = np.abs(t - x["ranges"])[hit & own].max()
    print(f"rays: {own.sum()} hits, {(hit != own).sum()} hit or miss mismatches, at most {1e3 * gap:.2f} mm apart (allowed 0 and 1 mm)")
    if (hit != own).any() or gap > 1e-3:
        sys.exit("the two sides see different things")
    beside("ray cast", lambda: ours("raycast"), lambda: scene.cast_rays(rays, nthreads=args.threads), args.runs, "Open3D")


main()

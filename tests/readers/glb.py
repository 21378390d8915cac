# packages: trimesh==5.2.0 pygltflib==1.16.5
"""Reads a scene.glb with trimesh and pygltflib: the voxels of each class by the volume of its mesh, and where a box is."""

import importlib.metadata
import json
import sys

import numpy as np
import pygltflib
import trimesh


def main(path):
    document = pygltflib.GLTF2().load(path)
    recipe = next(n.extras["sceneloom"] for n in document.nodes if n.extras and "sceneloom" in n.extras)
    assert recipe["class_map"] == "occ3d-nuscenes" and recipe["voxel_m"] == 0.4, recipe
    scene = trimesh.load_scene(path, process=False)
    voxels, boxes, placeholders = {}, 0, 0
    for node in document.nodes:
        extras = node.extras or {}
        if "class_id" not in extras:
            continue
        material = document.materials[document.meshes[node.mesh].primitives[0].material].name
        assert material == extras["class"], (material, extras)
        transform, geometry = scene.graph[node.name]
        if "id" in extras:
            boxes += 1
            x, y, z = extras["center_m"]
            assert np.allclose(transform[:3, 3], [x, z, -y], atol=1e-3), (node.name, transform, extras)
            ahead = transform[:3, :3] @ [1, 0, 0]
            yaw = extras["yaw_rad"]
            assert np.allclose(ahead, [np.cos(yaw), 0, -np.sin(yaw)], atol=1e-4), (node.name, ahead)
            if extras.get("placeholder"):
                placeholders += 1
                size = scene.geometry[geometry].extents
                assert np.allclose(size, extras["size_m"], rtol=1e-5), (node.name, size)
                continue
        count = scene.geometry[geometry].volume / 0.4**3
        assert count > 0.5 and abs(count - round(count)) < 1e-2, (node.name, count)
        voxels[extras["class"]] = voxels.get(extras["class"], 0) + round(count)
    low, high = scene.bounds
    from_m = np.array(recipe["extent"]["from"]) * 0.4
    to_m = from_m + np.array(recipe["extent"]["columns"]) * 0.4
    # The box of a moving object may reach beyond the map.
    assert low[0] > from_m[0] - 20 and high[0] < to_m[0] + 20 and -to_m[1] - 20 < low[2], scene.bounds
    return {"voxels": voxels, "boxes": boxes, "placeholders": placeholders, "meshes": len(scene.geometry)}


if __name__ == "__main__":
    try:
        found = main(sys.argv[1])
    except Exception as error:  # one line for whoever runs all readers
        sys.exit(f"{type(error).__name__}: {error}".replace("\n", " ")[:300])
    versions = f"{trimesh.__version__}, pygltflib {importlib.metadata.version('pygltflib')}"
    print(json.dumps({"reader": "trimesh", "version": versions, "accepted": True, "read": found}))

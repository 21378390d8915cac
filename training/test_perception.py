"""python test_perception.py: the LiDAR perceiver's data, network, figures and a toy training, on the processor, in half a minute. With the path of
`sceneloom-worlds`, on frames of the program too."""
import json
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import torch

import pack_perception
import train_perception
from loop import pick_device
from models.lidar_perceiver import BOX, GROUPS, PILLAR, STANDS, LidarPerceiver, PerceiverConfig, decode, pillars
from perception_data import IGNORED, PerceptionFrames, asked_for, batch, disturbed, mirrored, sample, targets
from perception_eval import Boxes, Standing, average_precision, evaluated, matched


def toy(rng, cars=6):
    """A frame: a level road, cars of class 4 on it, each with returns on its sides; the last one has none."""
    ground = np.stack([*rng.uniform(-39.9, 39.9, (2, 4000)), np.zeros(4000), np.full(4000, 20)], 1)
    boxes, returns, labels = [], [ground], np.full((200, 200), 11, np.uint8)
    for i in range(cars):
        x, y, yaw = -33 + 12 * i, rng.uniform(-35, 35), rng.uniform(-3, 3)
        c, s = np.cos(yaw), np.sin(yaw)
        n = 0 if i == cars - 1 else 200
        at = rng.uniform(-1, 1, (n, 3)) * [2.2, 0.9, 0.8]
        returns.append(np.stack([x + at[:, 0] * c - at[:, 1] * s, y + at[:, 0] * s + at[:, 1] * c, 0.8 + at[:, 2], np.full(n, 90)], 1))
        boxes.append([x, y, 0.8, 4.5, 1.9, 1.6, yaw, 4, n])
        labels[int((x + 40) / 0.4), int((y + 40) / 0.4)] = 4
    return np.concatenate(returns).astype(np.float32), np.array(boxes, np.float32), labels


def folder_of(path, count):
    rng = np.random.default_rng(5)
    assert pack_perception.pack((toy(rng) for _ in range(count)), path) == count
    return PerceptionFrames(path)


def pillars_hold_what_was_measured():
    points = torch.tensor([[0.1, 0.3, 0.5, 255.0], [0.3, 0.1, 0.9, 0.0], [float("nan"), 0, 0, 0], [0, 0, 0, float("inf")], [40.0, 0, 0, 1], [-40.1, 0, 0, 1]])
    x = pillars(points)
    assert x.shape == (PILLAR, 200, 200) and torch.isfinite(x).all()
    column = x[:, 100, 100]
    assert torch.allclose(column[[4, 5]], torch.log1p(torch.ones(2)) / 4) and torch.allclose(column[12:15], torch.tensor([0.3, 0.5 / 3, 0.5]))
    assert abs(column[15] - np.log(3) / 4) < 1e-6 and torch.allclose(column[16:18], torch.zeros(2), atol=1e-5)
    assert (x[15] > 0).sum() == 1
    empty = pillars(torch.zeros(0, 4))
    assert not empty[:18].any() and abs(empty[18, 0, 0] - 39.8 * 2**0.5 / 40) < 1e-5


def truth_comes_back():
    """What is asked of the network, decoded, is the boxes that have returns; also in a mirror."""
    points, boxes, labels = toy(np.random.default_rng(1))
    standing = np.where(labels == 4, 5, 0).astype(np.uint8)
    for symmetry in range(8):
        p, b, s = mirrored(points, boxes, standing, symmetry)
        assert pillars(torch.from_numpy(p)).shape == (PILLAR, 200, 200) and (s == 5).sum() == len(b)
        heat, numbers, weight = targets(b)
        assert (heat == 1).sum() == len(b) - 1 and (heat < 0).any() and weight.max() == 1
        clear = torch.from_numpy(np.concatenate([np.where(heat > 0.99, 5.0, -5.0), numbers])).float()
        found = decode(clear, 0.5).numpy()
        assert len(found) == len(b) - 1
        for box in b[b[:, 8] > 0]:
            near = found[np.hypot(*(found[:, 2:4] - box[:2]).T).argmin()]
            assert np.abs(near[2:8] - box[:6]).max() < 1e-3 and abs(np.exp(1j * near[8]) - np.exp(1j * box[6])) < 1e-3
            x, y = int((box[0] + 40) / 0.4), int((box[1] + 40) / 0.4)
            assert s[x - 1 : x + 2, y - 1 : y + 2].max() == 5
    assert len(disturbed(points, np.random.default_rng(2))) > 0.5 * len(points)


def figures_are_right():
    scores, right = np.array([0.9, 0.8, 0.7]), np.array([1.0, 1, 1])
    assert average_precision(scores, right, 3) > 0.99 and average_precision(scores, 1 - right, 3) == 0 and average_precision(scores, right, 0) is None
    assert average_precision(scores, right, 6) < 0.5 and average_precision(np.zeros(0), np.zeros(0), 3) == 0
    assert list(matched(np.array([[0.0, 0], [0.1, 0], [5, 5]]), np.array([[0.0, 0]]), 1.0)) == [0, -1, -1]
    boxes = Boxes()
    _, truth, _ = toy(np.random.default_rng(1))
    true, groups = asked_for(truth)
    found = torch.tensor(np.column_stack([groups, np.full(len(true), 0.9), true[:, :7]]))
    boxes.add(found, truth)
    out = boxes.figures()
    # The last car has no return: it is not asked for, and finding it is a ghost.
    assert out["ghosts_per_frame"] == 1 and out["groups"]["car"]["asked"] == 5 and set(out["groups"]) == {"car"}
    assert out["groups"]["car"]["errors"]["place_m"] == 0 and 0.9 < out["map"] <= 1
    standing = Standing()
    logits = torch.nn.functional.one_hot(torch.zeros(200, 200, dtype=torch.long), len(STANDS)).permute(2, 0, 1).float()
    truth = np.zeros((200, 200), np.uint8)
    truth[:100] = IGNORED
    standing.add(logits, truth, torch.zeros(PILLAR, 200, 200))
    assert standing.figures()["all"]["miou"] == 1 and standing.figures()["seen"]["miou"] == 0


def an_empty_sweep_is_nothing_new():
    net = LidarPerceiver(PerceiverConfig(widths=(8, 12, 16))).eval()
    stands, boxes = net(pillars(torch.zeros(0, 4))[None])
    assert stands.shape == (1, len(STANDS), 200, 200) and boxes.shape == (1, len(GROUPS) + BOX, 100, 100)
    assert torch.isfinite(stands).all() and torch.isfinite(boxes).all() and decode(boxes[0].detach(), 0.5).shape == (0, 9)
    loss, parts = train_perception.losses(net, pillars(torch.zeros(0, 4))[None], torch.full((1, 200, 200), IGNORED, dtype=torch.uint8), torch.zeros(1, 5, 100, 100),
                                          torch.zeros(1, BOX, 100, 100), torch.zeros(1, 100, 100))
    loss.backward()
    assert torch.isfinite(loss) and parts["box"] == 0


def tables_of_nuscenes_are_read():
    """A car 10 m ahead of a vehicle that looks along y, as tables tell it."""
    with tempfile.TemporaryDirectory() as folder:
        tables = Path(folder) / "v1.0-mini"
        (Path(folder) / "samples" / "LIDAR_TOP").mkdir(parents=True)
        tables.mkdir()
        turn = [2**-0.5, 0, 0, 2**-0.5]
        rows = {"scene": [{"token": "s", "name": "scene-1"}], "sample": [{"token": "m", "scene_token": "s"}],
                "calibrated_sensor": [{"token": "c", "rotation": [1, 0, 0, 0], "translation": [1, 0, 2]}],
                "ego_pose": [{"token": "e", "rotation": turn, "translation": [100, 50, 0]}], "category": [{"token": "k", "name": "vehicle.car"}],
                "instance": [{"token": "i", "category_token": "k"}],
                "sample_annotation": [{"sample_token": "m", "instance_token": "i", "rotation": turn, "translation": [100, 60, 1], "size": [2, 4, 1.5],
                                       "num_lidar_pts": 3}],
                "sample_data": [{"sample_token": "m", "is_key_frame": True, "filename": "samples/LIDAR_TOP/a.pcd.bin", "calibrated_sensor_token": "c",
                                 "ego_pose_token": "e"}]}
        for name, found in rows.items():
            (tables / f"{name}.json").write_text(json.dumps(found))
        np.array([[1, 2, -1, 7, 0]], "<f4").tofile(Path(folder) / "samples/LIDAR_TOP/a.pcd.bin")
        (points, boxes, standing), = pack_perception.of_nuscenes(folder)
        assert np.allclose(points, [[2, 2, 1, 7]]) and (standing == 17).all()
        assert np.allclose(boxes, [[10, 0, 1, 4, 2, 1.5, 0, 4, 3]], atol=1e-6)


def what_stands_is_told():
    labels = np.full((200, 200, 16), 17, np.uint8)
    labels[0, 0, 0], labels[0, 1, 0], labels[0, 1, 6], labels[0, 2, 0], labels[0, 2, 5], labels[0, 3, 15] = 11, 11, 16, 11, 16, 15
    labels[0, 4, 2:5] = (4, 16, 15)
    assert list(pack_perception.standing(labels)[0, :6]) == [11, 11, 16, 15, 4, 17]


def a_square_is_a_part_of_its_frame(frames):
    for seed in range(4):
        whole, part = (batch(frames, np.random.default_rng(seed), 1, side) for side in (200, 64))
        assert [p.shape[-1] for p in part] == [64, 64, 32, 32, 32] and part[3].shape == (1, BOX, 32, 32)
        x = part[0][0, 18, 0]
        corner = [(x0, y0) for x0 in range(0, 137, 2) for y0 in range(0, 137, 2) if torch.equal(whole[0][0, 18, x0, y0 : y0 + 64], x)]
        assert any(torch.allclose(whole[0][0, :, x0 : x0 + 64, y0 : y0 + 64], part[0][0], atol=1e-5)
                   and torch.equal(whole[2][0, :, x0 // 2 : x0 // 2 + 32, y0 // 2 : y0 // 2 + 32], part[2][0]) for x0, y0 in corner)


def toy_training():
    """A minute's training on a few frames lowers every loss and is resumed where it was."""
    with tempfile.TemporaryDirectory() as folder:
        frames = folder_of(Path(folder) / "train", 6)
        assert frames.read(0)[2].max() == 5 and sample(frames, None, 0)[0].shape == (PILLAR, 200, 200)
        a_square_is_a_part_of_its_frame(frames)
        device, dtype = pick_device(1)
        torch.manual_seed(0)
        net, rng = LidarPerceiver(PerceiverConfig(widths=(8, 12, 16))), np.random.default_rng(0)
        optimizer, first = torch.optim.AdamW(net.parameters(), lr=1e-2), None
        for _ in range(40):
            loss, parts = train_perception.losses(net, *batch(frames, rng, 2, 120))
            optimizer.zero_grad()
            loss.backward()
            optimizer.step()
            first = first or {k: v.item() for k, v in parts.items()}
        assert all(parts[k].item() < 0.7 * first[k] for k in parts), (first, parts)
        found = evaluated(net.eval(), frames, range(2))
        assert found["standing"]["all"]["miou"] > 0.3 and set(found["boxes"]["groups"]) == {"car"}
        if find_spec("PIL"):
            from perception_sheet import sheet
            assert sheet(net, frames, range(2)).size == (1212, 806)


def frames_of_the_program(worlds):
    with tempfile.TemporaryDirectory() as folder:
        for part, seed in (("train", 6), ("val", 2)):
            subprocess.run([worlds, "--kind", "perception", "--frames", "3", "--seed", str(seed), "-o", f"{folder}/{part}"], check=True, stderr=subprocess.DEVNULL)
        frames = PerceptionFrames(f"{folder}/train")
        assert len(frames) == 3 and all(len(frames.read(i)[0]) > 5000 for i in range(3))
        out = f"{folder}/w.safetensors"
        subprocess.run([sys.executable, "train_perception.py", "--data", folder, "--minutes", "0.2", "-o", out, "--tiny", "--side", "64", "--held-out", "2", "--batch", "2"], check=True,
                       cwd=Path(__file__).parent, stdout=subprocess.DEVNULL)
        said = subprocess.run([sys.executable, "perception_eval.py", out, f"{folder}/val", "--sheet", f"{folder}/s.png"], check=True, cwd=Path(__file__).parent,
                              capture_output=True, text=True).stdout
        assert json.loads(said)["frames"] == 3 and Path(f"{folder}/s.png").exists()


if __name__ == "__main__":
    torch.set_num_threads(1)
    pillars_hold_what_was_measured()
    truth_comes_back()
    figures_are_right()
    an_empty_sweep_is_nothing_new()
    tables_of_nuscenes_are_read()
    what_stands_is_told()
    toy_training()
    if len(sys.argv) > 1:
        frames_of_the_program(str(Path(sys.argv[1]).resolve()))
    print("ok")

"""python test_training.py REFERENCE: losses and schedule against reference/metrics.json and closed forms."""
import json
import math
import shlex
import sys
import tempfile
from pathlib import Path

import numpy as np
import torch
from safetensors.numpy import save_file
from torch import nn

from calibrate import figures, search
from data import GRIDS, Places, Streamed, draw_given, leaned, named, turned, turned_heading, with_background
from muon import orthogonalised
from losses import kl_to_normal, lovasz_softmax, vae_loss
from models.occ_dit import CONDITION, DitConfig, OccDit, condition_of, patchify, unpatchify
from models.occ_vae import OccVae, VaeConfig, fold, unfold
from models.occ_dit_time import OccDitTime, TimeConfig, warp
from models.refiner import Refiner
from models.time_decoder import TimeDecoder, cell_warp, window_pose
from models.triplane_vae import TriplaneVae, numbers, side_of
from pack import columns_of
from pack_refiner import ARRAYS, PackedPairs
from schedule import alpha_bar, ddim_sample


def close(a, b, tolerance):
    worst = (torch.as_tensor(a, dtype=torch.float64) - torch.as_tensor(b, dtype=torch.float64)).abs().max().item()
    assert worst <= tolerance, (worst, tolerance)


def lovasz_against_reference(folder):
    """Torch 2.15.0 in float64, tolerance 1e-10, gradient 1e-9 (reference/README.md)."""
    for case in json.loads((folder / "metrics.json").read_text())["lovasz"]:
        logits = torch.tensor(case["logits"], dtype=torch.float64, requires_grad=True)
        loss = lovasz_softmax(logits.softmax(-1), torch.tensor(case["labels"]))
        close(loss, case["loss"], 1e-10)
        loss.backward()
        close(logits.grad, case["grad_logits"], 1e-9)


def schedule_against_reference(folder):
    table = json.loads((folder / "schedulers.json").read_text())["alpha_bar"]["cosine_zero_snr"]
    close(alpha_bar()[table["t"]], table["alpha_bar"], 1e-12)


def row_31_kl():
    zero = torch.zeros(4)
    assert kl_to_normal(zero, zero).item() == 0
    for logvar in (30.0, -30.0, 1e4, -1e4):
        kl = kl_to_normal(zero, torch.full((4,), logvar))
        assert torch.isfinite(kl) and kl >= 0
    # Near zero the naive form cancels: KL = logvar^2 / 4 there.
    small = torch.full((4,), 1e-3)
    close(kl_to_normal(zero, small), 0.25e-6 * (1 + 1e-3 / 3), 1e-9)


def row_32_losses():
    p = torch.tensor([[1e4, -1e4, 0.0]]).softmax(-1)
    for label in range(3):
        loss = lovasz_softmax(p, torch.tensor([label]))
        assert torch.isfinite(loss)
    logits = torch.randn(40, 5, dtype=torch.float64, requires_grad=True)
    labels = torch.randint(3, (40,))  # classes 3 and 4 are absent
    assert torch.autograd.gradcheck(lambda x: lovasz_softmax(x.softmax(-1), labels), logits, atol=1e-3)


def shapes_and_schedule():
    x = torch.randn(2, 3, 20, 12)
    assert torch.equal(unfold(fold(x)), x)
    assert torch.equal(fold(x)[0, :, 4, 5], x[0, :, 8:10, 10:12].permute(1, 2, 0).reshape(-1))
    x = torch.randn(2, 50, 50, 8)
    assert torch.equal(unpatchify(patchify(x)), x)
    abar = alpha_bar()
    assert abar[-1] == 0 and (abar[1:] < abar[:-1]).all() and len(abar) == 1000
    # Data that is one point x0: v = alpha eps - sigma x0 is known, and DDIM must land on x0.
    x0 = torch.randn(1, 50, 50, 8)

    def v(x, t):
        a = abar[int(t[0])]
        alpha, sigma = a.sqrt().float(), (1 - a).sqrt().float()
        return alpha * (x - alpha * x0) / sigma - sigma * x0

    close(ddim_sample(v, torch.randn_like(x0), 7), x0, 1e-5)


def networks_learn():
    """Both networks run, every parameter gets a gradient, nothing outside an encoder's reach matters."""
    torch.manual_seed(0)
    vae = OccVae(VaeConfig(widths=(8, 16, 32)))
    labels = torch.full((1, 200, 200, 16), 17, dtype=torch.uint8)
    labels[:, :, :, 0] = 11
    labels[0, 100:110, 100:104, :4] = 4
    vae_loss(vae, labels)[0].backward()
    assert all(p.grad is not None and torch.isfinite(p.grad).all() for p in vae.parameters())
    moved = labels.clone()
    moved[0, 104, 104, 3] = 7
    with torch.no_grad():
        far = (vae.encode(moved) - vae.encode(labels)).abs().amax((0, 3))
    far[24:29, 24:29] = 0  # two cells around cell (26, 26)
    assert far.max() < 1e-5
    empty = torch.full_like(labels, 17)
    assert torch.isfinite(vae_loss(vae, empty)[0])

    dit = OccDit(DitConfig(width=64, depth=2, heads=2))
    torch.nn.init.normal_(dit.final.weight)
    condition = dit.condition(torch.randn(1, 50, 50, CONDITION), torch.zeros(1, 9))
    dit(torch.randn(1, 50, 50, 8), torch.tensor([500.0]), condition).sum().backward()
    assert all(torch.isfinite(p.grad).all() for p in dit.parameters() if p.grad is not None)


def a_window_hears_what_its_part_of_the_frame_says():
    torch.manual_seed(1)
    draw = lambda *shape, high=2: torch.randint(high, (1, *shape))
    whole = {"mask": draw(50, 50).float(), "context": torch.randn(1, 50, 50, 8), "draft": torch.randn(1, 50, 50, 8),
             "bev": draw(200, 200, high=2**18).int(), "heading": draw(200, 200, high=241).byte(), "given": draw(50, 50, 2).float(),
             "columns": draw(200, 200, 5, high=17).byte(), "ground": draw(50, 50).float()}
    cells = condition_of(**whole)
    assert cells.shape == (1, 50, 50, CONDITION)
    part = {name: x[:, 40:72, 80:112] if x.shape[1] == 200 else x[:, 10:18, 20:28] for name, x in whole.items()}
    assert torch.equal(condition_of(**part), cells[:, 10:18, 20:28])
    # A network without blocks looks at each token alone, so a window of it is a window of the whole.
    dit = OccDit(DitConfig(width=64, depth=0, heads=2))
    torch.nn.init.normal_(dit.final.weight)
    x, t, named = torch.randn(1, 50, 50, 8), torch.tensor([500.0]), torch.zeros(1, 9)
    with torch.no_grad():
        all_ = dit(x, t, dit.condition(cells, named))
        window = dit(x[:, 10:18, 20:28], t, dit.condition(cells[:, 10:18, 20:28], named, torch.tensor([[5, 10]])))
    close(window, all_[:, 10:18, 20:28], 1e-5)


def columns_of_the_background():
    draft = np.full((200, 200, 16), 17, np.uint8)
    draft[..., 2] = 11
    given = draft.copy()
    given[3, 4, 3:7], given[3, 4, 9], given[5, 6, 2:4] = 15, 16, 16
    found = columns_of(draft, given)
    assert found[3, 4].tolist() == [4, 7, 10, 10, 3] and found[5, 6].tolist() == [0, 0, 3, 4, 3] and found[0, 0].tolist() == [0, 0, 0, 0, 3]


def muon_treats_matrices_of_one_shape_alike():
    torch.manual_seed(4)
    matrices = torch.randn(3, 96, 64)
    found = orthogonalised(matrices)
    assert (torch.linalg.svdvals(found) < 1.3).all() and (torch.linalg.svdvals(found)[:, :60] > 0.5).all()
    close(orthogonalised(matrices[1]), found[1], 2e-2)


def headings_turn_with_their_frames():
    x, y = np.meshgrid(np.arange(200), np.arange(200), indexing="ij")
    for symmetry in range(8):
        for code in (1, 31, 61, 200):
            angle = (code - 1) / 240 * 2 * np.pi
            ahead = turned(x * np.cos(angle) + y * np.sin(angle), symmetry)  # grows along the heading
            found = turned_heading(np.full((200, 200), code, np.uint8), symmetry)[100, 100]
            angle = (found - 1) / 240 * 2 * np.pi
            assert abs(np.cos(angle) - (ahead[101, 100] - ahead[100, 100])) < 1e-6, (symmetry, code)
            assert abs(np.sin(angle) - (ahead[100, 101] - ahead[100, 100])) < 1e-6, (symmetry, code)
    none = np.zeros((200, 200), np.uint8)
    assert not turned_heading(none, 3).any()


def named_numbers():
    grid, bev = np.full((200, 200, 16), 17, np.uint8), np.ones((200, 200), np.int32)
    assert named(grid, bev) == [0, 0, 0, 0]  # a map that is all road and empty
    bev[:100] = 0
    grid[:100, :50, 3] = 16
    assert named(grid, bev) == [1.0, 0, 0, 0.125]


def leaning_moves_whole_columns():
    grid = np.full((64, 64, 16), 17, np.uint8)
    grid[..., 4], grid[..., 5] = 11, np.arange(64)[:, None] % 10
    rng, levels = np.random.default_rng(5), set()
    for _ in range(20):
        found = leaned(rng, grid)
        taken = found != 17
        assert (taken.sum(2) <= 2).all() and (found[taken] <= 11).all()
        both = taken.sum(2) == 2  # a column within the grid keeps its labels, one above the other
        first = taken.argmax(2)
        assert (np.take_along_axis(found, first[..., None], 2)[both] == 11).all()
        levels |= set(first[both].tolist())
    assert len(levels) > 6 and (grid[..., 4] == 11).all()


def a_given_background_stands_in_the_draft():
    dense, draft = np.full((200, 200, 16), 17, np.uint8), np.full((200, 200, 16), 17, np.uint8)
    draft[..., 0], draft[5, 5, 1] = 11, 4
    dense[..., 0], dense[:9, :9, 1:4], dense[7, 7, 2] = 13, 15, 16
    found = with_background(draft, dense)
    assert (found[..., 0] == 11).all() and found[5, 5, 1] == 4 and found[7, 7, 2] == 16
    assert (found == 15).sum() == 9 * 9 * 3 - 2 and (found[9:, 9:, 1:] == 17).all()
    flags = draw_given(np.random.default_rng(2), 400)
    shares = flags.mean((1, 2, 3))
    assert 0.35 < (shares == 1).mean() < 0.55 and 0.15 < (shares == 0).mean() < 0.35


def a_stream_is_read_in_order():
    """A command that writes three shards of two frames: the newest four are kept, each under the number of one that went."""
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for i in range(3):
            arrays = {n: np.full((2, *s), i, np.int32 if n == "bev" else np.uint8) for n, s in GRIDS.items()}
            save_file(arrays, path := Path(folder) / f"{i}.safetensors")
            files.append(str(path))
        write = ("import sys\nfor f in sys.argv[1:]:\n    data = open(f, 'rb').read()\n"
                 "    sys.stdout.buffer.write(len(data).to_bytes(8, 'little') + data)")
        frames, seen = Streamed(shlex.join([sys.executable, "-c", write, *files]), keep=4), [0, 1]
        held, places = frames.at(0), Places(frames)
        while len(seen) < 6:
            new = frames.rescan()
            places.add(new)
            seen += new
        assert seen == [0, 1, 2, 3, 0, 1] and len(frames) == 4
        assert [int(frames.read(i, "dense")[0, 0, 0]) for i in range(4)] == [2, 2, 1, 1]
        assert frames.read(held, "bev")[0, 0] == 0  # a pair stays what it was
        assert sorted({p[0] for p in places.found[2]}) == [0, 1] and not places.found[0]
        assert frames.rescan() == []
        try:
            Streamed(shlex.join([sys.executable, "-c", "raise SystemExit(3)"]))
        except SystemExit as e:
            assert "code 3" in str(e), e
        else:
            raise AssertionError("a command that fails was not named")


def calibration_undoes_a_bias():
    torch.manual_seed(3)
    truth = torch.randint(2, (4000,)).to(torch.uint8) * 17  # `others` or free
    logits = torch.randn(4000, 18) - 8
    logits[torch.arange(4000), truth.long()] += 1
    logits[:, 0] += 9  # seen too often
    logits[:, 17] += 8
    known = {kind: (logits, truth, torch.zeros(18, 18, dtype=torch.long)) for kind in ("dense", "labels")}
    shift = search(known)
    before, after = figures(known, torch.zeros(18)), figures(known, shift)
    assert (after > before).all() and shift[0] - shift[17] < -0.3, (before, after, shift)


def a_refiner_sees_one_place_in_all_its_latents():
    with tempfile.TemporaryDirectory() as folder:
        shard = Path(folder) / "shard"
        shard.mkdir()
        # Every fine cell says which coarse cell it is of.
        coarse = np.arange(2500, dtype=np.float16).reshape(1, 1, 50, 50, 1).repeat(2, 1)
        fine = coarse.repeat(2, 2).repeat(2, 3)
        for name in ARRAYS:
            np.save(shard / f"{name}.npy", coarse if name == "coarse" else fine)
        pairs = PackedPairs(folder)
        *latents, cells = pairs.read(1, (7, 20), 12)
        assert len(pairs) == 2 and cells.shape == (12, 12, 1) and cells[0, 0, 0] == 7 * 50 + 20
        for latent in latents:
            assert (latent == cells.repeat(2, 0).repeat(2, 1)).all()
    net, (x, rough, told, small) = Refiner(), (torch.randn(1, n, n, c) for n, c in ((24, 16), (24, 16), (24, 16), (12, 8)))
    nn.init.normal_(net.head.weight)
    before, moved = net(x, torch.tensor([500.0]), rough, told, small), rough.clone()
    moved[0, 2, 2] += 1
    after = net(x, torch.tensor([500.0]), moved, told, small)
    changed = (before != after).any(-1)[0]
    assert changed[2, 2] and not changed[12:].any() and not changed[:, 12:].any(), "it sees 8 m and no more"


def temporal_blocks_begin_as_nothing():
    """With gates at zero each frame is drawn as the single-frame transformer draws it; the warp finds the same place of the world."""
    torch.manual_seed(4)
    base = OccDit(DitConfig(width=64, depth=2, heads=1)).eval()
    for p in base.parameters():
        torch.nn.init.normal_(p, std=0.05)
    net = OccDitTime(base, TimeConfig(width=64, heads=1, blocks=1)).eval()
    pose = torch.tensor([[[0.0, 0.0, 0.0], [6.4, 0.0, 0.0], [0.0, 0.0, math.pi / 2]]])
    index, seen, offset = warp(pose)
    token = lambda x, y: x * 25 + y
    assert index[0, 0, 1, token(10, 7)] == token(8, 7) and not seen[0, 0, 1, token(1, 7)]
    assert index[0, 0, 2, token(20, 12)] == token(12, 4)
    close(offset[0, 0, 1, token(10, 7)], [0.0, 0.0, 1.0, 0.0, -0.25, 0.25, 0.0, 1.0], 1e-6)
    x, cells, named = torch.randn(3, 50, 50, 8), torch.rand(3, 50, 50, CONDITION), torch.zeros(3, 9)
    heard, t = base.condition(cells, named), torch.full((3,), 400.0)
    close(net(x, t, heard, (index, seen, offset)), base(x, t, heard), 1e-6)
    torch.nn.init.normal_(net.blocks[0].ada.bias)
    assert (net(x, t, heard, (index, seen, offset)) - base(x, t, heard)).abs().max() > 1e-3


def three_planes_hold_as_much():
    """The planes of a frame hold about as many numbers as the latent of the top view, and any crop's side is told by their number."""
    assert abs(numbers(50) - 50 * 50 * 8) < 200 and all(side_of(numbers(s)) == s for s in (4, 16, 50))
    vae = TriplaneVae(VaeConfig(widths=(8, 8, 8), encoder_kernels=((1,), (1,), (1,)), decoder_kernels=((1,), (1,), (1,))))
    labels = torch.full((1, 32, 32, 16), 17, dtype=torch.uint8)
    labels[:, :, :, 0] = 11
    assert vae.encode(labels).shape == (1, 1, numbers(8), 1) and vae.decode(vae.encode(labels)).shape == labels.shape


def a_temporal_decoder_begins_as_nothing():
    """At the start it leaves latents as they are; then a cell hears its place of the world in other frames, and nothing of frames that are out of sight."""
    torch.manual_seed(6)
    net, latents = TimeDecoder().eval(), torch.randn(2, 3, 50, 50, 8)
    pose = torch.tensor([[[0.0, 0.0, 0.0], [16.0, 0.0, 0.0], [200.0, 0.0, 0.0]], [[0.0, 0.0, 0.0], [0.0, 0.0, math.pi / 2], [0.0, 0.0, 0.0]]])
    index, seen, offset = warped = cell_warp(pose)
    assert index.shape == seen.shape == (2, 3, 3, 2500) and offset.shape == (2, 3, 3, 2500, 8)
    assert index[0, 0, 1, 20 * 50 + 7] == 10 * 50 + 7 and not seen[0, 0, 1, 9 * 50 + 7] and not seen[0, 2, :2].any() and seen[0, 2, 2].all()
    assert index[1, 0, 1, 30 * 50 + 24] == 24 * 50 + 19
    assert torch.equal(net(latents, warped), latents)
    torch.nn.init.normal_(net.head.weight)
    moved = latents.clone()
    moved[0, 2] += 1  # the frame far away
    moved[0, 1, 10, 7] += 1
    changed = (net(moved, warped) != net(latents, warped)).any(-1)
    assert changed[0, 0, 20, 7] and changed[0, 0].sum() <= 9 and changed[0, 2].all() and not changed[1].any()
    # Windows of one place: what a cell of one of them is in another, it is in the frames.
    corner = torch.tensor([[[14, 3], [4, 3]]])
    small = cell_warp(window_pose(pose[:1, :2], corner, 8), 8)[0]
    assert (small[0, 0, 1] == torch.arange(64)).all() and (index[0, 0, 1, 14 * 50 + 3] == 4 * 50 + 3)


def the_comparison_of_networks_begins():
    """benches/peers/networks.py on the shipped weights and a bare road, without our side of it."""
    root = Path(__file__).resolve().parents[1]
    sys.path.insert(0, str(root / "benches/peers"))
    import networks

    torch.manual_seed(7)
    vae = networks.network("occ_vae", networks.OccVae, networks.VaeConfig)
    dit = networks.network("occ_dit", networks.OccDit, networks.DitConfig)
    labels = torch.full((200, 200, 16), 17, dtype=torch.uint8)
    labels[..., 2] = 11
    bev, heading = torch.ones(200, 200, dtype=torch.int32), torch.zeros(200, 200, dtype=torch.uint8)
    with torch.inference_mode():
        latent = vae.encode(labels[None])[0]
        told = networks.condition(dit, bev, heading, latent)
        v = dit(latent[None], torch.tensor([500.0]), told)[0]
        other = dit(latent[None], torch.tensor([500.0]), networks.condition(dit, bev * 0, heading, latent))[0]
        same = (vae.decode(latent[None])[0] == labels).float().mean()
    assert v.shape == latent.shape == (50, 50, 8) and torch.isfinite(v).all() and (v != other).any()
    assert same > 0.95, same


if __name__ == "__main__":
    reference = Path(sys.argv[1] if len(sys.argv) > 1 else "../../shared/reference")
    lovasz_against_reference(reference)
    schedule_against_reference(reference)
    print("references ok")
    for test in (row_31_kl, row_32_losses, shapes_and_schedule, networks_learn, a_window_hears_what_its_part_of_the_frame_says,
                 columns_of_the_background, muon_treats_matrices_of_one_shape_alike, headings_turn_with_their_frames, named_numbers, leaning_moves_whole_columns, a_given_background_stands_in_the_draft, a_stream_is_read_in_order, calibration_undoes_a_bias, a_refiner_sees_one_place_in_all_its_latents,
                 temporal_blocks_begin_as_nothing, a_temporal_decoder_begins_as_nothing, three_planes_hold_as_much,
                 the_comparison_of_networks_begins):
        test()
        print(test.__name__, "ok")

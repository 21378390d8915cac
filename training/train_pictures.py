"""Trains picture VAE, segmenter and picture transformer in one go, on frames that stream in meanwhile.

First the VAE, with the segmenter beside it, whose features tell the VAE what matters; then the transformer on the VAE's latents, the VAE's decoder
(latents stay) and the segmenter now and then, and, if asked for, small transformers that lack something; at the end the figures on held-out frames. Weights are
written in f16 every minute. Everything goes by the clock: `--minutes` for the first two parts, and how they are shared."""
import argparse
import contextlib
import copy
import itertools
import json
import math
import os
import random
import re
import time
from pathlib import Path

import torch
from safetensors.torch import load_file, save_file
from torch.nn import functional as F

from loop import pick_device
from muon import orthogonalised
from models.picture_dit import NOTHING, PictureDit, PictureDitConfig, cell_depth, warp
from models.picture_vae import CELL, Critic, PictureVae, PictureVaeConfig
from models.segmenter import OUTSIDE, Segmenter, SegmenterConfig
from picture_data import Pool, Streams, constant, planes_of, silence
from picture_eval import figures_of, write_sheets
from schedule import STEPS, alpha_bar

SMALL = dict(told=(8, 32, 64), cells=64, width=128, depth=4, heads=4, across=(1, 3))
ABLATIONS = {"all": {}, "no_cross_view": dict(across=()), "no_depth": dict(depths=False), "no_previous": dict(before=False),
             "planes_1": dict(planes=32), "planes_3": dict(planes=32, plane_kernel=3)}
OBJECTS = 11  # classes 1 to 10 are objects
OBJECT_WEIGHT = 2.0
FAR_M = 50.0  # where depth-aware weights are largest
SAVE_S = 60.0


class RecordedMuon(torch.optim.Optimizer):
    """As `muon.Muon`, with a learning rate that is a tensor on the device."""

    def __init__(self, parameters, rate, momentum=0.95, weight_decay=0.01):
        super().__init__(parameters, dict(momentum=momentum, weight_decay=weight_decay))
        self.rate = rate
        self.velocities = {p: torch.zeros_like(p) for group in self.param_groups for p in group["params"]}

    @torch.no_grad()
    def step(self):
        for group in self.param_groups:
            alike = {}
            for p in group["params"]:
                if p.grad is None:
                    continue
                velocity = self.velocities[p].lerp_(p.grad, 1 - group["momentum"])
                ahead = p.grad.lerp(velocity, group["momentum"]).reshape(len(p), -1)
                alike.setdefault(ahead.shape, []).append((p, ahead))
            for (rows, columns), found in alike.items():
                updates = orthogonalised(torch.stack([ahead for _, ahead in found])) * (-0.2 * max(rows, columns) ** 0.5 * self.rate)
                for (p, _), update in zip(found, updates):
                    p.mul_(1 - self.rate * group["weight_decay"]).add_(update.reshape(p.shape))


class Learner:
    """A network with its optimisers, average and learning rate. All that a step computes stays on the device, so that it can be recorded."""

    def __init__(self, model, lr, kind="muon", ema=0.999, warmup=100, betas=(0.9, 0.98), weight_decay=0.01):
        self.model, self.lr, self.warmup, self.most = model, lr, warmup, ema
        self.ema = copy.deepcopy(model).requires_grad_(False).eval()
        self.kind, self.betas, self.weight_decay = kind, betas, weight_decay
        device = next(model.parameters()).device
        self.rate, self.decay, self.norm = (torch.zeros((), device=device) for _ in range(3))
        self.step, self.mean = 0, {}
        self.make_optimizers()

    def make_optimizers(self):
        inner = {m.weight for name, m in self.model.named_modules() if self.kind == "muon" and isinstance(m, (torch.nn.Conv2d, torch.nn.Linear))
                 and re.match(self.model.INNER, name) and m.weight.requires_grad and getattr(m, "groups", 1) == 1}
        self.parameters = [p for p in self.model.parameters() if p.requires_grad]
        rest = [p for p in self.parameters if p not in inner]
        groups = [{"params": [p for p in rest if p.ndim >= 2], "weight_decay": self.weight_decay},
                  {"params": [p for p in rest if p.ndim < 2], "weight_decay": 0.0}]
        card = self.rate.is_cuda
        self.optimizers = [torch.optim.AdamW(groups, lr=self.rate if card else self.lr, betas=self.betas, fused=True, capturable=card)]
        if inner:
            self.optimizers.append(RecordedMuon([p for p in self.parameters if p in inner], self.rate, weight_decay=self.weight_decay))
        self.trained = [(e, p.data) for e, p in zip(self.ema.parameters(), self.model.parameters()) if p.requires_grad]

    def before(self, done):
        """Learning rate and average of the next step; `done` is the share of the time that is over."""
        self.step += 1
        rate = self.lr * min(1.0, self.step / self.warmup) * 0.5 * (1 + math.cos(math.pi * min(1.0, done)))
        self.rate.fill_(rate)
        self.decay.fill_(min(self.most, (1 + self.step) / (10 + self.step)))
        if not self.rate.is_cuda:
            for group in self.optimizers[0].param_groups:
                group["lr"] = rate

    def update(self, loss, told=None):
        """One step. Gradients that are not finite count as 0."""
        for p in self.parameters:
            p.grad = None
        loss.backward()
        gradients = [p.grad for p in self.parameters if p.grad is not None]
        for g in gradients:
            g.nan_to_num_(0.0, 0.0, 0.0)
        self.norm.copy_(torch.nn.utils.get_total_norm(gradients))
        torch._foreach_mul_(gradients, (1 / (self.norm + 1e-6)).clamp(max=1.0))
        for optimizer in self.optimizers:
            optimizer.step()
        averages, values = zip(*self.trained)
        torch._foreach_mul_(averages, self.decay)
        torch._foreach_add_(averages, torch._foreach_mul(values, 1 - self.decay))
        for name, value in (told or {}).items():
            value = value.detach().float()
            if name in self.mean:
                self.mean[name].lerp_(value, 0.02)
            else:
                self.mean[name] = value.clone()

    def means(self):
        return {name: round(value.item(), 4) for name, value in self.mean.items()}


class Recorded:
    """A step without arguments. On a card its kernels are recorded once (a CUDA graph) and replayed: else a processor with other things to do
    cannot keep such small networks busy. What cannot be recorded goes on as it is."""

    WARM = 3

    def __init__(self, step, record):
        self.step, self.record, self.graph, self.calls = step, record, None, 0

    def __call__(self):
        if self.graph is not None:
            return self.graph.replay()
        self.calls += 1
        if not self.record:
            return self.step()
        if self.calls <= self.WARM:
            stream = torch.cuda.Stream()
            stream.wait_stream(torch.cuda.current_stream())
            with torch.cuda.stream(stream):
                self.step()
            return torch.cuda.current_stream().wait_stream(stream)
        try:
            torch.cuda.synchronize()
            graph = torch.cuda.CUDAGraph()
            with torch.cuda.graph(graph):
                self.step()
            graph.replay()
            self.graph = graph
        except Exception as error:
            print(f"not recorded: {type(error).__name__} {str(error)[:300]}", flush=True)
            self.record = False
            torch.cuda.synchronize()
            self.step()


def pyramid_loss(drawn, truth):
    """L1 of pictures and of their steps from pixel to pixel, at whole, half and quarter size."""
    total = 0.0
    for _ in range(3):
        gap = drawn - truth
        total = total + gap.abs().mean() + 0.5 * ((gap[..., 1:] - gap[..., :-1]).abs().mean() + (gap[..., 1:, :] - gap[..., :-1, :]).abs().mean())
        drawn, truth = F.avg_pool2d(drawn, 2), F.avg_pool2d(truth, 2)
    return total / 3


class Trainer:
    def __init__(self, args):
        self.args, self.started = args, time.monotonic()
        self.device, self.dtype = pick_device(args.threads)
        if args.f32:
            self.dtype = None
        torch.manual_seed(args.seed)
        torch.backends.cuda.matmul.allow_tf32 = torch.backends.cudnn.allow_tf32 = True
        self.coin, self.steps = random.Random(args.seed), {}
        self.out = Path(args.output)
        self.out.mkdir(parents=True, exist_ok=True)
        self.log = open(self.out / "log.jsonl", "a")
        self.figures, self.last_save = {}, 0.0
        size = tuple(int(n) for n in args.size.split("x"))
        ablations = [n for n in args.ablate.split(",") if n]
        planes = any("planes" in n for n in ablations)
        self.pool, self.held = Pool(args.room, size, self.device, planes), Pool(args.held_out, size, self.device, planes)
        widths = dict(vae=PictureVaeConfig(), dit=PictureDitConfig(), seg=SegmenterConfig())
        if args.tiny:
            widths = dict(vae=PictureVaeConfig(widths=(16, 24, 32)), dit=PictureDitConfig(told=(8, 16, 24), cells=32, width=64, depth=2, heads=2, across=(1,)),
                          seg=SegmenterConfig(widths=(16, 24, 32)))
            SMALL.update(told=(4, 8, 16), cells=16, width=32, depth=2, heads=1, across=(1,))
        self.vae = Learner(self.on_device(PictureVae(widths["vae"])), args.vae_lr)
        self.seg = Learner(self.on_device(Segmenter(widths["seg"])), args.lr, ema=0.995)
        self.critic = Learner(self.on_device(Critic(16 if args.tiny else 48)), 4e-4, kind="adamw", betas=(0.5, 0.9), ema=0.9)
        self.dit = Learner(self.on_device(PictureDit(widths["dit"])), args.lr)
        self.ablations = {n: Learner(self.on_device(PictureDit(PictureDitConfig(**{**SMALL, **ABLATIONS[n]}))), args.lr) for n in ablations}
        for learner, path in ((self.vae, args.init_vae), (self.dit, args.init_dit), (self.seg, args.init_seg)):
            if path:
                weights = {k: v.float() for k, v in load_file(path).items()}
                learner.model.load_state_dict(weights)
                learner.ema.load_state_dict(weights)
        self.abar = alpha_bar().to(self.device)

    def on_device(self, model):
        return model.to(self.device, memory_format=torch.channels_last)

    def amp(self):
        return torch.autocast(self.device.type, self.dtype, cache_enabled=False) if self.dtype is not None else contextlib.nullcontext()

    def seconds(self):
        return time.monotonic() - self.started

    def note(self, **row):
        row = {"s": round(self.seconds(), 1), "frames": self.pool.seen} | row
        self.log.write(json.dumps(row) + "\n")
        self.log.flush()
        print(json.dumps(row), flush=True)

    def recorded(self, name, *what):
        """The step of a method with some arguments, recorded at its fourth call."""
        key = (name, *what)
        if key not in self.steps:
            self.steps[key] = Recorded(lambda: getattr(self, name)(*what), self.device.type == "cuda" and not self.args.eager)
        return self.steps[key]

    def forget(self, *names):
        """Gives back the memory of steps that are done with."""
        self.steps = {key: step for key, step in self.steps.items() if key[0] not in names}

    # The VAE and the segmenter.

    def segment_loss(self, pictures, shown):
        logits = self.seg.model(pictures).float()
        target = shown.long()
        return F.cross_entropy(logits, target.clamp(max=logits.shape[1] - 1).masked_fill(target == OUTSIDE, -100), ignore_index=-100)

    def segmenter_step(self):
        pictures, shown = self.pool.pictures(self.args.pictures)
        with self.amp():
            loss = self.segment_loss(pictures, shown)
        self.seg.update(loss, {"seg": loss})

    def step_segmenter(self, done):
        self.seg.before(done)
        self.recorded("segmenter_step")()

    def picture_losses(self, drawn, pictures, like):
        """What is wrong with drawn pictures, and by name."""
        near = pyramid_loss(drawn, pictures)
        told = {"l1": (drawn - pictures).abs().mean()}
        if like:
            told["like"] = self.seg.ema.likeness(drawn, pictures)
            near = near + self.args.like * told["like"]
        return near, told

    def against_critic(self, loss, drawn):
        """Adds what the critic says, weighed so that it pulls so much of what the loss does at the last layer (VQGAN, 2012.09841)."""
        with self.amp():
            judged = -self.critic.model(drawn).mean()
        head = self.vae.model.decoder_head.weight
        pulls = [torch.autograd.grad(part, head, retain_graph=True)[0].norm() for part in (loss, judged)]
        weight = (self.args.critic * pulls[0] / (pulls[1] + 1e-6)).clamp(max=10.0).detach()
        return loss + weight * judged

    def teach_critic(self, drawn, pictures):
        with self.amp():
            true, false = self.critic.model(pictures), self.critic.model(drawn.detach())
        self.critic.update(F.relu(1 - true).mean() + F.relu(1 + false).mean(), {"true": true.mean(), "false": false.mean()})

    def vae_step(self, like, taught, judged):
        pictures, _ = self.pool.pictures(self.args.pictures)
        model = self.vae.model
        with self.amp():
            mean, logvar = model.moments(pictures)
            drawn = model.draw(mean + (0.5 * logvar).exp() * torch.randn_like(mean))
            loss, told = self.picture_losses(drawn, pictures, like)
        kl = 0.5 * (mean.square() + logvar.exp() - 1 - logvar).mean()
        loss = loss + self.args.kl * kl
        if judged:
            loss = self.against_critic(loss, drawn)
        self.vae.update(loss, told | {"kl": kl})
        if taught:
            self.teach_critic(drawn, pictures)

    def step_vae(self, done):
        self.vae.before(done)
        self.critic.before(0.0)
        self.recorded("vae_step", self.seg.step > 200, done > self.args.critic_from - 0.05, done > self.args.critic_from)()

    def decoder_step(self):
        """The decoder alone, on latents as a generator may leave them."""
        latent, pictures = self.pool.drawn(self.args.pictures)
        latent = latent + self.args.latent_noise * torch.rand(len(latent), 1, 1, 1, device=self.device) * torch.randn_like(latent)
        model = self.vae.model
        with self.amp():
            drawn = model.draw((latent * model.latent_std + model.latent_mean).permute(0, 3, 1, 2))
            loss, told = self.picture_losses(drawn, pictures, True)
        loss = self.against_critic(loss, drawn)
        self.vae.update(loss, told)
        self.teach_critic(drawn, pictures)

    def step_decoder(self, done):
        self.vae.before(0.5 + 0.5 * done)
        self.critic.before(0.0)
        self.recorded("decoder_step")()

    @torch.no_grad()
    def fix_latents(self):
        """The encoder is done: statistics of its mean, if they did not come with it, and what the transformer will see."""
        self.forget("vae_step")
        self.vae.model.load_state_dict(self.vae.ema.state_dict())
        if not self.args.init_vae:
            with self.amp():
                mean = torch.cat([self.vae.ema.moments(self.pool.pictures(self.args.pictures)[0])[0] for _ in range(8)])
            for model in (self.vae.model, self.vae.ema):
                model.latent_mean.copy_(mean.mean((0, 2, 3)))
                model.latent_std.copy_(mean.std((0, 2, 3)))
        model = self.vae.model
        for part in (model.stem, model.encoder, model.down, model.encoder_norm, model.encoder_head):
            part.requires_grad_(False)
        self.vae.make_optimizers()
        self.held.encode(self.vae.ema, self.amp, self.held.seen)
        self.encode_new(10**6)

    def encode_new(self, most):
        self.pool.encode(self.vae.ema, self.amp, most)

    # The transformer.

    def condition(self, model, part, hears=True):
        """What a network hears of a batch of `Pool.moments`."""
        c = model.config
        planes = None
        if c.planes:
            dense = part["dense"] if hears else torch.full_like(part["dense"], NOTHING)
            planes = planes_of(dense, part["pose"], part["intrinsic"], self.pool.size, c.planes)
        time_of_day, weather, depth = part["time"], part["weather"], part["depth_m"]
        classes, facing = part["classes"], part["facing"]
        if not hears:
            classes, facing, depth = torch.zeros_like(classes), torch.zeros_like(facing), torch.zeros_like(depth)
        return model.condition(classes, depth, facing, time_of_day, weather, part["camera"], planes)

    def warped(self, part, latent):
        """Latents of the frame before [B,6,h,w,C] as the cells of this one see them."""
        scale = constant((1 / CELL, 1 / CELL, 1.0), self.device)
        intrinsic = (part["intrinsic"] * scale[:, None]).flatten(0, 1)
        depths = (cell_depth(part[name]).flatten(0, 1) for name in ("depth_m", "depth_before_m"))
        return warp(latent.flatten(0, 1), *depths, intrinsic, part["way"].flatten(0, 1)).view(*latent.shape[:4], -1)

    def heavy(self, part, how, done):
        """Weights of cells [B,6,h,w,1] whose pixels show objects: all `plain`, `objects` twice as heavy, or as in SyntheOcc's code (2410.00337) by `depth` 1.1 to 2.1,
        by `progress` of the training 1.2 to 2.2, or `both` multiplied."""
        objects = ((part["classes"] > 0) & (part["classes"] < OBJECTS)).float()
        if how == "plain":
            return torch.ones((), device=self.device)
        if how == "objects":
            pixels = objects * (OBJECT_WEIGHT - 1)
        else:
            deep = (part["depth_m"] / FAR_M).clamp(max=1.0)
            pixels = objects * ((1.1 + deep if how != "progress" else 1.0) * (1.2 + done if how != "depth" else 1.0) - 1)
        return 1 + F.max_pool2d(pixels, CELL)[..., None]

    def v_loss(self, model, part, random, told=1.0, before=None, how="objects", done=0.0):
        """Error of v of a batch: weighed for learning, and plain. `before` says which frames hear the frame before (bool [B]), `how` cells are weighed `heavy`
        says."""
        target, b = part["latent"], len(part["latent"])
        u = (torch.arange(b, device=self.device) + torch.rand(b, device=self.device, generator=random)) / b
        t = (u * STEPS).long().clamp(max=STEPS - 1)
        a = self.abar[t].float().view(b, 1, 1, 1, 1)
        noise = torch.randn(target.shape, device=self.device, generator=random)
        noisy, v = a.sqrt() * target + (1 - a).sqrt() * noise, a.sqrt() * noise - (1 - a).sqrt() * target
        with self.amp():
            heard = None
            if model.config.before and before is not None:
                kept = part["before"] + 0.3 * torch.rand(b, 1, 1, 1, 1, device=self.device, generator=random) * torch.randn(
                    target.shape, device=self.device, generator=random)
                heard = self.warped(part, kept) * before.view(b, 1, 1, 1, 1)
            guess = model(noisy, t.float(), self.condition(model, part), heard)
        error = (guess - v).square()
        snr1 = 1 / (1 - self.abar[t])
        weight = (snr1.clamp(max=5.0) / snr1).float().view(b, 1, 1, 1, 1)
        return (error * weight * self.heavy(part, how, done)).mean(), error.mean()

    def dit_step(self, name, n, mirrored):
        """A step of the transformer, or of an ablation by its name, on n frames."""
        learner = self.ablations[name] if name else self.dit
        frames, moment = self.pool.random_frames(n, encoded=True), torch.randint(2, (n,), device=self.device)
        part = self.pool.moments(frames, moment, mirrored)
        u, told, after = (torch.rand(n, device=self.device) for _ in range(3))
        part["time"], part["weather"] = part["time"].masked_fill(u < 0.05, 4), part["weather"].masked_fill((u > 0.03) & (u < 0.08), 6)
        told = told >= self.args.silent
        silence(part, told)
        loss, v = self.v_loss(learner.model, part, None, before=(after < self.args.before) & told)
        learner.update(loss, {"v": v})

    def step_dit(self, name, n, done):
        (self.ablations[name] if name else self.dit).before(done)
        self.recorded("dit_step", name, n, not name and self.coin.random() < 0.5)()

    @torch.no_grad()
    def held_v(self, model):
        """Error of v on held-out frames, without and with the frame before; always the same noise."""
        found = []
        for with_before in (False, True):
            random, errors = torch.Generator(self.device).manual_seed(7), []
            for _ in range(max(1, self.args.held_out // self.args.batch)):
                frames = torch.randint(min(self.held.count, self.held.encoded), (self.args.batch,), device=self.device, generator=random)
                moment = torch.randint(2, (self.args.batch,), device=self.device, generator=random)
                part = self.held.moments(frames, moment, False)
                before = torch.full((self.args.batch,), with_before, device=self.device)
                errors.append(self.v_loss(model, part, random, before=before)[1])
            found.append(round(torch.stack(errors).mean().item(), 4))
        return dict(zip(("v_alone", "v_after"), found))

    # The whole.

    def save(self, last=False):
        """f16 weights of the averages, each file replaced in one go."""
        for name, learner in (("vae", self.vae), ("dit", self.dit), ("segmenter", self.seg)):
            if learner.step == 0:
                continue
            meta = {"kind": f"picture_{name}", "config": json.dumps(learner.ema.config.as_dict()), "steps": str(learner.step),
                    "seconds": f"{self.seconds():.0f}", "frames": str(self.pool.seen), "done": str(last)}
            part = self.out.parent / f".{name}.part"
            save_file({k: v.half().contiguous().cpu() for k, v in learner.ema.state_dict().items()}, part, meta)
            os.replace(part, self.out / f"{name}.safetensors")
        self.last_save = self.seconds()

    def warm(self):
        """Loads what the steps need, while no frames are there: they learn nothing of the empty pool, the rates being 0."""
        self.pool.encode(self.vae.ema, self.amp, 0)
        self.segmenter_step()
        self.vae_step(True, True, True)
        self.dit_step(None, self.args.batch, False)
        self.sync()
        for learner in (self.seg, self.vae, self.critic, self.dit):
            learner.mean.clear()
        self.note(event="warm")

    def gather(self, streams, wait=None):
        """Takes frames in; waits for a number of them if there are fewer."""
        while True:
            self.pool.take_all(streams)
            if wait is None or self.pool.seen >= wait or streams.running == 0:
                return
            time.sleep(0.2)

    def run(self):
        args = self.args
        streams = Streams([args.stream.format(i=i, start=i * 10**6) for i in range(args.streams)])
        held = Streams([args.held_stream])
        self.warm()
        self.gather(streams, args.first)
        self.note(event="first frames")
        whole = 60 * args.minutes
        vae_end, end = self.seconds() + args.vae_share * (whole - self.seconds()), whole
        if args.init_vae:
            vae_end = self.seconds()
        begin = self.seconds()
        noted = begin
        for step in itertools.count():
            done = (self.seconds() - begin) / max(1e-9, vae_end - begin)
            if done >= 1:
                break
            self.step_vae(done)
            if step % 3 == 0 or self.seg.step < 100:
                self.step_segmenter(0.5 * done)
            self.gather(streams)
            self.pool_held(held)
            if step % 4 == 0:
                self.sync()
            if self.seconds() - noted > args.note_s:
                self.sync()
                noted = self.seconds()
                self.note(part="vae", step=self.vae.step, seg_step=self.seg.step, recorded=sum(x.graph is not None for x in self.steps.values()), **self.vae.means(), **self.seg.means(), **self.critic.means())
            self.maybe_save()
        # Who goes on from weights does not wait for all of them: they come meanwhile.
        while self.held.seen < (8 if args.init_vae else args.held_out) and held.running:
            self.pool_held(held)
            self.gather(streams)
            time.sleep(0.1)
        self.fix_latents()
        self.note(event="latents fixed", std=[round(v, 3) for v in self.vae.ema.latent_std.tolist()], held=self.held.count)
        self.train_transformer(streams, held, end)
        streams.stop()
        held.stop()
        self.save(last=True)
        self.finish()

    def pool_held(self, held):
        if self.held.seen < self.args.held_out:
            self.held.take_all(held)

    def train_transformer(self, streams, held, end):
        args, begin = self.args, self.seconds()
        noted, spent = begin, {"dit": 0.0, "decoder": 0.0, "ablations": 0.0}
        shares = {"decoder": args.decoder_share, "ablations": args.ablation_share if self.ablations else 0.0}
        for step in itertools.count():
            now = self.seconds()
            done = (now - begin) / max(1e-9, end - begin)
            if done >= 1:
                break
            behind = [k for k, share in shares.items() if spent[k] < share * (now - begin)]
            what = behind[0] if behind and step % 2 else "dit"
            if what == "dit":
                self.step_dit(None, args.batch, done)
            elif what == "decoder":
                self.step_decoder(done)
                if self.vae.step % 2 == 0:
                    self.step_segmenter(0.5 + 0.5 * done)
            else:
                for name in list(self.ablations):
                    try:
                        self.step_dit(name, args.ablation_batch, done)
                    except torch.OutOfMemoryError as error:
                        self.note(event="dropped", ablation=name, why=str(error)[:200])
                        del self.ablations[name]
            if step % 8 == 0:
                self.gather(streams)
                self.encode_new(4)
            if what != "dit" or step % 16 == 0:
                self.sync()
            spent[what] += self.seconds() - now
            if self.seconds() - noted > args.note_s:
                self.sync()
                noted = self.seconds()
                self.pool_held(held)
                self.held.encode(self.vae.ema, self.amp, self.held.seen)
                self.note(part="dit", step=self.dit.step, encoded=self.pool.encoded, recorded=sum(x.graph is not None for x in self.steps.values()), spent={k: round(v, 1) for k, v in spent.items()}, **self.dit.means(), **self.held_v(self.dit.ema), **self.vae.means(), **self.seg.means(), vae_step=self.vae.step)
            self.maybe_save()
        self.figures["ablations"] = {n: {"steps": a.step, **a.means(), **self.held_v(a.ema)} for n, a in self.ablations.items()}
        self.note(event="trained", ablations=self.figures["ablations"])

    def maybe_save(self):
        if self.seconds() - self.last_save > SAVE_S:
            self.save()

    def sync(self):
        if self.device.type == "cuda":
            torch.cuda.synchronize()

    def finish(self):
        """Figures and sheets of held-out frames."""
        try:
            self.figures |= figures_of(self)
            self.figures["counts"] = {"frames": self.pool.seen, "vae_steps": self.vae.step, "dit_steps": self.dit.step, "segmenter_steps": self.seg.step,
                                      "device": torch.cuda.get_device_name() if self.device.type == "cuda" else "cpu"}
            (self.out / "figures.json").write_text(json.dumps(self.figures, indent=1))
            self.note(event="figures", **self.figures)
            write_sheets(self, self.out)
        finally:
            self.note(event="done")


def arguments():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("--stream", required=True, help="folder of shards, or command that streams training frames; {i} is the number of the stream, {start} its first frame")
    p.add_argument("--held-stream", required=True, help="the same of held-out frames")
    p.add_argument("--streams", type=int, default=15, help="how many of the first command run side by side")
    p.add_argument("--minutes", type=float, required=True, help="wall clock of all training; figures come after it")
    p.add_argument("--vae-share", type=float, default=0.3, help="of that time")
    p.add_argument("-o", "--output", required=True, help="folder for weights, log, figures and sheets")
    p.add_argument("--size", default="256x144")
    p.add_argument("--room", type=int, default=4096, help="frames that are kept")
    p.add_argument("--first", type=int, default=32, help="frames that are waited for")
    p.add_argument("--held-out", type=int, default=64, help="held-out frames")
    p.add_argument("--pictures", type=int, default=48, help="pictures in a step of the VAE")
    p.add_argument("--batch", type=int, default=32, help="frames in a step of the transformer")
    p.add_argument("--ablation-batch", type=int, default=16)
    p.add_argument("--lr", type=float, default=2e-3)
    p.add_argument("--vae-lr", type=float, default=3e-3)
    p.add_argument("--kl", type=float, default=1e-6)
    p.add_argument("--like", type=float, default=0.5, help="weight of the segmenter's features")
    p.add_argument("--critic", type=float, default=0.2, help="how strongly the critic pulls")
    p.add_argument("--critic-from", type=float, default=0.5, help="share of the VAE's time after which it does")
    p.add_argument("--latent-noise", type=float, default=0.25, help="of a spread: most noise of latents that the decoder learns on at the end")
    p.add_argument("--decoder-share", type=float, default=0.2, help="of the transformer's time for decoder and segmenter")
    p.add_argument("--ablation-share", type=float, default=0.15, help="of the transformer's time for ablations")
    p.add_argument("--ablate", default="", help=f"small networks that lack something, with commas: {', '.join(ABLATIONS)}")
    p.add_argument("--before", type=float, default=0.6, help="share of samples that hear the frame before")
    p.add_argument("--silent", type=float, default=0.04, help="share of samples that are told nothing, for guidance")
    p.add_argument("--sampling", type=int, default=4, help="steps of the pictures that are judged")
    p.add_argument("--guidance", type=float, default=2.0, help="of those pictures; 1 is none, and half of the work")
    p.add_argument("--init-vae", help="weights to go on from; the encoder stays as it is, and its own part of the training is left out")
    p.add_argument("--init-dit", help="weights to go on from")
    p.add_argument("--init-seg", help="weights to go on from")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--note-s", type=float, default=20.0)
    p.add_argument("--tiny", action="store_true", help="toy widths, for tests")
    p.add_argument("--f32", action="store_true")
    p.add_argument("--eager", action="store_true", help="record no steps")
    return p


if __name__ == "__main__":
    Trainer(arguments().parse_args()).run()

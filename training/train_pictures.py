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
import time
from pathlib import Path

import torch
from safetensors.torch import load_file, save_file
from torch.nn import functional as F

from loop import optimizers, pick_device
from models.picture_dit import PictureDit, PictureDitConfig, cell_depth, warp
from models.picture_vae import CELL, Critic, PictureVae, PictureVaeConfig
from models.segmenter import OUTSIDE, Segmenter, SegmenterConfig
from picture_data import Pool, Streams, planes_of
from picture_eval import figures_of, write_sheets
from schedule import STEPS, alpha_bar

SMALL = dict(told=(8, 32, 64), cells=64, width=128, depth=4, heads=4, across=(1, 3))
ABLATIONS = {"all": {}, "no_cross_view": dict(across=()), "no_depth": dict(depths=False), "no_previous": dict(before=False),
             "planes_1": dict(planes=32), "planes_3": dict(planes=32, plane_kernel=3)}
OBJECTS = 11  # classes 1 to 10 are objects
OBJECT_WEIGHT = 2.0
SAVE_S = 60.0


class Learner:
    """A network with its optimisers, average and learning rate; its time runs from 0 to 1."""

    def __init__(self, model, lr, kind="muon", ema=0.999, warmup=100, betas=(0.9, 0.98), weight_decay=0.01):
        self.model, self.lr, self.warmup, self.decay = model, lr, warmup, ema
        self.ema = copy.deepcopy(model).requires_grad_(False).eval()
        self.optimizers = optimizers(model, kind, lr, betas, weight_decay)
        self.parameters = [p for p in model.parameters() if p.requires_grad]
        self.step, self.skipped, self.mean = 0, 0, {}

    def update(self, loss, done, told=None):
        """One step; `done` is the share of the time that is over. Gradients that are not finite change nothing."""
        self.step += 1
        rate = self.lr * min(1.0, self.step / self.warmup) * 0.5 * (1 + math.cos(math.pi * min(1.0, done)))
        for optimizer in self.optimizers:
            for group in optimizer.param_groups:
                group["lr"] = rate
            optimizer.zero_grad(set_to_none=True)
        loss.backward()
        gradients = [p.grad for p in self.parameters if p.grad is not None]
        norm = torch.nn.utils.get_total_norm(gradients)
        finite = norm.isfinite()
        shrink = torch.where(finite, (1 / (norm + 1e-6)).clamp(max=1.0), torch.zeros_like(norm))
        torch._foreach_mul_(gradients, shrink)
        if self.step % 50 == 0 and not finite.item():
            self.skipped += 1
            self.model.load_state_dict(self.ema.state_dict())
            return
        for optimizer in self.optimizers:
            optimizer.step()
        decay = min(self.decay, (1 + self.step) / (10 + self.step))
        torch._foreach_lerp_(list(self.ema.parameters()), [p.data for p in self.model.parameters()], 1 - decay)
        for name, value in (told or {}).items():
            value = value.detach()
            self.mean[name] = value if name not in self.mean else self.mean[name].lerp(value, 0.02)

    def means(self):
        return {name: round(value.item(), 4) for name, value in self.mean.items()}


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
        torch.backends.cudnn.benchmark = True
        self.random = torch.Generator(self.device).manual_seed(args.seed)
        self.coin = torch.Generator().manual_seed(args.seed)  # on the processor: what it says is asked at once
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
        return torch.autocast(self.device.type, self.dtype) if self.dtype is not None else contextlib.nullcontext()

    def seconds(self):
        return time.monotonic() - self.started

    def note(self, **row):
        row = {"s": round(self.seconds(), 1), "frames": self.pool.seen} | row
        self.log.write(json.dumps(row) + "\n")
        self.log.flush()
        print(json.dumps(row), flush=True)

    # The VAE and the segmenter.

    def segment_loss(self, pictures, shown):
        logits = self.seg.model(pictures).float()
        target = shown.long()
        target = torch.where(target == OUTSIDE, -100, target.clamp(max=logits.shape[1] - 1))
        return F.cross_entropy(logits, target, ignore_index=-100)

    def step_segmenter(self, done):
        pictures, shown = self.pool.pictures(self.args.pictures, self.random)
        with self.amp():
            loss = self.segment_loss(pictures, shown)
        self.seg.update(loss, done, {"seg": loss})

    def picture_losses(self, drawn, pictures):
        """What is wrong with drawn pictures, and by name."""
        near = pyramid_loss(drawn, pictures)
        like = self.seg.ema.likeness(drawn, pictures) if self.seg.step > 100 else drawn.new_zeros(())
        return near + self.args.like * like, {"l1": (drawn - pictures).abs().mean(), "like": like}

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
        self.critic.update(F.relu(1 - true).mean() + F.relu(1 + false).mean(), 0.0, {"true": true.mean(), "false": false.mean()})

    def step_vae(self, done):
        pictures, _ = self.pool.pictures(self.args.pictures, self.random)
        model = self.vae.model
        with self.amp():
            mean, logvar = model.moments(pictures)
            latent = mean + (0.5 * logvar).exp() * torch.randn(mean.shape, device=self.device, generator=self.random)
            drawn = model.draw(latent)
            loss, told = self.picture_losses(drawn, pictures)
        kl = 0.5 * (mean.square() + logvar.exp() - 1 - logvar).mean()
        loss = loss + self.args.kl * kl
        judged = done > self.args.critic_from
        if judged:
            loss = self.against_critic(loss, drawn)
        self.vae.update(loss, done, told | {"kl": kl})
        if done > self.args.critic_from - 0.05:
            self.teach_critic(drawn, pictures)

    def step_decoder(self, done):
        """The decoder alone, on latents as a generator may leave them."""
        latent, pictures = self.pool.drawn(self.args.pictures, self.random)
        noise = torch.randn(latent.shape, device=self.device, generator=self.random)
        latent = latent + self.args.latent_noise * torch.rand(len(latent), 1, 1, 1, device=self.device, generator=self.random) * noise
        model = self.vae.model
        with self.amp():
            drawn = model.draw((latent * model.latent_std + model.latent_mean).permute(0, 3, 1, 2))
            loss, told = self.picture_losses(drawn, pictures)
        loss = self.against_critic(loss, drawn)
        self.vae.update(loss, 0.5 + 0.5 * done, told)
        self.teach_critic(drawn, pictures)

    @torch.no_grad()
    def fix_latents(self):
        """The encoder is done: statistics of its mean, and what the transformer will see."""
        pictures = torch.cat([self.pool.pictures(self.args.pictures, self.random)[0] for _ in range(8)])
        with self.amp():
            mean = torch.cat([self.vae.ema.moments(part)[0] for part in pictures.split(self.args.pictures)])
        for model in (self.vae.model, self.vae.ema):
            if model is self.vae.model:
                model.load_state_dict(self.vae.ema.state_dict())
            model.latent_mean.copy_(mean.mean((0, 2, 3)))
            model.latent_std.copy_(mean.std((0, 2, 3)))
        frozen = [self.vae.model.stem, self.vae.model.encoder, self.vae.model.down, self.vae.model.encoder_norm, self.vae.model.encoder_head]
        for part in frozen:
            part.requires_grad_(False)
        self.vae.parameters = [p for p in self.vae.model.parameters() if p.requires_grad]
        self.vae.optimizers = optimizers(self.vae.model, "muon", self.vae.lr, (0.9, 0.98), 0.0)
        for optimizer in self.vae.optimizers:
            for group in optimizer.param_groups:
                group["params"] = [p for p in group["params"] if p.requires_grad]
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
            planes = planes_of(part["dense"], part["pose"], part["intrinsic"], self.pool.size, c.planes)
        time_of_day, weather, depth = part["time"], part["weather"], part["depth_m"]
        classes, facing = part["classes"], part["facing"]
        if not hears:
            classes, facing, depth = torch.zeros_like(classes), torch.zeros_like(facing), torch.zeros_like(depth)
        return model.condition(classes, depth, facing, time_of_day, weather, part["camera"], planes)

    def warped(self, part, latent):
        """Latents of the frame before [B,6,h,w,C] as the cells of this one see them."""
        scale = torch.tensor([1 / CELL, 1 / CELL, 1.0], device=self.device)
        intrinsic = (part["intrinsic"] * scale[:, None]).flatten(0, 1)
        depths = (cell_depth(part[name]).flatten(0, 1) for name in ("depth_m", "depth_before_m"))
        return warp(latent.flatten(0, 1), *depths, intrinsic, part["way"].flatten(0, 1)).view(*latent.shape[:4], -1)

    def v_loss(self, model, part, random, told=1.0, before=None):
        """Error of v of a batch: weighed for learning, and plain. `before` says which frames hear the frame before (bool [B])."""
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
        objects = ((part["classes"] > 0) & (part["classes"] < OBJECTS)).float()
        heavy = 1 + (OBJECT_WEIGHT - 1) * F.max_pool2d(objects, CELL)[..., None]
        return (error * weight * heavy).mean(), error.mean()

    def batch(self, n, pool, random):
        known = min(pool.count, pool.encoded)
        frames = torch.randint(known, (n,), device=self.device, generator=random)
        moment = torch.randint(2, (n,), device=self.device, generator=random)
        mirrored = pool is self.pool and torch.rand((), generator=self.coin).item() < 0.5
        return pool.moments(frames, moment, mirrored)

    def step_dit(self, learner, n, done):
        part = self.batch(n, self.pool, self.random)
        u = torch.rand(n, device=self.device, generator=self.random)
        part["time"], part["weather"] = torch.where(u < 0.05, 4, part["time"]), torch.where((u > 0.03) & (u < 0.08), 6, part["weather"])
        silent = torch.rand(n, device=self.device, generator=self.random) < self.args.silent
        for name in ("classes", "facing", "depth_m"):
            part[name] = part[name] * ~silent.view(n, 1, 1, 1)
        before = torch.rand(n, device=self.device, generator=self.random) < self.args.before
        loss, v = self.v_loss(learner.model, part, self.random, before=before & ~silent)
        learner.update(loss, done, {"v": v})

    @torch.no_grad()
    def held_v(self, model):
        """Error of v on held-out frames, without and with the frame before; always the same noise."""
        found = []
        for with_before in (False, True):
            random, errors = torch.Generator(self.device).manual_seed(7), []
            for _ in range(max(1, self.args.held_out // self.args.batch)):
                part = self.batch(self.args.batch, self.held, random)
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
            if self.seconds() - noted > args.note_s:
                self.sync()
                noted = self.seconds()
                self.note(part="vae", step=self.vae.step, seg_step=self.seg.step, **self.vae.means(), **self.seg.means(), **self.critic.means())
            self.maybe_save()
        while self.held.seen < args.held_out and held.running:
            self.pool_held(held)
            time.sleep(0.1)
        self.fix_latents()
        self.note(event="latents fixed", std=[round(v, 3) for v in self.vae.ema.latent_std.tolist()], held=self.held.count)
        self.train_transformer(streams, end)
        streams.stop()
        held.stop()
        self.save(last=True)
        self.finish()

    def pool_held(self, held):
        if self.held.seen < self.args.held_out:
            self.held.take_all(held)

    def train_transformer(self, streams, end):
        args, begin = self.args, self.seconds()
        noted, spent = begin, {"dit": 0.0, "decoder": 0.0, "ablations": 0.0}
        shares = {"decoder": args.decoder_share, "ablations": args.ablation_share if self.ablations else 0.0}
        turns = itertools.cycle(self.ablations.items())
        for step in itertools.count():
            now = self.seconds()
            done = (now - begin) / max(1e-9, end - begin)
            if done >= 1:
                break
            behind = [k for k, share in shares.items() if spent[k] < share * (now - begin)]
            what = behind[0] if behind and step % 2 else "dit"
            if what == "dit":
                self.step_dit(self.dit, args.batch, done)
            elif what == "decoder":
                self.step_decoder(done)
                if self.vae.step % 2 == 0:
                    self.step_segmenter(0.5 + 0.5 * done)
            else:
                for name, learner in itertools.islice(turns, len(self.ablations)):
                    self.step_dit(learner, args.ablation_batch, done)
            if step % 8 == 0:
                self.gather(streams)
                self.encode_new(4)
            if what != "dit" or step % 16 == 0:
                self.sync()
            spent[what] += self.seconds() - now
            if self.seconds() - noted > args.note_s:
                self.sync()
                noted = self.seconds()
                self.note(part="dit", step=self.dit.step, encoded=self.pool.encoded, **self.dit.means(), **self.held_v(self.dit.ema), **self.vae.means(), **self.seg.means(), vae_step=self.vae.step)
            self.maybe_save()
        self.figures["ablations"] = {n: {"steps": a.step, **a.means(), **self.held_v(a.ema)} for n, a in self.ablations.items()}
        self.note(event="trained", ablations=self.figures["ablations"], skipped=[x.skipped for x in (self.vae, self.seg, self.dit)])

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
    p.add_argument("--stream", required=True, help="command that streams training frames; {i} is the number of the stream, {start} its first frame")
    p.add_argument("--held-stream", required=True, help="command that streams held-out frames")
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
    p.add_argument("--sampling", type=int, default=8, help="steps of the pictures that are judged")
    p.add_argument("--init-vae"), p.add_argument("--init-dit"), p.add_argument("--init-seg")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--threads", type=int, default=2)
    p.add_argument("--note-s", type=float, default=20.0)
    p.add_argument("--tiny", action="store_true", help="toy widths, for tests")
    p.add_argument("--f32", action="store_true")
    return p


if __name__ == "__main__":
    Trainer(arguments().parse_args()).run()

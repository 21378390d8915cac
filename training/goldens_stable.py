"""Reference numbers of `sceneloom-stable`, made with diffusers and transformers.

    python goldens_stable.py            writes ../tests/reference/stable/

Three tiny models with random weights, saved as folders that diffusers can read, and beside each a file `golden.safetensors`
with inputs and outputs of their parts and of whole runs. `sd15` is shaped like Stable Diffusion 1.5, `sd21` like 2.1 (split
into shards, bfloat16, v prediction), `ring` like SyntheOcc: attention to neighbouring views and frames, planes through 1x1
convolutions. Weights are rounded to what is stored before anything is computed. Needs torch, diffusers, transformers.
"""

import json
import shutil
from pathlib import Path

import diffusers
import numpy as np
import torch
from diffusers import (
    AutoencoderKL,
    ControlNetModel,
    DDIMScheduler,
    DPMSolverMultistepScheduler,
    EulerDiscreteScheduler,
    PNDMScheduler,
    StableDiffusionControlNetPipeline,
    StableDiffusionImg2ImgPipeline,
    StableDiffusionPipeline,
    UNet2DConditionModel,
    UniPCMultistepScheduler,
)
from safetensors.torch import save_file
from torch import nn
from transformers import CLIPTextConfig, CLIPTextModel, CLIPTokenizer

OUT = Path(__file__).resolve().parent.parent / "tests/reference/stable"
PROMPT = "A wet road, it's dawn; two cars"
NEGATIVE = "blur"
PROMPTS = [
    PROMPT,
    "",
    "  Many\tspaces\n and CAPITALS ",
    "caf\u00e9 d'or we'll 42 cars!!! ...",
    "\u4ea4\u901a and \U0001f697",
    "road " * 100,
    "<|endoftext|> inside <|startoftext|>",
    "cafe\u0301 \u0130 \u00a0 x",
]
SCHEDULERS = {
    "ddim": DDIMScheduler,
    "pndm": PNDMScheduler,
    "dpm": DPMSolverMultistepScheduler,
    "euler": EulerDiscreteScheduler,
    "unipc": UniPCMultistepScheduler,
}
BETAS = dict(num_train_timesteps=1000, beta_start=0.00085, beta_end=0.012, beta_schedule="scaled_linear")


def noise(seed, *shape):
    return torch.from_numpy(np.random.default_rng(seed).standard_normal(shape)).float()


def randomized(module, seed, dtype):
    """Every weight anew, so that nothing is zero or one by chance, rounded to `dtype`."""
    random = torch.Generator().manual_seed(seed)
    for name, p in module.named_parameters():
        if p.ndim == 1:
            value = torch.randn(p.shape, generator=random) * 0.1 + (1.0 if "norm" in name and "weight" in name else 0.0)
        else:
            fan = p[0].numel()
            value = torch.randn(p.shape, generator=random) / fan**0.5
        p.data = value.to(dtype).float()
    return module.eval()


# ---------------------------------------------------------------- tokenizer


def write_tokenizer(folder, pad):
    folder.mkdir(parents=True, exist_ok=True)
    letters = "!',.;0123456789abcdefghijklmnopqrstuvwxyz"
    merges = ["r o", "a d</w>", "ro ad</w>", "c a", "ca r", "r s</w>", "ca rs</w>", "w e", "we t</w>", "' s</w>", "! !", "d a"]
    words = [*letters, *(c + "</w>" for c in letters)]
    words += [m.replace(" ", "") for m in merges] + ["<|startoftext|>", "<|endoftext|>"]
    vocab = {w: i for i, w in enumerate(dict.fromkeys(words))}
    (folder / "vocab.json").write_text(json.dumps(vocab, ensure_ascii=False))
    (folder / "merges.txt").write_text("#version: 0.2\n" + "\n".join(merges) + "\n")
    special = {"bos_token": "<|startoftext|>", "eos_token": "<|endoftext|>", "unk_token": "<|endoftext|>", "pad_token": pad}
    (folder / "special_tokens_map.json").write_text(json.dumps(special))
    more = {"model_max_length": 77, "tokenizer_class": "CLIPTokenizer", "do_lower_case": True, "add_prefix_space": False}
    (folder / "tokenizer_config.json").write_text(json.dumps({**special, **more}))
    return CLIPTokenizer.from_pretrained(folder), len(vocab)


# ---------------------------------------------------------------- views and frames


class Ring:
    """Attention to the neighbouring views and frames, put into every transformer block of a UNet (SyntheOcc, equation 5)."""

    def __init__(self, unet, views, frames, kind, zero):
        self.views, self.frames, self.kind = views, frames, kind
        self.pairs = {v: [(v - 1) % views, (v + 1) % views] for v in range(views)}
        for block in [m for m in unet.modules() if type(m).__name__ == "BasicTransformerBlock"]:
            width, attention = block.norm1.normalized_shape[0], block.attn1
            make = lambda: type(attention)(
                query_dim=width,
                cross_attention_dim=width,
                heads=attention.heads,
                dim_head=attention.inner_dim // attention.heads,
                bias=False,
            )
            block.norm4, block.attn4 = nn.LayerNorm(width), make()
            if zero == "gated":
                block.connector = nn.Module()
                block.connector.alpha = nn.Parameter(torch.zeros(width))
            elif zero == "zero_linear":
                block.connector = nn.Linear(width, width)
            if frames > 1:
                block.norm5, block.attn5, block.connector5 = nn.LayerNorm(width), make(), nn.Linear(width, width)
            block.forward = lambda x, block=block, **given: self.forward(block, x, given["encoder_hidden_states"])

    def heard(self, attention, x, neighbours, kind):
        out = torch.zeros_like(x)
        for item, others in neighbours.items():
            if kind == "concat":
                out[item] = attention(x[item : item + 1], torch.cat([x[o : o + 1] for o in others], 1))[0]
            else:
                for other in others:
                    out[item] += attention(x[item : item + 1], x[other : other + 1])[0]
        return out

    def connected(self, connector, x):
        if connector is None:
            return x
        return torch.tanh(connector.alpha) * x if hasattr(connector, "alpha") else connector(x)

    def forward(self, block, x, text):
        x = x + block.attn1(block.norm1(x))
        x = x + block.attn2(block.norm2(x), text)
        around, along = {}, {}
        for item in range(len(x)):
            start, view = item - item % self.views, item % self.views
            around[item] = [start + v for v in self.pairs[view]]
            frame = item // self.views % self.frames
            along[item] = [item + d * self.views for d in (-1, 1) if 0 <= frame + d < self.frames]
        heard = self.heard(block.attn4, block.norm4(x), around, self.kind)
        x = x + self.connected(getattr(block, "connector", None), heard)
        if self.frames > 1:
            x = x + block.connector5(self.heard(block.attn5, block.norm5(x), along, "add"))
        return x + block.ff(block.norm3(x))


class Planes(nn.Module):
    """SyntheOcc's encoder of multi-plane images."""

    def __init__(self, planes, width):
        super().__init__()
        self.position_encoder = nn.Sequential(nn.Conv2d(planes, width, 1), nn.ReLU(), nn.Conv2d(width, width, 1))

    def forward(self, planes):
        return self.position_encoder(planes)


# ---------------------------------------------------------------- folders


def replaced(name, table):
    for of, to in table.items():
        name = name.replace(f".{of}.", f".{to}.")
    return name


def save(model, folder, dtype, config=None, name="diffusion_pytorch_model", shards=1, renamed=lambda k: k):
    folder.mkdir(parents=True, exist_ok=True)
    if config is None:
        model.save_config(folder) if hasattr(model, "save_config") else model.config.save_pretrained(folder)
    else:
        # Which values were left to diffusers stands there in an order that changes.
        config = {k: v for k, v in config.items() if k != "_use_default_values"}
        (folder / "config.json").write_text(json.dumps(config, indent=1))
    state = {renamed(k): v.to(dtype).contiguous() for k, v in model.state_dict().items()}
    if shards == 1:
        save_file(state, folder / f"{name}.safetensors", metadata={"format": "pt"})
        return
    names, index = sorted(state), {}
    for shard in range(shards):
        file = f"{name}-{shard + 1:05}-of-{shards:05}.safetensors"
        part = names[shard::shards]
        save_file({k: state[k] for k in part}, folder / file, metadata={"format": "pt"})
        index |= {k: file for k in part}
    total = sum(v.numel() * v.element_size() for v in state.values())
    text = json.dumps({"metadata": {"total_size": total}, "weight_map": index})
    (folder / f"{name}.safetensors.index.json").write_text(text)


def parts(folder, seed, dtype, act, unet_more, pad, scheduler, shards=1, widths=(16, 32), prefix="", old=False):
    """The folder of a model: tokenizer, text encoder, VAE, UNet, scheduler. `prefix` of the text encoder's names and `old`
    names in the VAE's attention are those of files that are in use."""
    tokenizer, words = write_tokenizer(folder / "tokenizer", pad)
    text = CLIPTextModel(
        CLIPTextConfig(
            vocab_size=words, hidden_size=16, intermediate_size=32, num_hidden_layers=2, num_attention_heads=2,
            max_position_embeddings=77, hidden_act=act, projection_dim=16,
        )
    )
    vae = AutoencoderKL(
        block_out_channels=(widths[0] // 2, widths[1] // 2), layers_per_block=1, norm_num_groups=4, latent_channels=4, sample_size=16,
        down_block_types=("DownEncoderBlock2D",) * 2, up_block_types=("UpDecoderBlock2D",) * 2,
    )
    unet = UNet2DConditionModel(block_out_channels=widths, norm_num_groups=8, cross_attention_dim=16, **unet_more)
    for i, model in enumerate((text, vae, unet)):
        randomized(model, seed + i, dtype)
    save(text, folder / "text_encoder", dtype, name="model", renamed=lambda k: prefix + k)
    modern = {"to_q": "query", "to_k": "key", "to_v": "value", "to_out.0": "proj_attn"}
    save(vae, folder / "vae", dtype, renamed=lambda k: replaced(k, modern) if old else k)
    save(unet, folder / "unet", dtype, shards=shards)
    scheduler.save_pretrained(folder / "scheduler")
    index = {"_class_name": "StableDiffusionPipeline", "_diffusers_version": diffusers.__version__}
    named = dict(unet="UNet2DConditionModel", vae="AutoencoderKL", scheduler=type(scheduler).__name__)
    index |= {k: ["diffusers", v] for k, v in named.items()}
    index |= {"text_encoder": ["transformers", "CLIPTextModel"], "tokenizer": ["transformers", "CLIPTokenizer"]}
    (folder / "model_index.json").write_text(json.dumps(index, indent=1))
    return tokenizer, text, vae, unet


def ids(tokenizer, prompt):
    return tokenizer(prompt, padding="max_length", max_length=77, truncation=True, return_tensors="pt").input_ids


def watched(model, names, run):
    """First input and output of submodules during a run."""
    seen, handles = {}, []
    for name in names:
        def hook(module, given, kwargs, out, name=name):
            given = given[0] if given else kwargs["hidden_states"]
            out = out[0] if isinstance(out, tuple) else getattr(out, "sample", out)
            seen[f"{name}.in"], seen[f"{name}.out"] = given.clone(), out.clone()

        handles.append(model.get_submodule(name).register_forward_hook(hook, with_kwargs=True))
    run()
    for handle in handles:
        handle.remove()
    return {k: v.contiguous() for k, v in seen.items()}


def blocks(golden, tokenizer, text, vae, unet, size):
    """Numbers of every part of a model."""
    for i, prompt in enumerate(PROMPTS):
        golden[f"ids.{i}"] = ids(tokenizer, prompt)[0].int()
    context = text(ids(tokenizer, PROMPT))[0]
    golden["text"] = context
    picture = noise(1, 1, 3, size[0] * 2, size[1] * 2).clamp(-1, 1)
    golden["vae.picture"], golden["vae.mean"] = picture, vae.encode(picture).latent_dist.mean
    golden["vae.logvar"] = vae.encode(picture).latent_dist.logvar
    latent = noise(2, 1, 4, *size)
    golden["vae.latent"], golden["vae.decoded"] = latent, vae.decode(latent).sample
    mid = ["encoder.mid_block.resnets.0", "encoder.mid_block.attentions.0"]
    seen = watched(vae, mid, lambda: vae.encode(picture))
    golden |= {f"vae.{k}": v for k, v in seen.items()}
    x = noise(3, 2, 4, *size)
    two = torch.cat([context, context.flip(1)])
    golden["unet.x"], golden["unet.context"] = x, two
    names = ["time_embedding", "down_blocks.0.resnets.0", "down_blocks.0.attentions.0", "down_blocks.0.downsamplers.0"]
    names += ["mid_block", "down_blocks.0.attentions.0.transformer_blocks.0", "up_blocks.0.upsamplers.0", "down_blocks.0.attentions.0.transformer_blocks.0.ff"]
    seen = watched(unet, names, lambda: unet(x, 481, two))
    golden |= {f"unet.{k}": v for k, v in seen.items()}
    golden["unet.out"] = unet(x, 481, two).sample
    return golden


def control_of(unet, folder, seed, channels, dtype):
    control = ControlNetModel.from_unet(unet, conditioning_channels=channels, conditioning_embedding_out_channels=(8, 16))
    randomized(control, seed, dtype)
    save(control, folder, dtype)
    return control


def write(folder, golden):
    golden = {k: (v.detach().contiguous() if v.dtype == torch.int32 else v.detach().float().contiguous()) for k, v in golden.items()}
    save_file(golden, folder / "golden.safetensors")


# ---------------------------------------------------------------- schedulers


def steered(x, t):
    """Stands for a network."""
    return torch.cos(x * 1.3 + float(t) / 1000) * 0.7


def schedules():
    """Runs of every scheduler under a formula, and the configurations they had."""
    golden, cases = {}, []
    start = noise(5, 1, 4, 2, 2)
    golden["start"], clean = start, noise(6, 1, 4, 2, 2)
    golden["clean"] = clean
    for kind, make in SCHEDULERS.items():
        for betas in ("scaled_linear", "linear"):
            for spacing in ("leading", "trailing", "linspace"):
                for predicted in ("epsilon", "v_prediction"):
                    for steps, more in ((1, {}), (4, {}), (7, {}), (20, {}), (10, {"steps_offset": 1}), (10, {"zero": True})):
                        if kind == "pndm" and (spacing == "linspace" and steps == 1 or "zero" in more):
                            continue
                        if "zero" in more and (predicted == "epsilon" or spacing != "trailing"):
                            continue
                        given = dict(BETAS, beta_schedule=betas, timestep_spacing=spacing, prediction_type=predicted)
                        if kind in ("ddim", "pndm"):
                            given["set_alpha_to_one"] = steps == 4
                        if kind == "ddim":
                            given["clip_sample"] = False  # as every pipeline of Stable Diffusion has it
                        if kind == "pndm":
                            given["skip_prk_steps"] = True
                        if "steps_offset" in more:
                            given["steps_offset"] = 1
                        if "zero" in more:
                            given["rescale_betas_zero_snr"] = True
                        scheduler = make(**given)
                        try:
                            scheduler.set_timesteps(steps)
                            x = start * scheduler.init_noise_sigma
                            for t in scheduler.timesteps:
                                asked = scheduler.scale_model_input(x, t)
                                x = scheduler.step(steered(asked, t), t, x).prev_sample
                        except (IndexError, ValueError) as error:
                            print("diffusers refuses", kind, spacing, steps, error)
                            continue
                        if not torch.isfinite(x).all():
                            print("diffusers is not finite", kind, given, steps)
                            continue
                        golden[f"case.{len(cases)}"] = x
                        config = {k: v for k, v in dict(scheduler.config).items() if not k.startswith("_")}
                        config["_class_name"] = make.__name__
                        cases.append({"kind": kind, "steps": steps, "config": config})
    for case in cases:
        case["config"] = {k: v for k, v in case["config"].items() if k in (
            "_class_name", "num_train_timesteps", "beta_start", "beta_end", "beta_schedule", "timestep_spacing",
            "prediction_type", "set_alpha_to_one", "clip_sample", "skip_prk_steps", "steps_offset", "rescale_betas_zero_snr")}
    write(OUT, {f"schedule.{k}": v for k, v in golden.items()})
    (OUT / "golden.safetensors").rename(OUT / "schedules.safetensors")
    (OUT / "schedules.json").write_text("[" + ",\n".join(json.dumps(c, separators=(",", ":")) for c in cases) + "]\n")


# ---------------------------------------------------------------- the three models


def decoded(vae, latents):
    return vae.decode(latents / vae.config.scaling_factor).sample


def sd15():
    folder, size = OUT / "sd15", (8, 8)
    scheduler = PNDMScheduler(**BETAS, skip_prk_steps=True, set_alpha_to_one=False, steps_offset=1)
    more = dict(
        down_block_types=("CrossAttnDownBlock2D", "DownBlock2D"), up_block_types=("UpBlock2D", "CrossAttnUpBlock2D"),
        layers_per_block=1, attention_head_dim=4, sample_size=8,
    )
    made = parts(folder, 10, torch.float16, "quick_gelu", more, "<|endoftext|>", scheduler, prefix="text_model.")
    tokenizer, text, vae, unet = made
    golden = blocks({}, *made, size)
    control = control_of(unet, folder / "controlnet", 20, 3, torch.float16)
    hint = noise(7, 1, 3, 16, 16).sigmoid()
    down, mid = control(golden["unet.x"][:1], 481, golden["unet.context"][:1], hint, 0.8, return_dict=False)
    golden |= {"control.hint": hint, "control.mid": mid} | {f"control.down.{i}": d for i, d in enumerate(down)}
    golden["control.embedding"] = control.controlnet_cond_embedding(hint)
    start = noise(8, 1, 4, *size)
    golden["run.noise"] = start
    given = dict(vae=vae, text_encoder=text, tokenizer=tokenizer, unet=unet, safety_checker=None, feature_extractor=None)
    told = dict(prompt=PROMPT, negative_prompt=NEGATIVE, output_type="latent", guidance_scale=7.5)
    # As read from the folder, where what was not said stands as said; latents are never clipped.
    config = dict(PNDMScheduler.from_pretrained(folder / "scheduler").config) | {"clip_sample": False}
    for kind, make in SCHEDULERS.items():
        pipe = StableDiffusionPipeline(scheduler=make.from_config(config), requires_safety_checker=False, **given)
        pipe.set_progress_bar_config(disable=True)
        latents = pipe(**told, num_inference_steps=5, latents=start).images
        golden[f"run.{kind}.latents"], golden[f"run.{kind}.picture"] = latents, decoded(vae, latents)
        image = StableDiffusionImg2ImgPipeline(scheduler=pipe.scheduler, requires_safety_checker=False, **given)
        image.set_progress_bar_config(disable=True)
        if kind == "pndm":
            continue
        clean = noise(9, 1, 4, *size) * 0.5
        golden["again.latents"], golden["again.noise"] = clean, torch.randn(clean.shape, generator=torch.Generator().manual_seed(4))
        seeded = torch.Generator().manual_seed(4)
        golden[f"again.{kind}"] = image(**told, image=clean, strength=0.6, num_inference_steps=5, generator=seeded).images
    pipe = StableDiffusionControlNetPipeline(
        controlnet=control, scheduler=DDIMScheduler.from_config(config), requires_safety_checker=False, **given
    )
    pipe.set_progress_bar_config(disable=True)
    golden["run.control.latents"] = pipe(
        **told, image=hint, num_inference_steps=5, latents=start, controlnet_conditioning_scale=0.7
    ).images
    write(folder, golden)


def sd21():
    folder, size = OUT / "sd21", (7, 10)
    scheduler = DDIMScheduler(
        **BETAS, set_alpha_to_one=False, steps_offset=1, clip_sample=False, prediction_type="v_prediction",
        timestep_spacing="trailing", rescale_betas_zero_snr=True,
    )
    more = dict(
        down_block_types=("CrossAttnDownBlock2D",) * 2, up_block_types=("CrossAttnUpBlock2D",) * 2, layers_per_block=1,
        attention_head_dim=[2, 4], use_linear_projection=True, upcast_attention=True, sample_size=8,
        mid_block_type="UNetMidBlock2DCrossAttn",
    )
    made = parts(folder, 30, torch.bfloat16, "gelu", more, "!", scheduler, shards=3)
    tokenizer, text, vae, unet = made
    golden = blocks({}, *made, size)
    start = noise(8, 1, 4, 8, 8)
    golden["run.noise"] = start
    pipe = StableDiffusionPipeline(
        vae=vae, text_encoder=text, tokenizer=tokenizer, unet=unet, scheduler=scheduler, safety_checker=None,
        feature_extractor=None, requires_safety_checker=False,
    )
    pipe.set_progress_bar_config(disable=True)
    told = dict(prompt=PROMPT, negative_prompt=NEGATIVE, output_type="latent", guidance_scale=5.0)
    latents = pipe(**told, num_inference_steps=5, latents=start, guidance_rescale=0.7).images
    golden["run.ddim.latents"], golden["run.ddim.picture"] = latents, decoded(vae, latents)
    write(folder, golden)


def ring():
    folder, size, views, frames, planes = OUT / "ring", (4, 7), 6, 2, 9
    more = dict(
        down_block_types=("CrossAttnDownBlock2D", "DownBlock2D"), up_block_types=("UpBlock2D", "CrossAttnUpBlock2D"),
        layers_per_block=1, attention_head_dim=[2, 4], use_linear_projection=True, sample_size=8,
    )
    scheduler = UniPCMultistepScheduler(**BETAS, steps_offset=1, prediction_type="epsilon")
    tokenizer, text, vae, unet = parts(folder, 50, torch.float16, "gelu", more, "!", scheduler, widths=(8, 16), old=True)
    context = text(ids(tokenizer, PROMPT))[0]
    silent = text(ids(tokenizer, NEGATIVE))[0]
    golden = {}
    # The released form: planes through a ControlNet whose embedding is two 1x1 convolutions.
    control = ControlNetModel.from_unet(unet, conditioning_channels=planes, conditioning_embedding_out_channels=(8, 16))
    control.controlnet_cond_embedding = Planes(planes, 8)
    randomized(control, 60, torch.float16)
    config = dict(control.config) | {"_class_name": "ControlNetModel1x1"}
    save(control, folder / "controlnet", torch.float16, config={k: v for k, v in config.items()})
    # The form of the paper: their features added right after the first convolution.
    encoder = randomized(Planes(planes, 8), 61, torch.float16)
    save(encoder, folder / "mpi_encoder", torch.float16, config={"conditioning_channels": planes, "embedding_channels": 8})
    pairs = {str(v): [(v - 1) % views, (v + 1) % views] for v in range(views)}
    plain = dict(unet.config)
    cases = (("add", "zero_linear", 1), ("concat", "gated", 1), ("add", "none", 1), ("add", "zero_linear", frames))
    mpi = torch.from_numpy(np.random.default_rng(70).integers(0, 17, (views, planes, *size))).float()
    golden["mpi"], golden["encoded"] = mpi, encoder(mpi)
    for kind, zero, n in cases:
        net = UNet2DConditionModel.from_config(plain)
        Ring(net, views, n, kind, zero)
        randomized(net, 51, torch.float16)
        name = f"unet_{kind}_{zero}_{n}"
        fields = {"neighboring_view_pair": pairs, "neighboring_attn_type": kind, "zero_module_type": zero}
        if n > 1:
            fields["cross_frame_attn_type"] = "add"
        config = plain | fields | {"_class_name": "UNet2DConditionModelMultiview"}
        target = folder / ("unet" if n == 1 and zero == "zero_linear" else name)
        save(net, target, torch.float16, config=config)
        x = noise(71, n * views, 4, *size)
        golden[f"{name}.x"] = x
        both = context.expand(n * views, -1, -1)
        golden[f"{name}.out"] = net(x, 300, both).sample
        if target.name == "unet":
            main = net
    golden["context"] = context
    for form in ("control", "encoder"):
        handle = None
        if form == "encoder":
            handle = main.conv_in.register_forward_hook(lambda m, given, out: out + encoder(mpi))
        scheduler.set_timesteps(5)
        x = noise(72, views, 4, *size)
        golden["run.noise"] = x
        for t in scheduler.timesteps:
            predicted = []
            for told in (silent, context):
                told = told.expand(views, -1, -1)
                extra = {}
                if form == "control":
                    down, mid = control(x, t, told, mpi, 1.0, return_dict=False)
                    extra = dict(down_block_additional_residuals=down, mid_block_additional_residual=mid)
                predicted.append(main(x, t, told, **extra).sample)
            guided = predicted[0] + 7.0 * (predicted[1] - predicted[0])
            x = scheduler.step(guided, t, x).prev_sample
        golden[f"run.{form}.latents"] = x
        if handle is not None:
            handle.remove()
    golden["run.control.picture"] = decoded(vae, golden["run.control.latents"])
    write(folder, golden)


# ---------------------------------------------------------------- the real models


def real():
    """Names and shapes of the public models, made without weights."""
    four = (320, 640, 1280, 1280)
    both = {
        "sd15": dict(cross_attention_dim=768, attention_head_dim=8),
        "sd21": dict(cross_attention_dim=1024, attention_head_dim=[5, 10, 20, 20], use_linear_projection=True),
    }
    texts = {
        "sd15": dict(hidden_size=768, intermediate_size=3072, num_hidden_layers=12, num_attention_heads=12, hidden_act="quick_gelu"),
        "sd21": dict(hidden_size=1024, intermediate_size=4096, num_hidden_layers=23, num_attention_heads=16, hidden_act="gelu"),
    }
    out = {}

    def listed(name, model, config, shapes=None):
        shapes = shapes or {k: list(v.shape) for k, v in model.state_dict().items()}
        config = {k: v for k, v in dict(config).items() if not k.startswith("_") and v is not None}
        out[name] = {"config": config, "shapes": shapes}

    with torch.device("meta"):
        for model, more in both.items():
            unet = UNet2DConditionModel(block_out_channels=four, **more)
            listed(f"{model}.unet", unet, unet.config)
            if model == "sd15":
                control = ControlNetModel(block_out_channels=four, **more)
                listed("sd15.controlnet", control, control.config)
            config = CLIPTextConfig(vocab_size=49408, max_position_embeddings=77, **texts[model])
            text = CLIPTextModel(config)
            # Public files have the names of older versions, and a table of positions.
            shapes = {"text_model." + k: list(v.shape) for k, v in text.state_dict().items()}
            listed(f"{model}.text_encoder", text, config.to_dict(), shapes | {"text_model.embeddings.position_ids": [1, 77]})
        vae = AutoencoderKL(
            block_out_channels=(128, 256, 512, 512), layers_per_block=2, latent_channels=4, sample_size=512,
            down_block_types=("DownEncoderBlock2D",) * 4, up_block_types=("UpDecoderBlock2D",) * 4,
        )
        listed("sd15.vae", vae, vae.config)
        # SyntheOcc: 2.1 with attention to neighbouring views, and a ControlNet that is shown 257 planes.
        unet = UNet2DConditionModel(block_out_channels=four, **both["sd21"])
        Ring(unet, 6, 1, "add", "zero_linear")
        pairs = {"0": [5, 1], "1": [0, 2], "2": [1, 3], "3": [2, 4], "4": [3, 5], "5": [4, 0]}
        fields = dict(neighboring_view_pair=pairs, neighboring_attn_type="add", zero_module_type="zero_linear", crossview_attn_type="basic")
        listed("synthe_occ.unet", unet, dict(unet.config) | fields)
        control = ControlNetModel(block_out_channels=four, conditioning_channels=257, **both["sd21"])
        control.controlnet_cond_embedding = Planes(257, 320)
        listed("synthe_occ.controlnet", control, control.config)
    (OUT / "shapes.json").write_text(json.dumps(out, separators=(",", ":")))


if __name__ == "__main__":
    torch.set_grad_enabled(False)
    torch.set_num_threads(1)
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir(parents=True)
    schedules()
    real()
    sd15()
    sd21()
    ring()
    total = sum(f.stat().st_size for f in OUT.rglob("*") if f.is_file())
    print(f"{OUT}: {total} bytes, diffusers {diffusers.__version__}, torch {torch.__version__}")

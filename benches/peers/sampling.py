"""Twenty steps of DDIM and DPM-Solver++(2M) around a network that costs next to nothing, 200,000 numbers: ours in f64 beside
diffusers in f32 and f64. Coefficients and loop, nothing else. Without diffusers DDIM is compared with plain NumPy."""
from common import Ours, agrees, arguments, beside, needs

needs("numpy", "safetensors")
import importlib.util
import sys

import numpy as np

STEPS = 20


def plain_ddim(x, steps, bars):
    """DDIM by its formula, NumPy in f64."""
    for i, t in enumerate(steps):
        e = 0.7 * x / (1 + np.abs(x)) + 0.0005 * t
        bar, following = bars[t], bars[steps[i + 1]] if i + 1 < len(steps) else 1.0
        clean = (x - np.sqrt(1 - bar) * e) / np.sqrt(bar)
        x = np.sqrt(following) * clean + np.sqrt(1 - following) * e
    return x


def main():
    args = arguments()
    ours = Ours(args.threads)
    x = ours.arrays()
    bars = np.cumprod(1 - np.linspace(1e-4, 0.02, 1000))
    steps = (np.round(np.arange(1000, 0, -1000 / STEPS)) - 1).astype(int)
    agrees("DDIM and NumPy f64", x["ddim"], plain_ddim(x["start"], steps, bars), 1e-6)
    beside("DDIM, 20 steps", lambda: ours("ddim"), lambda: plain_ddim(x["start"], steps, bars), args.runs, "NumPy f64")
    missing = [n for n in ("diffusers", "torch") if importlib.util.find_spec(n) is None]
    if missing:
        print(f"sampling: diffusers not compared, this Python lacks {', '.join(missing)} (benches/peers/setup.sh)")
        sys.exit(3)
    import diffusers
    import torch
    torch.set_num_threads(args.threads)
    linear = dict(beta_schedule="linear", beta_start=1e-4, beta_end=0.02, timestep_spacing="trailing", prediction_type="epsilon")
    made = {
        "ddim": diffusers.DDIMScheduler(clip_sample=False, set_alpha_to_one=True, **linear),
        "dpmpp": diffusers.DPMSolverMultistepScheduler(final_sigmas_type="zero", lower_order_final=True, **linear),
    }

    def run(scheduler, start):
        scheduler.set_timesteps(STEPS)
        state = start
        for t in scheduler.timesteps:
            state = scheduler.step(0.7 * state / (1 + state.abs()) + 0.0005 * t, t, state).prev_sample
        return state

    start = torch.from_numpy(x["start"])
    with torch.inference_mode():
        for name, scheduler in made.items():
            # diffusers keeps its tables in f32, and so agrees to about 1e-4 only.
            agrees(f"{name} and diffusers", x[name], run(scheduler, start).numpy(), 1e-3)
            beside(f"{name}, 20 steps", lambda: ours(name), lambda: run(scheduler, start.float()), args.runs,
                   f"diffusers {diffusers.__version__} f32")


main()

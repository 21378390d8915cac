"""The diffusion schedule: 1000 steps, cosine, rescaled to zero terminal SNR (2305.08891). Same as src/gen/diffusion."""
import math

import torch

STEPS = 1000


def alpha_bar():
    """float64 [1000]; the last one is exactly 0, the first one as in the cosine schedule."""
    u = [math.cos((i / STEPS + 0.008) / 1.008 * math.pi / 2) ** 2 for i in range(STEPS + 1)]
    beta = torch.tensor([min(1 - u[i + 1] / u[i], 0.999) for i in range(STEPS)], dtype=torch.float64)
    root = torch.cumprod(1 - beta, 0).sqrt()
    root = (root - root[-1]) * root[0] / (root[0] - root[-1])
    return root**2


def noised(abar, target, generator=None):
    """Targets [B,X,Y,C] at times drawn for a batch: noisy, t [B], v to predict, and a weight [B] that gives their errors of v the
    weight min(SNR + 1, 5) in x0 space (min-SNR, 2303.09556; finite at SNR 0). Times are stratified over the batch: less noise in the loss."""
    b = len(target)
    u = (torch.arange(b) + torch.rand(b, generator=generator)) / b
    t = (u * STEPS).long().clamp(max=STEPS - 1).to(target.device)
    a = abar.to(target.device)[t]
    alpha, sigma = a.sqrt().float().view(b, 1, 1, 1), (1 - a).sqrt().float().view(b, 1, 1, 1)
    noise = torch.randn(target.shape, generator=generator).to(target.device)
    snr1 = 1 / (1 - a)  # SNR + 1
    return alpha * target + sigma * noise, t.float(), alpha * noise - sigma * target, (snr1.clamp(max=5.0) / snr1).float()


def ddim_timesteps(n):
    """Trailing spacing: n timesteps from 999 down."""
    return [round(STEPS - i * STEPS / n) - 1 for i in range(n)]


@torch.no_grad()
def ddim_sample(predict_v, noise, n):
    """DDIM, eta 0, from pure noise; predict_v(x, t) with t a float tensor [B]."""
    abar, x = alpha_bar(), noise
    steps = ddim_timesteps(n)
    for i, t in enumerate(steps):
        a = abar[t].item()
        b = abar[steps[i + 1]].item() if i + 1 < n else 1.0
        v = predict_v(x, torch.full((x.shape[0],), float(t), device=x.device))
        x0, eps = a**0.5 * x - (1 - a) ** 0.5 * v, (1 - a) ** 0.5 * x + a**0.5 * v
        x = b**0.5 * x0 + (1 - b) ** 0.5 * eps
    return x

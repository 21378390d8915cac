"""Muon for the matrices inside a network, AdamW for the rest."""
import torch


def orthogonalised(matrices, steps=5):
    """[...,m,n] -> roughly the nearest matrices with orthonormal rows (or columns), by Newton-Schulz iterations with the
    coefficients of Jordan et al. (Muon, 2024): singular values end between 0.7 and 1.2, so bf16 is exact enough."""
    x = matrices / (matrices.norm(dim=(-2, -1), keepdim=True) + 1e-7)
    tall = x.shape[-2] > x.shape[-1]
    x = (x.mT if tall else x).to(torch.bfloat16 if x.shape[-1] >= 64 else x.dtype)
    for _ in range(steps):
        gram = x @ x.mT
        x = 3.4445 * x + (-4.7750 * gram + 2.0315 * (gram @ gram)) @ x
    return (x.mT if tall else x).to(matrices.dtype)


class Muon(torch.optim.Optimizer):
    """Steps of equal size in every direction of a weight matrix (convolutions: [out, in * k * k]), scaled to the size of
    AdamW's steps (0.2 RMS, 2502.16982), so that both share one learning rate. Matrices of one shape are treated at once."""

    def __init__(self, parameters, lr, momentum=0.95, weight_decay=0.01):
        super().__init__(parameters, dict(lr=lr, momentum=momentum, weight_decay=weight_decay))

    @torch.no_grad()
    def step(self):
        for group in self.param_groups:
            alike = {}
            for p in group["params"]:
                if p.grad is None:
                    continue
                velocity = self.state[p].setdefault("velocity", torch.zeros_like(p))
                velocity.lerp_(p.grad, 1 - group["momentum"])
                ahead = p.grad.lerp(velocity, group["momentum"]).reshape(len(p), -1)
                alike.setdefault(ahead.shape, []).append((p, ahead))
            for (rows, columns), found in alike.items():
                updates = orthogonalised(torch.stack([ahead for _, ahead in found]))
                for (p, _), update in zip(found, updates):
                    p.mul_(1 - group["lr"] * group["weight_decay"])
                    p.add_(update.reshape(p.shape), alpha=-0.2 * max(rows, columns) ** 0.5 * group["lr"])

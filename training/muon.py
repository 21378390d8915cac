"""Muon for the matrices inside a network, AdamW for the rest."""
import torch


def orthogonalised(matrix, steps=5):
    """[m,n] -> roughly the nearest matrix with orthonormal rows (or columns), by Newton-Schulz iterations with the
    coefficients of Jordan et al. (Muon, 2024): singular values end between 0.7 and 1.2."""
    x = matrix / (matrix.norm() + 1e-7)
    tall = x.shape[0] > x.shape[1]
    x = x.T if tall else x
    for _ in range(steps):
        gram = x @ x.T
        x = 3.4445 * x + torch.addmm(gram, gram, gram, beta=-4.7750, alpha=2.0315) @ x
    return x.T if tall else x


class Muon(torch.optim.Optimizer):
    """Steps of equal size in every direction of a weight matrix (convolutions: [out, in * k * k]), scaled to the size of
    AdamW's steps (0.2 RMS, 2502.16982), so that both share one learning rate."""

    def __init__(self, parameters, lr, momentum=0.95, weight_decay=0.01):
        super().__init__(parameters, dict(lr=lr, momentum=momentum, weight_decay=weight_decay))

    @torch.no_grad()
    def step(self):
        for group in self.param_groups:
            for p in group["params"]:
                if p.grad is None:
                    continue
                velocity = self.state[p].setdefault("velocity", torch.zeros_like(p))
                velocity.lerp_(p.grad, 1 - group["momentum"])
                ahead = p.grad.lerp(velocity, group["momentum"])
                update = orthogonalised(ahead.reshape(len(p), -1)).reshape(p.shape)
                p.mul_(1 - group["lr"] * group["weight_decay"])
                p.add_(update, alpha=-0.2 * max(len(p), p[0].numel()) ** 0.5 * group["lr"])

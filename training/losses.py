"""Losses and held-out figures of the occupancy VAE."""
import math

import torch
from torch.nn import functional as F

from models.occ_vae import CLASSES, FEATURES, FREE

# Voxels per class in the Occ3D training split (design/models.md section 3): rarer classes weigh more, 1 to 4.
_COUNTS = [2.1e6, 3.0e6, 2.3e5, 5.4e6, 3.41e7, 2.0e6, 3.3e5, 3.3e6, 5.4e5, 5.8e6, 1.35e7, 1.98e8, 4.9e6, 5.65e7, 6.65e7,
           2.28e8, 2.52e8]
RARITY = torch.tensor([1 + 3 * math.log(max(_COUNTS) / c) / math.log(max(_COUNTS) / min(_COUNTS)) for c in _COUNTS])
ANCHOR_WEIGHT = 1.0  # a tenth of the latents' spread away costs as much as a hundredth of cross-entropy
FREE_NEAR, FREE_ANYWHERE = 3.5, 8.0  # weights of the two kinds of free voxels: few are drawn out of many


def sample_voxels(labels, limit):
    """labels u8 [B,X,Y,16] -> flat indices, labels and weights of the voxels that are trained on: all of the ten object
    classes and `others` (up to `limit`) and up to `limit` of the rest, 1.5x as many free ones close to those, half as
    many from anywhere."""
    b, nx, ny, height = labels.shape
    flat, device = labels.reshape(-1), labels.device
    taken = (flat != FREE).nonzero().squeeze(1)
    object_ = flat[taken] < 11
    parts = []
    for group in (taken[object_], taken[~object_]):
        parts.append(group[torch.randint(len(group), (limit,), device=device)] if len(group) > limit else group)
    taken = torch.cat(parts)
    n = len(taken)
    if n:
        # Up to two columns away and any height: most free voxels that matter touch something.
        from_ = taken[torch.randint(n, (int(1.5 * n),), device=device)] // height
        dx, dy = torch.randint(-2, 3, (2, len(from_)), device=device)
        x, y = (from_ // ny % nx + dx).clamp(0, nx - 1), (from_ % ny + dy).clamp(0, ny - 1)
        near = ((from_ // (nx * ny) * nx + x) * ny + y) * height
        parts.append(near + torch.randint(height, near.shape, device=device))
    parts.append(torch.randint(flat.numel(), (n // 2 + 64,), device=device))
    index = torch.cat(parts)
    label = flat[index].long()
    weight = torch.full(index.shape, FREE_NEAR, device=device)
    weight[-len(parts[-1]):] = FREE_ANYWHERE
    # A drawn "free" voxel that is occupied counts as what it is.
    held = label != FREE
    weight[held] = RARITY.to(device)[label[held]]
    return index, label, weight


def lovasz_softmax(probabilities, labels):
    """Berman et al. 1705.08790: probabilities [N, C], labels [N]; mean over the classes present (free included)."""
    losses = []
    for c in labels.unique():
        foreground = (labels == c).to(probabilities.dtype)
        errors, order = (foreground - probabilities[:, c]).abs().sort(descending=True)
        foreground = foreground[order]
        union = foreground.sum() + (1 - foreground).cumsum(0)
        jaccard = 1 - (foreground.sum() - foreground.cumsum(0)) / union
        jaccard = torch.cat([jaccard[:1], jaccard[1:] - jaccard[:-1]])
        losses.append(errors @ jaccard)
    return torch.stack(losses).mean() if losses else probabilities.sum() * 0


def kl_to_normal(mean, logvar):
    """KL(N(mean, exp(logvar)) || N(0, 1)), mean over all numbers; expm1 keeps it exact near 0."""
    logvar = logvar.clamp(-30.0, 20.0)
    return 0.5 * (mean**2 + torch.expm1(logvar) - logvar).mean()


def vae_loss(model, labels, heard=None, kl_weight=1e-6, voxels_per_cell=5, lovasz_voxels=24_000, latent_noise=0.01, anchor=None):
    """`heard` as in `OccVae.features`. Cross-entropy and Lovasz on sampled voxels, the KL term and, given an `anchor` (another VAE), the squared distance of the
    latents from its own, in their spread. Returns the loss and its parts."""
    mean, logvar = model.moments(labels)
    latent = mean
    if model.training:
        latent = mean + torch.randn_like(mean) * (0.5 * logvar).exp()
        # A little of the latent's own spread, so that the decoder forgives what diffusion gets slightly wrong.
        spread = mean.detach().std((0, 2, 3), keepdim=True)
        level = 2 * latent_noise * torch.rand(len(mean), 1, 1, 1, device=mean.device)
        latent = latent + torch.randn_like(mean) * spread * level
    cells = labels.shape[0] * labels.shape[1] * labels.shape[2] // 16  # 1.6 m each, whatever the latent
    index, label, weight = sample_voxels(labels, voxels_per_cell * cells)
    logits = model.logits(model.features(latent, heard).reshape(-1, FEATURES)[index])
    ce = (F.cross_entropy(logits, label, reduction="none") * weight).sum() / weight.sum()
    pick = torch.randint(len(label), (min(lovasz_voxels, len(label)),), device=label.device)
    lovasz = lovasz_softmax(logits[pick].softmax(-1), label[pick])
    kl = kl_to_normal(mean, logvar)
    total, parts = ce + 0.5 * lovasz + kl_weight * kl, {"ce": ce.item(), "lovasz": lovasz.item(), "kl": kl.item()}
    if anchor is not None:
        with torch.no_grad():
            there = anchor.moments(labels)[0]
        away = (((mean - there) / anchor.latent_std.view(1, -1, 1, 1)) ** 2).mean()
        total, parts = total + ANCHOR_WEIGHT * away, parts | {"away": away.sqrt().item()}
    return total, parts


class Confusion:
    """Counts over frames; IoU = occupied against free, mIoU = mean over the classes that the truth holds."""

    def __init__(self):
        self.counts = torch.zeros(CLASSES, CLASSES, dtype=torch.long)

    def add(self, truth, found):
        joint = truth.reshape(-1).long() * CLASSES + found.reshape(-1).long()
        self.counts += torch.bincount(joint.cpu(), minlength=CLASSES**2).view(CLASSES, CLASSES)

    def iou(self):
        free = self.counts[FREE, FREE].item()
        both = self.counts[:FREE, :FREE].sum().item()
        return both / max(1, self.counts.sum().item() - free)

    def per_class(self):
        hit = self.counts.diagonal()[:FREE].double()
        truth, found = self.counts.sum(1)[:FREE].double(), self.counts.sum(0)[:FREE].double()
        return torch.where(truth > 0, hit / (truth + found - hit).clamp(min=1), torch.nan)

    def miou(self):
        return self.per_class().nanmean().item()

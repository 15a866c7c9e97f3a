"""Presses that PyTorch differentiates: the gradient of deflections by poses, in closed form from the contact normals. Needs torch.

Nothing of the press itself runs in PyTorch: it is the same kernel, in double precision on the CPU.
"""

from __future__ import annotations

from typing import Any

import torch

from bubbletouch._core import Mesh, Patch, SphereUnion

__all__ = ["press"]


def press(
    patch: Patch,
    thing: SphereUnion | Mesh,
    poses: torch.Tensor,
    *,
    depth: float | None = None,
    travel: float | None = None,
    force: float | None = None,
) -> torch.Tensor:
    """Deflections as Patch.press gives them, metres, float64: (n, ny, nx) or (n, n_taxels) of poses (n, 7), without n of one (7,).

    Their gradient goes to the poses, x, y, z, qw, qx, qy, qz: that of the rotation is across the quaternion, which is normalised before the press.

    Raises ValueError as Patch.press does; for poses of another shape or type.
    """
    if poses.shape[-1:] != (7,) or poses.ndim > 2 or poses.dtype != torch.float64:
        raise ValueError(f"poses: {tuple(poses.shape)} of {poses.dtype}; (n, 7) or (7,) of float64")
    goal = {"depth": depth, "travel": travel, "force": force}
    pressed: torch.Tensor = _Press.apply(poses, patch, thing, goal)
    return pressed


class _Press(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, poses: torch.Tensor, patch: Patch, thing: SphereUnion | Mesh, goal: dict[str, Any]) -> torch.Tensor:
        given = poses.detach().cpu().numpy()
        if not ctx.needs_input_grad[0]:
            return torch.from_numpy(patch.press(thing, given, **goal)).to(poses.device)
        frames, changes = patch.press(thing, given, jacobian=True, **goal)
        ctx.save_for_backward(poses, torch.from_numpy(changes).to(poses.device))
        return torch.from_numpy(frames).to(poses.device)

    @staticmethod
    def backward(ctx: Any, gradient: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        poses, changes = ctx.saved_tensors
        sides = range(poses.ndim - 1, gradient.ndim)
        motion = (gradient[..., None] * changes).sum(dim=tuple(sides))
        return torch.cat([motion[..., :3], _of_quaternion(poses[..., 3:], motion[..., 3:])], dim=-1), None, None, None


def _of_quaternion(turn: torch.Tensor, of_angles: torch.Tensor) -> torch.Tensor:
    """The gradient by w, x, y, z of one by small turns about fixed axes: a change dq turns by 2 dq q* / |q|²."""
    w, v = turn[..., :1], turn[..., 1:]
    by_w = -(v * of_angles).sum(dim=-1, keepdim=True)
    by_v = w * of_angles - torch.linalg.cross(v, of_angles)
    return 2 * torch.cat([by_w, by_v], dim=-1) / (turn * turn).sum(dim=-1, keepdim=True)

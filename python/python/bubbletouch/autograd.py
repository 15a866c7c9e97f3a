"""Presses with gradients for PyTorch, with respect to poses and spheres, in closed form from the contact normals. Needs torch.

The press itself does not run in PyTorch: it is computed by Patch.press, in double precision on the CPU.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from bubbletouch._core import Mesh, Patch, SphereUnion

__all__ = ["press"]


def press(
    patch: Patch,
    thing: SphereUnion | Mesh | tuple[torch.Tensor, torch.Tensor],
    poses: torch.Tensor,
    *,
    depth: float | None = None,
    travel: float | None = None,
    force: float | None = None,
) -> torch.Tensor:
    """Returns the deflections of Patch.press, metres, float64: (n, ny, nx) or (n, n_taxels) for poses (n, 7), without the axis n for one pose (7,).

    poses: float64, x, y, z, qw, qx, qy, qz. The quaternion is normalised before the press, so its gradient is perpendicular to it.
    thing: SphereUnion, Mesh, or spheres as a tuple of float64 tensors: centers (k, 3) and radii (k,), metres. Gradients with respect to these
    tensors are available at a given pose and after a travel. With a depth or a force they are not available, because the travel would also change.
    depth, travel, force: goal of the press, as for Patch.press.

    Raises ValueError for invalid arguments of Patch.press, for tensors of another shape or type, and for gradients with respect to spheres with a
    depth or a force.
    """
    _check("poses", poses, poses.shape[-1:] == (7,) and poses.ndim <= 2, "(n, 7) or (7,)")
    goal = {"depth": depth, "travel": travel, "force": force}
    if not isinstance(thing, tuple):
        pressed: torch.Tensor = _Press.apply(poses, None, None, patch, thing, goal)
        return pressed
    centers, radii = thing
    _check("centers", centers, centers.shape[1:] == (3,), "(k, 3)")
    _check("radii", radii, radii.shape == centers.shape[:1], "(k,)")
    if (centers.requires_grad or radii.requires_grad) and not (depth is None and force is None):
        raise ValueError("press: gradients by spheres with a depth or a force; at the pose, or with a travel")
    union = SphereUnion(centers.detach().cpu().numpy(), radii.detach().cpu().numpy())
    of_spheres: torch.Tensor = _Press.apply(poses, centers, radii, patch, union, goal)
    return of_spheres


def _check(name: str, given: torch.Tensor, is_shape: bool, shape: str) -> None:
    """Raises ValueError if the tensor does not have the allowed shape or is not float64."""
    if not is_shape or given.dtype != torch.float64:
        raise ValueError(f"{name}: {tuple(given.shape)} of {given.dtype}; {shape} of float64")


class _Press(torch.autograd.Function):
    """Autograd function of a press; its arguments are poses, centers, radii, patch, thing and goal."""

    @staticmethod
    def forward(
        ctx: Any,
        poses: torch.Tensor,
        centers: torch.Tensor | None,
        radii: torch.Tensor | None,
        patch: Patch,
        thing: SphereUnion | Mesh,
        goal: dict[str, Any],
    ) -> torch.Tensor:
        by_pose, *by_spheres = ctx.needs_input_grad[:3]
        given = poses.detach().cpu().numpy()
        pressed = patch.press(thing, given, contacts=any(by_spheres), jacobian=by_pose, **goal)
        frames, *rest = pressed if isinstance(pressed, tuple) else (pressed,)
        changes = torch.from_numpy(rest.pop()) if by_pose else None
        ctx.save_for_backward(poses, centers, radii, changes)
        ctx.spheres = _BySpheres(patch, rest.pop()) if rest else None
        return torch.from_numpy(frames).to(poses.device)

    @staticmethod
    def backward(ctx: Any, gradient: torch.Tensor) -> tuple[torch.Tensor | None, ...]:
        poses, centers, radii, changes = ctx.saved_tensors
        of_poses = None
        if changes is not None:
            sides = range(poses.ndim - 1, gradient.ndim)
            motion = (gradient[..., None] * changes.to(gradient.device)).sum(dim=tuple(sides))
            of_poses = torch.cat([motion[..., :3], _of_quaternion(poses[..., 3:], motion[..., 3:])], dim=-1)
        if ctx.spheres is None:
            return of_poses, None, None, None, None, None
        return of_poses, *ctx.spheres.gradients(gradient, poses, (centers, radii)), None, None, None


class _BySpheres:
    """Gradients of deflections with respect to spheres, from the contacts of a press. Saturated taxels have no gradient."""

    def __init__(self, patch: Patch, contacts: Any) -> None:
        stroke = np.broadcast_to(patch.stroke, len(patch))[contacts.taxel]
        goes = contacts.deflection < stroke
        numbers = contacts.pose, contacts.taxel, contacts.part
        self.pose, self.taxel, self.part = (torch.from_numpy(number[goes]) for number in numbers)
        self.gradient = torch.from_numpy(contacts.gradient[goes])
        self.n_taxels = len(patch)

    def gradients(
        self, gradient: torch.Tensor, poses: torch.Tensor, spheres: tuple[torch.Tensor, torch.Tensor]
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Returns the gradients of the loss with respect to the centers (k, 3), in the object frame, and the radii (k,).

        gradient: gradient of the loss with respect to the deflections.
        """
        centers, radii = (torch.zeros_like(sphere) for sphere in spheres)
        of_taxel = gradient.reshape(-1, self.n_taxels)[self.pose, self.taxel]
        motion = of_taxel[:, None] * self.gradient.to(gradient.device)
        turn = poses.detach().reshape(-1, 7)[self.pose, 3:]
        turn = turn / torch.linalg.norm(turn, dim=-1, keepdim=True)
        w, v = turn[:, :1], -turn[:, 1:]
        across = 2 * torch.linalg.cross(v, motion)
        centers.index_add_(0, self.part, motion + w * across + torch.linalg.cross(v, across))
        radii.index_add_(0, self.part, of_taxel * torch.linalg.norm(self.gradient, dim=-1).to(gradient.device))
        return centers, radii


def _of_quaternion(turn: torch.Tensor, of_angles: torch.Tensor) -> torch.Tensor:
    """Returns the gradient with respect to the quaternion w, x, y, z, given the gradient with respect to small rotations about fixed axes.

    A change dq of the quaternion is a rotation by 2 dq q* / |q|².
    """
    w, v = turn[..., :1], turn[..., 1:]
    by_w = -(v * of_angles).sum(dim=-1, keepdim=True)
    by_v = w * of_angles - torch.linalg.cross(v, of_angles)
    return 2 * torch.cat([by_w, by_v], dim=-1) / (turn * turn).sum(dim=-1, keepdim=True)

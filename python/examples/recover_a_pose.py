"""Estimates the pose of a drill from one frame, by the Levenberg-Marquardt method with the derivatives of the press."""

import time

import bubbletouch as bt
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

drill = bt.Catalogue.builtin().object("power_drill").pack(tolerance=0.25e-3)
patch = bt.Patch.grid(32, 32, pitch=2e-3, stroke=5e-3)


def turned(pose: Floats, change: Floats) -> Floats:
    """Returns the pose (7,) after a motion (6,): translation, metres, and a small rotation about the axes of the patch, radians."""
    w, v, half = pose[3], pose[4:], 0.5 * change[3:]
    turn = np.array([w - half @ v, *(v + w * half + np.cross(half, v))])
    return np.concatenate([pose[:3] + change[:3], turn / np.sqrt(turn @ turn)])


# The measured frame at the true pose, 3 mm deep, and an initial guess that is 1.4 mm and 2 degrees away.
truth = bt.touch_poses(drill, offset=[10e-3, 5e-3], yaw=0.4, tilt=[0.08, -0.05])
truth[2] -= patch.press(drill, truth, depth=3e-3, contacts=True)[1].travel[0]
felt = patch.press(drill, truth)
guess = turned(truth, np.array([1e-3, -1e-3, -0.3e-3, 0.015, -0.015, 0.03]))

start = time.perf_counter()
# Scales of translation and rotation: a rotation of 1 rad moves a point at a distance of 0.03 m by 0.03 m.
unit = np.array([1, 1, 1, 0.03, 0.03, 0.03])
damping = 1e-4
frame, jacobian = patch.press(drill, guess, jacobian=True)
step = 0
while np.abs(felt - frame).max() > 1e-10 and step < 50:
    step += 1
    rows = jacobian.reshape(-1, 6) * unit
    square = rows.T @ rows
    change = np.linalg.solve(square + damping * np.diag(square.diagonal()), rows.T @ (felt - frame).ravel())
    tried = turned(guess, np.asarray(unit * change, np.float64))
    tried_frame, tried_jacobian = patch.press(drill, tried, jacobian=True)
    if np.square(felt - tried_frame).sum() < np.square(felt - frame).sum():
        guess, frame, jacobian, damping = tried, tried_frame, tried_jacobian, damping / 5
    else:
        damping *= 4
took = time.perf_counter() - start

away = 1e3 * np.sqrt(np.square(guess[:3] - truth[:3]).sum())
angle = np.degrees(2 * np.arccos(min(1.0, abs(float(guess[3:] @ truth[3:])))))
print(f"{step} steps, {1e3 * took:.1f} ms: {away:.6f} mm and {angle:.6f} degrees from the truth")
assert away < 0.1 and angle < 0.1

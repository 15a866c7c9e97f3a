"""Presses 64 × 64 taxels on a mug and writes the deflections as a picture."""

import bubbletouch as bt

mug = bt.Catalogue.builtin().object("mug").pack(tolerance=0.25e-3)
patch = bt.Patch.grid(64, 64, pitch=2e-3, stroke=5e-3)
pose = bt.touch_poses(mug, offset=[5e-3, 0], yaw=0.3)

frame = patch.press(mug, pose, depth=3e-3)
print(f"{(frame > 0).sum()} of {frame.size} taxels touched, deepest {1e3 * frame.max():.1f} mm")
bt.write_frame("mug.png", frame, patch.pitch or 0.0)

"""Moves a robot hand step by step onto a ball until the force on its palm is one newton."""

import bubbletouch as bt

ball = bt.SphereUnion([[0.0, 0.0, 0.0]], 0.03)
scene = {
    "title": "A palm comes down on a ball until it feels a newton",
    "robots": [{"name": "hand", "floating": True}],
    "patches": [
        {
            "name": "palm",
            "robot": "hand",
            "layout": {"grid": {"nx": 24, "ny": 24, "pitch_mm": 3.0}},
            "stroke_mm": 5.0,
            "damping_n_s_per_m": 0.5,
        }
    ],
    "objects": [{"name": "ball", "object": ball}],
}
simulation = bt.simulate(scene)
height, dt = 0.032, 0.01
while True:
    # Taxels point along the palm's z axis; half a turn about x points them downwards.
    simulation.set_robot_pose("hand", [0.0, 0.0, height, 0.0, 1.0, 0.0, 0.0])
    simulation.step(dt)
    palm = simulation.observe()["patches"]["palm"]
    force = -palm["wrench"][2]
    if force >= 1.0:
        break
    # 20 mm/s before contact, then 2 mm/s.
    height -= (0.02 if force == 0.0 else 0.002) * dt
print(f"{simulation.time:.2f} s: {force:.3f} N on {palm['n_touched']} taxels, {1e3 * height:.2f} mm over the ball's middle")
assert 1.0 <= force < 1.05

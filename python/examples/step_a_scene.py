"""Simulates a scene frame by frame: a tennis ball moves down on a palm and up again."""

import bubbletouch as bt

scene = {
    "title": "A tennis ball comes down on a palm and goes again",
    "output_hz": 5.0,
    "patches": [
        {
            "name": "palm",
            "layout": {"grid": {"nx": 16, "ny": 16, "pitch_mm": 4.0}},
            "stroke_mm": 5.0,
        }
    ],
    "objects": [
        {
            "name": "ball",
            "object": "tennis",
            "at": {"position_mm": [0.0, 0.0, 3.0]},
            "motion": {
                "phases": [
                    {"duration_s": 1.0, "linear_mm_per_s": [0.0, 0.0, -5.0]},
                    {"duration_s": 1.0, "linear_mm_per_s": [0.0, 0.0, 5.0]},
                ]
            },
        }
    ],
}
for frame in bt.simulate(scene):
    palm = frame["patches"]["palm"]
    print(f"{frame['time']:.1f} s: {palm['n_touched']:3} taxels, {palm['force'].sum():6.3f} N")

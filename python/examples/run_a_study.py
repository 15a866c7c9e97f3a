"""Runs a study from a dict: how noise and compression change the accuracy."""

import bubbletouch as bt

study = bt.run(
    {
        "question": "What do noise and compression cost?",
        "trials": 2,
        "objects": {"sets": ["cans"], "surface_error_mm": 1.0},
        "skin": {"pitch_mm": 4.0, "size_mm": 64.0, "stroke_mm": 5.0},
        "touches": {"per_object": 10, "offset_x_mm": {"uniform": [-8.0, 8.0]}, "depth_mm": 3.0},
        "signal": {"noise_std_full_scale": [0.0, 0.05]},
        "sensing": {"ensemble": "sbhe", "ratio": [4, 16]},
        "recognition": {"classifier": "linear_svm"},
    },
    callback=lambda stage, done, total: print(f"{stage}: {done} of {total}", end="\r"),
)
print()
for name, table in study.items():
    print(f"{table.file}: {table.title}, {len(table)} rows of {', '.join(table.columns)}")

"""Measures the environment steps per second of 1,024 environments with patches of 16 × 16 taxels, and the time of touches and scores."""

from __future__ import annotations

import time

import numpy as np
from bubbletouch.env import FindObjectVector

many = FindObjectVector(1024)
many.reset(seed=0)
actions = np.random.default_rng(0).uniform(-1, 1, (50, 1024, 2)).astype(np.float32)
for action in actions[:10]:
    many.step(action)
best = np.inf
for _ in range(5):
    start = time.perf_counter()
    for action in actions:
        many.step(action)
    best = min(best, time.perf_counter() - start)
print(f"{50 * 1024 / best:,.0f} environment steps a second, {1e6 * best / 50 / 1024:.2f} us each")
start = time.perf_counter()
for _ in range(50):
    frames = many._world.touch(many._which, many._patch - many._middle, many._yaw)
print(f"touches {1e6 * (time.perf_counter() - start) / 50 / 1024:.2f} us each")
start = time.perf_counter()
for _ in range(50):
    many._world.scores(frames)
print(f"scores {1e6 * (time.perf_counter() - start) / 50 / 1024:.2f} us each")

"""Classifies noisy touches of four objects from 64 measurements each with a linear SVM; the test touches are not in the training set."""

import bubbletouch as bt
import numpy as np
from bubbletouch.learning import LinearSVC

catalogue = bt.Catalogue.builtin()
names = ["mug", "banana", "tennis", "power_drill"]
patch = bt.Patch.grid(32, 32, pitch=2e-3, stroke=5e-3)
chain = bt.Chain([bt.Step.error("gain", gain_std=0.05), bt.Step.noise(0.02), bt.Step.smoothing(2e-3)], patch)
projection = bt.Projection("sbhe", patch.shape, 64, seed=1)

random = np.random.default_rng(0)
features, labels = [], []
for number, name in enumerate(names):
    thing = catalogue.object(name).pack(tolerance=0.5e-3)
    offset, yaw = random.uniform(-0.01, 0.01, (100, 2)), random.uniform(0, 2 * np.pi, 100)
    frames = patch.press(thing, bt.touch_poses(thing, offset=offset, yaw=yaw), depth=3e-3)
    features.append(1e3 * projection(chain(frames, seed=2018, first=100 * number)))
    labels += [name] * 100

x, y = np.concatenate(features), np.array(labels)
test = np.arange(len(y)) % 4 == 0
accuracy = np.mean(LinearSVC(max_iter=10_000).fit(x[~test], y[~test]).predict(x[test]) == y[test])
print(f"{accuracy:.1%} of {test.sum()} touches recognised from 64 measurements of {patch.n_taxels} taxels")
assert accuracy > 0.6

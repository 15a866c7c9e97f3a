"""Trains small networks of PyTorch beside the classifiers of networks.toml: python experiments/networks.py OUT [EPOCHS]"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import torch
from torch import nn

import bubbletouch as bt


class Network:
    """Convolutional network if the features are an image of side x side taxels, and a dense network for other features."""

    def __init__(self, side: int, epochs: int = 20, random_state: int | None = None) -> None:
        self.side, self.epochs, self.random_state = side, epochs, random_state

    def layers(self, n_features: int, n_classes: int) -> nn.Module:
        """Returns an untrained network."""
        if n_features != self.side**2:
            return nn.Sequential(nn.Linear(n_features, 256), nn.ReLU(), nn.Dropout(0.3), nn.Linear(256, n_classes))
        blocks: list[nn.Module] = [nn.Unflatten(1, (1, self.side, self.side))]
        for into, out in ((1, 16), (16, 32), (32, 64)):
            blocks += [nn.Conv2d(into, out, 3, padding=1), nn.BatchNorm2d(out), nn.ReLU(), nn.MaxPool2d(2)]
        n = 64 * (self.side // 8) ** 2
        return nn.Sequential(*blocks, nn.Flatten(), nn.Dropout(0.3), nn.Linear(n, 128), nn.ReLU(), nn.Linear(128, n_classes))

    def turned(self, rows: torch.Tensor, quarters: int) -> torch.Tensor:
        """Returns images that are turned by quarters of a turn. Touches have any yaw, so a turned image is another touch of the same object."""
        if rows.shape[1] != self.side**2:
            return rows
        return torch.rot90(rows.view(-1, self.side, self.side), quarters, (1, 2)).reshape(len(rows), -1)

    def fit(self, rows: np.ndarray, labels: np.ndarray) -> None:
        torch.set_num_threads(1)
        torch.manual_seed(self.random_state or 0)
        self.classes_, numbers = np.unique(labels, return_inverse=True)
        x, y = torch.tensor(rows, dtype=torch.float32), torch.tensor(numbers)
        self.network = self.layers(x.shape[1], len(self.classes_))
        optimiser = torch.optim.AdamW(self.network.parameters(), lr=2e-3, weight_decay=1e-2)
        batches = -(-len(x) // 64)
        schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, 4e-3, total_steps=self.epochs * batches)
        for _ in range(self.epochs):
            for batch in torch.randperm(len(x)).split(64):
                images = self.turned(x[batch], int(torch.randint(4, ())))
                loss = nn.functional.cross_entropy(self.network(images), y[batch])
                optimiser.zero_grad()
                loss.backward()
                optimiser.step()
                schedule.step()
        self.network.eval()

    def predict_proba(self, rows: np.ndarray) -> np.ndarray:
        torch.set_num_threads(1)
        with torch.no_grad():
            parts = torch.tensor(rows, dtype=torch.float32).split(256)
            return torch.cat([self.network(part).softmax(1) for part in parts]).numpy()

    def predict(self, rows: np.ndarray) -> np.ndarray:
        return self.classes_[self.predict_proba(rows).argmax(1)]


def main() -> None:
    out, epochs = sys.argv[1], int([*sys.argv, "20"][2])
    study = bt.run(Path(__file__).with_name("networks.toml"), out, classifiers={"network": (Network(32, epochs), f"{epochs}-epochs")}, processes=2)
    summary, timing = study["summary"], study["timing"]
    for table in (summary, timing):
        print(table.title, len(table))


if __name__ == "__main__":
    main()

"""Scenes from Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bubbletouch as bt
import numpy as np
import pytest

from conftest import Command

SCENE: dict[str, Any] = {
    "title": "A tennis ball comes down on a palm and goes again",
    "output_hz": 10.0,
    "patches": [
        {
            "name": "palm",
            "layout": {"grid": {"nx": 16, "ny": 12, "pitch_mm": 4.0}},
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


def test_a_scene_goes_frame_by_frame() -> None:
    simulation = bt.simulate(SCENE)
    assert (simulation.n_frames, simulation.output_rate) == (21, 10.0)
    assert (simulation.patches, simulation.objects) == (["palm"], ["ball"])
    frames = list(simulation)
    assert [frame["time"] for frame in frames] == pytest.approx(np.arange(21) / 10)
    palm = [frame["patches"]["palm"] for frame in frames]
    assert palm[10]["deflection"].shape == palm[10]["force"].shape == (12, 16)
    assert palm[0]["n_touched"] == 0 and palm[10]["n_touched"] > 20
    assert palm[10]["wrench"][2] < 0 and palm[10]["signal"] is None
    assert frames[10]["objects"]["ball"]["pose"][2] == pytest.approx(-2e-3)
    assert frames[10]["objects"]["ball"]["held"] == "imposed"
    assert simulation.step() is None
    simulation.reset()
    first = simulation.step()
    assert first is not None and first["time"] == 0.0
    assert "1 of 21 frames" in repr(simulation)


def test_the_same_frames_as_the_commands(tmp_path: Path, command: Command) -> None:
    path = tmp_path / "ball.toml"
    path.write_text(bt._core.toml_of(bt.study._json(SCENE)))
    command("simulate", path, "--out", tmp_path / "out", "--quiet")
    recording = np.load(tmp_path / "out" / "recording.npz")
    deflections = np.stack([frame["patches"]["palm"]["deflection"] for frame in bt.simulate(path)])
    written = [recording[name] for name in recording.files if "deflection" in name]
    assert len(written) == 1
    # Recordings are of single precision.
    single = deflections.reshape(21, -1).astype(written[0].dtype)
    np.testing.assert_array_equal(single, written[0].reshape(21, -1))


def test_what_cannot_be_simulated_is_refused_by_its_key(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="output_hz"):
        bt.simulate(SCENE | {"output_hz": -1.0})
    with pytest.raises(ValueError, match="unknown field"):
        bt.simulate(SCENE | {"wind": 3})
    with pytest.raises(FileNotFoundError):
        bt.simulate(tmp_path / "missing.toml")

"""Tests of scenes."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import bubbletouch as bt
import numpy as np
import pytest

from conftest import Command, refused

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
    assert next(simulation, None) is None
    simulation.reset()
    assert next(simulation)["time"] == 0.0
    assert "1 patches, 1 objects, 21 frames" in repr(simulation)


def test_the_same_frames_as_the_commands(tmp_path: Path, command: Command) -> None:
    path = tmp_path / "ball.toml"
    path.write_text(bt._core.toml_of(bt.study._json(SCENE)))
    command("simulate", path, "--out", tmp_path / "out", "--quiet")
    recording = np.load(tmp_path / "out" / "recording.npz")
    deflections = np.stack([frame["patches"]["palm"]["deflection"] for frame in bt.simulate(path)])
    written = [recording[name] for name in recording.files if "deflection" in name]
    assert len(written) == 1
    # The command writes recordings in single precision.
    single = deflections.reshape(21, -1).astype(written[0].dtype)
    np.testing.assert_array_equal(single, written[0].reshape(21, -1))


def test_what_cannot_be_simulated_is_refused_by_its_key(tmp_path: Path) -> None:
    refused("output_hz", lambda: bt.simulate(SCENE | {"output_hz": -1.0}))
    refused("unknown field", lambda: bt.simulate(SCENE | {"wind": 3}))
    with pytest.raises(FileNotFoundError):
        bt.simulate(tmp_path / "missing.toml")


def same(a: dict[str, Any], b: dict[str, Any]) -> bool:
    """Returns whether two frames are bitwise equal."""
    pairs = [
        (a[kind][name][key], b[kind][name][key])
        for kind in ("patches", "objects")
        for name in a[kind]
        for key in a[kind][name]
    ]
    return all(np.array_equal(of_a, of_b) for of_a, of_b in pairs)


def test_a_step_by_hand_is_the_scenes_own() -> None:
    looped = list(bt.simulate(SCENE))
    ball = {key: value for key, value in SCENE["objects"][0].items() if key != "motion"}
    still = bt.simulate(SCENE | {"objects": [ball], "duration_s": 2.0})
    assert same(still.observe(), looped[0])
    for frame in looped[1:]:
        still.set_object_pose("ball", frame["objects"]["ball"]["pose"])
        still.step(0.1)
        assert same(still.observe(), frame)
    assert still.time == pytest.approx(2.0)
    refused("reset", lambda: next(still))
    still.reset()
    assert same(next(still), looped[0])


def test_objects_in_memory_are_touched_as_they_are(box: bt.Mesh) -> None:
    tennis = bt.Catalogue.builtin().object("tennis").pack(0.25e-3)
    ball = SCENE["objects"][0]
    given = bt.simulate(SCENE | {"objects": [ball | {"object": tennis}]})
    assert all(same(a, b) for a, b in zip(given, bt.simulate(SCENE), strict=True))
    at = {"position_mm": [0.0, 0.0, -1.0]}
    boxed = bt.simulate(SCENE | {"objects": [{"name": "box", "object": box, "at": at}]})
    frame = boxed.observe()["patches"]["palm"]
    # The lowest face of the box, 40 × 30 mm, is at z = −1 mm; the taxel centres are at z = 0, the tips half a pitch above.
    patch, pose = boxed.patch("palm"), np.array([0, 0, -1e-3, 1, 0, 0, 0])
    np.testing.assert_allclose(frame["deflection"], patch.press(box, pose), atol=1e-9)
    assert frame["n_touched"] >= 80
    refused("surface_error_mm.*beside an object in memory", lambda: bt.simulate(SCENE | {"objects": [ball | {"object": tennis, "surface_error_mm": 1.0}]}))


def arm(patch: dict[str, Any]) -> dict[str, Any]:
    urdf = Path(__file__).resolve().parents[2] / "objects" / "robots" / "arm.urdf"
    joints = ["shoulder_turn", "shoulder_bend", "arm_turn", "elbow_bend", "forearm_turn", "wrist_bend", "flange_turn"]
    start = {f"{joint}_rad": [0.0] for joint in joints}
    robot = {"name": "arm", "urdf": str(urdf), "joints": {"time_s": [0.0], "positions": start}}
    return SCENE | {"robots": [robot], "patches": [SCENE["patches"][0] | patch]}


def test_joints_and_bases_carry_the_skin() -> None:
    simulation = bt.simulate(arm({"robot": "arm", "link": "forearm"}))
    assert list(simulation.robots) == ["arm"] and len(simulation.robots["arm"]) == 7
    before = simulation.observe()["patches"]["palm"]["pose"]
    simulation.set_joint_positions("arm", [0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert np.array_equal(simulation.observe()["patches"]["palm"]["pose"], before)
    simulation.step(0.01)
    bent = simulation.observe()["patches"]["palm"]["pose"]
    assert np.linalg.norm(bent[:3] - before[:3]) > 0.05
    simulation.set_robot_pose("arm", [0.1, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    simulation.step(0.01)
    moved = simulation.observe()["patches"]["palm"]["pose"]
    np.testing.assert_allclose(moved[:3] - bent[:3], [0.1, 0.0, 0.0], atol=1e-12)


def test_forces_of_taxels_add_up_to_the_wrench() -> None:
    rough = SCENE["patches"][0] | {"friction": 0.5, "shear_stiffness_n_per_m": 50.0}
    for patch in (SCENE["patches"][0], rough):
        frame = list(bt.simulate(SCENE | {"patches": [patch]}))[10]["patches"]["palm"]
        assert frame["wrench"][2] < -0.1
        np.testing.assert_allclose(frame["force3"].sum(axis=0), frame["wrench"][:3], atol=1e-9)


def test_forces_of_a_heavy_free_ball_contain_what_the_stops_carry() -> None:
    palm = {"name": "palm", "layout": {"grid": {"nx": 16, "ny": 16, "pitch_mm": 4.0}}, "stroke_mm": 2.0}
    ball = {
        "name": "ball", "object": "team_handball", "at": {"position_mm": [1.0, 2.0, 5.0]}, "free": {"mass_kg": 50.0},
    }  # fmt: skip
    for friction in ({}, {"friction": 0.5}):
        scene = {"title": "heavy", "duration_s": 0.0, "patches": [palm | friction], "objects": [ball]}
        frame = bt.simulate(scene).observe()["patches"]["palm"]
        assert frame["wrench"][2] == pytest.approx(-490.5, rel=1e-6)
        np.testing.assert_allclose(frame["force3"].sum(axis=0), frame["wrench"][:3], atol=1e-6)


def test_threads_observe_a_simulation_that_another_one_steps() -> None:
    simulation, frames = bt.simulate(SCENE), list(bt.simulate(SCENE))
    known = {frame["time"]: frame["patches"]["palm"]["deflection"] for frame in frames}
    failed: list[float] = []
    next(simulation)

    def observe() -> None:
        for _ in range(300):
            frame = simulation.observe()
            if not np.array_equal(frame["patches"]["palm"]["deflection"], known[frame["time"]]):
                failed.append(frame["time"])

    threads = [threading.Thread(target=observe) for _ in range(3)]
    for thread in threads:
        thread.start()
    n_frames = 1 + sum(1 for _ in simulation)
    for thread in threads:
        thread.join()
    assert n_frames == len(frames) == len(known) and not failed


def test_another_seed_is_other_noise() -> None:
    noisy = SCENE | {"patches": [SCENE["patches"][0] | {"signal": ["force", {"noise_std_n": 0.01}]}]}
    simulation = bt.simulate(noisy)
    signals = []
    for seed in (None, None, 1, 1, 2):
        simulation.reset(seed)
        signals.append(simulation.observe()["patches"]["palm"]["signal"])
    assert np.array_equal(signals[0], signals[1]) and np.array_equal(signals[2], signals[3])
    assert not np.array_equal(signals[0], signals[2]) and not np.array_equal(signals[2], signals[4])


def test_what_cannot_be_set_is_refused() -> None:
    simulation = bt.simulate(arm({}))
    identity = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    for call, said in [
        (lambda: simulation.set_object_pose("bal", identity), "object: `bal`"),
        (lambda: simulation.set_object_pose("ball", [np.nan] * 7), "pose"),
        (lambda: simulation.set_object_pose("ball", [identity, identity]), "2 poses"),
        (lambda: simulation.set_robot_pose("leg", identity), "robot: `leg`"),
        (lambda: simulation.set_joint_positions("arm", [0.0]), "robots.arm.*1 positions"),
        (lambda: simulation.set_joint_positions("arm", [9.0] * 7), "robots.arm.*at most"),
        (lambda: simulation.set_joint_positions("arm", [[0.0] * 7]), r"shape \(1, 7\)"),
        (lambda: simulation.step(0.0), "positive number of seconds"),
        (lambda: simulation.step(float("nan")), "positive number of seconds"),
        (lambda: simulation.reset(-1), "seed: -1"),
        (lambda: simulation.patch("plam"), "patch: `plam`; palm"),
    ]:
        refused(said, lambda: call())


def test_a_frame_is_written_into_an_earlier_one() -> None:
    noisy = SCENE["patches"][0] | {"signal": ["force", {"noise_std_n": 0.01}], "friction": 0.4}
    scene = SCENE | {"patches": [noisy, noisy | {"name": "other", "layout": {"disc": {"radius_mm": 9.0, "pitch_mm": 3.0}}}]}
    simulation, twin = bt.simulate(scene), bt.simulate(scene)
    out, _ = twin.observe(), simulation.observe()
    arrays = {id(out["patches"][name][key]) for name in ("palm", "other") for key in ("deflection", "force3", "signal")}
    for height in (1.0, -1.0, -3.0):
        for one in (simulation, twin):
            one.set_object_pose("ball", [1e-3, 0, height * 1e-3, 1, 0, 0, 0])
            one.step(0.01)
        assert twin.observe(out=out) is out
        assert same(out, simulation.observe())
        assert arrays == {id(out["patches"][name][key]) for name in ("palm", "other") for key in ("deflection", "force3", "signal")}
    assert out["patches"]["palm"]["deflection"].max() > 1e-3
    for damage, said in [
        (lambda frame: frame.pop("patches"), "out: no dict `patches`"),
        (lambda frame: frame["patches"].pop("palm"), "out, patches: no dict `palm`"),
        (lambda frame: frame["objects"]["ball"].pop("pose"), "out, objects, ball: .*`pose`"),
        (lambda frame: frame["patches"]["palm"].update(force=np.zeros((16, 12))), r"palm, force: shape \(16, 12\); a float64 array in C order of shape \(12, 16\)"),
        (lambda frame: frame["patches"]["palm"].update(force=np.zeros((12, 16), np.float32)), "float64"),
        (lambda frame: frame["patches"]["palm"]["force"].setflags(write=False), "writeable"),
    ]:
        damaged = simulation.observe()
        damage(damaged)
        before = {key: value.copy() for key, value in damaged.get("patches", {}).get("other", {}).items() if isinstance(value, np.ndarray)}
        simulation.set_object_pose("ball", [0, 0, 5e-3, 1, 0, 0, 0])
        simulation.step(0.01)
        refused(said, lambda: simulation.observe(out=damaged))
        assert all(np.array_equal(damaged["patches"]["other"][key], value) for key, value in before.items())

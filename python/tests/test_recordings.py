"""Tests of recordings in other formats, read by independent readers."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import bubbletouch as bt
import numpy as np
import pytest
from bubbletouch.recording import Recording, rotations

from conftest import refused

SCENE: dict[str, Any] = {
    "title": "A pear slides over a turned palm",
    "output_hz": 100.0,
    "duration_s": 0.5,
    "patches": [
        {
            "name": "palm",
            "at": {"position_mm": [5.0, 0.0, 0.0], "rotation_deg": [10.0, 0.0, 30.0]},
            "layout": {"grid": {"nx": 16, "ny": 12, "pitch_mm": 4.0}},
            "stroke_mm": 5.0,
            "friction": 0.5,
            "shear_stiffness_n_per_m": 50.0,
            "signal": ["force", {"noise_std_n": 0.01}],
        },
        {
            "name": "back",
            "at": {"position_mm": [0.0, 0.0, 30.0]},
            "layout": {"hexagonal": {"nx": 5, "ny": 5, "pitch_mm": 4.0}},
            "stroke_mm": 5.0,
        },
    ],
    "objects": [
        {
            "name": "pear",
            "object": "pear",
            "at": {"position_mm": [0.0, 0.0, -1.0]},
            "motion": {"phases": [{"duration_s": 0.5, "linear_mm_per_s": [30.0, 0.0, -4.0]}]},
        }
    ],
}


@pytest.fixture(scope="module")
def recording() -> Recording:
    recording = Recording.of(bt.simulate(SCENE))
    assert len(recording) == 51 and recording.patches["palm"].force.max() > 0.1
    return recording


def test_a_recording_is_the_frames(recording: Recording) -> None:
    for number, frame in enumerate(bt.simulate(SCENE)):
        assert recording.time[number] == frame["time"]
        for name, felt in frame["patches"].items():
            recorded = recording.patches[name]
            assert np.array_equal(recorded.deflection[number], felt["deflection"])
            assert np.array_equal(recorded.force3[number], felt["force3"])
        assert np.array_equal(recording.objects["pear"][number], frame["objects"]["pear"]["pose"])
    assert recording.patches["palm"].signal is not None and recording.patches["back"].signal is None
    simulation = bt.simulate(SCENE)
    refused("frames: none", lambda: Recording.of(simulation, []))


def test_points_are_taxels_and_forces_in_the_world(recording: Recording) -> None:
    felt = recording.patches["palm"]
    points = felt.points()
    assert points.shape == (51, 16 * 12, 6)
    turn = rotations(felt.pose)[30]
    assert np.allclose(turn @ turn.T, np.eye(3), atol=1e-15) and np.linalg.det(turn) == pytest.approx(1)
    # Rotation of the patch in the world, computed from its roll and yaw.
    roll, yaw = np.radians(10), np.radians(30)
    about_x = np.array([[1, 0, 0], [0, np.cos(roll), -np.sin(roll)], [0, np.sin(roll), np.cos(roll)]])
    about_z = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    assert np.allclose(turn, about_z @ about_x, atol=1e-12)
    for taxel in (0, 77, 191):
        assert np.allclose(points[30, taxel, :3], turn @ felt.patch.centers[taxel] + [5e-3, 0, 0], atol=1e-12)
        assert np.allclose(points[30, taxel, 3:], turn @ felt.force3[30, taxel], atol=1e-12)


def test_arrow_and_parquet_bring_the_same_bits_back(recording: Recording, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    import pyarrow.parquet as pq

    recording.write_parquet(tmp_path / "r.parquet")
    read = pq.read_table(tmp_path / "r.parquet")
    assert read.equals(recording.table()) and read.num_rows == 51
    assert np.array_equal(read["time_s"].to_numpy(), recording.time)
    palm = recording.patches["palm"]
    for key in ("pose", "deflection", "force", "force3", "wrench", "signal"):
        tensors = read[f"palm.{key}"].combine_chunks()
        tensors = tensors.chunk(0) if hasattr(tensors, "chunk") else tensors
        assert np.array_equal(tensors.to_numpy_ndarray(), getattr(palm, key)), key
    assert "back.signal" not in read.column_names
    layouts = json.loads(read.schema.metadata[b"patches"])
    assert np.array_equal(layouts["palm"]["centers_m"], palm.patch.centers)
    assert read.schema.metadata[b"title"].decode() == SCENE["title"]


def test_pandas_reads_the_parquet_file(recording: Recording, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    pandas = pytest.importorskip("pandas")
    recording.write_parquet(tmp_path / "r.parquet")
    frame = pandas.read_parquet(tmp_path / "r.parquet")
    assert np.array_equal(np.stack(frame["back.force"]), recording.patches["back"].force)


@pytest.fixture(scope="module")
def lerobot(recording: Recording, tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("pyarrow")
    pytest.importorskip("pandas")
    from bubbletouch.lerobot import write_lerobot

    folder = tmp_path_factory.mktemp("lerobot") / "dataset"
    other = Recording.of(bt.simulate(SCENE | {"title": "Another task", "duration_s": 0.3}))
    write_lerobot(folder, [recording, other, recording], fps=20)
    return folder


def test_a_lerobot_dataset_has_windows_of_fast_touch_and_point_sets(lerobot: Path, recording: Recording) -> None:
    import pandas as pd
    import pyarrow.parquet as pq

    info = json.loads((lerobot / "meta/info.json").read_text())
    assert (info["codebase_version"], info["total_episodes"], info["total_tasks"]) == ("v3.0", 3, 2)
    assert info["features"]["observation.touch.palm"] == {"dtype": "float32", "shape": [5, 192], "names": None}
    assert info["features"]["observation.points.back"]["shape"] == [25, 6]
    rows = pq.read_table(lerobot / "data/chunk-000/file-000.parquet")
    assert set(rows.column_names) == set(info["features"]) and info["total_frames"] == rows.num_rows == 11 + 7 + 11
    touch = np.array(rows["observation.touch.palm"].to_pylist(), np.float32)
    fast = recording.patches["palm"].force.reshape(51, -1).astype(np.float32)
    # 100 touch frames and 20 rows per second: row k contains frames 5 k − 4 to 5 k.
    for row in range(1, 11):
        assert np.array_equal(touch[row], fast[5 * row - 4 : 5 * row + 1])
    assert np.array_equal(touch[0], np.repeat(fast[:1], 5, axis=0))
    # Windows do not cross the boundary between episodes.
    assert np.array_equal(touch[11], touch[0]) and np.array_equal(touch[18:], touch[:11])
    points = np.array(rows["observation.points.palm"].to_pylist(), np.float32)
    assert np.array_equal(points[10], recording.patches["palm"].points()[50].astype(np.float32))
    assert rows["index"].to_pylist() == list(range(29))
    assert rows["timestamp"].to_pylist()[:3] == pytest.approx([0, 0.05, 0.1])
    episodes = pq.read_table(lerobot / "meta/episodes/chunk-000/file-000.parquet").to_pydict()
    assert episodes["dataset_from_index"] == [0, 11, 18] and episodes["length"] == [11, 7, 11]
    tasks = pd.read_parquet(lerobot / "meta/tasks.parquet")
    assert list(tasks.index) == [SCENE["title"], "Another task"] and list(tasks["task_index"]) == [0, 1]
    assert rows["task_index"].to_pylist() == [0] * 11 + [1] * 7 + [0] * 11
    stats = json.loads((lerobot / "meta/stats.json").read_text())
    assert np.allclose(stats["observation.touch.palm"]["max"], touch.max(axis=0))
    assert stats["timestamp"]["count"] == [29] and len(stats["timestamp"]["mean"]) == 1


def test_our_reader_takes_the_newest_frame_of_a_window(lerobot: Path) -> None:
    import pyarrow.parquet as pq

    feature = "observation.touch.back"
    windows = np.array(pq.read_table(lerobot / "data/chunk-000/file-000.parquet")[feature].to_pylist())
    read = bt.read_recorded(lerobot, feature)
    assert read.frames.shape[2:] == windows.shape[2:]
    first = windows[: read.frames.shape[1], -1]
    np.testing.assert_array_equal(read.frames[0], first)


def test_huggingfaces_datasets_read_the_lerobot_dataset(lerobot: Path) -> None:
    datasets = pytest.importorskip("datasets")
    info = json.loads((lerobot / "meta/info.json").read_text())

    def feature(about: dict[str, Any]) -> Any:
        # The feature types equal the types in LeRobot's reader.
        shape = tuple(about["shape"])
        if shape == (1,):
            return datasets.Value(about["dtype"])
        if len(shape) == 1:
            return datasets.Sequence(datasets.Value(about["dtype"]), length=shape[0])
        return datasets.Array2D(shape=shape, dtype=about["dtype"])

    features = datasets.Features({name: feature(about) for name, about in info["features"].items()})
    path = str(lerobot / "data/chunk-000/file-000.parquet")
    read = datasets.Dataset.from_parquet([path], features=features, cache_dir=str(lerobot / "cache"))
    row = read.with_format("numpy")[12]
    assert row["observation.touch.palm"].shape == (5, 192) and row["episode_index"] == 1


def test_lerobots_own_reader_reads_it(lerobot: Path, recording: Recording) -> None:
    pytest.importorskip("lerobot")
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    dataset = LeRobotDataset("bubbletouch/test", root=lerobot, delta_timestamps={"observation.pose.palm": [-0.05, 0.0]})
    assert (dataset.fps, dataset.num_episodes, len(dataset)) == (20, 3, 29)
    row = dataset[12]
    assert (row["task"], int(row["episode_index"]), int(row["frame_index"])) == ("Another task", 1, 1)
    fast = recording.patches["palm"].force.reshape(51, -1).astype(np.float32)
    assert np.array_equal(dataset[28]["observation.touch.palm"].numpy(), fast[46:51])
    assert dataset[28]["observation.points.back"].shape == (25, 6)
    # Frames are requested by time offsets, as policies do.
    poses = recording.patches["palm"].pose[[45, 50]].astype(np.float32)
    assert np.array_equal(dataset[28]["observation.pose.palm"].numpy(), poses)
    assert np.allclose(dataset.meta.stats["observation.pose.palm"]["mean"], poses[0])


def test_reruns_reader_takes_the_lerobot_dataset(lerobot: Path) -> None:
    experimental = pytest.importorskip("rerun.experimental")
    if not hasattr(experimental, "LeRobotReader"):
        pytest.skip("this rerun has no LeRobotReader")
    reader = experimental.LeRobotReader(lerobot)
    assert (reader.version, reader.episodes()) == ("v3", [0, 1, 2])


def test_what_is_no_lerobot_dataset_is_refused(recording: Recording, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    pytest.importorskip("pandas")
    from bubbletouch.lerobot import write_lerobot

    refused("at least 200 frames a second", lambda: write_lerobot(tmp_path / "a", [recording], fps=200))
    refused("quantity: pose, which patch `[a-z]+` has not", lambda: write_lerobot(tmp_path / "a", [recording], fps=20, quantity="pose"))  # type: ignore[arg-type]
    refused("episodes: none", lambda: write_lerobot(tmp_path / "a", [], fps=20))
    refused("window", lambda: write_lerobot(tmp_path / "a", [recording], fps=20, window=0))
    refused("`back` has not", lambda: write_lerobot(tmp_path / "a", [recording], fps=20, quantity="signal"))
    fewer = Recording.of(bt.simulate(SCENE | {"patches": SCENE["patches"][:1]}))
    refused(r"episodes\[1\]: other patches", lambda: write_lerobot(tmp_path / "a", [recording, fewer], fps=20))
    assert not (tmp_path / "a").exists()
    write_lerobot(tmp_path / "a", [recording], fps=20)
    with pytest.raises(FileExistsError):
        write_lerobot(tmp_path / "a", [recording], fps=20)


def test_mcaps_own_reader_reads_every_message(recording: Recording, tmp_path: Path) -> None:
    pytest.importorskip("mcap")
    from bubbletouch.mcap_file import write_mcap
    from mcap.reader import make_reader

    write_mcap(tmp_path / "r.mcap", recording)
    with (tmp_path / "r.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None and summary.statistics is not None
        assert summary.statistics.message_count == 51 * 5
        topics = {channel.topic: summary.schemas[channel.schema_id].name for channel in summary.channels.values()}
        assert topics == {
            "/palm/points": "foxglove.PointCloud", "/palm/touch": "bubbletouch.Touch",
            "/back/points": "foxglove.PointCloud", "/back/touch": "bubbletouch.Touch",
            "/pear/pose": "foxglove.PoseInFrame",
        }  # fmt: skip
        seen = {topic: 0 for topic in topics}
        for _, channel, message in reader.iter_messages():
            said, frame = json.loads(message.data), seen[channel.topic]
            seen[channel.topic] += 1
            assert message.log_time == round(1e9 * recording.time[frame])
            assert said["timestamp"] == {"sec": message.log_time // 10**9, "nsec": message.log_time % 10**9}
            if channel.topic == "/palm/points":
                felt = recording.patches["palm"]
                points = np.frombuffer(base64.b64decode(said["data"]), "<f4").reshape(-1, 6)
                assert said["point_stride"] == 24 and [field["offset"] for field in said["fields"]] == list(range(0, 24, 4))
                assert np.array_equal(points[:, :3], felt.patch.centers.astype(np.float32))
                assert np.array_equal(points[:, 3:], felt.force3[frame].astype(np.float32))
                assert said["pose"]["orientation"]["w"] == felt.pose[frame, 3]
            if channel.topic == "/palm/touch":
                assert np.array_equal(said["force_n"], recording.patches["palm"].force[frame].ravel())
            if channel.topic == "/pear/pose":
                assert list(said["pose"]["position"].values()) == recording.objects["pear"][frame, :3].tolist()
        assert set(seen.values()) == {51}


def test_reruns_own_reader_finds_every_taxel(tmp_path: Path) -> None:
    rr = pytest.importorskip("rerun")
    chunk = pytest.importorskip("rerun.chunk")
    from bubbletouch.live import View

    simulation = bt.simulate(SCENE)
    with rr.RecordingStream("bubbletouch-test") as to:
        to.save(tmp_path / "r.rrd")
        view = View(simulation, to)
        frames = list(simulation)
        for frame in frames:
            view.show(frame)
        to.flush()
    positions, forces = [], []
    for part in chunk.RrdReader(tmp_path / "r.rrd").stream():
        if part.entity_path != "/palm/taxels":
            continue
        for name, values in part.to_record_batch().to_pydict().items():
            if name.endswith("Points3D:positions"):
                positions += [value for value in values if value is not None]
            if name.endswith("force_n"):
                forces += [value for value in values if value is not None]
    assert len(positions) == len(forces) == 51
    patch = simulation.patch("palm")
    for frame, at, force in zip(frames, positions, forces, strict=True):
        felt = frame["patches"]["palm"]
        expected = patch.centers - felt["deflection"].reshape(-1, 1) * patch.axes
        assert np.array_equal(np.array(at, np.float32), expected.astype(np.float32))
        assert np.array_equal(force, felt["force"].ravel())

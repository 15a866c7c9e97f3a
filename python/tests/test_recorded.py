"""Recorded touches: arrays in memory, and files of Zarr, HDF5, Parquet, CSV, NumPy and LeRobot, each written by the test."""

import json
import sys

import bubbletouch as bt
import numpy as np
import pytest

from conftest import refused

N = 60
STUDY = {
    "question": "?",
    "trials": 2,
    "skin": {"pitch_mm": 4.0, "stroke_mm": 5.0},
    "signal": {"steps": ["noise"], "noise_std_full_scale": 0.05},
    "sensing": {"measurements": 8},
    "recognition": {"classifier": "linear_svm"},
}


@pytest.fixture(scope="module")
def arrays():
    """Frames of three classes with 8 × 8 taxels, their labels as texts, and groups."""
    rng = np.random.default_rng(0)
    labels = np.repeat(["cup", "ball", "pen"], N // 3)
    row, column = np.mgrid[:8, :8]
    middle = 2 + 0.5 * np.arange(N)[:, None, None] // 20
    frames = np.exp(-((row - 3.5) ** 2 + (column - middle) ** 2) / 4) + 0.9 * rng.random((N, 8, 8))
    return frames.astype(np.float32), labels, np.arange(N) // 4


def accuracy(recorded, study=STUDY, **options):
    table = bt.run(study, recorded=recorded, **options)["accuracy"]
    return {name: [str(value) for value in column] for name, column in table.columns.items()}


@pytest.fixture(scope="module")
def usual(arrays, tmp_path_factory):
    """Rows of the study of the arrays in files."""
    folder = tmp_path_factory.mktemp("files")
    frames, labels, groups = arrays
    for name, array in {"frames": frames, "labels": labels, "groups": groups}.items():
        np.save(folder / f"{name}.npy", array)
    return accuracy({name: str(folder / f"{name}.npy") for name in ("frames", "labels", "groups")})


def same(found, arrays):
    frames, labels, groups = arrays
    assert np.array_equal(found.frames.reshape(N, -1), frames.reshape(N, -1))
    assert found.labels.tolist() == labels.tolist()
    assert groups is None or found.groups.tolist() == groups.tolist()
    assert len(found) == N


def test_arrays_in_memory_give_the_rows_of_files(arrays, usual, tmp_path):
    frames, labels, groups = arrays
    table = {"frames": frames, "labels": labels.tolist(), "groups": groups}
    assert accuracy(table) == usual
    assert accuracy(bt.Recorded(frames, labels, groups)) == usual
    assert accuracy(None, {**STUDY, "recorded": table}) == usual
    # A study file keeps its other keys.
    file = tmp_path / "study.toml"
    file.write_text(bt._core.toml_of(bt.study._json({**STUDY, "recorded": {"previous_touch": "none"}})))
    assert accuracy(table, file) == usual
    # A run in a folder is continued, and other arrays do not replace those of the folder.
    out = tmp_path / "out"
    assert accuracy(table, out=out) == usual
    assert accuracy(table, out=out) == usual
    assert len(list((out / "recorded").glob("*.npy"))) == 3


def test_a_layout_is_a_patch_or_an_array(arrays):
    frames, labels, groups = arrays
    row, column = np.mgrid[:8, :8]
    places = 4e-3 * np.stack([column.ravel(), row.ravel(), np.zeros(64)], axis=1)
    axes = np.tile([0.0, 0.0, 1.0], (64, 1))
    study = {**STUDY, "recognition": {"classifier": "linear_svm", "features": "fourier_magnitude"}, "sensing": {"ensemble": "identity"}}
    expected = accuracy(bt.Recorded(frames, labels, groups), study)
    patch = bt.Patch.grid(8, 8, 4e-3, stroke=5e-3)
    for layout in (places, np.hstack([places, axes]), patch):
        found = bt.Recorded(frames.reshape(N, 64), labels, groups, keys={"layout": layout})
        assert accuracy(found, study) == expected
    with pytest.raises(ValueError, match=r"recorded.layout: shape \(64, 2\) of float64; a Patch, or positions"):
        accuracy(bt.Recorded(frames.reshape(N, 64), labels, groups, keys={"layout": places[:, :2]}), study)
    with pytest.raises(ValueError, match=r"^recorded\.layout: 63 taxels; 64, as recorded\.frames has$"):
        accuracy(bt.Recorded(frames.reshape(N, 64), labels, groups, keys={"layout": places[1:]}), study)


def test_sensors_in_memory_are_joined(arrays):
    frames, labels, groups = arrays
    whole = bt.Recorded(frames.reshape(N, 64), labels, groups, keys={"full_scale": 2.0})
    parts = {"left": frames.reshape(N, 64)[:, :24], "right": frames.reshape(N, 64)[:, 24:]}
    scale = {"full_scale": 2.0}
    assert accuracy(bt.Recorded(parts, labels, groups, keys={"left": scale, "right": scale})) == accuracy(whole)
    refused("sensors left, right; one sensor", lambda: bt.audit(bt.Recorded(parts, labels, groups)))


def test_touches_of_unequal_length_are_padded(arrays):
    frames, labels, _ = arrays
    lengths = 4 + np.arange(N) % 4
    touches = [np.linspace(0, 1, n)[:, None] * frame.ravel() for n, frame in zip(lengths, frames, strict=True)]
    padded = np.full((N, 7, 64), np.nan)
    for touch, own in zip(padded, touches, strict=True):
        touch[: len(own)] = own
    keys = {"labels": labels, "order": "n t c", "resampled_frames": 4}
    assert accuracy({"frames": touches, **keys}) == accuracy({"frames": padded, **keys})
    refused("touches of 4 to 7 of 7 frames", lambda: accuracy({"frames": touches, "labels": labels, "order": "n t c"}))


def test_audit_reads_a_recording(arrays):
    frames, labels, groups = arrays
    recorded = bt.Recorded(frames, labels, groups)
    said = [f.sentence for f in bt.audit(recorded, permutations=399).findings]
    assert said == [f.sentence for f in bt.audit(frames, labels, groups, permutations=399).findings]


def test_npz(arrays, tmp_path):
    frames, labels, groups = arrays
    np.savez(tmp_path / "a.npz", frames=frames, labels=labels, groups=groups)
    same(bt.read_recorded(tmp_path / "a.npz"), arrays)
    # A folder of files: groups are the files, unless the files contain groups.
    for part in range(3):
        own = slice(20 * part, 20 * part + 20)
        np.savez(tmp_path / f"part{part + 9}.npz", frames=frames[own], labels=labels[own])
    (tmp_path / "a.npz").unlink()
    found = bt.read_recorded(tmp_path)
    same(found, (frames, labels, None))
    assert found.groups.tolist() == [f"part{9 + touch // 20}.npz" for touch in range(N)]
    assert found.touches.tolist() == [f"{tmp_path}/part{9 + touch // 20}.npz/{touch % 20}" for touch in range(N)]


def test_hdf5(arrays, usual, tmp_path):
    h5py = pytest.importorskip("h5py")
    frames, labels, groups = arrays
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["skin/frames"], file["labels"], file["groups"] = frames, labels.astype("S"), groups
    found = bt.read_recorded(tmp_path / "a.h5", "skin/frames")
    same(found, arrays)
    assert accuracy(found) == usual
    # A dataset for each touch, with labels in attributes.
    with h5py.File(tmp_path / "b.hdf5", "w") as file:
        for touch in range(N):
            group = file.create_group(f"data/demo_{touch}")
            group["obs/tactile"] = np.repeat(frames[touch][None], 1 + touch % 2, axis=0)
            group.attrs["object"], group["session"] = str(labels[touch]), groups[touch]
    found = bt.read_recorded(tmp_path / "b.hdf5", "data/*/obs/tactile", labels="data/*@object", groups="data/*/session")
    assert found.frames.shape == (N, 2, 8, 8) and found.lengths.tolist() == [1 + touch % 2 for touch in range(N)]
    same(bt.Recorded(found.frames[:, 0], found.labels, found.groups), arrays)
    # A file for each touch.
    for touch in range(N):
        with h5py.File(tmp_path / f"grasp_{touch}.h5", "w") as file:
            file["tactile"], file.attrs["object"] = frames[touch][None], str(labels[touch])
    for name in ("a.h5", "b.hdf5"):
        (tmp_path / name).unlink()
    found = bt.read_recorded(tmp_path, "tactile", labels="@object")
    assert found.frames.shape == (N, 1, 8, 8) and found.groups is None
    same(found, (frames, labels, None))


def test_zarr(arrays, tmp_path):
    zarr = pytest.importorskip("zarr")
    frames, labels, groups = arrays
    numbers = np.unique(labels, return_inverse=True)[1]
    group = zarr.open_group(str(tmp_path / "a.zarr"), mode="w")
    for name, array in {"tactile": frames, "labels": numbers, "groups": groups}.items():
        made = group.create_array(name, shape=array.shape, dtype=array.dtype) if hasattr(group, "create_array") else group.zeros(name, shape=array.shape, dtype=array.dtype)
        made[...] = array
    found = bt.read_recorded(tmp_path / "a.zarr", "tactile")
    same(found, (frames, numbers, groups))
    refused("a.zarr: no array `frames`; one of groups, labels, tactile", lambda: bt.read_recorded(tmp_path / "a.zarr"))


def test_parquet(arrays, tmp_path):
    pa = pytest.importorskip("pyarrow")
    pq = pytest.importorskip("pyarrow.parquet")
    frames, labels, groups = arrays
    rows = frames.reshape(N, 64)
    lists = pa.array(list(rows.astype(np.float64)))
    columns = {f"taxel_{k}": rows[:, k] for k in range(64)}
    pq.write_table(pa.table({"frames": lists, "labels": labels, "groups": groups, **columns}), tmp_path / "a.parquet")
    same(bt.read_recorded(tmp_path / "a.parquet"), (rows.astype(np.float64), labels, groups))
    same(bt.read_recorded(tmp_path / "a.parquet", "taxel_*"), arrays)
    same(bt.read_recorded(tmp_path / "a.parquet", list(columns)), arrays)
    sensors = bt.read_recorded(tmp_path / "a.parquet", {"first": ["taxel_0", "taxel_1"], "all": "taxel_*"})
    assert sensors.frames["first"].shape == (N, 2) and sensors.frames["all"].shape == (N, 64)
    # Rows that are the frames of touches.
    found = bt.read_recorded(tmp_path / "a.parquet", touches="groups", labels="labels")
    assert found.frames.shape == (15, 4, 64) and found.labels.tolist() == ["cup"] * 5 + ["ball"] * 5 + ["pen"] * 5
    refused(r"a.parquet, `groups`: 0, 1, 2 in touch cup; one value for all rows of a touch", lambda: bt.read_recorded(tmp_path / "a.parquet", touches="labels"))


def test_csv(arrays, tmp_path):
    frames, labels, groups = arrays
    rows = frames.reshape(N, 64).astype(np.float64)
    file = tmp_path / "a.csv"
    names = [f"ff_{k}" for k in range(1, 25)] + [f"th_{k}" for k in range(1, 41)]
    lines = [",".join(["object", "session", *names])]
    lines += [",".join([label, str(group), *map(repr, row.tolist())]) for label, group, row in zip(labels, groups, rows, strict=True)]
    file.write_text("\n".join(lines) + "\n")
    found = bt.read_recorded(file, {"ff": "ff_*", "th": "th_*"}, labels="object", groups="session")
    assert np.array_equal(np.hstack([found.frames["ff"], found.frames["th"]]), rows)
    same(bt.Recorded(rows, found.labels, found.groups), (rows, labels, groups))
    for text, words in {
        "\n".join(lines)[:-5000]: "a.csv, line [0-9]+: [0-9]+ values; 66, as line 1 has",
        "\n".join(lines).replace("th_1,", "ff_1,", 1): "column `ff_1` twice",
        "\n".join(lines).replace(repr(float(rows[3, 0])), "broken", 1): "a.csv, column `ff_1`: elements of type <U.*; numbers",
        "": "a.csv: an empty file",
    }.items():
        file.write_text(text)
        refused(words, lambda: bt.read_recorded(file, "ff_*", labels="object"))
    with pytest.raises(ValueError, match="a.csv, column .*: no readings, shape"):
        file.write_bytes(b"\xfe,")
        bt.read_recorded(file)
    file.write_text("\n".join(lines).replace(repr(float(rows[3, 0])), "", 1))
    assert np.isnan(bt.read_recorded(file, "ff_*", labels="object").frames[3, 0])


def lerobot(folder, arrays, version):
    """Writes a LeRobot folder of 15 episodes of 3 or 4 frames."""
    pa = pytest.importorskip("pyarrow")
    pq = pytest.importorskip("pyarrow.parquet")
    frames, labels, groups = arrays
    tasks = ["cup", "ball", "pen"]
    kept = [touch for touch in range(N) if touch % 8 != 7]
    columns = {
        "observation.tactile.palm": pa.array([row.tolist() for row in frames.astype(np.float64)[kept]]),
        "observation.state": pa.array(np.zeros((len(kept), 2)).tolist()),
        "episode_index": groups[kept],
        "frame_index": np.array(kept) % 4,
        "index": np.arange(len(kept)),
        "task_index": np.array([tasks.index(label) for label in labels[kept]]),
    }
    table = pa.table(columns)
    (folder / "meta").mkdir(parents=True)
    features = {
        "observation.tactile.palm": {"dtype": "float32", "shape": [8, 8], "names": None},
        "observation.state": {"dtype": "float32", "shape": [2], "names": None},
        "observation.images.top": {"dtype": "video", "shape": [3, 8, 8], "names": None},
    }
    features |= {name: {"dtype": "int64", "shape": [1], "names": None} for name in ("episode_index", "frame_index", "index", "task_index")}
    info = {"codebase_version": version, "total_episodes": 15, "total_frames": len(kept), "fps": 10, "features": features}
    (folder / "meta" / "info.json").write_text(json.dumps(info))
    if version == "v3.0":
        (folder / "data" / "chunk-000").mkdir(parents=True)
        half = len(kept) // 2
        pq.write_table(table.slice(half), folder / "data" / "chunk-000" / "file-001.parquet")
        pq.write_table(table.slice(0, half), folder / "data" / "chunk-000" / "file-000.parquet")
        pq.write_table(pa.table({"task_index": [2, 0, 1], "task": ["pen", "cup", "ball"]}), folder / "meta" / "tasks.parquet")
    else:
        for episode in range(15):
            file = folder / "data" / f"chunk-{episode // 10:03d}" / f"episode_{episode:06d}.parquet"
            file.parent.mkdir(parents=True, exist_ok=True)
            pq.write_table(table.filter(pa.compute.equal(table["episode_index"], episode)), file)
        lines = [json.dumps({"task_index": k, "task": task}) for k, task in enumerate(tasks)]
        (folder / "meta" / "tasks.jsonl").write_text("\n".join(lines) + "\n")
    return kept


@pytest.mark.parametrize("version", ["v2.1", "v3.0"])
def test_lerobot(arrays, tmp_path, version):
    pytest.importorskip("pyarrow.compute")
    frames, labels, groups = arrays
    kept = lerobot(tmp_path / "set", arrays, version)
    found = bt.read_recorded(tmp_path / "set")
    assert found.frames.shape == (15, 4, 8, 8) and found.labels.tolist() == labels[::4].tolist()
    assert found.lengths.tolist() == [4 if episode % 2 == 0 else 3 for episode in range(15)]
    assert np.array_equal(found.frames[2], frames[8:12]) and np.isnan(found.frames[1, 3]).all()
    accuracy(bt.Recorded(found.frames, found.labels, keys={"resampled_frames": 3}), {**STUDY, "trials": 1})
    each = bt.read_recorded(tmp_path / "set", {"palm": "observation.tactile.palm", "arm": "observation.state"}, touches="index")
    assert each.frames["palm"].shape == (len(kept), 1, 8, 8) and each.frames["arm"].shape == (len(kept), 1, 2)
    assert each.groups.tolist() == groups[kept].tolist() and each.labels.tolist() == labels[kept].tolist()
    for wrong, words in {
        "observation.images.top": "no feature `observation.images.top` of numbers; one of observation.tactile.palm",
        "observation.touch": "info.json: no feature `observation.touch`",
    }.items():
        refused(words, lambda: bt.read_recorded(tmp_path / "set", wrong))
    info = tmp_path / "set" / "meta" / "info.json"
    right = info.read_text()
    for text, words in {
        right[:50]: "info.json: cannot be read",
        right.replace('"total_frames": 53', '"total_frames": 60'): "data: 53 rows; 60, as ",
        right.replace("[8, 8]", "[8, 9]", 1): r"observation.tactile.palm`: rows of shape \(8, 8\); \(8, 9\)",
        right.replace("observation.tactile", "observation.skin"): "info.json: no feature of touch; frames = a name",
    }.items():
        assert text != right
        info.write_text(text)
        refused(words, lambda: bt.read_recorded(tmp_path / "set"))
    info.write_text(right)
    tasks = next(file for file in (tmp_path / "set" / "meta").iterdir() if file.name.startswith("tasks"))
    tasks.write_bytes(tasks.read_bytes()[:20])
    refused("tasks.*cannot be read", lambda: bt.read_recorded(tmp_path / "set"))
    data = next((tmp_path / "set" / "data").rglob("*.parquet"))
    data.write_bytes(data.read_bytes()[:100])
    refused(r"(episode_|file-)0+\w*\.parquet: .*; a complete Parquet file", lambda: bt.read_recorded(tmp_path / "set"))


def test_places_without_recordings_are_refused(arrays, tmp_path):
    refused("none: no such file or folder; a .zarr folder", lambda: bt.read_recorded(tmp_path / "none"), FileNotFoundError)
    refused("a folder without recordings", lambda: bt.read_recorded(tmp_path))
    (tmp_path / "a.pkl").write_bytes(b"")
    refused("a.pkl: another file", lambda: bt.read_recorded(tmp_path / "a.pkl"))
    frames, labels, _ = arrays
    np.savez(tmp_path / "a.npz", frames=frames, labels=labels)
    np.savez(tmp_path / "b.npz", frames=frames[:, :4], labels=labels)
    refused(r"b.npz, frames: frames of shape \(4, 8\); \(8, 8\), as other touches have", lambda: bt.read_recorded(tmp_path))


@pytest.mark.parametrize(("file", "package"), [("a.h5", "h5py"), ("a.parquet", "pyarrow")])
def test_a_missing_package_is_named(file, package, tmp_path, monkeypatch):
    (tmp_path / file).write_bytes(b"")
    for name in [name for name in sys.modules if name.split(".")[0] == package] + [package]:
        monkeypatch.setitem(sys.modules, name, None)
    refused(rf"{file}: needs the package {package}; pip install {package}", lambda: bt.read_recorded(tmp_path / file), ImportError)


def test_several_values_per_taxel_are_channels():
    rng = np.random.default_rng(7)
    labels = np.repeat([0, 1, 2], 20)
    frames = rng.normal(labels[:, None, None, None, None], 1.0, (N, 2, 4, 5, 3))
    seen = {"features": [], "rows": []}

    def channels(given):
        seen["features"].append(np.array(given).reshape(-1, 3, 4, 5))
        return given.reshape(len(given), -1)

    class Network:
        """Nearest class mean of the rows, which have the axes frame, channel, row and column."""

        def fit(self, rows, labels):
            seen["rows"].append((rows.reshape(-1, 2, 3, 4, 5), labels))
            self.means = np.array([rows[labels == k].mean(0) for k in range(3)])

        def predict(self, rows):
            return ((rows[:, None] - self.means) ** 2).sum(-1).argmin(1)

    study = {**STUDY, "signal": {"steps": []}, "sensing": {"ensemble": "identity"}, "recognition": {"classifier": "mine", "features": ["channels", "raw"], "scaling": "none"}}
    recorded = {"frames": frames, "labels": labels, "order": "n t y x c", "full_scale": 5.0}
    bt.run(study, recorded=recorded, classifiers={"mine": (Network(), "1")}, features={"channels": (channels, "1")})
    # Deflections are fractions of the full scale times the stroke; frames are stored as float32.
    expected = (frames.transpose(0, 1, 4, 2, 3) / 5.0 * 5e-3).astype(np.float32)
    known = {frame.tobytes() for frame in expected.reshape(-1, 3, 4, 5)}
    assert {frame.astype(np.float32).tobytes() for frame in np.concatenate(seen["features"]) if frame.any()} == known
    known = {touch.tobytes(): label for touch, label in zip(expected, labels, strict=True)}
    assert seen["rows"]
    for rows, of in seen["rows"]:
        assert all(known[row.astype(np.float32).tobytes()] == label for row, label in zip(rows, of, strict=True))


def test_links_of_hdf5_files_are_followed(tmp_path):
    h5py = pytest.importorskip("h5py")
    frames = np.arange(96, dtype=float).reshape(6, 4, 4)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["frames"] = frames
    with h5py.File(tmp_path / "links.h5", "w") as file:
        file["data/frames"], file["data/labels"] = frames, np.arange(6) % 2
        file["soft"], file["far"] = h5py.SoftLink("/data/frames"), h5py.ExternalLink("other.h5", "/frames")
        file["data/up"], file["none"] = h5py.SoftLink("/"), h5py.SoftLink("/absent")
    for name in ("data/frames", "/data/frames", "soft", "far"):
        found = bt.read_recorded(tmp_path / "links.h5", name, labels="/data/labels")
        assert np.array_equal(found.frames, frames) and found.labels.tolist() == [0, 1] * 3
    refused("no array `none`; one of data/frames, data/labels, far, soft", lambda: bt.read_recorded(tmp_path / "links.h5", "none"))


def test_dates_are_groups():
    study = {"question": "?", "trials": 2, "skin": {"pitch_mm": 2.0, "stroke_mm": 1.0}, "recognition": {"classifier": "nearest_centroid"}}
    frames = np.random.default_rng(1).random((40, 4, 4))
    labels, days = np.arange(40) % 2, np.arange(40) // 4
    dates = np.datetime64("2024-02-27") + days
    run = [bt.run(study, recorded={"frames": frames, "labels": labels, "groups": groups}) for groups in (days, dates)]
    assert run[0]["accuracy"]["accuracy"].tolist() == run[1]["accuracy"]["accuracy"].tolist()
    dates[3] = np.datetime64("NaT")
    refused("^recorded.groups, position 3: NaT; integers or texts$", lambda: bt.run(study, recorded={"frames": frames, "labels": labels, "groups": dates}))


def test_splits_of_scikit_learn_are_the_trials(arrays):
    model_selection = pytest.importorskip("sklearn.model_selection")
    frames, labels, groups = arrays
    splits = list(model_selection.StratifiedGroupKFold(3, shuffle=True, random_state=0).split(frames, labels, groups))
    study = {**STUDY, "trials": 3, "report": {"predictions": True}}
    found = bt.run(study, recorded=bt.Recorded(frames, labels, groups, splits=splits))["predictions"].columns
    rows = list(zip(*(found[name] for name in ("trial", "touch", "group", "truth")), strict=True))
    for trial, (_, test) in enumerate(splits):
        own = sorted((int(touch), int(group), str(truth)) for number, touch, group, truth in rows if number == trial)
        assert own == sorted((touch, groups[touch], labels[touch]) for touch in test)
    refused("at most 3", lambda: bt.run({**study, "trials": 4}, recorded=bt.Recorded(frames, labels, groups, splits=splits)))


class Grouped:
    """Classifier that needs the groups of its rows."""

    def fit(self, rows, labels, groups):
        assert len(groups) == len(rows)
        # Each group of the recording has one class.
        self.class_of = {group: label for group, label in zip(groups, labels, strict=True)}
        assert all(self.class_of[group] == label for group, label in zip(groups, labels, strict=True))
        self.label = labels[0]

    def predict(self, rows):
        return np.full(len(rows), self.label)


def test_groups_are_passed_to_estimators_that_accept_them(arrays):
    svm, model_selection = pytest.importorskip("sklearn.svm"), pytest.importorskip("sklearn.model_selection")
    frames, labels, _ = arrays
    groups = np.arange(N) // 2
    search = model_selection.GridSearchCV(svm.SVC(), {"C": [1.0, 10.0]}, cv=model_selection.GroupKFold(3))
    recorded = bt.Recorded(frames, labels, groups)
    accuracies = bt.run(STUDY, recorded=recorded, classifiers={"grouped": Grouped(), "search": search})["accuracy"].columns
    # Without groups, both raise an exception.
    assert {"grouped", "search"} <= set(accuracies["classifier"])

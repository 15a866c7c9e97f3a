"""Recordings as people have them: each format and each kind of array, read and run as the guide says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import bubbletouch as bt
import numpy as np
import pytest

from conftest import refused

N, TAXELS = 45, (6, 4)
LABELS = np.repeat(["cup", "ball", "pen"], 15)
SUBJECTS = np.array([f"s{touch % 5}" for touch in range(N)])
LENGTHS = [5 + touch % 3 for touch in range(N)]
STUDY: dict[str, Any] = {
    "question": "?",
    "trials": 1,
    "skin": {"pitch_mm": 4.0, "stroke_mm": 5.0},
    "sensing": {"measurements": 8},
    "recognition": {"classifier": "linear_svm"},
}


@pytest.fixture(scope="module")
def trials() -> list[Any]:
    """Returns touches of 5 to 7 frames of 6 × 4 taxels."""
    rng = np.random.default_rng(0)
    return [rng.normal(0.4 + 0.3 * (touch // 15), 0.3, (LENGTHS[touch], *TAXELS)) for touch in range(N)]


@pytest.fixture(scope="module")
def usual(trials: list[Any]) -> Any:
    return accuracy({"frames": trials, "labels": LABELS, "resampled_frames": 3})


def accuracy(recorded: Any, study: dict[str, Any] = STUDY) -> Any:
    if isinstance(recorded, bt.Recorded):
        recorded.keys = {"resampled_frames": 3} if recorded.lengths is not None else {}
    return bt.run(study, recorded=recorded)["accuracy"]["accuracy"].tolist()


def same(found: bt.Recorded, trials: list[Any], labels: Any = LABELS, groups: Any = None) -> None:
    """Asserts that a recording contains the touches, and that a study of it gives the accuracy of the arrays."""
    assert found.labels is not None and found.labels.tolist() == list(labels)
    assert (found.groups is None) if groups is None else found.groups is not None and found.groups.tolist() == list(groups)
    assert found.lengths is not None and found.lengths.tolist() == [len(touch) for touch in trials]
    for own, touch in zip(np.asarray(found.frames), trials, strict=True):
        assert np.allclose(own[: len(touch)].reshape(touch.shape), touch, atol=1e-6) and np.isnan(own[len(touch) :]).all()


def table(trials: list[Any]) -> dict[str, Any]:
    """Returns the columns of a table with a row for each frame."""
    rows, touch = np.concatenate([trial.reshape(len(trial), -1) for trial in trials]), np.repeat(np.arange(N), LENGTHS)
    columns: dict[str, Any] = {"time": np.concatenate([0.1 * np.arange(n) for n in LENGTHS])}
    columns |= {f"taxel_{k}": rows[:, k] for k in range(24)}
    return columns | {"trial": touch, "label": LABELS[touch], "subject": SUBJECTS[touch]}


def write_csv(path: Path, columns: dict[str, Any], delimiter: str = ",", header: bool = True) -> None:
    lines = [delimiter.join(columns)] if header else []
    lines += [delimiter.join(str(value) for value in row) for row in zip(*(column.tolist() for column in columns.values()), strict=True)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def test_hdf5_with_a_group_for_each_trial(trials: list[Any], usual: Any, tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    file = tmp_path / "a.h5"
    with h5py.File(file, "w") as opened:
        for touch in range(N):
            group = opened.create_group(f"trial_{touch:03d}")
            group["tactile"], group["timestamp"] = trials[touch], 0.1 * np.arange(LENGTHS[touch])
            group.attrs["label"], group.attrs["subject"] = str(LABELS[touch]), str(SUBJECTS[touch])
    found = bt.read_recorded(file, "*/tactile", labels="*@label", groups="*@subject")
    same(found, trials, groups=SUBJECTS)
    found.groups = None
    assert accuracy(found) == usual
    refused("a.h5: no attribute `trial_000@class`; one of label, subject", lambda: bt.read_recorded(file, "*/tactile", labels="*@class"))
    # Names that differ in numbers are listed once.
    refused(r"a.h5: no array `frames`; one of trial_\*/tactile, trial_\*/timestamp$", lambda: bt.read_recorded(file))


def test_hdf5_with_the_label_in_the_path(trials: list[Any], tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    file = tmp_path / "b.h5"
    with h5py.File(file, "w") as opened:
        for touch in range(N):
            opened[f"{LABELS[touch]}/{SUBJECTS[touch]}_{touch}/tactile"] = trials[touch]
    found = bt.read_recorded(file, "{label}/{group}_*/tactile")
    order = sorted(range(N), key=lambda touch: (LABELS[touch], SUBJECTS[touch], touch))
    same(found, [trials[touch] for touch in order], LABELS[order], SUBJECTS[order])


def test_hdf5_tables_and_texts(trials: list[Any], tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    first = np.stack([trial[0].ravel() for trial in trials])
    rows = np.zeros(N, np.dtype([("t", "f8"), ("taxels", "f8", (24,)), ("label", "i4")]))
    rows["taxels"], rows["label"] = first, np.arange(N) // 15
    with h5py.File(tmp_path / "c.h5", "w") as opened:
        opened["data"] = rows
        opened.create_dataset("texts", data=list(LABELS), dtype=h5py.string_dtype())
        ragged = opened.create_dataset("ragged", (N,), dtype=h5py.vlen_dtype(np.float32))
        for touch in range(N):
            ragged[touch] = trials[touch].ravel()
    found = bt.read_recorded(tmp_path / "c.h5", "data/taxels", labels="data/label")
    assert np.array_equal(found.frames, first) and found.labels is not None and found.labels.tolist() == rows["label"].tolist()
    found = bt.read_recorded(tmp_path / "c.h5", "data/taxels", labels="texts")
    assert found.labels is not None and found.labels.tolist() == LABELS.tolist()
    refused("c.h5: no array `data`; one of data/t, data/taxels, data/label, ragged, texts", lambda: bt.read_recorded(tmp_path / "c.h5", "data"))
    refused("c.h5, array `ragged`: elements of type ndarray; numbers, in an array for each touch", lambda: bt.read_recorded(tmp_path / "c.h5", "ragged"))


@pytest.mark.parametrize("version", [2, 3])
def test_zarr_formats(trials: list[Any], version: int, tmp_path: Path) -> None:
    zarr = pytest.importorskip("zarr", "3.0")
    group = zarr.open_group(str(tmp_path / "a.zarr"), mode="w", zarr_format=version)
    frames = np.concatenate(trials)
    for name, array in {"data/tactile": frames, "data/label": np.repeat(np.arange(N) // 15, LENGTHS), "meta/episode_ends": np.cumsum(LENGTHS)}.items():
        group.create_array(name, shape=array.shape, dtype=array.dtype)[...] = array
    group.create_array("names", shape=(N,), dtype=str)[...] = LABELS
    # A replay buffer: the rows of all touches, and the row at which each touch ends. Labels are of rows or of touches.
    same(bt.read_recorded(tmp_path / "a.zarr", "data/tactile", labels="data/label", touches="meta/episode_ends"), trials, np.arange(N) // 15)
    same(bt.read_recorded(tmp_path / "a.zarr", "data/tactile", labels="names", touches="meta/episode_ends"), trials)
    each = zarr.open_group(str(tmp_path / "b.zarr"), mode="w", zarr_format=version)
    for touch in range(N):
        own = each.create_group(f"trial_{touch}")
        own.attrs["label"] = str(LABELS[touch])
        own.create_array("tactile", shape=trials[touch].shape, dtype="float64")[...] = trials[touch]
    same(bt.read_recorded(tmp_path / "b.zarr", "*/tactile", labels="*@label"), trials)
    for path in (tmp_path / "a.zarr" / "data" / "tactile").rglob("*"):
        if path.is_file() and not path.name.startswith((".z", "zarr")):
            path.write_bytes(path.read_bytes()[:20])
    refused("a.zarr, array `data/tactile`: cannot be read", lambda: bt.read_recorded(tmp_path / "a.zarr", "data/tactile"))


def test_a_column_for_each_taxel(trials: list[Any], usual: Any, tmp_path: Path) -> None:
    columns = table(trials)
    keys: dict[str, Any] = {"labels": "label", "groups": "subject", "touches": "trial"}
    for name, delimiter in (("a.csv", ","), ("b.csv", ";"), ("c.tsv", "\t")):
        write_csv(tmp_path / name, columns, delimiter)
        found = bt.read_recorded(tmp_path / name, "taxel_*", **keys)
        same(found, trials, groups=SUBJECTS)
        # Frames of 24 taxels are no grid.
        assert found.order == "n t c"
        found.groups = None
        if name == "a.csv":
            accuracy(found)
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    for label in (columns["label"], pa.array(columns["label"]).dictionary_encode()):
        pq.write_table(pa.table({**columns, "label": label}), tmp_path / "a.parquet")
        same(bt.read_recorded(tmp_path / "a.parquet", "taxel_*", **keys), trials, groups=SUBJECTS)
    refused(r"a.parquet: no array `tax_\*`; one of time, taxel_\*, trial, label, subject", lambda: bt.read_recorded(tmp_path / "a.parquet", "tax_*", labels="label"))


def test_a_file_for_each_touch(trials: list[Any], tmp_path: Path) -> None:
    columns = table(trials)
    for folder in ("csv", "text", "npy"):
        (tmp_path / folder).mkdir()
    for touch in range(N):
        rows = columns["trial"] == touch
        name = f"{LABELS[touch]}_{SUBJECTS[touch]}_{touch:02d}"
        own = {key: column[rows] for key, column in columns.items() if key != "trial"}
        write_csv(tmp_path / "csv" / f"{name}.csv", own)
        write_csv(tmp_path / "text" / f"{name}.csv", {key: column for key, column in own.items() if key.startswith("taxel_")}, header=False)
        place = tmp_path / "npy" / SUBJECTS[touch] / LABELS[touch]
        place.mkdir(parents=True, exist_ok=True)
        np.save(place / f"{touch}.npy", trials[touch])
    order = sorted(range(N), key=lambda touch: (LABELS[touch], SUBJECTS[touch], touch))
    ordered, labels, groups = [trials[touch] for touch in order], LABELS[order], SUBJECTS[order]
    # Labels are a column with one value, or a part of the path. Files without names of columns contain readings alone.
    same(bt.read_recorded(tmp_path / "csv", "taxel_*", labels="label", groups="subject", touches="file"), ordered, labels, groups)
    same(bt.read_recorded(tmp_path / "text" / "{label}_{group}_*.csv", touches="file"), ordered, labels, groups)
    by_group = sorted(range(N), key=lambda touch: (SUBJECTS[touch], LABELS[touch], touch))
    found = bt.read_recorded(f"{tmp_path}/npy/{{group}}/{{label}}/*.npy", touches="file")
    same(found, [trials[touch] for touch in by_group], LABELS[by_group], SUBJECTS[by_group])
    refused(r"ball_s0_15.csv, array `time`: 0.0, 0.1, .*; one value for each touch", lambda: bt.read_recorded(tmp_path / "csv", "taxel_*", labels="time", touches="file"))
    with pytest.raises(FileNotFoundError, match=r"\*.h5: no such file or folder; .* or a pattern with \*, .label. or .group. of such files"):
        bt.read_recorded(tmp_path / "npy" / "{label}" / "*.h5")
    (tmp_path / "text" / "cup_s0_00.csv").write_text("1,2,3\n4,5\n")
    refused("cup_s0_00.csv, line 2: 2 values; 3, as line 1 has", lambda: bt.read_recorded(tmp_path / "text", touches="file"))


def test_numpy_files(trials: list[Any], tmp_path: Path) -> None:
    objects = np.empty(N, object)
    objects[:] = trials
    np.savez(tmp_path / "a.npz", frames=objects, labels=LABELS)
    np.save(tmp_path / "a.npy", objects, allow_pickle=True)
    for name in ("a.npz", "a.npy"):
        refused(rf"{name}, array `frames`: pickled objects, which may run code; numbers, or numpy.load\(.*allow_pickle=True", lambda: bt.read_recorded(tmp_path / name))
    np.save(tmp_path / "b.npy", np.stack([trial[:5] for trial in trials]))
    found = bt.read_recorded(tmp_path / "b.npy", labels=LABELS, groups=list(SUBJECTS))
    assert found.labels is not None and found.groups is not None
    assert found.labels.tolist() == LABELS.tolist() and found.groups.tolist() == SUBJECTS.tolist()
    refused(r"labels: shape \(4,\); \(45,\), a value for each touch", lambda: bt.read_recorded(tmp_path / "b.npy", labels=LABELS[:4]))


def test_arrays_in_memory(trials: list[Any], usual: Any) -> None:
    objects = np.empty(N, object)
    objects[:] = trials
    for frames in (objects, [trial.tolist() for trial in trials], tuple(trials)):
        assert accuracy({"frames": frames, "labels": LABELS, "resampled_frames": 3}) == usual
    even = np.stack([trial[:5] for trial in trials])
    rows = even.reshape(N, -1)
    expected, expected_of_rows = (accuracy({"frames": frames, "labels": LABELS}) for frames in (even, rows))
    # Masked readings are missing.
    masked = accuracy({"frames": np.ma.MaskedArray(rows, np.broadcast_to(np.arange(120) == 3, rows.shape)), "labels": LABELS})
    assert masked == accuracy({"frames": np.where(np.arange(120) == 3, np.nan, rows), "labels": LABELS})
    try:
        import pandas as pd

        assert accuracy({"frames": pd.DataFrame(rows), "labels": pd.Series(LABELS).astype("category"), "groups": None}) == expected_of_rows
    except ImportError:
        pass
    try:
        import xarray as xr

        assert accuracy({"frames": xr.DataArray(even, dims=("n", "t", "y", "x")), "labels": xr.DataArray(LABELS)}) == expected
    except ImportError:
        pass
    try:
        import torch

        tensor = torch.tensor(even).requires_grad_()
        assert accuracy({"frames": tensor, "labels": torch.tensor(np.arange(N) // 15)}) == accuracy({"frames": even, "labels": np.arange(N) // 15})
        accuracy({"frames": torch.tensor(even).to(torch.bfloat16), "labels": LABELS})
    except ImportError:
        pass


class Wrong:
    """Tensor that cannot be converted."""

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise RuntimeError("on a device")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda given: {"frames": []}, r"^recorded\.frames: no touches; at least one$"),
        (lambda given: {"frames": 3.0}, r"^recorded\.frames: float; an array, or the path of a file$"),
        (lambda given: {"frames": {"a": 1}}, r"^recorded\.frames: dict; an array, or the path of a file$"),
        (lambda given: {"frames": iter(given)}, r"^recorded\.frames: list_iterator; an array, or the path of a file$"),
        (lambda given: {"frames": Wrong()}, r"^recorded\.frames: Wrong that cannot be converted to an array \(on a device\); an array$"),
        (lambda given: {"frames": np.zeros((N, 4), complex)}, r"^recorded\.frames: elements of type complex128; numbers$"),
        (lambda given: {"frames": np.zeros(N, [("a", "f4"), ("b", "f4")])}, r"^recorded\.frames: fields a, b; an array of numbers, such as one field$"),
        (lambda given: {"frames": [*given[:-1], given[-1][:, :5]]}, r"^recorded\.frames, touch 44: shape \(7, 5, 4\); \(n_frames, 6, 4\), as touch 0 has$"),
        (lambda given: {"frames": [*given[:-1], given[-1][0]]}, r"^recorded\.frames, touch 44: shape \(6, 4\); \(n_frames, 6, 4\), as touch 0 has$"),
        (lambda given: {"frames": [[1.0, 2.0], [1.0]]}, r"^recorded\.frames, touch 1: shape \(1,\); \(2,\), as touch 0 has$"),
        (lambda given: {"frames": ["a", "b"]}, r"^recorded\.frames, touch 0: str; an array"),
        (lambda given: {"resampled_frames": None}, r"recorded\.frames: touches of 5 to 7 of 7 frames; touches with all frames, or recorded\.resampled_frames"),
        (lambda given: {"labels": [None, *LABELS[1:]]}, r"^recorded\.labels, position 0: None; integers or texts$"),
        (lambda given: {"labels": np.array([1, *LABELS[1:]], object)}, r"^recorded\.labels: texts and integers; one kind$"),
        (lambda given: {"labels": np.linspace(0, 1, N)}, r"recorded\.labels, position 1: 0\.0227.*; one class for each touch"),
        (lambda given: {"labels": LABELS[1:]}, r"recorded\.labels: 44 values; 45, one a touch of recorded\.frames"),
        (lambda given: {"sensors": "palm"}, r"^recorded\.sensors: str; a list of dicts, each with name and frames$"),
        (lambda given: {"lengths": np.full(N, 99)}, r"recorded\.lengths, position 0: 99; an integer from 1 to 7"),
    ],
)
def test_wrong_arrays_are_refused_by_their_key(change: Callable[[Any], dict[str, Any]], words: str, trials: list[Any], tmp_path: Path) -> None:
    given = {"frames": trials, "labels": LABELS, "resampled_frames": 3}
    with pytest.raises(ValueError, match=words) as raised:
        bt.run(STUDY, tmp_path / "out", recorded={**given, **change(trials)})
    assert str(tmp_path) not in str(raised.value) and "/tmp" not in str(raised.value)
    assert not (tmp_path / "out" / "journal.jsonl").exists()


def written(kind: str, file: Path, arrays: dict[str, Any]) -> None:
    """Writes arrays by name into a file of a format; rows of numbers are a column for each taxel of a table."""
    if kind == "npz":
        np.savez(file, **arrays)
    elif kind == "h5":
        with pytest.importorskip("h5py").File(file, "w") as opened:
            for name, array in arrays.items():
                opened[name] = array.astype("S") if array.dtype.kind == "U" else array
    elif kind == "zarr":
        group = pytest.importorskip("zarr", "3.0").open_group(str(file), mode="w")
        for name, array in arrays.items():
            made = group.create_array(name, shape=array.shape, dtype=str if array.dtype.kind == "U" else array.dtype)
            if array.size:
                made[...] = array
    else:
        columns: dict[str, Any] = {}
        for name, array in arrays.items():
            columns |= {f"{name}_{k}": array[:, k] for k in range(array.shape[1])} if array.ndim == 2 else {name: array}
        if kind == "csv":
            write_csv(file, columns)
        else:
            pytest.importorskip("pyarrow.parquet").write_table(pytest.importorskip("pyarrow").table(columns), file)


@pytest.mark.parametrize("kind", ["npz", "h5", "zarr", "parquet", "csv"])
def test_each_fault_is_refused_in_each_format(kind: str, tmp_path: Path) -> None:
    labels, numbers = np.repeat(["cup", "ball", "pen"], 10), np.arange(30) // 10
    frames = np.random.default_rng(1).normal(numbers[:, None], 1.0, (30, 8))
    good: dict[str, Any] = {"frames": frames, "labels": labels, "groups": np.arange(30) // 3}
    nan, missing = np.where(np.arange(30) == 4, np.nan, numbers), np.where(np.arange(30) == 4, "", labels)
    is_table = kind in ("parquet", "csv")
    faults: list[tuple[dict[str, Any], str]] = [
        ({"labels": nan}, "`labels`, position 4: nan; integers or texts"),
        ({"groups": nan}, "`groups`, position 4: nan; integers or texts"),
        ({"labels": missing}, "`labels`, position 4: an empty text; integers or texts"),
        ({"frames": np.full((30, 8), "x")}, "elements of type .*; numbers$"),
        ({name: array[:0] for name, array in good.items()}, r"shape \(0,.*\); at least one reading"),
    ]
    if not is_table:
        faults += [
            ({"labels": labels[1:]}, r"`labels`: shape \(29,\); \(30,\), a value for each touch"),
            ({"groups": np.arange(31)}, r"`groups`: shape \(31,\); \(30,\), a value for each touch"),
            ({"labels": frames}, r"`labels`: shape \(30, 8\); \(30,\), a value for each touch"),
        ]
        one_hot = (labels[:, None] == np.unique(labels)).astype(np.float64)
        written(kind, tmp_path / f"hot.{kind}", good | {"labels": one_hot})
        hot = bt.read_recorded(tmp_path / f"hot.{kind}").labels
        assert hot is not None and hot.tolist() == one_hot.argmax(axis=1).tolist()
    for number, (change, words) in enumerate(faults):
        file = tmp_path / f"a{number}.{kind}"
        written(kind, file, good | change)
        refused(rf"a{number}\.{kind}.*{words}", lambda: bt.read_recorded(file, "frames_*" if is_table else "frames"))
    file = tmp_path / f"a.{kind}"
    written(kind, file, good)
    found = bt.read_recorded(file, "frames_*" if is_table else "frames")
    for name, array in good.items():
        assert np.array_equal(np.asarray(getattr(found, name)).reshape(array.shape), array)
    accuracy(found)
    for name, words in (("labels", "no array `label`"), ("groups", "no array `label`"), ("touches", "no array `label`")):
        refused(rf"a\.{kind}: {words}; one of ", lambda: bt.read_recorded(file, "frames_*" if is_table else "frames", **{name: "label"}))
    with pytest.raises(ValueError, match=rf"a\.{kind}, `groups`: 0, 1, 2 in touch cup; one value for all rows of a touch"):
        bt.read_recorded(file, "frames_*" if is_table else "frames", touches="labels")
    # Readings are checked by the study, which names the array and the position.
    written(kind, file, good | {"frames": np.where(np.arange(240).reshape(30, 8) == 26, np.nan, frames)})
    refused(r"^recorded\.frames, frame 3, taxel 2: NaN; a finite number", lambda: accuracy(bt.read_recorded(file, "frames_*" if is_table else "frames")))
    written(kind, file, {"frames": frames})
    refused("key recorded.labels: no such key", lambda: accuracy(bt.read_recorded(file, "frames_*" if is_table else "frames")))
    written(kind, file, {"tactile": frames, "labels": labels})
    if kind != "csv":
        refused(rf"a\.{kind}: no array `frames`; one of ", lambda: bt.read_recorded(file))
    if kind != "zarr":
        whole = file.read_bytes()
        for n in (len(whole) // 2, 10, 0):
            file.write_bytes(whole[:n])
            refused(rf"a\.{kind}{'' if kind == 'csv' else '.*: cannot be read .*; a complete '}", lambda: bt.read_recorded(file, "frames_*" if is_table else "frames"))
    if kind == "parquet":
        pa = pytest.importorskip("pyarrow")
        twice = pa.Table.from_arrays([pa.array([1.0]), pa.array([1.0])], names=["frames_0", "frames_0"])
        pytest.importorskip("pyarrow.parquet").write_table(twice, file)
        refused(r"a\.parquet: column `frames_0` twice; each name once", lambda: bt.read_recorded(file, "frames_*"))


def test_wrong_test_sets_are_refused_by_their_key() -> None:
    numbers = np.arange(30) // 10
    frames = np.random.default_rng(1).normal(numbers[:, None], 1.0, (30, 8))
    good: dict[str, Any] = {"frames": frames, "labels": numbers, "frames_test": frames[::3], "labels_test": numbers[::3]}
    accuracy(good)
    for change, words in [
        ({"labels_test": numbers[::3] + 1}, "key recorded.labels_test: class 3, of which no touch trains; classes of recorded.labels"),
        ({"labels_test": numbers[::3] * 0}, "key recorded.labels_test: no touch of class 1; touches of each class"),
        ({"labels_test": ["cup"] * 10}, "recorded.labels_test: numbers in one array of labels and texts in the other; .* as in recorded.labels$"),
        ({"labels_test": numbers[:9]}, "recorded.labels_test: 9 values; 10, one a touch of recorded.frames"),
        ({"frames_test": frames[::3, :5]}, "recorded.frames_test: touches of 1 frame of 1 × 5 taxels; .* 1 × 8 taxels, as recorded.frames has"),
        ({"frames_test": frames[:0]}, r"recorded\.frames_test: no readings, shape \(0, 8\); at least one reading"),
        ({"labels_test": None}, "key recorded.labels_test: no such key beside frames_test"),
    ]:
        refused(words, lambda: accuracy({**good, **change}))

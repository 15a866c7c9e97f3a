"""How recorded touches are joined: sensors and labels by names, rows by touches, arrays by positions that are documented, or refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bubbletouch as bt
import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import refused

N = 18
STUDY: dict[str, Any] = {
    "question": "?",
    "trials": 2,
    "skin": {"pitch_mm": 4.0, "stroke_mm": 5.0},
    "recognition": {"classifier": "nearest_centroid"},
}
LABELS = np.repeat(["cup", "ball", "pen"], 6)


def touch(number: int, n_frames: int = 4, n_taxels: int = 3) -> NDArray[np.float64]:
    """Returns readings that contain the number of their touch."""
    return 1.0 + number + np.arange(n_frames)[:, None] / 16 + np.arange(n_taxels) / 256


def write_rows(file: Path, columns: dict[str, Any]) -> None:
    rows = zip(*(np.asarray(column).tolist() for column in columns.values()), strict=True)
    lines = [",".join(columns), *(",".join(map(str, row)) for row in rows)]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def rows_of(numbers: Any, sessions: Any, **others: Any) -> dict[str, Any]:
    """Returns the columns of a table with four rows for each of 18 touches."""
    frames = np.concatenate([touch(number) for number in range(N)])
    each = {"trial": numbers, "session": sessions, "object": LABELS, **others}
    return {f"taxel_{k}": frames[:, k] for k in range(3)} | {name: np.repeat(values, 4) for name, values in each.items()}


def test_sensors_of_different_rates_have_lengths_of_their_own(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    lengths = {"thumb": 3 + np.arange(N) % 4, "palm": 12 - np.arange(N) % 5, "arm": np.full(N, 5)}
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, own in lengths.items():
            for number in range(N):
                file[f"data/demo_{number}/{name}"] = touch(number, own[number])
        file["labels"] = LABELS.astype("S")
    found = bt.read_recorded(tmp_path / "a.h5", {name: f"data/*/{name}" for name in lengths}, labels="labels")
    assert {name: own.tolist() for name, own in found.lengths.items()} == {name: lengths[name].tolist() for name in ("thumb", "palm")}
    found.keys = {"resampled_frames": 3}
    # The last frame of each touch is read, not the padding of another sensor.
    sensors = [{"name": name, "order": "n t c", "frames": [touch(number, own[number]) for number in range(N)]} for name, own in lengths.items()]
    expected = bt.run(STUDY, recorded={"labels": LABELS, "resampled_frames": 3, "sensors": sensors})["accuracy"]["accuracy"]
    assert bt.run(STUDY, recorded=found)["accuracy"]["accuracy"].tolist() == expected.tolist()
    assert [sensor["lengths"].tolist() for sensor in found.table()["sensors"] if "lengths" in sensor] == [lengths["thumb"].tolist(), lengths["palm"].tolist()]
    mine = bt.Recorded({name: np.zeros((N, 12, 3)) for name in ("thumb", "palm")}, LABELS, lengths={"palm": lengths["palm"]})
    assert ["lengths" in sensor for sensor in mine.table()["sensors"]] == [False, True]


def test_sensors_are_joined_by_the_names_of_their_touches(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for number in range(N):
            file[f"palm_{number:03d}"], file[f"thumb_{number:03d}"] = touch(number), touch(number, n_taxels=2)
            file[f"label_{number:03d}"] = str(LABELS[number])
    sensors = {"thumb": "thumb_*", "palm": "palm_*"}
    found = bt.read_recorded(tmp_path / "a.h5", sensors, labels="label_*")
    assert found.labels.tolist() == LABELS.tolist() and found.touches.tolist() == [f"thumb_{number:03d}" for number in range(N)]
    # As many arrays of each sensor, of which two have no other.
    with h5py.File(tmp_path / "a.h5", "a") as file:
        del file["palm_003"], file["thumb_005"]
    with pytest.raises(ValueError, match=r"a\.h5: `thumb_003` without an array `palm_\*` of the same touch; an array of each sensor for each touch"):
        bt.read_recorded(tmp_path / "a.h5", sensors, labels="label_*")


def test_touch_numbers_that_restart_in_each_session_are_other_touches_or_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    sessions = np.repeat(["monday", "tuesday", "friday"], 6)
    numbers = {"trial": np.arange(N) % 6}
    write_rows(file, rows_of(numbers["trial"], sessions))
    expected = np.stack([touch(number) for number in range(N)])
    for keys in ({"groups": "session"}, {"labels": "object", "groups": "session"}, {"labels": "object"}):
        found = bt.read_recorded(file, "taxel_*", touches="trial", **keys)
        assert np.array_equal(found.frames, expected) and found.touches.tolist() == [str(number % 6) for number in range(N)]
        assert found.labels is None or found.labels.tolist() == LABELS.tolist()
    words = r"a\.csv, `trial`: touch 0 in rows 0 to 3 and again in rows 24 to 27; adjacent rows for each touch, or groups that differ"
    refused(words, lambda: bt.read_recorded(file, "taxel_*", touches="trial"))
    # Rows of one touch that are not adjacent, and a session that begins twice.
    columns = rows_of(np.arange(N), sessions)
    turned = np.argsort(np.tile(np.arange(4), N), kind="stable")
    write_rows(file, {name: column[turned] for name, column in columns.items()})
    with pytest.raises(ValueError, match="`trial`: touch 0 in rows 0 to 0 and again in rows 18 to 18; adjacent rows"):
        bt.read_recorded(file, "taxel_*", touches="trial", labels="object", groups="session")
    write_rows(file, rows_of(np.arange(N) % 3, sessions))
    with pytest.raises(ValueError, match="`trial`: touch 0 in rows 0 to 3 and again in rows 12 to 15; adjacent rows"):
        bt.read_recorded(file, "taxel_*", touches="trial", labels="object", groups="session")


def test_labels_of_touches_whose_numbers_do_not_ascend_are_those_of_the_rows_or_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    numbers = (np.arange(N) * 7 + 5) % N
    write_rows(file, rows_of(numbers, np.zeros(N, int)))
    found = bt.read_recorded(file, "taxel_*", touches="trial", labels="object")
    assert found.labels.tolist() == LABELS.tolist() and found.touches.tolist() == [str(number) for number in numbers]
    assert np.array_equal(found.frames, np.stack([touch(number) for number in range(N)]))
    words = r"a\.csv, `trial`: a value for each touch, but touch 12 comes before touch 1; a value for each row, or ascending numbers"
    refused(words, lambda: bt.read_recorded(file, "taxel_*", touches="trial", labels=LABELS))
    write_rows(file, rows_of(np.sort(numbers), np.zeros(N, int)))
    assert bt.read_recorded(file, "taxel_*", touches="trial", labels=LABELS).labels.tolist() == LABELS.tolist()


def test_files_of_one_name_in_several_folders_are_several_groups(tmp_path: Path) -> None:
    for day in range(4):
        (tmp_path / f"day{day}").mkdir()
        for part in range(2):
            np.save(tmp_path / f"day{day}" / f"part{part}.npy", np.zeros((3, 4)))
    for path in (tmp_path, f"{tmp_path}/day*/part*.npy"):
        found = bt.read_recorded(path)
        assert found.groups.tolist() == [f"day{touch // 6}/part{touch // 3 % 2}.npy" for touch in range(24)]


def test_files_have_natural_order_and_touches_have_names(tmp_path: Path) -> None:
    label_of = {}
    for number in range(N):
        file = tmp_path / f"touch_{number}.npy"
        np.save(file, touch(number))
        label_of[str(file)] = str(LABELS[number])
    found = bt.read_recorded(f"{tmp_path}/touch_*.npy", touches="file")
    assert found.touches.tolist() == [str(tmp_path / f"touch_{number}.npy") for number in range(N)]
    assert found.touches.tolist() != sorted(label_of)
    found = bt.read_recorded(f"{tmp_path}/touch_*.npy", touches="file", labels=[label_of[name] for name in found.touches])
    assert found.labels.tolist() == LABELS.tolist()


def test_two_sources_of_labels_or_groups_are_refused(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    for label in ("cup", "pen"):
        (tmp_path / label).mkdir()
        np.savez(tmp_path / label / "a.npz", frames=np.zeros((3, 4)), object=np.repeat(label, 3))
    pattern = f"{tmp_path}/{{label}}/*.npz"
    assert bt.read_recorded(pattern).labels.tolist() == ["cup"] * 3 + ["pen"] * 3
    for labels in ("object", ["cup"] * 6):
        refused(r"^labels: given beside \{label\} in `.*\{label\}/\*\.npz`; one of both$", lambda: bt.read_recorded(pattern, labels=labels))
    refused(r"^groups: given beside \{group\} in `", lambda: bt.read_recorded(f"{tmp_path}/{{group}}/*.npz", groups="object"))
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["cup/a"] = file["pen/a"] = np.zeros((3, 4))
    refused(r"^labels: given beside \{label\} in `\{label\}/\*`; one of both$", lambda: bt.read_recorded(tmp_path / "a.h5", "{label}/*", labels=["cup", "pen"]))


def test_columns_of_a_pattern_have_the_order_of_the_file(tmp_path: Path) -> None:
    names = ["s3", "s0", "s10", "s2"]
    columns = {name: 1.0 + k + 0.5 * (np.arange(5) % 2) for k, name in enumerate(names)}
    write_rows(tmp_path / "a.csv", columns)
    expected = np.stack(list(columns.values()), axis=1)
    for frames in ("s*", None, names, ["s3", "s0", "s1*", "s2"]):
        assert np.array_equal(bt.read_recorded(tmp_path / "a.csv", frames).frames, expected)
    pa, pq = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    pq.write_table(pa.table(columns), tmp_path / "a.parquet")
    assert np.array_equal(bt.read_recorded(tmp_path / "a.parquet", "s*").frames, expected)


def test_tables_of_pandas_have_no_taxel_of_the_index(tmp_path: Path) -> None:
    pd = pytest.importorskip("pandas")
    frame = pd.DataFrame(np.random.default_rng(0).random((N, 4)))
    file = tmp_path / "a.csv"
    for options in ({}, {"index": False}, {"header": False}, {"header": False, "index": False}, {"sep": ";"}):
        frame.to_csv(file, **options)
        if options.get("index", True):
            with pytest.warns(UserWarning, match="a.csv: column 1 (has no name|counts the rows); it is left out"):
                found = bt.read_recorded(file)
        else:
            found = bt.read_recorded(file)
        assert np.array_equal(found.frames, frame.to_numpy())
    frame.to_csv(file)
    pd.read_csv(file).assign(labels=LABELS, time=0.25 * np.arange(N)).to_csv(file)
    with pytest.warns(UserWarning, match="has no name"), pytest.raises(ValueError, match=r'a\.csv: columns of several kinds: `#` \(4\), `time`; .* frames="#"'):
        bt.read_recorded(file)
    for frames in ("#", ["0", "1", "2", "3"]):
        with pytest.warns(UserWarning, match="has no name"):
            found = bt.read_recorded(file, frames)
        assert np.array_equal(found.frames, frame.to_numpy()) and found.labels.tolist() == LABELS.tolist()


def test_indexes_of_pandas_are_equal_or_refused() -> None:
    pd = pytest.importorskip("pandas")
    frames = pd.DataFrame(np.stack([touch(number)[0] for number in range(N)]))
    labels = pd.Series(LABELS)
    expected = bt.run(STUDY, recorded={"frames": frames.to_numpy(), "labels": LABELS})["accuracy"]["accuracy"].tolist()
    assert bt.run(STUDY, recorded={"frames": frames, "labels": labels})["accuracy"]["accuracy"].tolist() == expected
    mixed = labels.sample(frac=1.0, random_state=1)
    groups = pd.Series(np.arange(N) // 2, index=np.arange(N) + 1)
    for change, words in [
        ({"labels": mixed}, "^recorded.labels: another index than recorded.frames; equal ones, or .to_numpy"),
        ({"groups": groups}, "^recorded.groups: another index than recorded.frames"),
        ({"frames_test": frames[::-1], "labels_test": labels}, "^recorded.labels_test: another index than recorded.frames_test"),
        ({"frames_test": frames[[2, 1, 0]], "labels_test": LABELS}, "^recorded.frames_test: other columns than recorded.frames"),
        ({"zero": pd.Series([0.0, 0.0, 0.1], index=[2, 1, 0])}, "^recorded.zero: other columns than recorded.frames"),
        ({"frames": frames.assign(time=0.5)}, r"^recorded.frames: columns of several kinds: `#` \(3\), `time`; a data frame of those"),
        ({"frames": [frames, frames[[2, 1, 0]]]}, "^recorded.frames, touch 1: other columns than those of touch 0, or in another order"),
        ({"frames": None, "sensors": [{"name": "a", "frames": frames[::-1]}]}, r"recorded\.labels: another index than recorded\.sensors\[1\]\.frames"),
    ]:
        refused(words, lambda: bt.run(STUDY, recorded={"frames": frames, "labels": labels} | change))
    # Values without an index are joined by their positions.
    turned = {"frames": frames[::-1], "labels": LABELS[::-1]}
    plain = turned | {"frames": frames.to_numpy()[::-1]}
    turned, plain = (bt.run(STUDY, recorded=given)["accuracy"]["accuracy"].tolist() for given in (turned, plain))
    assert turned == plain
    for options in ({"labels": mixed}, {"labels": labels, "groups": groups}, {"labels": labels, "sessions": groups}):
        refused("^(labels|groups|sessions): another index than (frames|labels)", lambda: bt.audit(frames, **options))


def test_hidden_files_are_not_read_and_other_files_are_no_pickles(tmp_path: Path) -> None:
    for number in range(3):
        np.save(tmp_path / f"a{number}.npy", np.full((2, 4), number))
    (tmp_path / ".ipynb_checkpoints").mkdir()
    np.save(tmp_path / ".ipynb_checkpoints" / "a0-checkpoint.npy", np.zeros((2, 4)))
    (tmp_path / "._a0.npy").write_bytes(b"\0\5\26\7\0\2\0\0Mac OS X        ")
    (tmp_path / ".DS_Store").write_bytes(b"\0\0\0\1Bud1")
    for path in (tmp_path, f"{tmp_path}/*.npy"):
        assert bt.read_recorded(path).frames[:, 0].tolist() == [0, 0, 1, 1, 2, 2]
    for name in ("b.npy", "b.npz"):
        (tmp_path / name).write_bytes(b"Mac OS X")
        refused(rf"{name}: cannot be read \(it begins neither as a \.npy nor as a \.npz file\); a complete NumPy file", lambda: bt.read_recorded(tmp_path / name))


def test_empty_arrays_have_no_readings(tmp_path: Path) -> None:
    empty = np.zeros((0, 8, 8))
    np.save(tmp_path / "empty.npy", empty)
    for call in (lambda: bt.audit(empty), lambda: bt.audit(tmp_path / "empty.npy"), lambda: bt.read_recorded(tmp_path / "empty.npy")):
        refused("no readings, shape .0, 8, 8.; at least one reading", lambda: call())

"""Tests of audits of arrays: findings as objects, tables, and messages."""

from __future__ import annotations

from pathlib import Path

import bubbletouch as bt
import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import refused


def data(n: int = 120) -> tuple[NDArray[np.float64], NDArray[np.str_]]:
    """Returns frames of a disc of one of three sizes at random places with noise, and the names of the classes."""
    random = np.random.default_rng(4)
    classes = random.integers(0, 3, n)
    y, x = np.mgrid[:12, :12]
    centres = random.uniform(4, 7, (n, 2, 1, 1))
    away = np.hypot(y - centres[:, 0], x - centres[:, 1])
    frames = np.clip((1.5 + classes)[:, None, None] - away, 0, 1) + 0.02 * random.standard_normal((n, 12, 12))
    return frames, np.array(["small", "middle", "large"])[classes]


def test_faults_are_objects_with_numbers(tmp_path: Path) -> None:
    frames, labels = data()
    frames[3, 5, 5] = np.nan
    frames[:, 6, 6] = 0.5
    frames[:, 0, 0] += 0.05 * np.unique(labels, return_inverse=True)[1]
    found = bt.audit(frames, labels, untouched=[0], out=tmp_path / "audit", permutations=399)
    assert {fault.check for fault in found.faults} == {"untouched"}
    assert {finding.check for finding in found.findings if finding.verdict == "note"} >= {"missing_readings", "constant_taxels"}
    missing = next(finding for finding in found.findings if finding.check == "missing_readings")
    assert missing.verdict == "note" and missing.value == 1 / frames.size and missing.advice
    assert "missing_readings" in found.tables["findings"]["check"]
    assert found.page.read_text(encoding="utf-8").count("<article") == len(found.findings)


def test_axes_are_ordered_and_a_temporary_folder_is_kept() -> None:
    frames, labels = data()
    touches = np.repeat(frames[:, None], 2, axis=1)
    whole = bt.audit(touches, labels, permutations=399)
    moved = bt.audit(np.moveaxis(touches, 1, -1), labels, order="n y x t", permutations=399)
    assert repr(whole.findings) == repr(moved.findings)
    assert whole.page.exists()


def test_each_order_is_audited_as_by_path(tmp_path: Path) -> None:
    frames, labels = data()
    values = np.stack([frames, 0.5 * frames, frames ** 2], axis=-1)[:, None]
    np.save(tmp_path / "values.npy", values)
    by_path = bt.audit(tmp_path / "values.npy", labels, order="n t y x c", permutations=399)
    assert said(bt.audit(values, labels, order="n t y x c", permutations=399)) == said(by_path)
    listed = bt.audit(values.reshape(120, -1, 3), labels, order="n c c", permutations=399)
    assert listed.findings and said(bt.audit(frames.reshape(120, -1), labels, order="n c", grid=(12, 12), permutations=399)) == said(bt.audit(frames, labels, permutations=399))


def test_wrong_arguments_are_named() -> None:
    frames, labels = data()
    refused("^labels: 119 values; 120, one a touch of frames$", lambda: bt.audit(frames, labels[1:]))
    refused('^order: "n t y"; a letter for each axis', lambda: bt.audit(frames, labels, order="n t y"))
    refused("^before_contact: 0..2; ", lambda: bt.audit(frames, labels, before_contact=(0, 2)))
    refused("^untouched: 144; taxels from 0 to 143$", lambda: bt.audit(frames, labels, untouched=[144]))
    refused("^not_claimed: weather; order, session, ", lambda: bt.audit(frames, labels, not_claimed=["weather"]))
    refused("^untouched: -1; at least 0$", lambda: bt.audit(frames, labels, untouched=[-1]))
    refused("^seed: -1; at least 0$", lambda: bt.audit(frames, labels, seed=-1))
    refused("^permutations: 10; a whole number from 399 to 100000$", lambda: bt.audit(frames, labels, permutations=10))
    refused("^frames: NoneType; an array, or the path of a file$", lambda: bt.audit(None))
    refused("^split: group; time with these data$", lambda: bt.audit(frames, labels, split="group"))


def test_a_given_test_set_is_one_more_split(tmp_path: Path) -> None:
    frames, labels = data(160)
    # The touches of the test set have a pattern of their class in place of the disc.
    random = np.random.default_rng(7)
    patterns = 0.2 * random.standard_normal((3, 12, 12))
    frames[110:] = patterns[np.unique(labels, return_inverse=True)[1][110:]] + 0.02 * random.standard_normal((50, 12, 12))
    found = bt.audit(frames[:110], labels[:110], test=(frames[110:], labels[110:]), out=tmp_path / "audit", permutations=399)
    split = next(finding for finding in found.findings if (finding.check, finding.subject) == ("split", "given"))
    assert split.verdict == "fault" and split.value + 0.2 < split.baseline
    assert "with the given test set" in split.sentence
    table = found.tables["accuracy_by_split"]
    assert {n for held_out, n in zip(table["split"], table["n_tested"], strict=True) if held_out == "given"} == {50}
    groups = np.arange(160) % 8
    whole = bt.audit(frames[:110], labels[:110], groups[:110], test=(frames[110:], labels[110:], groups[110:]), permutations=399)
    keys = {"frames_test": frames[110:], "labels_test": labels[110:], "groups_test": groups[110:]}
    recorded = bt.Recorded(frames[:110], labels[:110], groups[:110], keys=keys)
    same = bt.audit(recorded, permutations=399)
    assert repr(whole.findings) == repr(same.findings)
    assert any(finding.subject == "group" for finding in whole.findings)


def test_wrong_test_sets_are_named() -> None:
    frames, labels = data()
    refused("^test: touches of 1 frame of 5 × 12 taxels; touches of 1 frame of 12 × 12 taxels, as frames has$", lambda: bt.audit(frames, labels, test=(frames[:, :5], labels)))
    refused("^test: a test set; labels_test and groups_test, if frames has labels and groups$", lambda: bt.audit(frames, labels, test=(frames, None)))
    refused("^test, labels: 29 values; 30, one a touch of test$", lambda: bt.audit(frames, labels, test=(frames[:30], labels[:29])))
    refused("^test: not a test set", lambda: bt.audit(frames, labels, test=frames))
    refused("^labels: texts in one array and numbers in another; texts or numbers in all$", lambda: bt.audit(frames, labels, test=(frames, np.zeros(len(frames), dtype=int))))


def said(found: bt.Audit) -> str:
    return repr(found.findings)


def test_paths_are_read_as_by_the_command(tmp_path: Path) -> None:
    frames, labels = data()
    groups = np.arange(120) // 5
    np.savez(tmp_path / "recording.npz", frames=frames, labels=labels, groups=groups)
    np.save(tmp_path / "touches.npy", frames)
    np.save(tmp_path / "classes.npy", labels)
    whole = said(bt.audit(frames, labels, groups, permutations=399))
    assert said(bt.audit(tmp_path / "recording.npz", permutations=399)) == whole
    assert said(bt.audit(str(tmp_path / "touches.npy"), labels, groups, permutations=399)) == whole
    assert said(bt.audit(frames, tmp_path / "classes.npy", groups, permutations=399)) == whole
    days = np.datetime64("2024-01-01") + groups // 3
    assert said(bt.audit(tmp_path / "recording.npz", sessions=days, permutations=399)) == said(
        bt.audit(frames, labels, groups, sessions=groups // 3, permutations=399)
    )
    test = (tmp_path / "touches.npy", labels)
    assert said(bt.audit(frames + 0.01, labels, test=test, permutations=399)) == said(
        bt.audit(frames + 0.01, labels, test=(frames, labels), permutations=399)
    )
    refused(r"^frames: .*absent\.npz: no such file; an array, or the path of a file$", lambda: bt.audit(tmp_path / "absent.npz"), FileNotFoundError)
    refused("^labels: object: no such file; an array, or the path of a file$", lambda: bt.audit(frames, "object"), FileNotFoundError)
    refused(r"^labels: 119 values; 120, one a touch of .*touches\.npy$", lambda: bt.audit(tmp_path / "touches.npy", labels[1:]))
    refused("^frames: dict; an array, or the path of a file$", lambda: bt.audit({"thumb": frames}, labels))  # type: ignore[arg-type]


def test_files_of_other_formats_are_read(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    frames, labels = data()
    with h5py.File(tmp_path / "touches.h5", "w") as file:
        file["frames"], file["labels"] = frames, labels.astype("S")
    assert said(bt.audit(tmp_path / "touches.h5", permutations=399)) == said(bt.audit(frames, labels, permutations=399))


def test_masked_readings_are_missing_and_masked_labels_are_refused() -> None:
    frames, labels = data()
    masked = np.ma.masked_array(frames, mask=np.zeros(frames.shape, bool))
    masked[3, 5, 5] = np.ma.masked
    found = bt.audit(masked, labels, permutations=399)
    missing = next(finding for finding in found.findings if finding.check == "missing_readings")
    assert missing.value == 1 / frames.size
    numbers = np.unique(labels, return_inverse=True)[1]
    refused("^labels, position 7: nan; integers or texts$", lambda: bt.audit(frames, np.ma.masked_array(numbers, mask=np.arange(120) == 7)))
    refused("^groups, position 0: None; integers or texts$", lambda: bt.audit(frames, labels, [None] * 120))
    refused("^labels, position 2: nan; integers or texts$", lambda: bt.audit(frames, [np.nan if touch == 2 else label for touch, label in enumerate(labels.tolist())]))
    one_hot = bt.audit(frames, np.eye(3, dtype=int)[numbers], permutations=399)
    assert said(one_hot) == said(bt.audit(frames, numbers, permutations=399))


def test_padding_of_unequal_touches_is_not_missing(tmp_path: Path) -> None:
    random = np.random.default_rng(11)
    frames, labels = data()
    lengths = random.integers(3, 8, len(frames))
    touches = [frame + 0.02 * random.standard_normal((n, 12, 12)) for frame, n in zip(frames, lengths, strict=True)]
    found = bt.audit(touches, labels, permutations=399)
    missing = next(finding for finding in found.findings if finding.check == "missing_readings")
    assert (missing.verdict, missing.value) == ("passed", 0.0)
    assert "Touches have 3 to 7 frames; frames after the end of a touch are not counted." in missing.sentence
    assert not found.faults
    # Touches may be padded by any number if their lengths are given, in memory and in files.
    padded = np.zeros((len(frames), 7, 12, 12))
    for row, touch in zip(padded, touches, strict=True):
        row[: len(touch)] = touch
    recorded = bt.Recorded(padded, labels, lengths=lengths)
    assert said(bt.audit(recorded, permutations=399)) == said(found)
    np.savez(tmp_path / "touches.npz", frames=padded, labels=labels, lengths=lengths)
    assert said(bt.audit(tmp_path / "touches.npz", permutations=399)) == said(found)
    # A length that names the class is a fault.
    of_class = [frame[None].repeat(3 + 2 * number, axis=0) for frame, number in zip(frames, np.unique(labels, return_inverse=True)[1], strict=True)]
    noisy = [touch + 0.02 * random.standard_normal(touch.shape) for touch in of_class]
    assert "padding" in {fault.check for fault in bt.audit(noisy, labels, permutations=399).faults}

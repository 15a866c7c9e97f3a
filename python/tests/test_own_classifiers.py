"""Tests of studies with classifiers and features whose code is in Python."""

from __future__ import annotations

import copy
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import bubbletouch as bt
import numpy as np
import pytest
from bubbletouch import _foreign

from conftest import Command, refused

STUDY: dict[str, Any] = {
    "question": "How well does my classifier tell cans apart?",
    "trials": 3,
    "objects": {"sets": ["cans"], "surface_error_mm": 1.0},
    "skin": {"pitch_mm": 4.0, "size_mm": 64.0, "stroke_mm": 5.0},
    "touches": {"per_object": 8, "offset_x_mm": {"uniform": [-8.0, 8.0]}, "depth_mm": 3.0},
    "signal": {"noise_std_full_scale": [0.0, 0.05]},
    "sensing": {"ensemble": "sbhe", "ratio": [4, 16]},
    "recognition": {"classifier": ["linear_svm", "rbf_svm"]},
}
# Columns that differ between rows of equal results.
NOT_COMPARED = ("configuration", "classifier", "features", "c", "c_used", "gamma_used", "n_capped")


def with_keys(**recognition: Any) -> dict[str, Any]:
    """Returns the study with other keys of [recognition]."""
    changed = copy.deepcopy(STUDY)
    changed["recognition"] |= recognition
    return changed


def rows_of(study: bt.Study, column: str, value: str, table: str = "accuracy") -> list[tuple[Any, ...]]:
    """Returns the rows of a table in which a column has a value, without the columns that name the configuration."""
    columns = dict(study[table].columns)
    if column not in columns:
        known = study["summary"].columns
        of = dict(zip(known["configuration"], known[column], strict=True))
        columns[column] = [str(of[number]) for number in columns["configuration"]]
    names = [name for name in columns if name not in NOT_COMPARED]
    rows = zip(*(columns[name] for name in names), strict=True)
    return [tuple(map(str, row)) for row, is_of in zip(rows, np.asarray(columns[column]) == value, strict=True) if is_of]


class Nearest:
    """Nearest class mean, without anything of scikit-learn; counts its fits in a file."""

    def __init__(self, log: Path | None = None, fatal: int | None = None) -> None:
        self.log, self.fatal = log, fatal

    def fit(self, rows: Any, labels: Any) -> None:
        if self.log is not None:
            with self.log.open("a") as file:
                file.write("fit\n")
            if self.fatal is not None and len(self.log.read_text().splitlines()) == self.fatal:
                os._exit(7)
        self.names = np.unique(labels)
        self.means = np.array([rows[labels == name].mean(0) for name in self.names])

    def predict(self, rows: Any) -> Any:
        return self.names[((rows[:, None] - self.means) ** 2).sum(-1).argmin(1)]


class Drawn:
    """Predicts labels that NumPy's global generator draws."""

    def fit(self, rows: Any, labels: Any) -> None:
        self.names = np.unique(labels)
        self.chosen = np.random.permutation(self.names)

    def predict(self, rows: Any) -> Any:
        return np.random.choice(self.chosen, len(rows))


def test_scikit_learns_svc_has_the_rows_of_ours() -> None:
    svm = pytest.importorskip("sklearn.svm")
    study = bt.run({**STUDY, "trials": 10}, classifiers={"svc": svm.SVC(kernel="linear", C=1.0), "svc_rbf": svm.SVC(C=1.0)})
    for table in ("accuracy", "confusion"):
        for ours, theirs in (("linear_svm", "svc"), ("rbf_svm", "svc_rbf")):
            rows = rows_of(study, "classifier", ours, table)
            assert rows == rows_of(study, "classifier", theirs, table) and len(rows) >= 40
    assert len(rows_of(study, "classifier", "svc", "comparison")) == 4
    page = (study.folder / "report.html").read_text()
    assert "svc_rbf" in page
    assert np.isfinite(np.asarray(study["comparison"]["p_holm"], dtype=float)).any()


def test_a_study_names_its_classifier_or_gets_it_at_the_end() -> None:
    named = bt.run(with_keys(classifier="mine"), classifiers={"mine": Nearest()})
    assert set(named["accuracy"]["classifier"]) == {"mine"}
    added = bt.run(with_keys(classifier="nearest_centroid"), classifiers={"mine": Nearest()})
    assert rows_of(added, "classifier", "mine") == rows_of(added, "classifier", "nearest_centroid")
    assert rows_of(named, "classifier", "mine") == rows_of(added, "classifier", "mine")


def test_results_have_the_same_bytes_in_any_number_of_processes() -> None:
    forest = pytest.importorskip("sklearn.ensemble").RandomForestClassifier(n_estimators=5)
    mine = {"drawn": Drawn(), "forest": forest}
    functions = {"roots": np.sqrt, "noisy": noisy}
    study = with_keys(classifier="nearest_centroid")
    study["signal"] = {"noise_std_full_scale": 0.0}
    study["sensing"] = {"ensemble": "identity"}
    study["skin"] |= {"pitch_mm": 8.0}
    runs = [bt.run(study, classifiers=mine, features=functions, processes=n) for n in (0, 2)]
    runs.append(bt.run(study, classifiers=mine, features=functions))
    for table in ("accuracy", "summary", "confusion"):
        assert len({(run.folder / f"{table}.csv").read_bytes() for run in runs}) == 1, table
    trials = rows_of(runs[0], "classifier", "drawn")
    assert len(set(trials)) > 1, "each trial has a seed of its own"


def noisy(frames: Any) -> Any:
    return frames + np.random.normal(0, 1e-6, frames.shape)


KILLED = """
import sys
from pathlib import Path
sys.path.insert(0, {tests!r})
import bubbletouch as bt
from test_own_classifiers import STUDY, Nearest
bt.run(STUDY, {out!r}, classifiers={{"mine": (Nearest(Path({log!r}), 4), "1")}})
"""


def test_a_killed_run_goes_on_and_another_version_is_computed_again(tmp_path: Path) -> None:
    out, log = tmp_path / "out", tmp_path / "log"
    code = KILLED.format(tests=str(Path(__file__).parent), out=str(out), log=str(log))
    assert subprocess.run([sys.executable, "-c", code]).returncode == 7

    def n_fits(version: str | None) -> int:
        log.write_text("")
        mine = Nearest(log) if version is None else (Nearest(log), version)
        study = bt.run(STUDY, out, classifiers={"mine": mine})
        whole = bt.run(STUDY, classifiers={"mine": Nearest()})
        for table in ("accuracy", "summary", "confusion"):
            assert (study.folder / f"{table}.csv").read_bytes() == (whole.folder / f"{table}.csv").read_bytes()
        return len(log.read_text().splitlines())

    n_all = 3 * 2 * 2
    assert 0 < n_fits("1") < n_all
    assert n_fits("1") == 0
    assert n_fits("2") == n_all
    # Without a version, the code and the parameters are the version.
    assert n_fits(None) == n_all and n_fits(None) == 0
    # A study of this classifier alone shares no work item with another version.
    alone = with_keys(classifier="mine")
    bt.run(alone, tmp_path / "alone", classifiers={"mine": (Nearest(), "1")})
    again = bt.run(alone, tmp_path / "alone", classifiers={"mine": (Drawn(), "2")})
    assert rows_of(again, "classifier", "mine") == rows_of(bt.run(alone, classifiers={"mine": Drawn()}), "classifier", "mine")


def test_a_version_follows_code_and_parameters() -> None:
    svm = pytest.importorskip("sklearn.svm")
    pipeline = pytest.importorskip("sklearn.pipeline")

    def version(thing: Any) -> str:
        return bt._foreign.identified({"mine": thing}, None)[0][0][1]

    assert version(svm.SVC()) == version(svm.SVC(C=1.0)) != version(svm.SVC(C=2.0)) != version(svm.LinearSVC(C=2.0))
    steps = [pipeline.make_pipeline(svm.SVC(C=c)) for c in (1.0, 1.0, 2.0)]
    assert version(steps[0]) == version(steps[1]) != version(steps[2])
    assert version(Nearest()) != version(Nearest(Path("log"))) != version(Drawn())

    def function(thing: Any) -> str:
        return bt._foreign.identified(None, {"mine": thing})[1][0][1]

    def scaled(by: float) -> Any:
        return lambda frames: by * frames

    assert function(scaled(1.0)) == function(scaled(1.0)) != function(scaled(2.0)) != function(noisy)
    # Lambdas on one line have one source text.
    first, second, third = (lambda frames: frames[:, :3]), (lambda frames: frames[:, :4]), (lambda frames: frames[:, :3])
    assert function(first) == function(third) != function(second)

    def itself(frames: Any) -> Any:
        return frames if itself else frames

    assert function(itself) == function(itself)


def trained_with(c: float) -> Any:
    """Returns a classifier whose methods depend on a variable around the class."""

    class Trained:
        def fit(self, rows: Any, labels: Any) -> None:
            from sklearn.svm import SVC

            self.fitted = SVC(C=c).fit(rows, labels)

        def predict(self, rows: Any) -> Any:
            return self.fitted.predict(rows)

    return Trained()


class Base:
    """First form of a base class."""

    def fit(self, rows: Any, labels: Any) -> None:
        """Does nothing."""

    def predict(self, rows: Any) -> Any:
        return np.zeros(len(rows))


class Form(Base):
    """Classifier whose text contains its field and not its code."""

    def __init__(self, k: int) -> None:
        self.k = k

    def __repr__(self) -> str:
        return f"Form({self.k})"


class OtherForm(Form):
    """Classifier with the text of another class."""

    def predict(self, rows: Any) -> Any:
        return np.ones(len(rows))


def test_a_version_follows_bases_and_variables_around_a_class() -> None:
    def version(thing: Any) -> str:
        return bt._foreign.identified({"mine": thing}, None)[0][0][1]

    assert version(trained_with(1.0)) == version(trained_with(1.0)) != version(trained_with(2.0))
    # Objects with equal texts and different code.
    assert version(Form(3)) == version(Form(3)) != version(Form(4))
    assert version(Form(3)) != version(OtherForm(3))
    derived = type("Derived", (Base,), {"__module__": __name__})
    other = type("Derived", (Nearest,), {"__module__": __name__})
    assert version(derived()) == version(derived()) != version(other())


def test_a_version_is_equal_in_all_processes() -> None:
    program = """
import bubbletouch as bt
function = lambda frames: frames if "a" in {"a", "b", "c", "d"} else -frames
print(bt._foreign.identified(None, {"mine": function})[1][0][1])
"""
    found = set()
    for seed in ("1", "2", "3"):
        run = subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=True, env=os.environ | {"PYTHONHASHSEED": seed}
        )
        found.add(run.stdout)
    assert len(found) == 1


def test_classes_of_the_main_program_run_in_processes(tmp_path: Path) -> None:
    study = with_keys(classifier="mine") | {"trials": 1, "signal": {"noise_std_full_scale": 0.0}, "sensing": {"ratio": 4}}
    program = tmp_path / "main.py"
    program.write_text(f"""
import bubbletouch as bt
import numpy as np

class Mine:
    def fit(self, rows, labels):
        self.classes = np.unique(labels)
        self.means = [rows[labels == label].mean(axis=0) for label in self.classes]

    def predict(self, rows):
        return self.classes[np.argmin([((rows - mean) ** 2).sum(axis=1) for mean in self.means], axis=0)]

if __name__ == "__main__":
    for processes in (0, 2):
        print(list(bt.run({study!r}, classifiers={{"mine": Mine()}}, processes=processes)["summary"].columns["accuracy"]))
""")
    run = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    first, second = run.stdout.splitlines()
    assert first == second


def test_decisions_on_several_touches_add_probabilities_or_votes() -> None:
    linear_model = pytest.importorskip("sklearn.linear_model")
    study = with_keys(classifier="linear_svm", touches_per_decision=[1, 3])
    study["touches"] |= {"per_object": 24}
    mine = {"logistic": linear_model.LogisticRegression(), "votes": Nearest()}
    accuracy = bt.run(study, classifiers=mine)["accuracy"]
    kinds, k, found = (np.asarray(accuracy[name]) for name in ("classifier", "touches_per_decision", "accuracy"))
    for kind in ("logistic", "votes"):
        one, three = (found[(kinds == kind) & (k == n)].mean() for n in (1, 3))
        assert 0.5 < one < three, (kind, one, three)


def test_the_prior_of_probabilities_is_not_subtracted() -> None:
    linear_model = pytest.importorskip("sklearn.linear_model")
    # With equal priors in the probabilities, an imbalance of the training touches must not favour the rare objects.
    study = with_keys(classifier="linear_svm", touches_per_decision=[1, 3], class_imbalance=8.0)
    study["touches"] |= {"per_object": 48}
    mine = {"balanced": linear_model.LogisticRegression(class_weight="balanced")}
    accuracy = bt.run(study, classifiers=mine)["accuracy"]
    kinds, k, found = (np.asarray(accuracy[name]) for name in ("classifier", "touches_per_decision", "accuracy"))
    one, three = (found[(kinds == "balanced") & (k == n)].mean() for n in (1, 3))
    assert one < three, (one, three)


def test_a_function_of_frames_makes_features() -> None:
    def sums(frames: Any) -> Any:
        images = frames.reshape(len(frames), 16, 16)
        return np.hstack([images.sum(1), images.sum(2)])

    study = with_keys(classifier="linear_svm")
    study["sensing"] = {"ensemble": "identity"}
    study["touches"] |= {"frames": 2}
    found = bt.run(study, features={"same": lambda frames: frames.copy(), "sums": sums})
    assert rows_of(found, "features", "same") == rows_of(found, "features", "raw")
    assert rows_of(found, "features", "sums") != rows_of(found, "features", "raw")
    assert len(rows_of(found, "features", "sums")) == 6
    study["recognition"]["features"] = "sums"
    study["recognition"]["temporal_features"] = "deepest"
    alone = bt.run(study, features={"sums": sums})
    assert set(alone["accuracy"]["features"]) == {"sums"}


class Failing:
    def __init__(self, how: str) -> None:
        self.how = how

    def fit(self, rows: Any, labels: Any) -> None:
        if self.how == "fit":
            raise ArithmeticError("no convergence after 5 steps")

    def predict(self, rows: Any) -> Any:
        answers = {"few": [0], "unknown": [99] * len(rows), "negative": [-1] * len(rows), "half": [0.5] * len(rows), "words": ["a"] * len(rows)}
        return np.array(answers[self.how])


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ("fit", "ArithmeticError: no convergence after 5 steps"),
        ("few", "1 labels for 18 rows; one label a row"),
        ("unknown", "label 99; labels of the training rows"),
        ("negative", "; labels of the training rows"),
        ("half", "not whole"),
        ("words", "ValueError"),
    ],
)
def test_an_error_names_study_configuration_and_trial(how: str, said: str) -> None:
    with pytest.raises(ValueError, match=r"study, configuration \d \(mine, raw\), trial \d, classifier mine: ") as raised:
        bt.run(with_keys(classifier="mine"), classifiers={"mine": Failing(how)})
    assert said in str(raised.value)
    if how == "fit":
        assert isinstance(raised.value.__cause__, ArithmeticError)


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda frames: frames[0], r"shape \(64,\)"),
        (lambda frames: frames[:0], r"shape \(0, 64\) for 1 frames; \(1, n_features\)"),
        (lambda frames: np.full((len(frames), 3), np.nan), "not finite, in column 0; finite numbers"),
        (lambda frames: np.zeros((len(frames), 1 + (len(frames) > 1))), r"for \d+ frames; \(\d+, 1\)"),
        (lambda frames: frames.nothing, "AttributeError"),
    ],
)
def test_an_error_of_features_names_them(function: Any, said: str) -> None:
    refused(f"features mine: .*{said}", lambda: bt.run(with_keys(), features={"mine": (function, said.encode().hex()[:60])}))


def test_what_is_no_classifier_is_refused(tmp_path: Path) -> None:
    for given, said in [
        ({"classifiers": {"mine": object()}}, "classifier mine: object; an object with fit"),
        ({"classifiers": {"mine": Nearest}}, "classifier mine: type; an object with fit"),
        ({"classifiers": {"mine": (Nearest(), 1)}}, "a tuple of 2; .*a text as version"),
        ({"classifiers": {"linear_svm": Nearest()}}, "linear_svm.*; a name that no other classifier has"),
        ({"classifiers": {"a b": Nearest()}}, "a b.*letters, digits"),
        ({"features": {"mine": 3}}, "features mine: int; a function"),
        ({"classifiers": [Nearest()]}, "classifier: list; a dict of names"),
        ({"features": {"mine": lambda frames: frames + 1j}}, "the function returned complex128; real numbers"),
        ({"features": {"raw": np.sqrt}}, "raw.*; a name that no other features have"),
        ({"processes": -1}, "processes: -1; zero or"),
    ]:
        refused(said, lambda: bt.run(STUDY, tmp_path / "out", **given))
        assert not (tmp_path / "out").exists()
    refused("mine", lambda: bt.run(with_keys(classifier="mine"), tmp_path / "out"))
    with pytest.raises(ValueError, match="study: .*; classifiers and features of the program for a study that recognises objects"):
        bt.run({"question": "q", "stability": {}}, tmp_path / "out", classifiers={"mine": Nearest()})
    assert not (tmp_path / "out").exists()


def test_the_command_reports_such_a_study_and_does_not_run_it(tmp_path: Path, command: Command) -> None:
    study = bt.run(STUDY, tmp_path / "out", classifiers={"mine": (Nearest(), "1")})
    before = (study.folder / "summary.csv").read_bytes()
    command("report", study.folder)
    assert (study.folder / "summary.csv").read_bytes() == before and "mine" in (study.folder / "report.html").read_text()
    assert "mine@1" in (study.folder / "study.toml").read_text()
    with pytest.raises(subprocess.CalledProcessError) as failed:
        command("run", study.folder / "study.toml", "--out", tmp_path / "again")
    assert failed.value.returncode == 2 and "classifier mine: no code for version 1" in failed.value.stderr


GUIDE = (Path(__file__).resolve().parents[2] / "guide" / "own_methods.md").read_text()


def test_the_program_of_the_guide_trains_and_predicts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = re.findall(r"^```python,mine.py\n(.*?)^```", GUIDE, re.M | re.S)[0]
    (tmp_path / "mine.py").write_text(code)
    command = {"command": [sys.executable, "mine.py"], "time_limit_s": 60}
    text = bt._core.toml_of(bt.study._json(with_keys(classifier=["nearest_centroid", command])))
    (tmp_path / "study.toml").write_text(text)
    # Paths are relative to the study file.
    study = bt.run(tmp_path / "study.toml", tmp_path / "out")
    assert rows_of(study, "classifier", "mine") == rows_of(study, "classifier", "nearest_centroid")
    assert len(rows_of(study, "classifier", "mine")) == 12
    (tmp_path / "mine.py").write_text("raise ArithmeticError('no convergence')")
    with pytest.raises(ValueError, match=r"configuration \d .*classifier mine: .* ended with exit status: 1: ArithmeticError: no convergence; exit code 0"):
        bt.run(tmp_path / "study.toml", tmp_path / "out")


def test_the_python_of_the_guide_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("sklearn")
    pytest.importorskip("pandas")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "experiments").mkdir()
    (tmp_path / "experiments" / "quickstart.toml").write_text(bt._core.toml_of(bt.study._json(with_keys(classifier="nearest_centroid"))))
    variables: dict[str, object] = {}
    for code in re.findall(r"^```python\n(.*?)^```", GUIDE, re.M | re.S)[:2]:
        exec(compile(code, "own_methods.md", "exec"), variables)
    assert "tuned" in (tmp_path / "results" / "mine" / "summary.csv").read_text()
    # A parameter of an own estimator is a column.
    shown = [line.split() for line in capsys.readouterr().out.splitlines()[-4:]]
    assert shown[0] == ["C", "accuracy"] and [float(line[1]) for line in shown[1:]] == [0.1, 1.0, 10.0]


def power(frames: Any, exponent: float = 1.0) -> Any:
    return np.abs(frames) ** exponent


class Turned(Nearest):
    """Nearest class mean of features times a factor, as a variable without set_params."""

    def __init__(self, weight: float = 1.0) -> None:
        super().__init__()
        self.weight = weight

    def fit(self, rows: Any, labels: Any) -> None:
        super().fit(rows * np.array([self.weight, *[1.0] * (rows.shape[1] - 1)]), labels)


def swept(classifier: str, key: str, values: list[Any], **given: Any) -> bt.Study:
    study = with_keys(classifier=classifier, features="powers" if given.get("features") else "raw")
    return bt.run({**study, "axes": {f"recognition.parameters.{key}": values}}, **given)


def accuracies(study: bt.Study, **where: Any) -> list[float]:
    table = study["summary"].columns
    is_of = np.all([np.asarray(table[name]) == value for name, value in where.items()], axis=0) if where else slice(None)
    return list(np.asarray(table["accuracy"])[is_of])


def test_a_parameter_of_an_own_method_is_an_axis_whose_values_equal_runs_of_their_own() -> None:
    svm = pytest.importorskip("sklearn.svm")
    make_pipeline = pytest.importorskip("sklearn.pipeline").make_pipeline
    study = swept("svc", "svc.C", [1e-3, 10.0], classifiers={"svc": svm.SVC(kernel="linear")})
    of_pipeline = swept("svc", "svc.svc__C", [1e-3, 10.0], classifiers={"svc": make_pipeline(svm.SVC(kernel="linear"))})
    for c in (1e-3, 10.0):
        alone = accuracies(bt.run(with_keys(classifier="svc"), classifiers={"svc": svm.SVC(kernel="linear", C=c)}))
        assert accuracies(study, C=c) == accuracies(of_pipeline, svc__C=c) == alone
    assert accuracies(study, C=1e-3) != accuracies(study, C=10.0)
    words = swept("svc", "svc.kernel", ["linear", "rbf"], classifiers={"svc": svm.SVC()})
    assert accuracies(words, kernel="rbf") == accuracies(bt.run(with_keys(classifier="svc"), classifiers={"svc": svm.SVC()}))
    turned = swept("mine", "mine.weight", [1.0, -50.0], classifiers={"mine": Turned()}, processes=2)
    assert accuracies(turned, weight=1.0) == accuracies(bt.run(with_keys(classifier="mine"), classifiers={"mine": Turned()}))
    assert accuracies(turned, weight=1.0) != accuracies(turned, weight=-50.0)
    powers = swept("linear_svm", "powers.exponent", [1.0, 3.0], features={"powers": power})
    one = bt.run(with_keys(classifier="linear_svm", features="cubes"), features={"cubes": lambda frames: np.abs(frames) ** 3.0})
    assert accuracies(powers, exponent=3.0) == accuracies(one)
    assert accuracies(powers, exponent=3.0) != accuracies(powers, exponent=1.0)


def test_a_parameter_that_an_own_method_does_not_have_is_refused() -> None:
    svm = pytest.importorskip("sklearn.svm")
    own: dict[str, Any] = {"classifiers": {"svc": svm.SVC(), "mine": Turned()}, "features": {"powers": power}}
    for key, words in (
        ("svc.D", r"svc\.D = 1.*recognition\.parameters\.svc: classifier svc: .*Invalid parameter 'D' for estimator SVC"),
        ("mine.wait", r"recognition\.parameters\.mine: classifier mine: .*no parameter wait; .*weight"),
        ("powers.frames", r"recognition\.parameters\.powers: features powers: .*multiple values for argument 'frames'"),
        ("powers.root", r"recognition\.parameters\.powers: features powers: .*unexpected keyword argument 'root'"),
        ("svm.C", r"recognition\.parameters\.svm: given, but the study has no classifier or features of your own with this name"),
    ):
        refused(words, lambda: bt.run({**with_keys(classifier="linear_svm"), "axes": {f"recognition.parameters.{key}": [1, 2]}}, **own))


FACTOR = 2.0


def scaled(frames: Any) -> Any:
    return FACTOR * frames


def scaled_again(frames: Any) -> Any:
    return scaled(frames)


class WithState:
    """Method with variables of any type."""

    def __init__(self, value: Any) -> None:
        self.value = value

    def features(self, frames: Any) -> Any:
        return FACTOR * frames


def test_a_version_follows_bound_methods_variables_matrices_and_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    def version(thing: Any) -> str:
        [(_, found, _)] = _foreign.identified(None, {"f": thing})[1]
        return found

    tables: list[Any] = [np.array([1, "a"], object), np.array([1, "b"], object)]
    if pandas := sys.modules.get("pandas") or pytest.importorskip("pandas"):
        # The representation of a long table omits its middle.
        tables += [pandas.DataFrame({"a": np.where(np.arange(1000) == row, 1.0, 0.0)}) for row in (500, 501)]
    sparse = pytest.importorskip("scipy.sparse")
    tables += [sparse.csr_matrix(np.eye(3) * k) for k in (1, 2)]
    versions = [version(WithState(value).features) for value in tables]
    assert len(set(versions)) == len(tables)
    assert versions == [version(WithState(copy.deepcopy(value)).features) for value in tables]
    before = [version(thing) for thing in (scaled, scaled_again, WithState(1).features)]
    monkeypatch.setattr(sys.modules[__name__], "FACTOR", 3.0)
    assert all(version(thing) != old for thing, old in zip((scaled, scaled_again, WithState(1).features), before, strict=True))


def test_a_fresh_run_computes_everything_again(tmp_path: Path) -> None:
    log = tmp_path / "log"
    out = tmp_path / "out"
    for fresh in (False, False, True):
        bt.run(STUDY, out, classifiers={"mine": (Nearest(log), "1")}, fresh=fresh)
        log.write_text(log.read_text() + "end\n")
    runs = [run.count("\n") for run in log.read_text().split("end\n")]
    assert runs[0] > 0 and runs[1] == 0 and runs[2] == runs[0]
    assert (tmp_path / "out.1").is_dir()

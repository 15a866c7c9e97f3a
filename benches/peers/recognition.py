#!/usr/bin/env python3
"""Times scikit-learn and bubbletouch on equal touches: both get the same rows and the same split in one run.

Both learn from the folders that `bubbletouch features` writes. Features are standardised on the training rows beforehand (population
standard deviation). A comparison alternates the two programs. In each round, the peer is fitted once, and bubbletouch is fitted about as
often as takes the same time; the first of these fits is not counted. Times are medians over the rounds of the mean times. Predictions are
compared row by row. Dual objectives are compared for SVMs that solve the same problem. README.md beside this file describes the settings.
"""

import argparse
import csv
import datetime
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

# The numbers of threads of NumPy's and scikit-learn's libraries are set per comparison by threadpoolctl.
import numpy as np
import scipy
import sklearn
from sklearn.ensemble import RandomForestClassifier
from sklearn.linear_model import LogisticRegression
from sklearn.model_selection import GridSearchCV
from sklearn.naive_bayes import GaussianNB
from sklearn.neighbors import KNeighborsClassifier
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC, LinearSVC
from threadpoolctl import threadpool_limits

try:
    from sklearnex.svm import SVC as IntelSVC
except ImportError:
    IntelSVC = None

ROOT = Path(__file__).resolve().parents[2]

# Peer, its maker, what of ours answers the same question, and whether both solve the same optimisation problem.
OVO = ["--multiclass", "one_vs_one"]
OVR = ["--multiclass", "one_vs_rest"]
# LIBLINEAR's own problem and method, to its default tolerance.
DESCENT = ["--solver", "coordinate_descent", "--tolerance", "1e-4"]
COMPARISONS = [
    ("SVC(linear)", lambda jobs: SVC(kernel="linear"), ["--classifier", "linear_svm", *OVO], True),
    ("SVC(rbf)", lambda jobs: SVC(kernel="rbf"), ["--classifier", "rbf_svm", *OVO], True),
    ("SVC(poly, coef0=1)", lambda jobs: SVC(kernel="poly", coef0=1.0), ["--classifier", "polynomial_svm", *OVO], True),
    ("LinearSVC(hinge)", lambda jobs: LinearSVC(loss="hinge"), ["--classifier", "linear_svm", *OVO], False),
    ("LinearSVC(hinge)", lambda jobs: LinearSVC(loss="hinge"), ["--classifier", "linear_svm", *OVR], False),
    ("LinearSVC(hinge)", lambda jobs: LinearSVC(loss="hinge"), ["--classifier", "linear_svm", *OVR, *DESCENT], False),
    ("LinearSVC()", lambda jobs: LinearSVC(), ["--classifier", "linear_svm", *OVO], False),
    ("LogisticRegression", lambda jobs: LogisticRegression(max_iter=200), ["--classifier", "logistic_regression"], False),
    # Both sides go on until they meet their tolerances. In the row above, scikit-learn stops at 200 iterations, often before.
    ("LogisticRegression, converged", lambda jobs: LogisticRegression(max_iter=20_000), ["--classifier", "logistic_regression"], False),
    ("KNeighbors(5)", lambda jobs: KNeighborsClassifier(5, n_jobs=jobs), ["--classifier", "k_nearest"], False),
    ("GaussianNB", lambda jobs: GaussianNB(), ["--classifier", "naive_bayes"], False),
    ("RandomForest(100)", lambda jobs: RandomForestClassifier(random_state=0, n_jobs=jobs), ["--classifier", "random_forest"], False),
]

# Intel's own SVMs beside scikit-learn's, where they install.
if IntelSVC:
    for kernel, ours in [("linear", "linear_svm"), ("rbf", "rbf_svm"), ("poly", "polynomial_svm")]:
        name = f"sklearnex SVC({kernel})"
        make = lambda jobs, kernel=kernel: IntelSVC(kernel=kernel, coef0=1.0, n_jobs=jobs)
        COMPARISONS.append((name, make, ["--classifier", ours, *OVO], False))

COLUMNS = [
    "date", "machine", "bubbletouch", "scikit_learn", "numpy", "threads", "noise_std", "smoothing_mm", "measurements", "n_train", "n_test",
    "peer", "ours", "peer_fit_s", "our_fit_s", "fit_ratio", "our_cold_fit_s", "peer_predict_s", "our_predict_s", "predict_ratio",
    "peer_accuracy", "our_accuracy", "identical_fraction", "peer_dual", "our_dual", "dual_difference", "peer_warnings",
]


class Folder:
    """Folder of features that `bubbletouch features` wrote, with standardised training and test rows."""

    def __init__(self, path, n_train):
        self.path = path
        features, labels = np.load(path / "features.npy"), np.load(path / "labels.npy")
        train, test = np.load(path / "train.npy")[:n_train], np.load(path / "test.npy")
        scaler = StandardScaler().fit(features[train])
        self.train, self.test = scaler.transform(features[train]), scaler.transform(features[test])
        self.train_labels, self.test_labels = labels[train], labels[test]
        configuration = (path / "configuration.toml").read_text()
        self.settings = {key: toml_number(configuration, key) for key in ["noise_std", "smoothing_mm", "measurements"]}
        self.scaled = self.write_scaled(scaler.transform(features))

    def write_scaled(self, features):
        """Writes a copy of the folder with standardised features and returns its path. The times of both programs then exclude the scaling."""
        scaled = self.path.parent / f"{self.path.name}_scaled"
        scaled.mkdir(exist_ok=True)
        for file in self.path.iterdir():
            if file.is_file() and file.name != "features.npy":
                shutil.copyfile(file, scaled / file.name)
        np.save(scaled / "features.npy", features)
        return scaled


def toml_number(text, key):
    """Returns a number of a flat TOML table. (Python has a TOML reader only since version 3.11.)"""
    return float(next(line.split("=")[1] for line in text.splitlines() if line.startswith(f"{key} =")))


class Ours:
    """The command `bubbletouch classify` with a fixed number of threads."""

    def __init__(self, binary, threads, n_train):
        self.binary, self.n_train = binary, n_train
        self.environment = dict(os.environ, RAYON_NUM_THREADS=str(threads))

    def classify(self, folder, options, repeat=1):
        """Returns the command's JSON output (accuracy, times in seconds, dual objective) and the predicted labels of the test rows, (n_test,)."""
        with tempfile.TemporaryDirectory() as scratch:
            predictions = Path(scratch) / "predictions.npy"
            command = [self.binary, "classify", str(folder.scaled), "--scaling", "none", *options, "--json", "--repeat", str(repeat)]
            command += ["--train-rows", str(self.n_train), "--predictions", str(predictions)]
            done = subprocess.run(command, env=self.environment, capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit(done.stderr)
            return json.loads(done.stdout), np.load(predictions)


# Maximum number of counted fits of bubbletouch in one round.
MOST_WARM_FITS = 20
# A peer whose fit takes longer, in seconds, is fitted only once for each folder, for all comparisons and numbers of threads. LIBLINEAR has one thread
# and takes minutes at 1,024 measurements. Variations of the machine's speed average out over such a time.
SLOW_S = 10.0


def timed(action):
    start = time.perf_counter()
    result = action()
    return time.perf_counter() - start, result


def dual_objective(model, labels):
    """Returns the sum over all pairs of classes of ½ Σ a_i a_j y_i y_j K(x_i, x_j) − Σ a_i, from the coefficients that libsvm returns.

    In scikit-learn's dual_coef_, shape (n_classes − 1, n_SV), a support vector of class i has the coefficient of the pair
    (i, j) in row j − 1 if j > i, and in row j otherwise.
    """
    n_classes = len(model.classes_)
    vectors, packed = model.support_vectors_, model.dual_coef_
    first = np.concatenate([[0], np.cumsum(model.n_support_)])
    gamma = model._gamma
    total = 0.0
    for i in range(n_classes):
        for j in range(i + 1, n_classes):
            rows = np.r_[first[i]:first[i + 1], first[j]:first[j + 1]]
            coefficients = np.concatenate([packed[j - 1, first[i]:first[i + 1]], packed[i, first[j]:first[j + 1]]])
            used = coefficients != 0.0
            points, coefficients = vectors[rows[used]], coefficients[used]
            products = points @ points.T
            if model.kernel == "rbf":
                norms = np.diag(products)
                products = np.exp(-gamma * np.maximum(norms[:, None] + norms[None, :] - 2.0 * products, 0.0))
            elif model.kernel == "poly":
                products = (gamma * products + model.coef0) ** model.degree
            total += 0.5 * coefficients @ products @ coefficients - np.abs(coefficients).sum()
    return total


def compare(folder, ours, comparison, threads, repeats, slow):
    """Returns the table row of one comparison. The peer and bubbletouch alternate."""
    name, make, options, is_same_problem = comparison
    peer_times, our_times, cold_s = [], [], []
    repeat = 2
    with threadpool_limits(threads), warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        for _ in range(repeats):
            answer = ours.classify(folder, options, repeat)
            fitted = slow.get((name, folder.path))
            if fitted is None:
                model = make(threads)
                fit_s, _ = timed(lambda: model.fit(folder.train, folder.train_labels))
                predict_s, predicted = timed(lambda: model.predict(folder.test))
                names = sorted({warning.category.__name__ for warning in warned})
                fitted = model, fit_s, predict_s, predicted, names
                if fit_s > SLOW_S:
                    slow[name, folder.path] = fitted
            model, fit_s, predict_s, predicted, names = fitted
            peer_times.append((fit_s, predict_s))
            # The first fit of a new process has cold caches, unlike the peer's; only later fits are counted.
            ours_s = [statistics.mean(answer[0][part][1:]) for part in ["fit_s", "predict_s"]]
            our_times.append(ours_s)
            cold_s.append(answer[0]["fit_s"][0])
            # Repeat for about the time of one fit and prediction of the peer; both then average over equal variations of the machine's speed.
            repeat = 1 + max(1, min(MOST_WARM_FITS, round((fit_s + predict_s) / sum(ours_s))))
    row = {"peer": name, "peer_accuracy": np.mean(predicted == folder.test_labels)}
    row["peer_fit_s"], row["peer_predict_s"] = map(statistics.median, zip(*peer_times))
    row["peer_warnings"] = " ".join(names)
    found, labels = answer
    row["ours"] = " ".join(options[1::2])
    row["our_fit_s"], row["our_predict_s"] = map(statistics.median, zip(*our_times))
    row["our_cold_fit_s"] = statistics.median(cold_s)
    row["fit_ratio"] = row["peer_fit_s"] / row["our_fit_s"]
    row["predict_ratio"] = row["peer_predict_s"] / row["our_predict_s"]
    row["our_accuracy"] = found["accuracy"]
    row["identical_fraction"] = np.mean(labels == predicted)
    if is_same_problem:
        row["peer_dual"], row["our_dual"] = dual_objective(model, folder.train_labels), found["svm"]["dual_objective"]
        row["dual_difference"] = (row["our_dual"] - row["peer_dual"]) / abs(row["peer_dual"])
    return row


def compare_grid(folder, ours, threads, repeats):
    """Compares a 6 × 6 grid of C and γ with 5-fold cross-validation and the final fit with GridSearchCV; returns a list of one row."""
    penalties = [10.0**k for k in range(-1, 5)]
    # Multiples of 'scale', 1 / (m · variance).
    gammas = [4.0**k for k in range(-4, 2)]
    options = ["--classifier", "rbf_svm", *OVO, "--cv-folds", "5"]
    for name, values in [("--c-grid", penalties), ("--gamma-grid", gammas)]:
        options += [name, ",".join(f"{value:g}" for value in values)]
    scale = 1.0 / (folder.train.shape[1] * folder.train.var())
    grid = {"C": penalties, "gamma": [gamma * scale for gamma in gammas]}
    peer_times, our_times = [], []
    with threadpool_limits(threads):
        for _ in range(repeats):
            found, labels = ours.classify(folder, options)
            our_times.append(found["fit_s"][0])
            peer = GridSearchCV(SVC(), grid, cv=5, n_jobs=threads)
            peer_times.append(timed(lambda: peer.fit(folder.train, folder.train_labels))[0])
    row = {"peer": "GridSearchCV(SVC(rbf))", "ours": "6 x 6 grid of C and gamma, 5 folds"}
    row["peer_fit_s"], row["our_fit_s"] = map(statistics.median, [peer_times, our_times])
    row["fit_ratio"] = row["peer_fit_s"] / row["our_fit_s"]
    predicted = peer.predict(folder.test)
    row["peer_accuracy"], row["our_accuracy"] = np.mean(predicted == folder.test_labels), found["accuracy"]
    row["identical_fraction"] = np.mean(labels == predicted)
    return [row]


def show(row):
    def number(key, form):
        return format(row[key], form) if row.get(key) is not None else ""

    print(
        f"{row['threads']:>7} {row['measurements']:>5.0f} {row['noise_std']:>5g} {row['peer']:<22} {row.get('ours', 'none'):<26}"
        f"{number('peer_fit_s', '9.3f'):>9}{number('our_fit_s', '9.3f'):>9}{number('fit_ratio', '8.1f'):>8}"
        f"{number('peer_predict_s', '10.3f'):>10}{number('our_predict_s', '9.4f'):>9}{number('predict_ratio', '8.1f'):>8}"
        f"{number('peer_accuracy', '9.4f'):>9}{number('our_accuracy', '8.4f'):>8}{number('identical_fraction', '10.4f'):>10}"
        f"{number('dual_difference', '+11.1e'):>11}",
        flush=True,
    )


HEADER = (
    f"{'threads':>7} {'m':>5} {'noise':>5} {'peer':<22} {'ours':<26}{'fit s':>9}{'ours':>9}{'ratio':>8}"
    f"{'predict s':>10}{'ours':>9}{'ratio':>8}{'accuracy':>9}{'ours':>8}{'identical':>10}{'dual':>11}"
)


def make_folders(arguments):
    """Writes the features of each configuration with the command, and returns the folders. Existing folders are reused."""
    folders = []
    for number in arguments.configurations:
        path = arguments.work / f"{arguments.study.stem}_configuration_{number}"
        if not (path / "configuration.toml").exists():
            command = [arguments.binary, "features", str(arguments.study), "--configuration", str(number), "--out", str(path)]
            if arguments.objects:
                command += ["--objects", str(arguments.objects)]
            subprocess.run(command, check=True)
        folders.append(path)
    return folders


def parse():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--objects", type=Path, help="a folder of PLY meshes in metres; replaces the study's objects")
    parser.add_argument("--study", type=Path, default=ROOT / "experiments/peers.toml")
    parser.add_argument("--configurations", type=int, nargs="+", default=[0, 1, 2, 9, 10, 11], help="configurations of the study")
    parser.add_argument("--work", type=Path, default=ROOT / "target/peers", help="where the features go")
    parser.add_argument("--binary", default=str(ROOT / "target/release/bubbletouch"))
    parser.add_argument("--train-rows", type=int, default=6000)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--threads", type=int, nargs="+", default=[1, os.cpu_count()])
    parser.add_argument("--only", default="", help="only peers whose names hold this")
    parser.add_argument("--skip", default=None, help="no peers whose names hold this")
    parser.add_argument("--grid", action="store_true", help="only the grid of C and gamma against GridSearchCV")
    parser.add_argument("--out", type=Path, default=ROOT / "results/peers/recognition.csv")
    return parser.parse_args()


def machine():
    """Returns the processor's name, or an empty text if /proc/cpuinfo does not contain it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return ""


def main():
    arguments = parse()
    version = subprocess.run([arguments.binary, "--version"], check=True, capture_output=True, text=True).stdout.split()[-1]
    print(f"bubbletouch {version}, scikit-learn {sklearn.__version__}, NumPy {np.__version__}, SciPy {scipy.__version__}, {machine()}")
    common = {
        "date": datetime.date.today().isoformat(), "machine": machine(), "bubbletouch": version,
        "scikit_learn": sklearn.__version__, "numpy": np.__version__,
    }
    print(HEADER)
    rows, slow = [], {}
    for threads in dict.fromkeys(arguments.threads):
        ours = Ours(arguments.binary, threads, arguments.train_rows)
        for path in make_folders(arguments):
            folder = Folder(path, arguments.train_rows)
            sizes = {"n_train": len(folder.train), "n_test": len(folder.test), "threads": threads}
            for found in measure(folder, ours, threads, arguments, slow):
                rows.append(common | sizes | folder.settings | found)
                show(rows[-1])
                write(arguments.out, rows)
    print(f"{len(rows)} comparisons in {arguments.out}")


def measure(folder, ours, threads, arguments, slow):
    if arguments.grid:
        yield from compare_grid(folder, ours, threads, arguments.repeats)
        return
    for comparison in COMPARISONS:
        is_skipped = arguments.skip is not None and arguments.skip in comparison[0]
        if arguments.only in comparison[0] and not is_skipped:
            yield compare(folder, ours, comparison, threads, arguments.repeats, slow)


def write(path, rows):
    """Writes the rows to a temporary file and renames it, so that no partial table remains."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial")
    with partial.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        table.writerows(rows)
    partial.replace(path)


if __name__ == "__main__":
    main()

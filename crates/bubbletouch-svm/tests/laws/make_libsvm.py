#!/usr/bin/env python3
"""Writes libsvm.json: hard data sets and what LIBSVM makes of them, by scikit-learn 1.9.1 (pip install scikit-learn==1.9.1).

    python make_libsvm.py > libsvm.json

A set is training rows (six significant digits, so that every reader gets the same bits), labels and probes; a case is a set,
a kernel, a C and a way of making many classes of two. LIBSVM keeps kernel values in 32 bits, so its solutions are not exact: `gap`
is the sum over the binary problems of (primal − dual objective) of its coefficients, in 64 bits, and `decision_error` follows
from it. The objective is ½|w|² + C Σ hinge − …: strongly convex in w, so |w − w*|² ≤ 2 gap, and a decision value
w·φ(x) − ρ, where ρ comes from a support vector's margin, is off by at most 2 sqrt(2 gap max K(x, x)) + the violation (tol).
"""

import json
import sys
import warnings

import numpy as np
from sklearn.svm import SVC

N_PROBES = 12
# Where rounding keeps LIBSVM from its tolerance it would not end; such a case counts its capped problems.
MOST_ITERATIONS = 1_000_000


def rounded(array):
    return np.array([[float(f"{value:.6g}") for value in row] for row in array])


def blobs(seed, sizes, n_columns, spread):
    """Classes of these sizes around random centres, `spread` times as wide as the centres are apart."""
    random = np.random.default_rng(seed)
    centres = random.normal(size=(len(sizes), n_columns))
    labels = np.concatenate([np.full(size, label) for label, size in enumerate(sizes)])
    rows = centres[labels] + spread * random.normal(size=(len(labels), n_columns))
    probes = centres[np.arange(N_PROBES) % len(sizes)] + spread * random.normal(size=(N_PROBES, n_columns))
    return rows, labels, probes


def make_sets():
    sets = {}
    rows, labels, probes = sets["overlapping"] = blobs(1, [20, 20, 20], 4, 1.0)
    apart = sets["separable"] = blobs(2, [15, 15, 15], 4, 0.2)
    for exponent in [-6, 6]:
        scale = 10.0**exponent
        sets[f"overlapping, scale 1e{exponent}"] = (rows * scale, labels, probes * scale)
        sets[f"separable, scale 1e{exponent}"] = tuple(part * scale if part.ndim == 2 else part for part in apart)
    mixed = np.array([1e-6, 1e-3, 1.0, 1e6])
    sets["mixed scales"] = (rows * mixed, labels, probes * mixed)
    # The same 30 points under both labels, and 10 points twice under one.
    same, same_labels, _ = blobs(3, [10, 10], 3, 0.5)
    both = np.random.default_rng(4).normal(size=(15, 3))
    sets["opposite duplicates"] = (
        np.concatenate([both, both, same, same]),
        np.concatenate([np.zeros(15, int), np.ones(15, int), same_labels, same_labels]),
        np.concatenate([both[:6], same[7:13]]),
    )
    sets["one row of a class"] = blobs(5, [1, 14, 25], 3, 0.4)
    constant = np.tile([0.0, 7.0], (60, 1))
    sets["constant features"] = (np.hstack([constant, rows]), labels, np.hstack([constant[:N_PROBES], probes]))
    sets["nothing but constants"] = (constant[:9], np.array([0, 0, 0, 1, 1, 1, 2, 2, 2]), constant[:2])
    corners, noise = np.array([[0, 0], [1, 1], [0, 1], [1, 0]]), np.random.default_rng(6).normal(size=(48 + N_PROBES, 2))
    xor = corners[np.arange(48 + N_PROBES) % 4] + 0.15 * noise
    sets["xor"] = (xor[:48], np.arange(48) % 4 // 2, xor[48:])
    for n_classes in [2, 10, 43, 100]:
        sets[f"{n_classes} classes"] = blobs(n_classes, [3] * n_classes, 6, 0.5)
    return {name: (rounded(rows), labels, rounded(probes)) for name, (rows, labels, probes) in sets.items()}


def kernel_matrix(kernel, gamma, a, b):
    if kernel == "linear":
        return a @ b.T
    if kernel == "poly":
        return (gamma * (a @ b.T) + 1.0) ** 3
    return np.exp(-gamma * ((a[:, None, :] - b[None, :, :]) ** 2).sum(axis=2))


class Binary:
    """One binary problem by LIBSVM: label 0 of scikit-learn is the negative side, so the positive rows get label 1."""

    def __init__(self, rows, is_positive, probes, kernel, gamma, c, tolerance):
        # scikit-learn keeps LIBSVM's order of the classes and turns signs: positive is label 1.
        model = SVC(kernel=kernel, gamma=gamma, coef0=1.0, degree=3, C=c, tol=tolerance, cache_size=500, max_iter=MOST_ITERATIONS)
        model.fit(rows, is_positive.astype(int))
        self.is_capped = model.fit_status_ != 0
        matrix = kernel_matrix(kernel, gamma, rows, rows)
        y = np.where(is_positive, 1.0, -1.0)
        coefficients = np.zeros(len(rows))
        coefficients[model.support_] = model.dual_coef_[0]
        values = matrix @ coefficients + model.intercept_[0]
        half = 0.5 * coefficients @ matrix @ coefficients
        self.dual = half - np.abs(coefficients).sum()
        self.gap = half + c * np.maximum(0.0, 1.0 - y * values).sum() + self.dual
        largest = max(np.diag(matrix).max(), np.diag(kernel_matrix(kernel, gamma, probes, probes)).max())
        self.error = 2.0 * np.sqrt(2.0 * max(self.gap, 0.0) * largest) + tolerance
        # In 64 bits from LIBSVM's coefficients.
        self.decision = kernel_matrix(kernel, gamma, probes, rows) @ coefficients + model.intercept_[0]


def one_vs_one(rows, labels, probes, *options):
    classes = np.unique(labels)
    problems, votes = [], np.zeros((len(probes), len(classes)))
    for i, a in enumerate(classes):
        for j, b in enumerate(classes[i + 1:], i + 1):
            used = (labels == a) | (labels == b)
            problem = Binary(rows[used], labels[used] == a, probes, *options)
            problems.append(problem)
            # LIBSVM's vote: above 0 for the first class, else for the second; the first maximum wins.
            votes[np.arange(len(probes)), np.where(problem.decision > 0.0, i, j)] += 1
    return problems, classes[votes.argmax(axis=1)]


def one_vs_rest(rows, labels, probes, *options):
    classes = np.unique(labels)
    problems = [Binary(rows, labels == a, probes, *options) for a in classes]
    return problems, classes[np.array([problem.decision for problem in problems]).argmax(axis=0)]


def make_case(sets, name, kernel, c, multiclass="one_vs_one"):
    rows, labels, probes = sets[name]
    variance = rows.shape[1] * rows.var()
    gamma = 1.0 / variance if variance > 0.0 else 1.0
    # Large C and large features: LIBSVM's 32 bits keep it from a finer one.
    tolerance = 1e-6 if c <= 10.0 and np.abs(rows).max() < 1e4 else 1e-3
    make = one_vs_one if multiclass == "one_vs_one" else one_vs_rest
    problems, predicted = make(rows, labels, probes, kernel, gamma, c, tolerance)
    case = {
        "set": name, "kernel": kernel, "gamma": gamma, "c": c, "multiclass": multiclass, "tolerance": tolerance,
        "dual": sum(p.dual for p in problems), "gap": sum(max(p.gap, 0.0) for p in problems),
        "decision_error": max(p.error for p in problems), "n_capped": sum(p.is_capped for p in problems),
        "labels": [int(label) for label in predicted],
    }
    largest = np.abs([p.decision for p in problems]).max()
    # A bound as large as the values says nothing about them.
    if len(problems) <= 45 and case["decision_error"] < 0.05 * max(largest, 1.0):
        case["decision"] = [[float(f"{value:.9g}") for value in row] for row in np.array([p.decision for p in problems]).T]
    print(
        f"{name:<22}{kernel:<8}C {c:<8g}{multiclass:<12} dual {case['dual']:<14.8g} gap {case['gap'] / max(abs(case['dual']), 1e-300):.1e}"
        f" error {case['decision_error']:.1e} of {largest:.1e} capped {case['n_capped']}",
        file=sys.stderr, flush=True,
    )
    return case


def main():
    warnings.simplefilter("ignore")
    sets = make_sets()
    plan = []
    for kernel in ["linear", "rbf", "poly"]:
        plan += [("overlapping", kernel, c) for c in [1e-6, 1e-3, 1.0, 1e3, 1e6]]
        plan += [("separable", kernel, c) for c in [1e-6, 1.0, 1e6]]
        plan += [(name, kernel, 1.0) for name in sets if name not in ("overlapping", "separable", "overlapping, scale 1e6")]
        if kernel != "linear":
            plan += [("overlapping, scale 1e6", kernel, 1.0)]
        plan += [("xor", kernel, 100.0), ("opposite duplicates", kernel, 100.0)]
        plan += [(name, kernel, 1.0, "one_vs_rest") for name in ("overlapping", "xor", "one row of a class", "10 classes")]
        plan += [(name, kernel, 1.0, "one_vs_rest") for name in ("constant features", "43 classes")]
    cases = [make_case(sets, *entry) for entry in plan]
    named = {
        name: {"rows": rows.tolist(), "labels": labels.tolist(), "probes": probes.tolist()}
        for name, (rows, labels, probes) in sets.items()
    }
    json.dump({"sets": named, "cases": cases}, sys.stdout)
    print()


if __name__ == "__main__":
    main()

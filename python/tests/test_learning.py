"""Tests of the SVM estimators."""

from __future__ import annotations

import pickle
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("sklearn")
from bubbletouch import _core
from bubbletouch.learning import SVC, GridSearch, LinearSVC
from numpy.typing import NDArray
from sklearn import svm
from sklearn.datasets import make_classification
from sklearn.exceptions import ConvergenceWarning
from sklearn.model_selection import GroupKFold, cross_val_score
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.utils.estimator_checks import parametrize_with_checks

from conftest import refused

# The small, unscaled data of scikit-learn's checks causes this warning.
pytestmark = pytest.mark.filterwarnings("ignore:.*stopped at max_iter = 1000")

# Checks that are expected to fail.
FAILING: dict[str, str] = {"check_class_weight_classifiers": "class_weight is None or balanced, not a dict"}


@parametrize_with_checks(
    [
        SVC(),
        SVC(kernel="linear", multi_class="ovr"),
        LinearSVC(),
        GridSearch(cv=2, C=[1.0, 10.0], gamma_scales=[1.0]),
    ],
    expected_failed_checks=lambda _: FAILING,
)
def test_scikit_learns_checks(estimator, check) -> None:  # type: ignore[no-untyped-def]
    check(estimator)


@pytest.fixture(scope="module")
def data() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    features, labels = make_classification(
        600, 20, n_informative=8, n_classes=4, class_sep=1.2, random_state=3
    )
    return StandardScaler().fit_transform(features), labels


@pytest.mark.parametrize("kernel", ["linear", "rbf", "poly"])
def test_it_finds_what_libsvm_finds(data, kernel: str) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    ours = SVC(kernel=kernel, tol=1e-6).fit(features[:400], labels[:400])
    theirs = svm.SVC(kernel=kernel, tol=1e-6, decision_function_shape="ovo")
    theirs.fit(features[:400], labels[:400])
    expected = theirs.decision_function(features[400:])
    np.testing.assert_allclose(ours.decision_values(features[400:]), expected, atol=2e-4)
    np.testing.assert_array_equal(ours.predict(features[400:]), theirs.predict(features[400:]))
    np.testing.assert_array_equal(ours.support_, np.sort(theirs.support_))
    np.testing.assert_array_equal(ours.n_support_, theirs.n_support_)
    theirs.decision_function_shape = "ovr"
    np.testing.assert_allclose(
        ours.decision_function(features[400:]), theirs.decision_function(features[400:]), atol=2e-4
    )


def test_the_linear_one_finds_what_liblinear_finds(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    ours = LinearSVC(tol=1e-6, max_iter=100_000).fit(features, labels)
    theirs = svm.LinearSVC(loss="hinge", tol=1e-8, max_iter=1_000_000).fit(features, labels)
    np.testing.assert_allclose(ours.coef_, theirs.coef_, atol=1e-3)
    np.testing.assert_allclose(ours.intercept_, theirs.intercept_, atol=1e-3)


def test_balanced_classes_have_the_weights_of_scikit_learn(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    # 4 classes of unequal size; two of them for LinearSVC, whose rows of other classes have another weight in LIBLINEAR.
    kept = np.arange(600) % (labels + 1) == 0
    features, labels, rest = features[kept], labels[kept], features[~kept]
    assert len(set(np.bincount(labels))) == 4
    for kernel in ("linear", "rbf"):
        keys = {"kernel": kernel, "tol": 1e-6, "class_weight": "balanced"}
        ours = SVC(**keys).fit(features, labels)
        theirs = svm.SVC(**keys, decision_function_shape="ovo").fit(features, labels)
        np.testing.assert_allclose(ours.decision_values(rest), theirs.decision_function(rest), atol=2e-4)
        assert not np.allclose(ours.decision_values(rest), SVC(kernel=kernel).fit(features, labels).decision_values(rest), atol=1e-2)
        again = pickle.loads(pickle.dumps(ours))
        np.testing.assert_array_equal(again.decision_values(rest), ours.decision_values(rest))
    two = labels % 3 == 0
    features, labels = features[two], labels[two]
    ours = LinearSVC(tol=1e-8, max_iter=100_000, class_weight="balanced").fit(features, labels)
    theirs = svm.LinearSVC(loss="hinge", tol=1e-8, max_iter=1_000_000, class_weight="balanced").fit(features, labels)
    np.testing.assert_allclose(ours.decision_function(rest), theirs.decision_function(rest), atol=1e-4)
    for estimator in (SVC(class_weight="even"), LinearSVC(class_weight="even")):
        refused("class_weight: `even`; None or balanced", lambda: estimator.fit(features, labels))


def test_names_are_classes_too(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    names = np.array(["mug", "bowl", "drill", "ball"])[labels]
    for estimator in (SVC(), LinearSVC()):
        predicted = estimator.fit(features, names).predict(features)
        assert set(predicted) <= set(names) and (predicted == names).mean() > 0.7


@pytest.mark.parametrize("estimator", [SVC(), SVC(kernel="linear"), LinearSVC(), GridSearch(cv=3)])
def test_what_is_unpickled_predicts_the_same_bits(data, estimator) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    estimator.fit(features[:300], labels[:300])
    again = pickle.loads(pickle.dumps(estimator))
    np.testing.assert_array_equal(
        again.decision_function(features), estimator.decision_function(features)
    )


def test_groups_are_kept_together(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    groups = np.arange(600) // 10
    search = GridSearch(SVC(), C=[0.1, 1, 10], gamma_scales=np.array([0.5, 1]), cv=GroupKFold(5))
    search.fit(features, labels, groups=groups)
    assert len(search.results_) == 6
    best = SVC(**search.best_params_)
    scores = cross_val_score(best, features, labels, groups=groups, cv=GroupKFold(5))
    assert search.best_score_ == pytest.approx(scores.mean(), abs=0.02)
    assert search.best_score_ == max(one["accuracy"] for one in search.results_)
    piped = make_pipeline(StandardScaler(), search).fit(features, labels, gridsearch__groups=groups)
    assert piped.score(features, labels) > 0.7


def test_the_score_is_the_mean_over_folds_of_any_size(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    # Rows that are repeated, as in a bootstrap, are trained on repeatedly.
    drawn = np.random.default_rng(1).integers(300, size=400)
    folds = [(np.arange(100, 600), np.arange(20)), (np.arange(400), np.arange(400, 600)), (drawn, np.arange(300, 600))]
    search = GridSearch(SVC(gamma=0.05, tol=1e-6), C=[0.01, 1.0], cv=folds).fit(features, labels)
    for one in search.results_:
        theirs = svm.SVC(gamma=0.05, tol=1e-6, C=one["C"])
        assert one["accuracy"] == pytest.approx(cross_val_score(theirs, features, labels, cv=folds).mean(), abs=1e-9)


def test_a_solver_that_stops_early_says_so(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    with pytest.warns(ConvergenceWarning, match="stopped at max_iter = 1 before"):
        capped = LinearSVC(max_iter=1, tol=1e-9).fit(features, labels)
    assert capped.n_capped_ > 0


@pytest.mark.parametrize(
    ("estimator", "said"),
    [
        (SVC(C=-1), "C: -1"),
        (SVC(C=float("nan")), "C: NaN"),
        (SVC(gamma=0), "gamma"),
        (SVC(gamma="wide"), "gamma: `wide`; scale, auto or a number above 0"),
        (SVC(kernel="sigmoid"), "kernel: `sigmoid`; linear, poly or rbf"),
        (SVC(multi_class="all"), "multi_class: `all`; ovo or ovr"),
        (SVC(tol=0), "tol: 0; a finite number above 0"),
        (SVC(gamma=float("nan")), "gamma: NaN; a finite number above 0"),
        (SVC(coef0=float("inf")), "coef0: inf; a finite number"),
        (SVC(kernel="poly", degree=2.7), "degree: 2.7; a whole number"),
        (SVC(kernel="poly", degree=0), "degree: 0; a whole number from 1 to 20"),
        (SVC(max_memory=1.5), "max_memory: 1.5; a whole number"),
        (LinearSVC(max_iter=1.5), "max_iter: 1.5; a whole number, at least 1"),
        (LinearSVC(max_iter=float("nan")), "max_iter: NaN; a whole number"),
        (LinearSVC(random_state=1.5), "random_state: 1.5; a whole number, at least 0"),
        (LinearSVC(random_state=-1), "random_state: -1; at least 0"),
        (LinearSVC(tol=float("inf")), "tol: inf; a finite number above 0"),
        (GridSearch(gamma_scales=[1.0, 0.0]), "gamma_scales: 0"),
        (GridSearch(C=[1.0, float("nan")]), "C: NaN; a finite number above 0"),
        (GridSearch(cv=[([0.5, 1.0], [2, 3])]), "cv, fold 1, train: .*; numbers below 600, or a mask of 600 rows"),
        (GridSearch(cv=[([0, 1], np.ones(599, bool))]), "cv, fold 1, test: .*; numbers below 600, or a mask of 600 rows"),
        (LinearSVC(C=0), "C: 0"),
        (LinearSVC(max_iter=-3), "max_iter: -3; at least 1"),
        (SVC(class_weight=np.ones(3)), r"class_weight: `\[1. 1. 1.\]`; None or balanced"),
        (GridSearch(C=-1.0), "C: -1"),
        (GridSearch(C=[]), "C"),
        (GridSearch(cv=[([0, 1], [10_000])]), "10000"),
    ],
)
def test_what_cannot_be_trained_is_refused(data, estimator, said: str) -> None:  # type: ignore[no-untyped-def]
    refused(said, lambda: estimator.fit(*data))


@pytest.mark.parametrize(
    ("estimator", "said"),
    [
        (SVC(C="1"), "C: '1'; a finite number above 0"),
        (SVC(degree="3"), "degree: '3'; a whole number"),
        (SVC(tol=True), "tol: True; a finite number above 0"),
        (LinearSVC(max_iter=None), "max_iter: None; a whole number, at least 1"),
        (GridSearch(LinearSVC()), r"estimator: LinearSVC\(\); an SVC of bubbletouch.learning"),
    ],
)
def test_what_is_no_number_is_a_type_error(data, estimator, said: str) -> None:  # type: ignore[no-untyped-def]
    refused(said, lambda: estimator.fit(*data), TypeError)


def test_masks_and_negative_numbers_of_rows_are_folds_as_numbers_are(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    mask = np.random.default_rng(5).random(600) < 0.7
    train, test = np.flatnonzero(mask), np.flatnonzero(~mask)
    expected = GridSearch(cv=[(train, test)]).fit(features, labels)
    for folds in ([(mask, ~mask)], [(mask.tolist(), (~mask).tolist())], [(train - 600, test)]):
        found = GridSearch(cv=folds).fit(features, labels)
        assert found.results_ == expected.results_
    assert len({one["accuracy"] for one in expected.results_}) > 1


def test_what_is_fitted_does_not_follow_later_parameters(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    fitted = SVC().fit(features, labels)
    before = fitted.decision_function(features), fitted.predict(features)
    fitted.set_params(multi_class="ovr", C=1e-3, kernel="linear", gamma=9.0, degree=9, coef0=9.0, tol=0.5, max_memory=1)
    np.testing.assert_array_equal(fitted.decision_function(features), before[0])
    np.testing.assert_array_equal(fitted.predict(features), before[1])
    linear = LinearSVC().fit(features, labels)
    scores = linear.decision_function(features)
    linear.set_params(C=1e-3, tol=0.5, max_iter=1, random_state=9)
    np.testing.assert_array_equal(linear.decision_function(features), scores)
    search = GridSearch(SVC(), cv=3, C=[1.0, 10.0]).fit(features, labels)
    chosen = search.decision_function(features)
    search.set_params(cv=2, C=[1e-3], estimator__multi_class="ovr", gamma_scales=[9.0])
    np.testing.assert_array_equal(search.decision_function(features), chosen)
    # A fit that fails leaves the model and its classes.
    with pytest.raises(ValueError, match="C: -1"):
        linear.set_params(C=-1).fit(features[labels < 2], np.array(["a", "b"])[labels[labels < 2]])
    np.testing.assert_array_equal(linear.predict(features), scores.argmax(axis=1))


def test_a_float_without_a_fraction_is_a_whole_number(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    one = LinearSVC(max_iter=np.float64(200), random_state=3.0).fit(features, labels)
    other = LinearSVC(max_iter=200, random_state=np.int64(3)).fit(features, labels)
    np.testing.assert_array_equal(one.coef_, other.coef_)


def test_the_core_refuses_what_the_estimators_would(data) -> None:  # type: ignore[no-untyped-def]
    features, labels = data
    params = SVC()._params(20)
    refused("labels: 599 labels; one for each of the 600 rows", lambda: _core.KernelSvm.train(features, labels[1:], params))
    with pytest.raises(ValueError, match="features, row 2, column 1: NaN"):
        spoilt = features.copy()
        spoilt[2, 1] = np.nan
        _core.KernelSvm.train(spoilt, labels, params)
    refused("labels: -1; whole numbers from 0", lambda: _core.KernelSvm.train(features, labels - 1, params))
    model = _core.KernelSvm.train(features, labels, params)
    refused("features: 19 columns; the 20 columns of training", lambda: model.labels(features[:, 1:]))


def test_without_scikit_learn_they_fit_and_predict() -> None:
    program = """
import sys
sys.modules["sklearn"] = None
import numpy as np, pickle
from bubbletouch.learning import SVC, LinearSVC, GridSearch, NotFittedError
random = np.random.default_rng(0)
labels = np.repeat(["a", "b", "c"], 40)
features = random.normal(size=(120, 5)) + np.repeat(np.eye(3, 5) * 4, 40, axis=0)
for estimator in (SVC(), LinearSVC(), GridSearch(cv=4)):
    try:
        estimator.predict(features)
    except NotFittedError:
        pass
    else:
        raise AssertionError
    assert estimator.fit(features, labels).score(features, labels) > 0.9
    assert (pickle.loads(pickle.dumps(estimator)).predict(features) == estimator.predict(features)).all()
    for bad in (features[:, 1:], features[0], features * np.nan):
        try:
            estimator.predict(bad)
        except ValueError:
            pass
        else:
            raise AssertionError
assert SVC(C=3).get_params()["C"] == 3 and SVC().set_params(C=4).C == 4
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)

"""Soft-margin support vector machines with the interface of scikit-learn's estimators.

If scikit-learn is installed (`pip install 'bubbletouch[learning]'`), the classes are scikit-learn estimators and work in its pipelines, searches
and scores. Without scikit-learn they can be trained, used for prediction and pickled. Features should have similar scales: apply StandardScaler
first.

Differences from scikit-learn: there are no sample weights, and `class_weight` is None or "balanced". `SVC` needs 4 · n_rows² to 8 · n_rows² bytes, at most `max_memory`; with less
memory, training is slower. Pickling a trained model stores its training rows; unpickling trains the model again. The unpickled model is bitwise
equal, and unpickling takes as long as training.
"""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bubbletouch import _core
from bubbletouch._numbers import real, whole

try:
    from sklearn.base import BaseEstimator, ClassifierMixin
    from sklearn.exceptions import ConvergenceWarning, NotFittedError
    from sklearn.model_selection import check_cv
    from sklearn.utils.multiclass import check_classification_targets
    from sklearn.utils.validation import check_is_fitted, validate_data
except ImportError:
    from bubbletouch._without_sklearn import (
        BaseEstimator,
        ClassifierMixin,
        ConvergenceWarning,
        NotFittedError,
        check_classification_targets,
        check_cv,
        check_is_fitted,
        validate_data,
    )

__all__ = ["SVC", "GridSearch", "LinearSVC", "NotFittedError"]

Floats = NDArray[np.float64]


class _Classifier(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Common base class of the estimators; it maps classes of any type to the labels 0, 1, … of the library."""

    classes_: NDArray[Any]
    _model: _core.KernelSvm | _core.LinearModel

    def _numbered(self, X: ArrayLike, y: ArrayLike) -> tuple[Floats, NDArray[np.int64], NDArray[Any]]:
        """Checks the training data. Returns the features (n, m), the class numbers (n,) from 0, and the classes, which are set after training."""
        features, labels = validate_data(self, X, y, dtype=np.float64, order="C")
        check_classification_targets(labels)
        classes, numbers = np.unique(labels, return_inverse=True)
        if len(classes) < 2:
            raise ValueError(f"labels: 1 class ({classes[0]}); at least two classes")
        return features, numbers, classes

    def _features(self, X: ArrayLike) -> Floats:
        """Returns the checked features (n, m) of a prediction. Raises NotFittedError before fit()."""
        check_is_fitted(self)
        return cast(Floats, validate_data(self, X, dtype=np.float64, order="C", reset=False))

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """Returns the predicted classes (n,) of features (n, m)."""
        features = self._features(X)
        return self.classes_[self._model.labels(features)]

    def _warn_of(self, n_capped: int, limit: str) -> None:
        """Issues a ConvergenceWarning if binary problems stopped at an iteration limit."""
        if n_capped:
            said = f"{n_capped} problems stopped at {limit} before they converged"
            warnings.warn(said, ConvergenceWarning, stacklevel=3)


def _is_balanced(class_weight: str | None) -> bool:
    """Returns whether the classes have balanced weights. Raises ValueError for other weights."""
    if class_weight is not None and (not isinstance(class_weight, str) or class_weight != "balanced"):
        raise ValueError(f"class_weight: `{class_weight}`; None or balanced")
    return class_weight is not None


class SVC(_Classifier):
    """Support vector machine with a kernel.

    C: penalty per unit of margin violation, above 0.
    kernel: rbf, linear or poly (with `degree` and `coef0`).
    gamma: "scale" (1 / (n_features · var X)), "auto" (1 / n_features) or a number above 0.
    tol: allowed violation of the optimality conditions, in units of the decision value, above 0.
    class_weight: "balanced" multiplies C for each row by n_rows / (n_classes · number of rows of its class), as in scikit-learn. Default: None.
    multi_class: "ovo" (one-vs-one: each pair of classes votes; the lowest class wins a tie, as in LIBSVM) or "ovr" (one-vs-rest).
    max_memory: maximum size of the stored kernel values, bytes.

    Attributes after fit: classes_, n_features_in_, support_ (indices of the support vectors in the training rows), n_support_ (number of support
    vectors per class), problems_ (each binary problem and its solution), n_capped_ (number of problems that stopped at the iteration cap).
    """

    _model: _core.KernelSvm
    problems_: list[dict[str, Any]]
    support_: NDArray[np.int64]
    n_support_: NDArray[np.int64]
    n_capped_: int

    def __init__(
        self,
        C: float = 1.0,
        *,
        kernel: str = "rbf",
        degree: int = 3,
        gamma: str | float = "scale",
        coef0: float = 0.0,
        tol: float = 1e-3,
        class_weight: str | None = None,
        multi_class: str = "ovo",
        max_memory: int = 2 << 30,
    ) -> None:
        self.C = C
        self.kernel = kernel
        self.degree = degree
        self.gamma = gamma
        self.coef0 = coef0
        self.tol = tol
        self.class_weight = class_weight
        self.multi_class = multi_class
        self.max_memory = max_memory

    def _params(self, n_features: int) -> dict[str, Any]:
        """Returns the checked parameters for the library. Raises TypeError and ValueError for invalid parameters."""
        match self.gamma:
            case "scale":
                gamma = None
            case "auto":
                gamma = 1.0 / n_features
            case str():
                raise ValueError(f"gamma: `{self.gamma}`; scale, auto or a number above 0")
            case number:
                gamma = real("gamma", number, above=0)
        return {
            "kernel": self.kernel,
            "gamma": gamma,
            "coef0": real("coef0", self.coef0),
            "degree": whole("degree", self.degree, least=1, most=20),
            "c": real("C", self.C, above=0),
            "tolerance": real("tol", self.tol, above=0),
            "multiclass": self.multi_class,
            "is_balanced": _is_balanced(self.class_weight),
            "memory_bytes": whole("max_memory", self.max_memory, least=0),
        }

    def fit(self, X: ArrayLike, y: ArrayLike) -> SVC:
        """Trains on features (n, m) and labels (n,), and returns the estimator. Ctrl-C raises KeyboardInterrupt at once; the training thread ends
        later.
        """
        features, numbers, classes = self._numbered(X, y)
        self._model = _core.KernelSvm.train(features, numbers, self._params(features.shape[1]))
        self.classes_ = classes
        self.problems_ = self._model.problems
        support = [p["rows"][p["coefficients"] != 0] for p in self.problems_]
        self.support_ = np.unique(np.concatenate(support))
        self.n_support_ = np.bincount(numbers[self.support_], minlength=len(self.classes_))
        self.n_capped_ = self._model.n_capped
        self._warn_of(self.n_capped_, "the iteration cap")
        return self

    def decision_values(self, X: ArrayLike) -> Floats:
        """Returns the decision values (n, n_problems) of features (n, m). Positive values favour the first class of a binary problem. Sums over
        several touches are comparable, too.
        """
        features = self._features(X)
        return self._model.decision_values(features)

    def decision_function(self, X: ArrayLike) -> Floats:
        """Returns scores of features (n, m).

        For two classes, the scores are (n,); positive scores favour the second class. Otherwise the scores are (n, n_classes); the largest score
        belongs to the predicted class, except for ties. For one-vs-one, a score is the number of votes plus a term between −1/3 and 1/3 that
        increases with the sum of the decision values of the class.
        """
        values = self.decision_values(X)
        if len(self.classes_) == 2:
            return -values[:, 0] if values.shape[1] == 1 else (values[:, 1] - values[:, 0]) / 2
        return self._model.class_scores(values)


class LinearSVC(_Classifier):
    """Linear support vector machine without a kernel matrix, trained by dual coordinate descent. Several classes are trained one-vs-rest.

    C: penalty per unit of margin violation (hinge loss), above 0.
    tol: spread of the projected gradients at which the solver stops, above 0.
    class_weight: "balanced" multiplies C for each row by n_rows / (n_classes · number of rows of its class). With three or more classes, scikit-learn
    differs: rows of the other classes have the weight 1 there. Default: None.
    max_iter: maximum number of passes over the rows, at least 1.
    random_state: seed of the order in which rows are visited. Default: 0.

    The intercept is regularised together with the weights, as in LIBLINEAR; the features should therefore be centred.

    Attributes after fit: classes_, n_features_in_, coef_ (n_classes, m; for two classes (1, m)), intercept_, n_iter_, n_capped_ (number of problems
    that stopped at max_iter).
    """

    _model: _core.LinearModel
    coef_: Floats
    intercept_: Floats
    n_iter_: int
    n_capped_: int

    def __init__(
        self,
        C: float = 1.0,
        *,
        tol: float = 1e-3,
        class_weight: str | None = None,
        max_iter: int = 1000,
        random_state: int | None = None,
    ) -> None:
        self.C = C
        self.tol = tol
        self.class_weight = class_weight
        self.max_iter = max_iter
        self.random_state = random_state

    def fit(self, X: ArrayLike, y: ArrayLike) -> LinearSVC:
        """Trains on features (n, m) and labels (n,), and returns the estimator. Ctrl-C raises KeyboardInterrupt at once; the training thread ends
        later.
        """
        features, numbers, classes = self._numbered(X, y)
        params = {
            "c": real("C", self.C, above=0),
            "tolerance": real("tol", self.tol, above=0),
            "is_balanced": _is_balanced(self.class_weight),
            "max_passes": whole("max_iter", self.max_iter, least=1),
            "seed": 0 if self.random_state is None else whole("random_state", self.random_state, least=0),
        }
        self._model = _core.LinearModel.train(features, numbers, params)
        self.classes_ = classes
        self.coef_, self.intercept_ = self._model.weights, self._model.bias
        if len(self.classes_) == 2:
            self.coef_ = (self.coef_[1:] - self.coef_[:1]) / 2
            self.intercept_ = (self.intercept_[1:] - self.intercept_[:1]) / 2
        self.n_iter_ = max(1, self._model.n_passes)
        self.n_capped_ = self._model.n_capped
        self._warn_of(self.n_capped_, f"max_iter = {self.max_iter}")
        return self

    def decision_function(self, X: ArrayLike) -> Floats:
        """Returns scores of features (n, m).

        For two classes, the scores are (n,); positive scores favour the second class. Otherwise the scores are (n, n_classes); the largest score
        belongs to the predicted class.
        """
        features = self._features(X)
        scores = self._model.scores(features)
        return (scores[:, 1] - scores[:, 0]) / 2 if len(self.classes_) == 2 else scores


class GridSearch(_Classifier):
    """Cross-validated choice of C and γ of an SVC, by the accuracy on held-out rows, averaged over the folds as in scikit-learn's GridSearchCV.
    The whole grid shares one matrix of inner products.

    estimator: SVC whose other parameters are used. Default: SVC().
    C: candidate values, each above 0.
    gamma_scales: candidate values of γ as multiples of the "scale" value. Default: the γ of the estimator.
    cv: number of folds, splitter of scikit-learn, or pairs of arrays of training and test rows (row indices, or masks of all rows). Splitters that
    support groups keep rows of one group together (argument `groups` of fit()).

    If accuracies are equal, the smaller γ is chosen, then the smaller C.

    Attributes after fit: best_params_ (C and gamma), best_score_, results_ (C, gamma and mean accuracy of each candidate), best_estimator_
    (trained on all rows).
    """

    results_: list[dict[str, Any]]
    best_score_: float
    best_params_: dict[str, Any]
    best_estimator_: SVC

    def __init__(
        self,
        estimator: SVC | None = None,
        *,
        C: Sequence[float] = (0.1, 1.0, 10.0, 100.0),
        gamma_scales: Sequence[float] | None = None,
        cv: Any = 5,
    ) -> None:
        self.estimator = estimator
        self.C = C
        self.gamma_scales = gamma_scales
        self.cv = cv

    def fit(self, X: ArrayLike, y: ArrayLike, groups: ArrayLike | None = None) -> GridSearch:
        """Chooses C and γ on features (n, m) and labels (n,), trains best_estimator_ on all rows, and returns the GridSearch."""
        features, numbers, classes = self._numbered(X, y)
        estimator = SVC() if self.estimator is None else self.estimator
        if not isinstance(estimator, SVC):
            raise TypeError(f"estimator: {estimator!r}; an SVC of bubbletouch.learning")
        split = cast(
            "Callable[..., Iterable[tuple[NDArray[Any], NDArray[Any]]]]",
            check_cv(self.cv, numbers, classifier=True).split,
        )
        n_rows = len(features)
        folds = [
            (_row_numbers(f"cv, fold {fold}, train", train, n_rows), _row_numbers(f"cv, fold {fold}, test", test, n_rows))
            for fold, (train, test) in enumerate(split(features, numbers, groups), start=1)
        ]
        params = estimator._params(features.shape[1])
        scales = [real("gamma_scales", scale, above=0) for scale in np.ravel([] if self.gamma_scales is None else self.gamma_scales).tolist()]
        candidates = [real("C", c, above=0) for c in np.ravel(self.C).tolist()]
        chosen = _core.choose_svm(features, numbers, params, folds, candidates, scales)
        self.classes_ = classes
        self.results_ = [dict(zip(("C", "gamma", "accuracy"), one, strict=True)) for one in chosen["tried"]]
        self.best_score_ = chosen["accuracy"]
        self.best_params_ = {"C": chosen["C"]}
        if chosen["gamma"] is not None:
            self.best_params_["gamma"] = chosen["gamma"]
        own = {name: getattr(estimator, name) for name in _SVC_NAMES} | self.best_params_
        self.best_estimator_ = SVC(**own).fit(features, np.asarray(y))
        return self

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """Returns the predicted classes (n,) of features (n, m)."""
        features = self._features(X)
        return self.best_estimator_.predict(features)

    def decision_function(self, X: ArrayLike) -> Floats:
        """Returns the decision function of best_estimator_ on features (n, m); see SVC.decision_function."""
        features = self._features(X)
        return self.best_estimator_.decision_function(features)


def _row_numbers(name: str, rows: ArrayLike, n_rows: int) -> NDArray[np.int64]:
    """Returns the row indices of a fold, as int64. The input is an array of row indices (negative indices count from the end) or a mask of all rows."""
    given = np.asarray(rows)
    if given.ndim != 1:
        raise ValueError(f"{name}: shape {given.shape}; (n,) numbers of rows, or a mask of {n_rows} rows")
    try:
        chosen: NDArray[np.int64] = np.arange(n_rows)[given.astype(np.int64) if given.size == 0 else given]
    except IndexError as error:
        raise ValueError(f"{name}: {error}; numbers below {n_rows}, or a mask of {n_rows} rows") from None
    return chosen


_SVC_NAMES = tuple(inspect.signature(SVC).parameters)

"""Replacements for the parts of scikit-learn that bubbletouch.learning uses, for installations without scikit-learn."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


class NotFittedError(ValueError, AttributeError):
    """Error raised if an estimator is used before fit()."""


class ConvergenceWarning(UserWarning):
    """Warning that a solver stopped at a limit before it converged."""


class BaseEstimator:
    """Base class of estimators. The parameters of an estimator are the arguments of its __init__."""

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Returns all parameters as a dict by name; `deep` is ignored."""
        return {name: getattr(self, name) for name in inspect.signature(type(self)).parameters}

    def set_params(self, **params: Any) -> BaseEstimator:
        """Sets parameters by name, and returns the estimator. Raises ValueError if a parameter does not exist."""
        known = self.get_params()
        for name, value in params.items():
            if name not in known:
                raise ValueError(f"parameter: `{name}`; {', '.join(known)}")
            setattr(self, name, value)
        return self


class ClassifierMixin:
    """Mixin class for classifiers; score() returns the accuracy."""

    def score(self, X: ArrayLike, y: ArrayLike) -> float:
        """Returns the accuracy on features X (n, m) and labels y (n,): the fraction of rows whose class is predicted correctly, 0 to 1."""
        return float(np.mean(self.predict(X) == np.asarray(y)))  # type: ignore[attr-defined]


def validate_data(
    estimator: Any, X: ArrayLike, y: ArrayLike | None = None, *, reset: bool = True, **of_array: Any
) -> Any:
    """Returns the features (n, m) as an array of finite numbers; if labels y are given, returns the features and the labels (n,).

    If `reset` is true, sets estimator.n_features_in_ to m; otherwise m must equal n_features_in_. `of_array` is passed to numpy.asarray. Raises
    ValueError for a wrong shape and for numbers that are not finite.
    """
    features = np.asarray(X, **of_array)
    if features.ndim != 2 or features.size == 0:
        raise ValueError(f"features: shape {features.shape}; (n_rows, n_features)")
    if not np.isfinite(features).all():
        raise ValueError("features: NaN or infinite; only finite numbers are allowed")
    if reset:
        estimator.n_features_in_ = features.shape[1]
    elif features.shape[1] != estimator.n_features_in_:
        given = f"{features.shape[1]} columns"
        raise ValueError(f"features: {given}; the {estimator.n_features_in_} columns of training")
    if y is None:
        return features
    labels = np.asarray(y)
    if labels.shape != (len(features),):
        raise ValueError(f"labels: shape {labels.shape}; one for each of the {len(features)} rows")
    return features, labels


def check_classification_targets(labels: NDArray[Any]) -> None:
    """Raises ValueError if the labels are numbers with fractional parts."""
    if labels.dtype.kind == "f" and (labels != np.round(labels)).any():
        raise ValueError("labels: numbers with fractions; names or whole numbers")


def check_is_fitted(estimator: Any) -> None:
    """Raises NotFittedError if the estimator is not fitted."""
    if not hasattr(estimator, "classes_"):
        raise NotFittedError(f"this {type(estimator).__name__} is not fitted yet: call fit first")


class _Folds:
    """Cross-validation folds: stratified folds if `cv` is a number of folds, otherwise the given pairs of training and test rows."""

    def __init__(self, cv: Any) -> None:
        self.cv = cv

    def split(
        self, features: NDArray[Any], labels: NDArray[Any], groups: ArrayLike | None = None
    ) -> Iterator[tuple[NDArray[Any], NDArray[Any]]]:
        """Yields the row indices (training, test) of each fold. The rows of each class are distributed evenly over the folds."""
        if not isinstance(self.cv, int):
            yield from self.cv
            return
        if self.cv < 2:
            raise ValueError(f"cv: {self.cv}; at least 2 folds")
        if groups is not None:
            raise ValueError("groups: given to a number of folds; folds as pairs of arrays")
        order = np.argsort(labels, kind="stable")
        fold = np.empty(len(labels), int)
        fold[order] = np.arange(len(labels)) % self.cv
        for number in range(self.cv):
            yield np.flatnonzero(fold != number), np.flatnonzero(fold == number)


def check_cv(cv: int | Iterable[Any], labels: NDArray[Any], *, classifier: bool) -> _Folds:
    """Returns cross-validation folds for a number of folds, or for given pairs of training and test rows. Raises ValueError if `cv` is neither."""
    if not isinstance(cv, int | Iterable):
        raise ValueError(f"cv: {cv!r}; a number of folds, or pairs of arrays of training and test rows")
    return _Folds(cv if isinstance(cv, int) else list(cv))

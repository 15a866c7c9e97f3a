"""What bubbletouch.learning takes from scikit-learn, where that is not installed: as little as fitting and predicting need."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


class NotFittedError(ValueError, AttributeError):
    """Asked of an estimator before fit."""


class ConvergenceWarning(UserWarning):
    """A solver stopped at its limit."""


class BaseEstimator:
    """Parameters are what __init__ takes."""

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """All parameters by name."""
        return {name: getattr(self, name) for name in inspect.signature(type(self)).parameters}

    def set_params(self, **params: Any) -> BaseEstimator:
        """Sets some of them. Raises ValueError for a name that there is not."""
        known = self.get_params()
        for name, value in params.items():
            if name not in known:
                raise ValueError(f"parameter: `{name}`; {', '.join(known)}")
            setattr(self, name, value)
        return self


class ClassifierMixin:
    """Accuracy as score."""

    def score(self, X: ArrayLike, y: ArrayLike) -> float:
        """The share of rows whose class is right."""
        return float(np.mean(self.predict(X) == np.asarray(y)))  # type: ignore[attr-defined]


def validate_data(
    estimator: Any, X: ArrayLike, y: ArrayLike | None = None, *, reset: bool = True, **of_array: Any
) -> Any:
    """Features (n, m) as finite float64, and labels (n,)."""
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
    """Refuses numbers that are no names."""
    if labels.dtype.kind == "f" and (labels != np.round(labels)).any():
        raise ValueError("labels: numbers with fractions; names or whole numbers")


def check_is_fitted(estimator: Any) -> None:
    """Refuses what has no classes yet."""
    if not hasattr(estimator, "classes_"):
        raise NotFittedError(f"this {type(estimator).__name__} is not fitted yet: call fit first")


class _Folds:
    """Each class in turn over the folds; or folds that are given."""

    def __init__(self, cv: Any) -> None:
        self.cv = cv

    def split(
        self, features: NDArray[Any], labels: NDArray[Any], groups: ArrayLike | None = None
    ) -> Iterator[tuple[NDArray[Any], NDArray[Any]]]:
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
    """Folds of a number, or as they are given."""
    if not isinstance(cv, int | Iterable):
        raise ValueError(f"cv: {cv!r}; a number of folds, or pairs of arrays of training and test rows")
    return _Folds(cv if isinstance(cv, int) else list(cv))

"""Classifiers and features of a study whose code is in Python: identities, seeds and processes."""

from __future__ import annotations

import copy
import hashlib
import inspect
import pickle
import random
import re
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from importlib import import_module
from multiprocessing import get_context
from types import CodeType, FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.float64]
Given = tuple[str, str, Any]

# Hexadecimal digits of the version that is derived from code and parameters. With fewer digits, two versions may be equal.
_DIGITS = 12

# One call at a time in this process: the random generators of NumPy and PyTorch are global.
_LOCK = threading.RLock()


def _described(thing: Any, above: tuple[Any, ...] = ()) -> str:
    """Returns a text that depends only on the code and the parameters of an estimator or a function; equal in all processes.

    above: things that contain this thing; a thing that contains itself is described once.
    """
    if any(thing is other for other in above):
        return "itself"
    inside = (*above, thing)
    if isinstance(thing, np.ndarray):
        return f"array {thing.dtype} {thing.shape} {hashlib.sha256(thing.tobytes()).hexdigest()}"
    if isinstance(thing, dict):
        return "{" + ", ".join(f"{key}: {_described(value, inside)}" for key, value in sorted(thing.items(), key=lambda item: str(item[0]))) + "}"
    if isinstance(thing, list | tuple):
        return "[" + ", ".join(_described(item, inside) for item in thing) + "]"
    if isinstance(thing, set | frozenset):
        # The order of a set differs between processes.
        return "{" + ", ".join(sorted(_described(item, inside) for item in thing)) + "}"
    if isinstance(thing, CodeType):
        return f"{thing.co_code.hex()} {_described(thing.co_consts, inside)} {thing.co_names!r} {thing.co_freevars!r}"
    if isinstance(thing, FunctionType):
        return f"{_source(thing)} {_cells(thing, inside)} {_described(thing.__defaults__ or (), inside)}"
    if isinstance(thing, type):
        # A class depends on its bases in the same module, and on the variables around its methods.
        own = [base for base in thing.__mro__ if base.__module__ == thing.__module__ and base is not object]
        cells = [_cells(method, inside) for base in own for method in vars(base).values() if isinstance(method, FunctionType) and method.__closure__]
        bases = " ".join(map(_source, own[1:]))
        return " ".join(filter(None, [f"{thing.__module__}.{thing.__qualname__} {_source(thing)}", bases, *cells]))
    if hasattr(thing, "func") and hasattr(thing, "args"):
        return f"{_described(thing.func, inside)} {_described(thing.args, inside)} {_described(getattr(thing, 'keywords', {}), inside)}"
    if hasattr(thing, "get_params") and not isinstance(thing, type):
        return f"{_described(type(thing), inside)} {_described(thing.get_params(deep=False), inside)}"
    if hasattr(thing, "__dict__") and getattr(type(thing), "__repr__", None) is getattr(object, "__repr__", None):
        return f"{_described(type(thing), inside)} {_described(vars(thing), inside)}"
    # The address of an object differs between processes.
    text = re.sub(r" at 0x[0-9a-fA-F]+", "", repr(thing))
    # The text of a dataclass, for example, contains its fields and not its code.
    return text if type(thing).__module__ == "builtins" else f"{_described(type(thing), inside)} {text}"


def _cells(function: FunctionType, above: tuple[Any, ...]) -> str:
    """Returns a text of the variables around a function, without the class of a method."""
    described = []
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        try:
            described.append("class" if name == "__class__" else _described(cell.cell_contents, above))
        except ValueError:
            described.append("no value")
    return "[" + ", ".join(described) + "]"


def _source(code: Any) -> str:
    """Returns the source text of a function or a class, or its bytecode if there is no source."""
    found = getattr(code, "__code__", None)
    try:
        source = inspect.getsource(code)
    except (OSError, TypeError):
        return f"{code.__qualname__}" if found is None else _described(found)
    # The source of a lambda is the whole line, which may contain several.
    return f"{source} {_described(found)}" if found is not None and found.co_name == "<lambda>" else source


def _named(what: str, given: Mapping[str, Any] | None, is_right: Callable[[Any], bool], allowed: str) -> Iterator[Given]:
    """Yields name, version and object of each given classifier or function."""
    if given is not None and not isinstance(given, Mapping):
        raise ValueError(f"{what}: {type(given).__name__}; a dict of names")
    for name, thing in (given or {}).items():
        version = None
        if isinstance(thing, tuple):
            if len(thing) != 2 or not isinstance(thing[1], str):
                raise ValueError(f"{what} {name}: a tuple of {len(thing)}; ({what}, version) with a text as version")
            thing, version = thing
        if not is_right(thing):
            raise ValueError(f"{what} {name}: {type(thing).__name__}; {allowed}")
        yield str(name), hashlib.sha256(_described(thing).encode()).hexdigest()[:_DIGITS] if version is None else version, thing


@contextmanager
def _seeded(seed: int) -> Iterator[None]:
    """Seeds the global random generators, and restores their states afterwards."""
    torch = sys.modules.get("torch")
    states = random.getstate(), np.random.get_state(), None if torch is None else torch.get_rng_state()
    random.seed(seed)
    np.random.seed(seed)
    if torch is not None:
        torch.manual_seed(seed)
    try:
        yield
    finally:
        random.setstate(states[0])
        np.random.set_state(states[1])
        if torch is not None and states[2] is not None:
            torch.set_rng_state(states[2])


def _fresh(estimator: Any, seed: int) -> Any:
    """Returns an unfitted copy of an estimator. Each `random_state` that is None becomes the seed."""
    if not hasattr(estimator, "get_params"):
        fresh = copy.deepcopy(estimator)
        if getattr(fresh, "random_state", 0) is None:
            fresh.random_state = seed
        return fresh
    try:
        from sklearn.base import clone
    except ImportError:
        fresh = copy.deepcopy(estimator)
    else:
        fresh = clone(estimator)
    unset = {key: seed for key, value in fresh.get_params().items() if key.rpartition("__")[2] == "random_state" and value is None}
    return fresh.set_params(**unset) if unset else fresh


def _fit(estimator: Any, rows: Rows, labels: NDArray[np.int64], seed: int, groups: NDArray[np.int64] | None = None) -> Any:
    with _LOCK, _seeded(seed):
        fresh = _fresh(estimator, seed)
        fresh.fit(rows, labels, **({} if groups is None or not _takes_groups(fresh) else {"groups": groups}))
    return fresh, seed, np.unique(labels)


def _takes_groups(estimator: Any) -> bool:
    """Returns whether `fit` has the argument `groups`, or is a search of scikit-learn, which passes it to its splitter."""
    if "groups" in inspect.signature(estimator.fit).parameters:
        return True
    try:
        from sklearn.model_selection._search import BaseSearchCV
    except ImportError:
        return False
    return isinstance(estimator, BaseSearchCV)


def _predict(model: Any, rows: Rows) -> NDArray[np.int64]:
    fitted, seed, _ = model
    with _LOCK, _seeded(seed):
        labels = np.asarray(fitted.predict(rows))
    if labels.ndim != 1:
        raise ValueError(f"predict returned shape {labels.shape}")
    whole = labels.astype(np.int64)
    if not np.array_equal(whole, labels):
        raise ValueError(f"predict returned {labels.dtype} that is not whole")
    return whole


def _log_probabilities(model: Any, rows: Rows) -> Rows | None:
    fitted, seed, classes = model
    if not hasattr(fitted, "predict_proba") or not np.array_equal(getattr(fitted, "classes_", classes), classes):
        return None
    with _LOCK, _seeded(seed):
        probabilities = np.asarray(fitted.predict_proba(rows), dtype=np.float64)
    with np.errstate(divide="ignore"):
        logarithms: Rows = np.log(probabilities)
    return logarithms


def _compute(function: Callable[[Rows], Any], frames: Rows) -> Rows:
    with _LOCK, _seeded(0):
        given = np.asarray(function(frames))
    if np.iscomplexobj(given):
        raise ValueError(f"the function returned {given.dtype}; real numbers are allowed")
    made = np.ascontiguousarray(given, dtype=np.float64)
    if made.ndim != 2 or len(made) != len(frames) or not made.size:
        raise ValueError(f"the function returned shape {made.shape} for {len(frames)} frames; ({len(frames)}, n_features) is allowed")
    return made


def _pickled(call: bytes) -> bytes:
    """Runs a pickled call in a process of the pool."""
    function, arguments = pickle.loads(call)
    # The classes of the main program are other objects in this process.
    answer: bytes = pickler().dumps(function(*arguments))
    return answer


def pickler() -> Any:
    """Returns cloudpickle, which supports lambdas and classes of notebooks, or pickle if cloudpickle is not installed."""
    try:
        return import_module("cloudpickle")
    except ImportError:
        return pickle


class Host:
    """Calls estimators and functions in this process, one call at a time, or in processes of their own."""

    def __init__(self, processes: int = 0) -> None:
        if processes < 0:
            raise ValueError(f"processes: {processes}; zero or a positive whole number")
        # Forked processes would inherit locked threads.
        self._pool = ProcessPoolExecutor(processes, mp_context=get_context("spawn")) if processes else None

    def call(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Returns the result of a call; bitwise equal in this process and in a process of the pool."""
        if self._pool is None:
            return function(*arguments)
        call = pickler().dumps((function, arguments))
        return pickle.loads(self._pool.submit(_pickled, call).result())

    def close(self) -> None:
        """Ends the processes."""
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)


class Trainer:
    """Estimator as the library calls it."""

    def __init__(self, host: Host, estimator: Any) -> None:
        self._host, self._estimator = host, estimator

    def fit(self, rows: Rows, labels: NDArray[np.int64], seed: int, groups: NDArray[np.int64] | None = None) -> Any:
        return self._host.call(_fit, self._estimator, rows, labels, seed, groups)

    def predict(self, model: Any, rows: Rows) -> NDArray[np.int64]:
        labels: NDArray[np.int64] = self._host.call(_predict, model, rows)
        return labels

    def log_probabilities(self, model: Any, rows: Rows) -> Rows | None:
        found: Rows | None = self._host.call(_log_probabilities, model, rows)
        return found


class Function:
    """Function of frames as the library calls it."""

    def __init__(self, host: Host, function: Callable[[Rows], Any]) -> None:
        self._host, self._function = host, function

    def compute(self, frames: Rows) -> Rows:
        made: Rows = self._host.call(_compute, self._function, frames)
        return made


def identified(classifiers: Mapping[str, Any] | None, features: Mapping[str, Any] | None) -> tuple[list[Given], list[Given]]:
    """Returns name, version and object of the given classifiers and features."""
    def has_fit(thing: Any) -> bool:
        return not isinstance(thing, type) and hasattr(thing, "fit") and hasattr(thing, "predict")

    of_classifiers = _named("classifier", classifiers, has_fit, "an object with fit(X, y) and predict(X)")
    return list(of_classifiers), list(_named("features", features, callable, "a function of frames (n, m)"))


def hosted(host: Host, given: tuple[list[Given], list[Given]]) -> tuple[list[Given], list[Given]]:
    """Returns the classifiers and features as the library calls them."""
    classifiers = [(name, version, Trainer(host, estimator)) for name, version, estimator in given[0]]
    return classifiers, [(name, version, Function(host, function)) for name, version, function in given[1]]

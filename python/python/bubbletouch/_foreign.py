"""Classifiers and features of a study whose code is in Python: identities, seeds and processes."""

from __future__ import annotations

import copy
import hashlib
import inspect
import json
import pickle
import random
import re
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from multiprocessing import get_context
from sysconfig import get_paths
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.float64]
Given = tuple[str, str, Any]
# Classifiers, and features.
Hosted = tuple[list[Given], list[Given]]

# Hexadecimal digits of the version that is derived from code and parameters. With fewer digits, two versions may be equal.
_DIGITS = 12

# Folders of the standard library and of installed packages, whose code belongs to no version.
_INSTALLED = tuple({path for name, path in get_paths().items() if name in ("stdlib", "platstdlib", "purelib", "platlib")})

# One call at a time in this process: the random generators of NumPy and PyTorch are global.
_LOCK = threading.RLock()


class _Description:
    """Text that depends only on the code and the parameters of estimators and functions; equal in all processes."""

    def __init__(self) -> None:
        # Things that contain the thing that is described; a thing that contains itself is described once.
        self._above: list[Any] = []
        # Classes and functions that have been described.
        self._known: set[int] = set()

    def of(self, thing: Any) -> str:
        """Returns the text of a thing; the second text of a class or a function is its name."""
        if any(thing is other for other in self._above):
            return "itself"
        if isinstance(thing, type | FunctionType):
            if id(thing) in self._known:
                return f"{thing.__module__}.{thing.__qualname__}"
            self._known.add(id(thing))
        self._above.append(thing)
        try:
            return self._text(thing)
        finally:
            self._above.pop()

    def _text(self, thing: Any) -> str:
        if isinstance(thing, np.ndarray):
            # The bytes of an array of objects are addresses.
            values = self.of(thing.tolist()) if thing.dtype.hasobject else hashlib.sha256(thing.tobytes()).hexdigest()
            return f"array {thing.dtype} {thing.shape} {values}"
        if isinstance(thing, dict):
            return "{" + ", ".join(f"{key}: {self.of(value)}" for key, value in sorted(thing.items(), key=lambda item: str(item[0]))) + "}"
        if isinstance(thing, list | tuple):
            return "[" + ", ".join(map(self.of, thing)) + "]"
        if isinstance(thing, set | frozenset):
            # The order of a set differs between processes.
            return "{" + ", ".join(sorted(map(self.of, thing))) + "}"
        if isinstance(thing, CodeType):
            return f"{thing.co_code.hex()} {self.of(thing.co_consts)} {thing.co_names!r} {thing.co_freevars!r}"
        if isinstance(thing, MethodType):
            return f"{self.of(thing.__self__)} {self.of(thing.__func__)}"
        if isinstance(thing, FunctionType):
            return f"{self._source(thing)} {self._around(thing)} {self.of([thing.__defaults__, thing.__kwdefaults__])}"
        if isinstance(thing, type):
            return self._class(thing)
        if hasattr(thing, "func") and hasattr(thing, "args"):
            return f"{self.of(thing.func)} {self.of(thing.args)} {self.of(getattr(thing, 'keywords', {}))}"
        if hasattr(thing, "get_params"):
            return f"{self.of(type(thing))} {self.of(thing.get_params(deep=False))}"
        if isinstance(getattr(thing, "__wrapped__", None), FunctionType):
            return self.of(thing.__wrapped__)
        if isinstance(thing, ModuleType) or type(thing).__module__ == "builtins":
            return _without_address(thing)
        return f"{self.of(type(thing))} {self.of(_state(thing))}"

    def _class(self, thing: type) -> str:
        """Returns the text of a class: its source, the sources of its bases in the user's modules, and the variables around their methods."""
        bases = [base for base in thing.__mro__ if base is thing or _is_own(base)]
        methods = [getattr(method, "__func__", method) for base in bases if _is_own(base) for method in vars(base).values()]
        around = [self._around(method) for method in methods if isinstance(method, FunctionType)]
        return " ".join([f"{thing.__module__}.{thing.__qualname__}", *map(self._source, bases), *around])

    def _around(self, function: FunctionType) -> str:
        """Returns a text of the variables that a function names: those of the functions around it, of its module, and of other modules of the user."""
        described = []
        for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
            try:
                described.append("class" if name == "__class__" else self.of(cell.cell_contents))
            except ValueError:
                described.append("no value")
        codes, names = [function.__code__], set[str]()
        for code in codes:
            names.update(code.co_names)
            codes += [inner for inner in code.co_consts if isinstance(inner, CodeType)]
        for name in sorted(names & function.__globals__.keys()) if _is_own(function) else ():
            value = function.__globals__[name]
            if isinstance(value, ModuleType) and _is_own(value):
                value = {member: vars(value)[member] for member in sorted(names & vars(value).keys())}
            elif isinstance(value, type | FunctionType) and not _is_own(value):
                value = f"{value.__module__}.{value.__qualname__}"
            described.append(f"{name}: {self.of(value)}")
        return "[" + ", ".join(described) + "]"

    def _source(self, code: Any) -> str:
        """Returns the source text of a function or a class, or its bytecode if there is no source."""
        found = getattr(code, "__code__", None)
        try:
            source = inspect.getsource(code)
        except (OSError, TypeError):
            return f"{code.__qualname__}" if found is None else self.of(found)
        # The source of a lambda is the whole line, which may contain several.
        return f"{source} {self.of(found)}" if found is not None and found.co_name == "<lambda>" else source


def _state(thing: Any) -> Any:
    """Returns the variables of an object, or the parts of which its copies are made. An object without either, such as a lock, has no state."""
    is_plain = all(getattr(type(thing), name) is getattr(object, name) for name in ("__reduce__", "__reduce_ex__"))
    if is_plain and hasattr(thing, "__dict__"):
        return vars(thing)
    try:
        parts = thing.__reduce_ex__(2)
    except (TypeError, AttributeError, pickle.PicklingError):
        return _without_address(thing)
    # The last two parts are iterators of items.
    return parts if isinstance(parts, str) else [*parts[:3], *([] if part is None else list(part) for part in parts[3:5])]


def _without_address(thing: Any) -> str:
    """Returns the representation of an object without its address, which differs between processes."""
    return re.sub(r" at 0x[0-9a-fA-F]+", "", repr(thing))


def _is_own(code: Any) -> bool:
    """Returns whether a module, class or function is the user's, and not of the standard library, an installed package or this package."""
    name = code.__name__ if isinstance(code, ModuleType) else code.__module__
    file = getattr(sys.modules.get(name), "__file__", None)
    is_built_in = file is None and name in sys.builtin_module_names
    return not is_built_in and name.partition(".")[0] != "bubbletouch" and not (file or "").startswith(_INSTALLED)


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
        yield str(name), hashlib.sha256(_Description().of(thing).encode()).hexdigest()[:_DIGITS] if version is None else version, thing


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


def _copied(estimator: Any) -> Any:
    """Returns an unfitted copy of an estimator."""
    if hasattr(estimator, "get_params"):
        try:
            from sklearn.base import clone
        except ImportError:
            pass
        else:
            return clone(estimator)
    return copy.deepcopy(estimator)


def _with_parameters(estimator: Any, values: dict[str, Any]) -> Any:
    """Returns an unfitted copy of an estimator with other values of its parameters. Without `set_params`, these are its variables."""
    changed = _copied(estimator)
    if hasattr(changed, "set_params"):
        return changed.set_params(**values)
    for name, value in values.items():
        if not hasattr(changed, name):
            raise ValueError(f"no parameter {name}; {', '.join(vars(changed))}")
        setattr(changed, name, value)
    return changed


def _fresh(estimator: Any, seed: int) -> Any:
    """Returns an unfitted copy of an estimator. Each `random_state` that is None becomes the seed."""
    fresh = _copied(estimator)
    if not hasattr(fresh, "get_params"):
        if getattr(fresh, "random_state", 0) is None:
            fresh.random_state = seed
        return fresh
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

    def with_parameters(self, values: str) -> Trainer:
        """Returns the estimator with other values of its parameters, a JSON object."""
        return Trainer(self._host, _with_parameters(self._estimator, json.loads(values)))

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

    def with_parameters(self, values: str) -> Function:
        """Returns the function with values of its keyword arguments, a JSON object."""
        given = json.loads(values)
        # Raises TypeError if the function has no such argument.
        inspect.signature(self._function).bind(None, **given)
        return Function(self._host, partial(self._function, **given))

    def compute(self, frames: Rows) -> Rows:
        made: Rows = self._host.call(_compute, self._function, frames)
        return made


def identified(classifiers: Mapping[str, Any] | None, features: Mapping[str, Any] | None) -> Hosted:
    """Returns name, version and object of the given classifiers and features."""
    def has_fit(thing: Any) -> bool:
        return not isinstance(thing, type) and hasattr(thing, "fit") and hasattr(thing, "predict")

    of_classifiers = _named("classifier", classifiers, has_fit, "an object with fit(X, y) and predict(X)")
    return list(of_classifiers), list(_named("features", features, callable, "a function of frames (n, m)"))


def hosted(host: Host, given: Hosted) -> Hosted:
    """Returns the classifiers and features as the library calls them."""
    classifiers = [(name, version, Trainer(host, estimator)) for name, version, estimator in given[0]]
    return classifiers, [(name, version, Function(host, function)) for name, version, function in given[1]]

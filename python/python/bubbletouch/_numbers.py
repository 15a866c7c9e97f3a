"""Checks of numeric arguments. Each error message contains the name of the argument, the given value and the allowed values."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import Any


# Largest seed of the library. Error messages omit the upper bound of a range that ends here.
_MOST = 2**64 - 1


def real(name: str, value: Any, *, above: float = -math.inf, least: float = -math.inf) -> float:
    """Returns the value as a float.

    The number must be finite, above `above` and at least `least`. Raises TypeError if the value is not a number, and ValueError if the number is
    out of range.
    """
    allowed = _range("a finite number", above, least)
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name}: {value!r}; {allowed}")
    number = float(value)
    if not (math.isfinite(number) and number > above and number >= least):
        given = "NaN" if math.isnan(number) else value
        raise ValueError(f"{name}: {given}; {allowed}")
    return number


def whole(name: str, value: Any, *, least: int, most: int = _MOST) -> int:
    """Returns the value as an integer from `least` to `most`; a float without a fractional part is accepted.

    Raises TypeError if the value is not a number, and ValueError if the number has a fractional part or is out of range.
    """
    allowed = f"at least {least}" if most == _MOST else f"a whole number from {least} to {most}"
    is_number = isinstance(value, Real) and not isinstance(value, bool)
    if not is_number:
        raise TypeError(f"{name}: {value!r}; a whole number, {allowed}")
    if not isinstance(value, Integral) and not float(value).is_integer():
        given = "NaN" if math.isnan(value) else value
        raise ValueError(f"{name}: {given}; a whole number, {allowed}")
    number = int(value)
    if not least <= number <= most:
        raise ValueError(f"{name}: {value}; {allowed}")
    return number


def _range(kind: str, above: float, least: float) -> str:
    """Returns the allowed range of a number as text, for error messages."""
    if above > -math.inf:
        return f"{kind} above {above:g}"
    return f"{kind}, at least {least:g}" if least > -math.inf else kind

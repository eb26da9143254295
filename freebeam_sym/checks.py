"""Checks of what a user gives, in one place. Each returns the value in the form that computations use."""

from __future__ import annotations

import math
import numbers

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["InputError", "count", "finite", "nonnegative", "positions", "positive"]


class InputError(ValueError):
    """Bad input. The message is one line: the value, what is allowed, and the cure."""


def _error(name: str, value: object, rule: str, hint: str) -> InputError:
    try:
        text = " ".join((str if isinstance(value, (numbers.Number, np.bool_)) else repr)(value).split())
    except ValueError:  # Python prints no integer of more than 4300 digits
        text = "a number of thousands of digits"
    if len(text) > 60:
        text = text[:57] + "..."
    return InputError(f"{name} = {text}: {rule}" + (f" ({hint})" if hint else ""))


def finite(name: str, value: object, hint: str = "") -> float:
    """`value` as a float. Any real number will do (NumPy scalars and fractions too), but no bool and no text.

    `hint` says in a few words what the quantity is. Raises InputError where it is NaN, infinite or no number.

    >>> finite("load", np.float32(0.5))
    0.5
    >>> finite("load", float("nan"), "nondimensional")
    Traceback (most recent call last):
    freebeam_sym.checks.InputError: load = nan: must be finite (nondimensional)
    """
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if (
        isinstance(value, (bool, np.bool_, str, bytes, np.ndarray))
        or (isinstance(value, numbers.Complex) and not isinstance(value, numbers.Real))
        or not hasattr(value, "__float__")  # what Decimal has too, which is not registered as a Real
    ):
        raise _error(name, value, "must be a real number", hint)
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise _error(name, value, "must be a real number", hint) from None
    except OverflowError:
        raise _error(name, value, "is beyond the range of a float", hint) from None
    if not math.isfinite(number):
        raise _error(name, value, "must be finite", hint)
    return number


def nonnegative(name: str, value: object, hint: str = "") -> float:
    """`value` as a float that is zero or greater. Raises InputError, as `finite` does.

    >>> nonnegative("alpha", -0.1, "internal damping")
    Traceback (most recent call last):
    freebeam_sym.checks.InputError: alpha = -0.1: must be zero or greater (internal damping)
    """
    number = finite(name, value, hint)
    if number < 0:
        raise _error(name, value, "must be zero or greater", hint)
    return number


def positive(name: str, value: object, hint: str = "") -> float:
    """`value` as a float greater than zero. Raises InputError, as `finite` does."""
    number = finite(name, value, hint)
    if number <= 0:
        raise _error(name, value, "must be greater than zero", hint)
    return number


def count(name: str, value: object, low: int = 1, high: int | None = None, hint: str = "") -> int:
    """`value` as an int from `low` to `high` (no upper limit where None). A float is no count, not even 8.0.

    Raises InputError.
    """
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    rule = f"must be a whole number, {low} " + ("or greater" if high is None else f"to {high}")
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Integral):
        raise _error(name, value, rule, hint)
    number = int(value)
    if number < low or (high is not None and number > high):
        raise _error(name, value, rule, hint)
    return number


def positions(
    name: str, values: ArrayLike, hint: str = "position along the beam in units of its length"
) -> NDArray[np.float64]:
    """Positions along the beam: one number or a sequence of numbers from 0 to 1, as an array of shape (n,).

    Raises InputError where one is no finite number or lies outside the beam, or where there is none.

    >>> positions("sensors", 1)
    array([1.])
    """
    array = np.asarray(values, dtype=object)
    if array.ndim > 1:
        raise InputError(f"{name} has shape {array.shape}: must be one number or of shape (n,) ({hint})")
    items = array.ravel().tolist()
    if not items:
        raise _error(name, [], "must name one position at least", hint)
    labels = [name] if len(items) == 1 else [f"{name}[{k}]" for k in range(len(items))]
    for label, item in zip(labels, items, strict=True):
        if not 0 <= finite(label, item, hint) <= 1:
            raise _error(label, item, "must lie from 0 to 1", hint)
    return np.array([float(item) for item in items])

"""Checks of what a user gives, in one place. Each returns the value in the form that computations use."""

from __future__ import annotations

import math
import numbers
import os

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "InputError", "Unstable", "array", "computable", "count", "finite", "memory", "nonnegative", "place",
    "positions", "positive", "reals", "refusal",
]  # fmt: skip

LARGEST = 1e60
"""Size from which on the products of values and stiffnesses that are computed may be no floats any more."""


class InputError(ValueError):
    """Bad input. The message is one line: the value, what is allowed, and the cure."""


class Unstable(InputError):
    """Something grows at the smallest loads, so that there is no first loss of stability."""


def refusal(name: str, value: object, rule: str, hint: str = "") -> InputError:
    """The error that says in one line what was given, what is allowed and, in `hint`, what it is about."""
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
        isinstance(value, (bool, np.bool_, str, bytes, np.ndarray, np.datetime64, np.timedelta64))
        or (isinstance(value, numbers.Complex) and not isinstance(value, numbers.Real))
        or not hasattr(value, "__float__")  # what Decimal has too, which is not registered as a Real
    ):
        raise refusal(name, value, "must be a real number", hint)
    try:
        number = float(value)
    except OverflowError:
        raise refusal(name, value, "is beyond the range of a float", hint) from None
    except Exception:  # whatever an object's own conversion raises
        raise refusal(name, value, "must be a real number", hint) from None
    if not math.isfinite(number):
        raise refusal(name, value, "must be finite", hint)
    return number


def nonnegative(name: str, value: object, hint: str = "") -> float:
    """`value` as a float that is zero or greater. Raises InputError, as `finite` does.

    >>> nonnegative("alpha", -0.1, "internal damping")
    Traceback (most recent call last):
    freebeam_sym.checks.InputError: alpha = -0.1: must be zero or greater (internal damping)
    """
    number = finite(name, value, hint)
    if number < 0:
        raise refusal(name, value, "must be zero or greater", hint)
    return number


def positive(name: str, value: object, hint: str = "") -> float:
    """`value` as a float greater than zero. Raises InputError, as `finite` does."""
    number = finite(name, value, hint)
    if number <= 0:
        raise refusal(name, value, "must be greater than zero", hint)
    return number


def count(name: str, value: object, low: int = 1, high: int | None = None, hint: str = "") -> int:
    """`value` as an int from `low` to `high` (no upper limit where None). A float is no count, not even 8.0.

    Raises InputError.
    """
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    rule = f"must be a whole number, {low} " + ("or greater" if high is None else f"to {high}")
    if isinstance(value, (bool, np.bool_, np.timedelta64)) or not isinstance(value, numbers.Integral):
        raise refusal(name, value, rule, hint)
    number = int(value)
    if number < low or (high is not None and number > high):
        raise refusal(name, value, rule, hint)
    return number


def computable(name: str, number: float) -> float:
    """A finite number that can be computed with: its products with stiffnesses are floats too. Raises InputError."""
    if abs(number) >= LARGEST:
        raise refusal(name, number, "must be below 1e60 in size to be computed with")
    return number


def memory() -> float:
    """Bytes of this machine's memory."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):  # no such call, as on Windows
        return 8.0 * 2**30


def array(name: str, values: object, hint: str = "") -> NDArray[np.float64]:
    """`values` as an array of floats of the same shape: one number, or numbers in sequences or arrays. What `finite`
    refuses is refused in each place, and masked arrays are; but NaN and infinite values pass.

    >>> array("loads", [1, 2.5])
    array([1. , 2.5])
    >>> array("loads", [1, True])
    Traceback (most recent call last):
    freebeam_sym.checks.InputError: loads[1] = True: must be a real number
    """
    if isinstance(values, np.ma.MaskedArray):
        raise InputError(f"{name} is a masked array, which is not supported: fill it, or leave the masked values out")
    try:
        found = np.asarray(values)
    except Exception:  # ragged, or whatever an object's own conversion raises
        raise refusal(name, values, "must be a number, or an array of numbers", hint) from None
    listed = () if isinstance(values, np.ndarray) else np.asarray(values, dtype=object).flat
    if found.dtype.kind in "iuf" and not any(isinstance(one, bool | np.bool_) for one in listed):
        with np.errstate(over="ignore"):  # of longer floats
            return found.astype(np.float64, copy=False)
    items = np.asarray(values, dtype=object)
    for place, item in np.ndenumerate(items):
        finite(f"{name}[{', '.join(map(str, place))}]" if place else name, item, hint)
    return items.astype(np.float64)


def reals(name: str, values: object, hint: str = "") -> NDArray[np.float64]:
    """`values` as an array of finite floats of the same shape, as `array` reads them. Raises InputError.

    >>> reals("loads", [[0.5], [float("nan")]])
    Traceback (most recent call last):
    freebeam_sym.checks.InputError: loads[1, 0] = nan: must be finite
    """
    found = array(name, values, hint)
    if not np.isfinite(found).all():
        place = tuple(np.argwhere(~np.isfinite(found))[0].tolist())
        label = f"{name}[{', '.join(map(str, place))}]" if place else name
        raise refusal(label, found[place], "must be finite", hint)
    return found


def positions(
    name: str, values: ArrayLike, hint: str = "position along the beam in units of its length"
) -> NDArray[np.float64]:
    """Positions along the beam: one number or a sequence of numbers from 0 to 1, as an array of shape (n,).

    Raises InputError where one is no finite number or lies outside the beam, or where there is none.

    >>> positions("sensors", 1)
    array([1.])
    """
    found = reals(name, values, hint)
    if found.ndim > 1:
        raise InputError(f"{name} has shape {found.shape}: must be one number or of shape (n,) ({hint})")
    if not found.size:
        raise refusal(name, [], "must name one position at least", hint)
    found = found.ravel()
    outside = np.flatnonzero((found < 0) | (found > 1))
    if outside.size:
        label = name if found.size == 1 else f"{name}[{outside[0]}]"
        raise refusal(label, found[outside[0]], "must lie from 0 to 1", hint)
    return found


def place(name: str, value: object) -> float:
    """One position along the beam, 0 to 1. Raises InputError, as `finite` and `positions` do."""
    return float(positions(name, finite(name, value))[0])

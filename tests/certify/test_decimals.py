"""Numbers as text: read as they are written; roots of intervals."""

from __future__ import annotations

from fractions import Fraction as F

import pytest

from freebeam_derive.certify.decimals import outward, read, roots, said, shown, written


@pytest.mark.parametrize("size", [F(1, 10**60), F(3, 10**7), F(2), F(10**9), F(10**60)])
@pytest.mark.parametrize("width", [F(1, 2), F(1, 10**4), F(1, 10**80)])
def test_roots_of_an_interval_are_in_one_hardly_wider(size: F, width: F) -> None:
    """a² ≤ low and high ≤ b², with b² − a² at most a millionth wider than the interval that was given."""
    low, high = size, size * (1 + width)
    a, b = roots(low, high)
    assert 0 < a and a**2 <= low and high <= b**2
    assert b**2 - a**2 < (high - low) * (1 + F(1, 10**6))


@pytest.mark.parametrize("size", [F(1, 10**60), F(2), F(10**60)])
def test_the_root_of_a_point_is_in_a_narrow_interval(size: F) -> None:
    a, b = roots(size, size)
    assert a**2 <= size < b**2 and b - a < a * F(1, 10**38) and roots(F(0), F(0)) == (0, 0)


@pytest.mark.parametrize("value", [F(0), F(-7), F(22, 7), F(-1, 3 * 10**40), F(10**5000)])
def test_what_is_written_is_read_as_it_was(value: F) -> None:
    assert read(written(value)) == value


@pytest.mark.parametrize("text", ["", ".", "-", "e5", "/3", "x", "1/0", "1 2", "1e999999", "nan", "٣"])
def test_what_is_no_number_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is no decimal and no quotient"):
        read(text)


@pytest.mark.parametrize("value", [F(0), F(-7), F(-1, 32), F(12_345_678_901_234), F(1234, 10**9), F(22, 7)])
def test_a_number_for_print_is_that_number(value: F) -> None:
    assert read(said(value)) == value and said(value).startswith("-") == (value < 0)
    assert ("/" in said(value)) == (value == F(22, 7))


@pytest.mark.parametrize("power", [-20, -3, -1, 0, 1, 2, 5, 18])
@pytest.mark.parametrize("digits", [2, 6, 25])
def test_decimals_are_rounded_outward_by_one_unit_at_most(power: int, digits: int) -> None:
    """Of both signs; one digit more than is asked for, or less, where 10 to a power is between two powers of 2."""
    for low in (F(31, 7) * F(10) ** power, F(-62, 7) * F(10) ** power, F(10) ** power):
        high = low + abs(low) / 10 ** (digits + 3)
        below, above = map(read, outward(low, high, digits))
        unit = abs(low) / F(10) ** (digits - 2)
        assert below <= low < high <= above and above - below < unit
        assert above - below > unit / 10**3 and outward(F(0), F(0), digits) == ("0", "0")


@pytest.mark.parametrize("width", [F(1, 10), F(1, 10**6), F(1, 10**30)])
def test_the_ends_of_an_interval_are_shown_as_far_as_they_differ(width: F) -> None:
    for low in (F(22, 7), F(-22, 7 * 10**9), F(10**12, 7)):
        high = low + abs(low) * width
        below, above = map(read, shown(low, high))
        assert below <= low < high <= above and above - below < (high - low) * F(11, 10)
    assert shown(F(5), F(5)) == ("5.0000000000000000000", "5.0000000000000000000")

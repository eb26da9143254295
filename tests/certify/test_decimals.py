"""Numbers as text: read as they are written; roots of intervals."""

from __future__ import annotations

from fractions import Fraction as F

import pytest

from freebeam_derive.certify.decimals import read, roots, written


@pytest.mark.parametrize("size", [F(1, 10**60), F(3, 10**7), F(2), F(10**9), F(10**60)])
@pytest.mark.parametrize("width", [F(1, 2), F(1, 10**4), F(1, 10**80)])
def test_roots_of_an_interval_are_in_one_hardly_wider(size: F, width: F) -> None:
    """a² ≤ low and high ≤ b², with b² − a² at most a millionth wider than the interval that was given."""
    low, high = size, size * (1 + width)
    a, b = roots(low, high)
    assert 0 < a and a**2 <= low and high <= b**2
    assert b**2 - a**2 < (high - low) * (1 + F(1, 10**6))


@pytest.mark.parametrize("value", [F(0), F(-7), F(22, 7), F(-1, 3 * 10**40), F(10**5000)])
def test_what_is_written_is_read_as_it_was(value: F) -> None:
    assert read(written(value)) == value


@pytest.mark.parametrize("text", ["", ".", "-", "e5", "/3", "x", "1/0", "1 2", "1e999999", "nan", "٣"])
def test_what_is_no_number_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is no decimal and no quotient"):
        read(text)

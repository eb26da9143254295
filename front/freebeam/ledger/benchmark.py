"""Certified values of all columns that come with freebeam, as a table that any other code can test itself against."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from decimal import Decimal, localcontext
from typing import TYPE_CHECKING, Any

from freebeam import own
from freebeam.ledger.reference_values import ENCLOSED, Case, first_loss, statements
from freebeam.proofs import certified_load
from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from freebeam_derive.statement import Column as Statement
    from freebeam_sym.columns import Column

__all__ = ["FILES", "Row", "cases", "row_of", "rows", "written_out"]

FILES = ("benchmark.csv", "benchmark.json")
DIGITS = 20  # of a load and a frequency
SERIES = 6  # functions, a segment and a field, of the series whose first loss is proven to be the first: seconds
APART = 0.01  # a series' load that differs by more, relative to it, is no word on the beam's
ABOUT = (
    "First loss of stability of columns under follower and other loads: critical load and frequency, nondimensional, "
    "each of the beam itself and not of a series. The definitions of the systems are under `systems`; how to use the "
    "table is said on the page beside it."
)
ITSELF = "the crossing of the beam itself is enclosed, alone, by interval arithmetic"
FIRST = "that it is the first is proven of a series of {} functions, whose load is {}"
CONVERGED = "that it is the first is not proven: converged series of polynomials say so"


@dataclass(frozen=True)
class Row:
    """A certified value. load, frequency: decimals of which all digits hold, rounded to `digits` of them. parameters:
    all of the column's own, and alpha and beta, exactly; kappa in place of these in the limit of vanishing damping
    beta = kappa alpha. proof: in words."""

    system: str
    parameters: Mapping[str, float]
    load: str
    frequency: str
    kind: str
    digits: int
    proof: str


def cases(statement: Statement, limits: bool) -> Iterator[Case]:
    """What is asked of a column: its defaults, its reference values, each of its own parameters at a quarter and three
    quarters of its range, light damping, and with `limits` that of vanishing internal damping."""
    defaults = {p.name: p.default for p in statement.parameters}
    found = [Case(defaults)]
    found += [Case({**defaults, **r.own}, r.alpha, r.beta, r.kappa) for r in statement.references]
    for p in statement.parameters:
        for share in (0.25, 0.75):
            value = float(f"{p.low + share * (p.high - p.low):.4g}")
            found.append(Case({**defaults, p.name: value}))
    light = {"alpha": 0.01, "beta": 0.1}
    if statement.damping:
        found.append(Case(defaults, **{name: light[name] for name in statement.damping}))
    if limits and "alpha" in statement.damping:
        found.append(Case(defaults, kappa=0.0))
    for n, case in enumerate(found):
        if case not in found[:n]:
            yield case


def row_of(column: Column, case: Case) -> Row | None:
    """The certified value of a case; None where stability is not lost, is not there, or nothing is proven of it."""
    try:
        found = first_loss(column, case, DIGITS + 2)
    except InputError:  # it is unstable at the smallest loads, say
        return None
    if found is None or found.proof != ENCLOSED:
        return None
    (load, digits), (frequency, more) = _rounded(*found.load), _rounded(*found.frequency)
    proof = f"{ITSELF}; {_first(column, case, found.kind, float(load))}"
    limit = {"kappa": case.kappa} if case.kappa is not None else {"alpha": case.alpha, "beta": case.beta}
    return Row(column.name, {**case.own, **limit}, load, frequency, found.kind, min(digits, more), proof)


def _rounded(low: str, high: str) -> tuple[str, int]:
    """What two decimals are alike to, in at most so many digits, and the number of these."""
    with localcontext(prec=DIGITS + 10):
        ends = Decimal(low), Decimal(high)
        if not any(ends):
            return "0", DIGITS
        for digits in range(DIGITS, 0, -1):
            unit = Decimal(1).scaleb(ends[0].adjusted() - digits + 1)
            one, other = (end.quantize(unit) for end in ends)
            if one == other:
                return f"{one:f}", digits
    raise InputError(f"{low} to {high}: have no digit in common")


def _first(column: Column, case: Case, kind: str, load: float) -> str:
    """What is known of whether a crossing is the first."""
    try:
        series = certified_load(column, SERIES, digits=10, **case.given)
    except InputError:  # an irrational factor, say, or a rigid motion that only the load restores
        return CONVERGED
    near = series.load and math.isclose(float(series.load[0]), load, rel_tol=APART)
    if series.load is None or not near or series.kind != kind or not all(series.proof.values()):
        return CONVERGED
    return FIRST.format(SERIES, f"{float(series.load[0]):.6g}")


def rows(progress: Callable[[str], None] | None = None) -> list[Row]:
    """All certified values, column by column."""
    found: list[Row] = []
    for name, statement in statements().items():
        column = own.column(name, "legendre")
        for case in cases(statement, not column.general):
            if progress:
                progress(f"{name}, value {len(found) + 1}")
            if (row := row_of(column, case)) is not None:
                found.append(row)
    return found


def written_out(found: list[Row]) -> dict[str, bytes]:
    """The files of the benchmark, by their names: the same bytes for the same values."""
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(Row.__dataclass_fields__)
    for row in found:
        parameters = "; ".join(f"{name}={repr(value).removesuffix('.0')}" for name, value in row.parameters.items())
        writer.writerow([row.system, parameters, *list(asdict(row).values())[2:]])
    record = {"about": ABOUT, "systems": _systems(), "values": [asdict(row) for row in found]}
    texts = table.getvalue(), json.dumps(record, indent=1, ensure_ascii=False) + "\n"
    return {name: text.encode() for name, text in zip(FILES, texts, strict=True)}


def _systems() -> dict[str, Any]:
    """What defines each column."""
    from freebeam_derive.definition import formulas

    return {
        name: {
            "title": statement.title,
            "family": statement.family,
            "source": statement.source,
            "parameters": {p.name: p.meaning for p in statement.parameters},
            **formulas(statement),
        }
        for name, statement in statements().items()
    }

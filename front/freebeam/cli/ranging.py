"""`freebeam critical --exact` over a range of a parameter. The command hands itself on as `asked`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from freebeam.cli.options import Interval, Number, refuse
from freebeam.cli.output import print_json, print_table, working, write_picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from freebeam.exact_ranges import ExactRange


def ranges(asked: Any) -> dict[str, Interval]:
    """The parameters that were given as a range."""
    kappa = {} if asked.kappa is None else {"kappa": asked.kappa}
    given: dict[str, Number] = {"alpha": asked.alpha, "beta": asked.beta, **kappa, **asked.assigned}
    return {name: value for name, value in given.items() if isinstance(value, Interval)}


def prove(asked: Any) -> None:
    """Prove it, write the picture, print. Raises InputError."""
    import freebeam as fb

    given = ranges(asked)
    name, interval = next(iter(given.items()))
    said = f"{name} = {interval}"
    known = name in asked.assigned and name in ("alpha", "beta", "kappa")
    refuse(known, f"--set {said}: is no parameter of the column's own; give --{name} {interval}")
    refuse(len(given) > 1, f"{said}: is a range, and so is {[*given][-1]}; give one of them a value")
    refuse(not asked.exact, f"{said}: over a range the beam itself is proven, not a series; give --exact too")
    for option, there in (("--all", asked.every), ("--truncation", asked.truncation)):
        refuse(there, f"{option}: is for one value of {name}, not for the range {interval}; leave it out")
    asked.check_free()
    refuse(asked.beam, f"{said}: a range is nondimensional; leave out the beam in SI units")
    asked.check_limit()
    more = {} if asked.digits is None else {"digits": asked.digits}
    exactly = {key: value for key, value in asked.exactly.items() if key != name}
    if name == "kappa":
        exactly["kappa"] = interval.exact
    with working("proof") as report:
        found = fb.exact_range(
            asked.chosen, name, interval.low.exact, interval.high.exact, **exactly, **more, progress=report
        )
    if asked.certificate:
        asked.keep(found)
    title = asked.title(**{name: str(interval)})
    if asked.plot:
        with working("picture"):
            write_picture(asked.plot, asked.force, lambda: _drawn(found), title)
    if asked.as_json:
        print_json(_record(asked, name, interval, found))
        return
    parts = len(found.pieces), "piece" if len(found.pieces) == 1 else "pieces"
    rows = [
        ["critical load", " to ".join(found.load)],
        ["proven", f"first, stable below, kind: each value, {parts[0]} {parts[1]}"],
    ]
    rows += [["not proven", f"{name} = {part.low} to {part.high}: {part.missing}"] for part in found.open]
    rows += [["taken exactly", ", ".join(f"{key} = {value}" for key, value in found.inputs.items())]]
    print_table(rows, title=f"{title}, the beam itself")
    print_table(
        [
            [f"{p.low} to {p.high}", " to ".join(p.load), p.kind, " to ".join(dict.fromkeys(p.frequency))]
            for p in found.pieces
        ],
        [name, "load", "kind", "frequency"],
    )


def _record(asked: Any, name: str, interval: Interval, found: ExactRange) -> dict[str, Any]:
    """All of it for JSON."""
    ends = [float(interval.low), float(interval.high)]
    record: dict[str, Any] = asked.record(
        exact=True, range=name, load_lower=found.load[0], load_upper=found.load[1], pieces=found.pieces,
        open=found.open, inputs=found.inputs, load_max=found.question.load_max,
    )  # fmt: skip
    if name in record["parameters"]:
        record["parameters"] = {**record["parameters"], name: ends}
    else:
        record[name] = ends
    return record


def _drawn(found: ExactRange) -> Figure:
    from freebeam import figures
    from freebeam.figures.look import figure

    drawn = figure((5.6, 3.8))
    figures.proven_range(found, ax=drawn.subplots())
    return drawn

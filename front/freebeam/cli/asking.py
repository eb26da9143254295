"""`freebeam critical`, `freebeam verify` and `freebeam spectrum`."""

from __future__ import annotations

import json
import math
from dataclasses import MISSING, dataclass
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from freebeam.cli.application import command
from freebeam.cli.options import (
    Case,
    CaseOptions,
    FileOptions,
    Number,
    Options,
    argument,
    flag,
    load_max_option,
    number,
    option,
    quantity,
    refuse,
    vanishing_or_number,
)
from freebeam.cli.output import print_json, print_table, working, written

if TYPE_CHECKING:
    from freebeam.proofs import Certified, CertifiedCrossing
    from freebeam_sym.stability.critical import CriticalLoad

Rows = list[list[str]]

# --- critical ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Critical(FileOptions, CaseOptions):
    """The question, and what is to be proven."""

    alpha: Number = option(
        "X", "Internal damping alpha; 0+ is the limit of ever smaller damping.", default="0", parser=vanishing_or_number
    )
    kappa: Number | None = quantity("K", "With --alpha 0+: the ratio beta/alpha in that limit; 0 if not given.")
    load_max: Number | None = load_max_option()
    digits: int | None = option("D", "Prove the critical load to D digits.")
    exact: bool = flag("With --digits: prove the load of the beam itself, not of the series.")
    every: bool = flag("With --digits: prove each crossing up to --load-max, and that there is no other.", "--all")
    truncation: bool = flag("Prove the error of the series: its load minus the load of the beam itself.")
    certificate: Path | None = option("FILE", "Write the proof to a file, which freebeam verify checks.")

    @property
    def ratio(self) -> Number | None:
        """β/α in the limit of vanishing damping; None where damping does not vanish."""
        return (self.kappa or number("0")) if self.alpha.text == "0+" else None

    def exactly(self) -> dict[str, Any]:
        """The question as the provers take it: exact numbers by name, in the units in which they were typed."""
        given = {"alpha": self.alpha, "beta": self.beta, "kappa": self.ratio, "load_max": self.load_max}
        numbers: dict[str, Any] = {name: x.exact for name, x in given.items() if x is not None}
        if self.beam:
            numbers["beam"] = tuple(x.exact for x in self.beam.values())
        return numbers | {name: x.exact for name, x in self.assigned.items()}


@dataclass(frozen=True)
class Found:
    """What is found for a question: the first loss of stability in floats, and what was proven, None where it was not
    asked for."""

    case: Case
    loss: CriticalLoad
    exact: bool
    proven: Certified | None
    crossings: tuple[CertifiedCrossing, ...] | None
    truncation: dict[str, Any] | None


@command(Critical, "freebeam critical --column beck --set eta=0.7 --alpha 1e-3")
def critical(asked: Critical) -> None:
    """Find the lowest load at which the column loses stability, by flutter or by divergence."""
    case = _ask(asked)
    found = _compute(asked, case)
    if asked.certificate and found.proven is not None:
        with written(asked.certificate, asked.force) as file:
            file.write((json.dumps(found.proven.certificate, indent=1) + "\n").encode())
    record = _record(found)
    if asked.as_json:
        print_json(record)
        return
    print_table(_rows(found, record), title=case.title())
    if found.crossings:
        load, frequency = (case.units.of(quantity) for quantity in ("load", "frequency"))
        header = [f"load{load}", "kind", f"frequency{frequency}", "unstable eigenvalues", "stability"]
        title = f"All crossings up to {record['load_max']:.10g}{load}: proven that there is no other"
        print_table([_crossing_row(crossing) for crossing in found.crossings], header, title)


def _ask(asked: Critical) -> Case:
    """The question; options that contradict one another are refused. Raises InputError."""
    limit, file = asked.ratio is not None, asked.certificate
    refuse(asked.kappa and not limit, f"kappa = {asked.kappa}: is the ratio of vanishing dampings; give --alpha 0+ too")
    refuse(
        limit and float(asked.beta),
        f"beta = {asked.beta}: vanishes with --alpha 0+; give the ratio beta/alpha by --kappa instead",
    )
    for name, given in (("--exact", asked.exact), ("--certificate", file), ("--all", asked.every)):
        refuse(given and asked.digits is None, f"{name}: belongs to a proof; give --digits, such as --digits 20")
    refuse(file and asked.beam, "--certificate: is nondimensional; leave out the beam in SI units")
    for name, given in (("--certificate", file), ("--all", asked.every), ("--truncation", asked.truncation)):
        refuse(given and asked.exact, f"{name}: is about the Ritz series; leave out --exact")
    there = file and file.exists() and not asked.force
    refuse(there, f"{file} exists; choose another file, or --force to replace it")
    return asked.case(asked.load_max, asked.ratio)


def _compute(asked: Critical, case: Case) -> Found:
    """The proofs that are asked for, then the answer in floats. Raises InputError where something is not proven."""
    import freebeam as fb
    from freebeam_sym.stability.critical import answer

    proven, crossings, truncation = None, None, None
    column, modes = case.question.column, case.question.modes
    if asked.digits is not None or asked.truncation:
        exactly, digits = asked.exactly(), asked.digits
        with working("proof") as report, case.units.in_errors():
            if digits is not None and asked.exact:
                proven = fb.exact_load(column, digits=digits, **exactly)
            elif digits is not None:
                proven = fb.certified_load(column, modes, digits=digits, progress=report, **exactly)
            if digits is not None and asked.every:
                report("all crossings")
                crossings = fb.certified_crossings(column, modes, digits=digits, progress=report, **exactly)
            if asked.truncation or (proven and proven.load and not asked.exact):
                truncation = _truncation(case, proven, exactly)
    with working("critical load") as report, case.units.in_errors():
        loss = answer(case.question)
        report("the beam itself")
        _ = loss.beam  # computed when it is first asked for
    return Found(case, loss, asked.exact, proven, crossings, truncation)


def _truncation(case: Case, series: Certified | None, exactly: dict[str, Any]) -> dict[str, Any]:
    """The truncation error as a record; where it is not known, why."""
    import freebeam as fb
    from freebeam_sym.checks import InputError

    try:
        found = fb.truncation_error(case.question.column, case.question.modes, series=series, **exactly)
    except InputError as error:
        return {"unknown": str(error)}
    exact = found.beam.load or (None, None)
    difference = dict(zip(("difference_lower", "difference_upper"), found.difference, strict=True))
    return {**difference, "relative": found.relative, "exact_lower": exact[0], "exact_upper": exact[1]}


def _record(found: Found) -> dict[str, Any]:
    """All of it for JSON."""
    loss, out = found.loss, found.case.units.out
    beam = loss.beam and {
        "load": out("load", loss.beam.load), "kind": loss.beam.kind, "uncertainty": loss.beam.uncertainty,
    }  # fmt: skip
    record = found.case.record(
        load=out("load", loss.load),
        kind=loss.kind,
        frequency=out("frequency", loss.frequency),
        error=loss.error,
        converged=loss.converged,
        beam=beam,
        touches=[[out("load", touch.load), out("frequency", touch.frequency)] for touch in loss.touches],
        load_max=out("load", loss.question.load_max),
    )
    if found.proven is not None:
        record |= _proof(found.proven, record, found.exact)
    if found.crossings is not None:
        record["crossings"] = [_crossing(crossing) for crossing in found.crossings]
    if found.truncation is not None:
        record["truncation"] = found.truncation
    return record


def _proof(proven: Certified, record: dict[str, Any], exact: bool) -> dict[str, Any]:
    """What a proof adds to the record, and what it changes there."""
    added: dict[str, Any] = {**_ends("load", proven.load), **_ends("frequency", proven.frequency)}
    added |= {"proof": dict(proven.proof), "exact": exact, "kind": proven.kind, "inputs": dict(proven.inputs)}
    if proven.load and proven.frequency and not exact:
        load = float(proven.load[0])
        if not math.isclose(load, record["load"] or math.inf, rel_tol=1e-6):
            # what floats take for a touch, or do not see, is a loss of stability of the series
            touches = [touch for touch in record["touches"] if not math.isclose(load, touch[0], rel_tol=1e-6)]
            added |= {"error": None, "converged": False, "touches": touches}
        added |= {"load": load, "frequency": float(proven.frequency[0])}
    return added


def _ends(name: str, interval: tuple[str, str] | None) -> dict[str, str | None]:
    lower, upper = interval or (None, None)
    return {f"{name}_lower": lower, f"{name}_upper": upper}


def _crossing(found: CertifiedCrossing) -> dict[str, Any]:
    return {
        "kind": found.kind,
        **_ends("load", found.load),
        **_ends("frequency", found.frequency),
        "unstable_below": found.unstable_below,
        "unstable_above": found.unstable_above,
        "stability": found.stability,
    }


def _crossing_row(found: CertifiedCrossing) -> list[str]:
    unstable = f"{found.unstable_below}, then {found.unstable_above}"
    return [" to ".join(found.load), found.kind, _interval(found.frequency), unstable, found.stability]


def _interval(ends: tuple[str, str]) -> str:
    return " to ".join(dict.fromkeys(ends))  # one number where the ends are the same


def _rows(found: Found, record: dict[str, Any]) -> Rows:
    """All of it as a table."""
    units, loss = found.case.units, found.loss
    unit = units.of("load")
    none = f"none up to {record['load_max']:.10g}{unit}"
    kind = loss.kind if found.exact else record["kind"]  # of the series
    if record["load"] is None:
        rows = [["critical load", none]]
    else:
        rows = [["critical load", _digits(record["load"], loss.rounding) + unit], ["kind", kind]]
        rows += [["frequency", f"{record['frequency']:.10g}{units.of('frequency')}"]]
    rows += [["touches", f"{load:.10g}{unit}: stability is not lost"] for load, _ in record["touches"]]
    rows += [["the beam itself", _beam(record["beam"], kind, none, unit)]]
    if record["load"] is not None:
        error = "" if record["error"] is None else f" (error {record['error']:.1e})"
        rows += [["converged", ("yes" if record["converged"] else "no") + error]]
    if found.proven is not None:
        rows += _proof_rows(found, found.proven, kind, none)
    if found.truncation is not None:
        rows += [["truncation error", found.truncation.get("unknown") or _difference(found.truncation, unit)]]
    return rows


def _beam(beam: dict[str, Any] | None, kind: str, none: str, unit: str) -> str:
    """The load of the beam itself, with its kind where that is another than that of the series."""
    if beam is None:
        return "not known: series of polynomials do not agree"
    if beam["load"] is None:
        return none
    load = _digits(beam["load"], beam["uncertainty"]) + unit
    return load if beam["kind"] == kind else f"{beam['kind']} at {load}"


def _proof_rows(found: Found, proven: Certified, kind: str, none: str) -> Rows:
    units = found.case.units
    of = "the beam itself" if found.exact else f"N = {found.case.question.modes}"
    rows = [[f"proven, {of}", f"{' to '.join(proven.load)}{units.of('load')}" if proven.load else none]]
    if proven.frequency:
        rows += [["kind", proven.kind]] if proven.kind != kind else []
        rows += [["frequency", _interval(proven.frequency) + units.of("frequency")]]
    rows += [["taken exactly", ", ".join(f"{name} = {value}" for name, value in proven.inputs.items())]]
    if not proven.load:
        return [*rows, ["proven is", f"stable {none.removeprefix('none ')}"]]
    shown, missing = (
        ", ".join(name.replace("_", " ") for name, yes in proven.proof.items() if yes is wanted)
        for wanted in (True, False)
    )
    return [*rows, ["proven is", shown], *([["not proven", missing]] if missing else [])]


def _difference(record: dict[str, Any], unit: str) -> str:
    """The truncation error, for print."""
    low, high = (Decimal(record[name]) for name in ("difference_lower", "difference_upper"))
    load = record["exact_lower"][:17] + unit
    if low <= 0 <= high:
        return f"none within 60 digits of the load of the beam itself, {load}"
    small = "E" if max(abs(low), abs(high)) < Decimal("1e-4") else ""
    return f"{low:{small}} to {high:{small}}{unit}, {record['relative']:.1e} of the load of the beam itself, {load}"


def _digits(value: float, error: float) -> str:
    """A number to the digits that its relative error leaves."""
    from freebeam_sym.stability.convergence import digits_that_hold

    return digits_that_hold(value, error)


# --- verify -----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Verify(Options):
    file: Path = argument(MISSING, metavar="FILE", help="A certificate of `freebeam critical --certificate`.")


@command(Verify, "freebeam verify certificate.json")
def verify(asked: Verify) -> None:
    """Check a certificate by a program that shares no code with the one that wrote it."""
    import freebeam as fb

    with working("verify"):
        found = fb.verify_certificate(str(asked.file))
    if asked.as_json:
        print_json({"file": str(asked.file), "verified": True, **found.record(), "proves": str(found)})
        return
    typer.echo(f"{asked.file}: {found}")


# --- spectrum ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class AskedSpectrum(CaseOptions):
    load: Number = quantity("P", "The load P.", default=MISSING)
    rigid: bool = flag("Include the rigid-body functions.")
    exact: bool = flag("With --digits: prove the eigenvalues of the beam itself, not of a series.")
    digits: int | None = option("D", "With --exact: prove each eigenvalue to D digits.")


@command(AskedSpectrum, "freebeam spectrum --load 50 --alpha 1e-3 --beta 0.1")
def spectrum(asked: AskedSpectrum) -> None:
    """Compute the eigenvalues at a load, sorted by |Im|, then by Re."""
    together = "--exact and --digits D go together here: each eigenvalue of the beam itself, to D digits"
    refuse(asked.exact != (asked.digits is not None), together)
    for name, given in (("--rigid", asked.rigid), ("SI units", asked.beam)):
        refuse(asked.exact and given, f"{name}: not with --exact, which is nondimensional and elastic")
    case = asked.case()
    if asked.digits is None:
        _show_spectrum(asked, case)
    else:
        _show_exact_spectrum(asked, case, asked.digits)


def _show_spectrum(asked: AskedSpectrum, case: Case) -> None:
    import freebeam as fb

    units = case.units
    found = fb.spectrum(case.question.system(units.into("load", asked.load), asked.rigid))
    record = case.record(
        load=asked.load,
        rigid=asked.rigid,
        eigenvalues=units.out("frequency", found.eigenvalues),
        error=found.error,
        reference_frequency=units.out("frequency", found.reference_frequency),
    )
    if asked.as_json:
        print_json(record)
        return
    rows = [
        [*(_part(x, abs(value), off) for x in (value.real, value.imag)), "" if math.isnan(error) else f"{error:.1e}"]
        for value, off, error in zip(record["eigenvalues"], found.rounding, found.error, strict=True)
    ]
    unit = units.of("frequency")
    print_table(rows, [f"Re{unit}", f"Im{unit}", "error"], case.title(load=f"{asked.load}{units.of('load')}"))


def _show_exact_spectrum(asked: AskedSpectrum, case: Case, digits: int) -> None:
    import freebeam as fb

    own = {name: value.exact for name, value in asked.assigned.items()}
    damping = asked.alpha.exact, asked.beta.exact
    with working("proof"):
        found = fb.exact_spectrum(
            case.question.column, asked.load.exact, *damping, modes=case.question.modes, digits=digits, **own
        )
    if asked.as_json:
        boxes = {"eigenvalues_lower": found.lower, "eigenvalues_upper": found.upper}
        print_json(case.record(load=asked.load, exact=True, digits=digits, **boxes, unproven=found.unproven))
        return
    boxes_of = zip(found.lower, found.upper, strict=True)
    rows = [[_interval(ends) for ends in zip(low, high, strict=True)] for low, high in boxes_of]
    rows += [[f"near {v.real:.6g}: not proven", f"near {v.imag:.6g}"] for v in found.unproven]
    print_table(rows, ["Re", "Im"], case.title(load=str(asked.load)) + ", the beam itself, each proven")


def _part(part: float, size: float, rounding: float) -> str:
    """Real or imaginary part of a number of this size, to the digits that its relative rounding leaves."""
    return "0" if abs(part) <= rounding * size else _digits(part, rounding * size / abs(part))

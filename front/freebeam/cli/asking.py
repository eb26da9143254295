"""`freebeam critical`, `freebeam verify` and `freebeam spectrum`."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from freebeam.cli.application import app
from freebeam.cli.options import (
    ZERO,
    AlphaOption,
    BasisOption,
    BetaOption,
    ColumnOption,
    JsonOption,
    LengthOption,
    LoadOption,
    MassOption,
    ModesOption,
    Number,
    RigidOption,
    SetOption,
    StiffnessOption,
    assignments,
    case_of,
    nondimensional,
    number,
    vanishing_or_number,
)
from freebeam.cli.output import print_json, print_table, working, written

if TYPE_CHECKING:
    from freebeam.proofs import CertifiedCrossing, Truncation


@app.command(epilog="Example: freebeam critical --column beck --set eta=0.7 --alpha 1e-3")
def critical(
    column: ColumnOption = "free-free",
    basis: BasisOption = None,
    modes: ModesOption = None,
    alpha: Annotated[
        Number,
        typer.Option(parser=vanishing_or_number, metavar="X", help="Internal damping; 0+ for its vanishing limit."),
    ] = ZERO,
    beta: BetaOption = ZERO,
    load_max: Annotated[Number | None, typer.Option(parser=number, metavar="P", help="Search up to this load.")] = None,
    own: SetOption = None,
    digits: Annotated[int | None, typer.Option(metavar="D", help="Prove the load to D digits.")] = None,
    exact: Annotated[bool, typer.Option("--exact", help="Of the beam itself, with no series.")] = False,
    every: Annotated[
        bool, typer.Option("--all", help="With --digits: every crossing up to --load-max, and that there is no other.")
    ] = False,
    truncation: Annotated[
        bool, typer.Option("--truncation", help="The series' error: its load less the beam's own, proven.")
    ] = False,
    kappa: Annotated[
        Number | None, typer.Option(parser=number, metavar="K", help="With --alpha 0+: the limit at beta = K alpha.")
    ] = None,
    certificate: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write what was proven, and the data that prove it.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace a certificate that exists.")] = False,
    bending_stiffness: StiffnessOption = None,
    mass_per_length: MassOption = None,
    length: LengthOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find the lowest load at which the column flutters or diverges."""
    import freebeam as fb
    from freebeam_sym.checks import InputError
    from freebeam_sym.stability.convergence import digits_that_hold

    vanishing = alpha.text == "0+"
    if kappa is not None and not vanishing:
        raise InputError(f"kappa = {kappa}: is the ratio of vanishing dampings; give --alpha 0+ with it")
    if vanishing and float(beta):
        raise InputError(f"beta = {beta}: vanishes with alpha 0+; give --kappa for the ratio beta/alpha instead")
    if digits is None and (exact or certificate or every):
        option = "--exact" if exact else "--certificate" if certificate else "--all"
        raise InputError(f"{option}: belongs to a proof; give --digits, such as --digits 20")
    if certificate and (bending_stiffness or mass_per_length or length):
        raise InputError("--certificate: is nondimensional; leave the beam in SI units out")
    for option, given in (("--certificate", certificate), ("--all", every), ("--truncation", truncation)):
        if exact and given:
            raise InputError(f"{option}: is of a Ritz series; leave --exact out")
    if certificate and certificate.exists() and not force:
        raise InputError(f"{certificate} exists; choose another file, or --force to replace it")
    case = case_of(column, modes, alpha, beta, own, (bending_stiffness, mass_per_length, length), basis)
    units = case.units
    if vanishing:
        case.typed["kappa"] = kappa or ZERO
    limit = {} if load_max is None else {"load_max": units.into("load", load_max)}
    if vanishing:
        limit["kappa"] = units.into("kappa", kappa or ZERO)
    proven, crossings, off = None, None, None
    if digits is not None or truncation:
        asked: dict[str, Any] = {} if load_max is None else {"load_max": load_max.exact}
        asked |= {"kappa": (kappa or ZERO).exact} if vanishing else {}
        asked |= {name: value.exact for name, value in assignments(own).items()}
        if bending_stiffness and mass_per_length and length:
            asked["beam"] = bending_stiffness.exact, mass_per_length.exact, length.exact
        of_series = (case.column, case.modes, alpha.exact, beta.exact)
        with working("proof") as report, nondimensional(units):
            if digits is not None and exact:
                proven = fb.exact_load(case.column, alpha.exact, beta.exact, digits=digits, **asked)
            elif digits is not None:
                proven = fb.certified_load(*of_series, digits=digits, progress=report, **asked)
            if digits is not None and every:
                report("all crossings")
                crossings = fb.certified_crossings(*of_series, digits=digits, progress=report, **asked)
            if not exact and (truncation or (proven is not None and proven.load)):
                off = _truncation(lambda: fb.truncation_error(*of_series, series=proven, **asked))
        if certificate and proven is not None:
            with written(certificate, force) as file:
                file.write((json.dumps(proven.certificate, indent=1) + "\n").encode())
    with working("critical load") as report, nondimensional(units):
        found = fb.critical_load(case.column, modes=case.modes, alpha=case.alpha, beta=case.beta, **limit, **case.own)
        report("the beam itself")
        beam = found.beam
    record = case.record(
        load=units.out("load", found.load),
        kind=found.kind,
        frequency=units.out("frequency", found.frequency),
        error=found.error,
        converged=found.converged,
        beam=None
        if beam is None
        else {"load": units.out("load", beam.load), "kind": beam.kind, "uncertainty": beam.uncertainty},
        touches=[[units.out("load", touch.load), units.out("frequency", touch.frequency)] for touch in found.touches],
        load_max=units.out("load", found.question.load_max),
    )
    if proven is not None:
        load, frequency = proven.load or (None, None), proven.frequency or (None, None)
        record |= {"load_lower": load[0], "load_upper": load[1]}
        record |= {"frequency_lower": frequency[0], "frequency_upper": frequency[1]}
        record |= {"proof": dict(proven.proof), "exact": exact, "kind": proven.kind, "inputs": dict(proven.inputs)}
        if proven.load and proven.frequency and not exact:
            first = float(proven.load[0])
            if not math.isclose(first, record["load"] or math.inf, rel_tol=1e-6):
                # what floats take for a touch, or do not see, is a loss of stability of the series
                touches = [touch for touch in record["touches"] if not math.isclose(first, touch[0], rel_tol=1e-6)]
                record |= {"error": None, "converged": False, "touches": touches}
            record |= {"load": first, "frequency": float(proven.frequency[0])}
    if crossings is not None:
        record |= {"crossings": [_crossing(crossing) for crossing in crossings]}
    if off is not None:
        record |= {"truncation": off}
    if as_json:
        print_json(record)
        return
    load_unit = units.of("load")
    none = f"none up to {record['load_max']:.10g}{load_unit}"
    kind = found.kind if exact else record["kind"]  # of the series
    if record["load"] is None:
        rows = [["critical load", none]]
    else:
        rows = [["critical load", digits_that_hold(record["load"], found.rounding) + load_unit]]
        rows += [["kind", kind]]
        rows += [["frequency", f"{record['frequency']:.10g}{units.of('frequency')}"]]
    rows += [["touches", f"{load:.10g}{load_unit}: stability is not lost"] for load, _ in record["touches"]]
    if beam is None:
        rows += [["the beam itself", "not known: series of polynomials do not agree"]]
    elif beam.load is None:
        rows += [["the beam itself", none]]
    else:
        its = digits_that_hold(record["beam"]["load"], beam.uncertainty) + load_unit
        rows += [["the beam itself", its if beam.kind == kind else f"{beam.kind} at {its}"]]
    if record["load"] is not None:
        error = "" if record["error"] is None else f" (error {record['error']:.1e})"
        rows += [["converged", ("yes" if record["converged"] else "no") + error]]
    if proven is not None:
        what = "the beam itself" if exact else f"N = {case.modes}"
        up_to = none.removeprefix("none ")
        rows += [[f"proven, {what}", f"{' to '.join(proven.load)}{load_unit}" if proven.load else none]]
        if proven.frequency:
            omega = f"{' to '.join(dict.fromkeys(proven.frequency))}{units.of('frequency')}"
            rows += [["kind", proven.kind]] if proven.kind != kind else []
            rows += [["frequency", omega]]
        rows += [["taken exactly", ", ".join(f"{name} = {value}" for name, value in proven.inputs.items())]]
        names = [name.replace("_", " ") for name, yes in proven.proof.items() if yes]
        rows += [["proven is", ", ".join(names) if proven.load else f"stable {up_to}"]]
        missing = [name.replace("_", " ") for name, yes in proven.proof.items() if not yes]
        if missing and proven.load:
            rows += [["not proven", ", ".join(missing)]]
    if off is not None:
        rows += [["truncation error", off.get("unknown") or _off(off, load_unit)]]
    print_table(rows, title=case.title())
    if crossings:
        header = [f"load{load_unit}", "kind", f"frequency{units.of('frequency')}", "unstable eigenvalues", "stability"]
        lines = [
            [
                " to ".join(c.load),
                c.kind,
                " to ".join(dict.fromkeys(c.frequency)),
                f"{c.unstable_below}, then {c.unstable_above}",
                c.stability,
            ]
            for c in crossings
        ]
        print_table(lines, header, f"All crossings {up_to}: proven that there is no other")


def _part(part: float, size: float, rounding: float) -> str:
    """Real or imaginary part of a number of this size, to the digits that its relative rounding leaves."""
    from freebeam_sym.stability.convergence import digits_that_hold

    return "0" if abs(part) <= rounding * size else digits_that_hold(part, rounding * size / abs(part))


def _truncation(ask: Callable[[], Truncation]) -> dict[str, Any]:
    """The truncation error as a record; where it is not known, why."""
    from freebeam_sym.checks import InputError

    try:
        found = ask()
    except InputError as error:
        return {"unknown": str(error)}
    exact = found.beam.load or (None, None)
    difference = dict(zip(("difference_lower", "difference_upper"), found.difference, strict=True))
    return {**difference, "relative": found.relative, "exact_lower": exact[0], "exact_upper": exact[1]}


def _off(record: dict[str, Any], unit: str) -> str:
    low, high = (Decimal(record[name]) for name in ("difference_lower", "difference_upper"))
    own = record["exact_lower"][:17] + unit
    if low <= 0 <= high:
        return f"none that 60 digits show, by the beam's own load {own}"
    small = "E" if max(abs(low), abs(high)) < Decimal("1e-4") else ""
    return f"{low:{small}} to {high:{small}}{unit}, {record['relative']:.1e} of the beam's own load {own}"


def _crossing(found: CertifiedCrossing) -> dict[str, Any]:
    return {
        "kind": found.kind,
        "load_lower": found.load[0],
        "load_upper": found.load[1],
        "frequency_lower": found.frequency[0],
        "frequency_upper": found.frequency[1],
        "unstable_below": found.unstable_below,
        "unstable_above": found.unstable_above,
        "stability": found.stability,
    }


@app.command(epilog="Example: freebeam verify certificate.json")
def verify(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A certificate of `critical --certificate`.")],
    as_json: JsonOption = False,
) -> None:
    """Check a certificate with a program that shares no code with the one that wrote it."""
    import freebeam as fb

    with working("verify"):
        found = fb.verify_certificate(str(file))
    if as_json:
        print_json({"file": str(file), "verified": True, **found.record(), "proves": str(found)})
        return
    typer.echo(f"{file}: {found}")


@app.command(epilog="Example: freebeam spectrum --load 50 --alpha 1e-3 --beta 0.1")
def spectrum(
    load: LoadOption,
    column: ColumnOption = "free-free",
    basis: BasisOption = None,
    modes: ModesOption = None,
    alpha: AlphaOption = ZERO,
    beta: BetaOption = ZERO,
    rigid: RigidOption = False,
    own: SetOption = None,
    digits: Annotated[int | None, typer.Option(metavar="D", help="With --exact: enclose to D digits.")] = None,
    exact: Annotated[
        bool, typer.Option("--exact", help="Of the beam itself, with no series, each eigenvalue proven.")
    ] = False,
    bending_stiffness: StiffnessOption = None,
    mass_per_length: MassOption = None,
    length: LengthOption = None,
    as_json: JsonOption = False,
) -> None:
    """Print the eigenvalues at a load, sorted by |Im|, then Re."""
    import freebeam as fb
    from freebeam_sym.checks import InputError

    if exact != (digits is not None):
        raise InputError("--exact and --digits D go together here: each eigenvalue of the beam itself, to D digits")
    if exact and (rigid or bending_stiffness or mass_per_length or length):
        option = "--rigid" if rigid else "SI units"
        raise InputError(f"{option}: not with --exact, which is nondimensional and of the elastic spectrum")
    case = case_of(column, modes, alpha, beta, own, (bending_stiffness, mass_per_length, length), basis)
    units = case.units
    if digits is not None:
        values = {name: value.exact for name, value in assignments(own).items()}
        with working("proof"):
            enclosed = fb.exact_spectrum(
                case.column, load.exact, alpha.exact, beta.exact, modes=case.modes, digits=digits, **values
            )
        if as_json:
            boxes = {"eigenvalues_lower": enclosed.lower, "eigenvalues_upper": enclosed.upper}
            print_json(case.record(load=load, exact=True, digits=digits, **boxes, unproven=enclosed.unproven))
            return
        lines = [
            [" to ".join(dict.fromkeys(ends)) for ends in zip(low, high, strict=True)]
            for low, high in zip(enclosed.lower, enclosed.upper, strict=True)
        ]
        lines += [[f"near {v.real:.6g}: not proven", f"near {v.imag:.6g}"] for v in enclosed.unproven]
        print_table(lines, ["Re", "Im"], case.title(load=str(load)) + ", the beam itself, each proven")
        return
    found = fb.spectrum(case.system(units.into("load", load), rigid))
    record = case.record(
        load=load,
        rigid=rigid,
        eigenvalues=units.out("frequency", found.eigenvalues),
        error=found.error,
        reference_frequency=units.out("frequency", found.reference_frequency),
    )
    if as_json:
        print_json(record)
        return
    rows = [
        [*(_part(x, abs(value), off) for x in (value.real, value.imag)), "" if math.isnan(error) else f"{error:.1e}"]
        for value, off, error in zip(record["eigenvalues"], found.rounding, found.error, strict=True)
    ]
    unit = units.of("frequency")
    print_table(rows, [f"Re{unit}", f"Im{unit}", "error"], case.title(load=f"{load}{units.of('load')}"))

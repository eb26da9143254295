"""`freebeam critical`, `freebeam verify` and `freebeam spectrum`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from freebeam_sym.cli.application import app
from freebeam_sym.cli.options import (
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
from freebeam_sym.cli.output import print_json, print_table, working, written


@app.command(epilog="Example: freebeam critical --column beck --set eta=0.7 --alpha 1e-3")
def critical(
    column: ColumnOption = "free-free",
    basis: BasisOption = None,
    modes: ModesOption = 8,
    alpha: Annotated[
        Number,
        typer.Option(parser=vanishing_or_number, metavar="X", help="Internal damping; 0+ for its vanishing limit."),
    ] = ZERO,
    beta: BetaOption = ZERO,
    load_max: Annotated[Number | None, typer.Option(parser=number, metavar="P", help="Search up to this load.")] = None,
    own: SetOption = None,
    digits: Annotated[int | None, typer.Option(metavar="D", help="Prove the load to D digits.")] = None,
    exact: Annotated[bool, typer.Option("--exact", help="Of the beam itself, with no series.")] = False,
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
    import freebeam_sym as fb
    from freebeam_sym.checks import InputError

    vanishing = alpha.text == "0+"
    if kappa is not None and not vanishing:
        raise InputError(f"kappa = {kappa}: is the ratio of vanishing dampings; give --alpha 0+ with it")
    if vanishing and float(beta):
        raise InputError(f"beta = {beta}: vanishes with alpha 0+; give --kappa for the ratio beta/alpha instead")
    if digits is None and (exact or certificate):
        option = "--exact" if exact else "--certificate"
        raise InputError(f"{option}: belongs to a proof; give --digits, such as --digits 20")
    if digits is not None and (bending_stiffness or mass_per_length or length):
        raise InputError("--digits: proofs are nondimensional; leave the beam in SI units out")
    if certificate and exact:
        raise InputError("--certificate: is written for a Ritz series; leave --exact out")
    if certificate and certificate.exists() and not force:
        raise InputError(f"{certificate} exists; choose another file, or --force to replace it")
    case = case_of(column, modes, alpha, beta, own, (bending_stiffness, mass_per_length, length), basis)
    units = case.units
    limit = {} if load_max is None else {"load_max": units.into("load", load_max)}
    if vanishing:
        limit["kappa"] = float(kappa or ZERO)
    proven = None
    if digits is not None:
        asked: dict[str, Any] = {"digits": digits, **({} if load_max is None else {"load_max": load_max.exact})}
        asked |= {"kappa": (kappa or ZERO).exact} if vanishing else {}
        asked |= {name: value.exact for name, value in assignments(own).items()}
        with working("proof") as report:
            if exact:
                proven = fb.exact_load(case.column, alpha.exact, beta.exact, **asked)
            else:
                proven = fb.certified_load(case.column, case.modes, alpha.exact, beta.exact, progress=report, **asked)
        if certificate:
            with written(certificate, force) as file:
                file.write((json.dumps(proven.certificate, indent=1) + "\n").encode())
    with working("critical load") as report, nondimensional(units):
        found = fb.critical_load(case.column, modes=case.modes, alpha=case.alpha, beta=case.beta, **limit, **case.own)
        report("convergence in the number of modes")
        more = found.convergence
    record = case.record(
        load=units.out("load", found.load),
        kind=found.kind,
        frequency=units.out("frequency", found.frequency),
        converged=more.converged,
        convergence={"modes": more.modes, "load": units.out("load", more.load), "kind": more.kind},
        load_max=units.out("load", found.load_max),
    )
    if proven is not None:
        load, frequency = proven.load or (None, None), proven.frequency or (None, None)
        record |= {"load_lower": load[0], "load_upper": load[1]}
        record |= {"frequency_lower": frequency[0], "frequency_upper": frequency[1]}
        record |= {"proof": dict(proven.proof), "exact": exact, "kind": proven.kind}
    if as_json:
        print_json(record)
        return
    load_unit = units.of("load")
    there: str = more.kind
    if found.load is None:
        rows = [["critical load", f"none up to {record['load_max']:.10g}{load_unit}"]]
    else:
        rows = [["critical load", f"{record['load']:.10g}{load_unit}"], ["kind", found.kind]]
        rows += [["frequency", f"{record['frequency']:.10g}{units.of('frequency')}"]]
    if more.load is not None:
        there += f" at {record['convergence']['load']:.10g}{load_unit}"
    rows += [["converged", f"{'yes' if more.converged else 'no'} (N = {more.modes}: {there})"]]
    if proven is not None:
        what = "the beam itself" if exact else f"N = {case.modes}"
        rows += [[f"proven, {what}", " to ".join(proven.load) if proven.load else "none up to the load given"]]
        rows += [["proven is", ", ".join(name.replace("_", " ") for name, yes in proven.proof.items() if yes)]]
    print_table(rows, title=case.title())


@app.command(epilog="Example: freebeam verify certificate.json")
def verify(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A certificate of `critical --certificate`.")],
    as_json: JsonOption = False,
) -> None:
    """Check a certificate with a program that shares no code with the one that wrote it."""
    import freebeam_sym as fb

    with working("verify"):
        sentence = fb.verify_certificate(str(file))
    if as_json:
        print_json({"file": str(file), "verified": True, "proves": sentence})
        return
    typer.echo(f"{file}: {sentence}")


@app.command(epilog="Example: freebeam spectrum --load 50 --alpha 1e-3 --beta 0.1")
def spectrum(
    load: LoadOption,
    column: ColumnOption = "free-free",
    basis: BasisOption = None,
    modes: ModesOption = 8,
    alpha: AlphaOption = ZERO,
    beta: BetaOption = ZERO,
    rigid: RigidOption = False,
    own: SetOption = None,
    bending_stiffness: StiffnessOption = None,
    mass_per_length: MassOption = None,
    length: LengthOption = None,
    as_json: JsonOption = False,
) -> None:
    """Print the eigenvalues at a load, sorted by |Im|, then Re."""
    import freebeam_sym as fb

    case = case_of(column, modes, alpha, beta, own, (bending_stiffness, mass_per_length, length), basis)
    units = case.units
    found = fb.spectrum(case.system(units.into("load", load), rigid))
    record = case.record(
        load=load,
        rigid=rigid,
        eigenvalues=units.out("frequency", found.eigenvalues),
        reference_frequency=units.out("frequency", found.reference_frequency),
    )
    if as_json:
        print_json(record)
        return
    rows = [[f"{value.real:.10g}", f"{value.imag:.10g}"] for value in record["eigenvalues"]]
    unit = units.of("frequency")
    print_table(rows, [f"Re{unit}", f"Im{unit}"], case.title(load=f"{load}{units.of('load')}"))

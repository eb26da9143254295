"""`freebeam critical`, `freebeam verify` and `freebeam spectrum`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from freebeam.cli import ranging
from freebeam.cli.application import command
from freebeam.cli.options import (
    REQUIRED,
    CaseOptions,
    FileOptions,
    Number,
    Options,
    Rounded,
    SearchOptions,
    argument,
    flag,
    number,
    number_or_range,
    option,
    ratio,
    refuse,
    vanishing_or_number,
)
from freebeam.cli.output import print_json, print_table, working, write_picture, written

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from freebeam.certificates import Proven
    from freebeam.proofs import Certified, CertifiedCrossing, CertifiedCrossings
    from freebeam_sym.columns import Column
    from freebeam_sym.stability.critical import CriticalLoad

Rows = list[list[str]]

# --- critical ---------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Found:
    """What is found: the first loss of stability in floats, and what was proven; None where it was not asked for."""

    loss: CriticalLoad
    proven: Certified | None
    crossings: CertifiedCrossings | None
    truncation: dict[str, Any] | None


USUAL_DIGITS = 15
"""Of a proof where none are named."""


@dataclass(frozen=True, kw_only=True)
class ProofOptions(FileOptions):
    """Of every command that writes a certificate."""

    certificate: Path | None = option("FILE", "Write the proof to a file, which freebeam verify checks.")

    def keep(self, found: Proven, why: str = "") -> None:
        """Write the certificate of an answer to its file, once the verifier has accepted it. Raises InputError."""
        from freebeam.certificates import text

        assert self.certificate is not None
        with working("verify the certificate"):
            certificate = found.certificate
        refuse(certificate is None, f"{self.certificate}: is not written{why}: {found.missing}")
        assert certificate is not None
        with written(self.certificate, self.force) as file:
            file.write(text(certificate))

    def check_free(self) -> None:
        """Refuse a file that is there already, before the work is begun. Raises InputError."""
        file = self.certificate
        there = file and file.exists() and not self.force
        refuse(there, f"{file} exists; choose another file, or --force to replace it")


@command("freebeam critical --column beck --set eta=0.7 --alpha 1e-3")
class Critical(ProofOptions, CaseOptions, SearchOptions):
    """Find the lowest load at which the column loses stability, by flutter or by divergence."""

    alpha: Number = option(
        "X", "Internal damping alpha; 0+ for the limit of vanishing damping.", default="0", parser=vanishing_or_number
    )
    READ: ClassVar[Any] = staticmethod(number_or_range)
    beta: Number = option("X", "External damping beta.", default="0", parser=number_or_range)
    kappa: Number | None = option(
        "K", "With --alpha 0+: the ratio beta/alpha in that limit; 0 if not given, inf for beta alone.", parser=ratio
    )
    digits: int | None = option("D", "Prove the critical load to D digits; 15 where a proof is asked for otherwise.")
    exact: bool = flag(
        "Prove it of the beam itself, not of the series. One parameter may be a range then, such as "
        "--set eta=0.6..0.7: proven for each value in it, without --digits to 1 %."
    )
    every: bool = flag("Prove all loads up to --load-max at which an eigenvalue crosses the imaginary axis.", "--all")
    truncation: bool = flag("Prove the error of the series: its load minus the load of the beam itself.")
    plot: Path | None = option("FILE.svg|.png|.pdf", "Draw the eigenvalues over the load; of a limit its tangent.")

    def run(self) -> None:
        if ranging.ranges(self):
            ranging.prove(self)
            return
        self.check()
        found = self.compute()
        if self.certificate and found.crossings is not None:
            self.keep(found.crossings)
        elif self.certificate and found.proven is not None:
            self.keep(found.proven, "" if all(found.proven.proof.values()) else ", for not all of it is proven")
        if self.plot:
            with working("picture"):
                write_picture(self.plot, self.force, self.drawn, self.title())
        record = self.record_of(found)
        if self.as_json:
            print_json(record)
            return
        print_table(self.rows(found, record), title=self.title())
        if found.crossings:
            load, frequency = (self.units.of(quantity) for quantity in ("load", "frequency"))
            header = [f"load{load}", "kind", f"frequency{frequency}", "unstable eigenvalues", "stability"]
            of = " of the beam itself" if self.exact else ""
            title = f"All crossings{of} up to {record['load_max']:.10g}{load}: proven that there is no other"
            print_table([_crossing_row(crossing) for crossing in found.crossings], header, title)

    @property
    def places(self) -> int | None:
        """Digits of the proof that is asked for; None where none is."""
        proof = self.exact or self.every or self.certificate is not None
        return USUAL_DIGITS if proof and self.digits is None else self.digits

    def check_limit(self) -> None:
        """Refuse dampings that contradict a limit of vanishing damping. Raises InputError."""
        limit = "kappa" in self.dampings
        refuse(self.kappa and not limit, f"kappa = {self.kappa}: is a ratio of vanishing dampings; give --alpha 0+ too")
        cure = "give the ratio beta/alpha by --kappa instead"
        refuse(limit and float(self.beta), f"beta = {self.beta}: vanishes with --alpha 0+; {cure}")

    def check(self) -> None:
        """Refuse options that contradict one another. Raises InputError."""
        self.check_limit()
        file = self.certificate
        refuse(file and self.beam, "--certificate: is nondimensional; leave out the beam in SI units")
        refuse(self.truncation and self.exact, "--truncation: is about the Ritz series; leave out --exact")
        listed = self.exact and self.every
        refuse(listed and self.load_max is None, "--exact --all: up to which load? give --load-max, such as 50")
        if self.places is not None or self.truncation:
            for name, value in self.assigned.items():
                why = f"{name}: {value} in SI units is no rational number of it, of which nothing is proven"
                refuse(isinstance(value, Rounded), f"{why}; set {name} nondimensional")
        self.check_free()
        refuse(self.plot and self.beam, "--plot: is nondimensional; leave out the beam in SI units")

    @property
    def dampings(self) -> dict[str, Number]:
        """As they were typed; in the limit of vanishing damping with their ratio kappa."""
        limit = {"kappa": self.kappa or number("0")} if self.alpha.text == "0+" else {}
        return {"alpha": self.alpha, "beta": self.beta, **limit}

    @property
    def exactly(self) -> dict[str, Any]:
        """The question as the provers take it: exact numbers by name, in the units in which they were typed."""
        given = self.dampings | ({} if self.load_max is None else {"load_max": self.load_max}) | self.assigned
        beam = {"beam": tuple(x.exact for x in self.beam.values())} if self.beam else {}
        return {name: x.exact for name, x in given.items()} | beam

    def drawn(self) -> Figure:
        """Imaginary and real parts of the eigenvalues over the load; of a limit of vanishing damping the tangent that
        finds it."""
        from freebeam import figures
        from freebeam.figures.look import figure
        from freebeam.maps.known import answer

        q, drawn = self.question, figure((5.2, 3.8) if "kappa" in self.dampings else (10.4, 3.8))
        if q.kappa is not None:
            figures.tangent(q.column, modes=q.modes, kappa=q.kappa, ax=drawn.subplots(), **q.parameters)
            return drawn
        loads, asked = None if answer(q).load else q.load_max, dict[str, Any](modes=q.modes, **q.values)
        left, right = drawn.subplots(1, 2)
        figures.eigenvalues(q.column, loads, part="imaginary", ax=left, **asked)
        figures.eigenvalues(q.column, loads, part="real", ax=right, **asked)
        return drawn

    def compute(self) -> Found:
        """The proofs that are asked for, then the answer in floats. Raises InputError where something is not proven."""
        import freebeam as fb
        from freebeam.maps.known import answer

        proven, crossings, truncation = None, None, None
        of_series, digits = (self.chosen, self.question.modes), self.places
        if digits is not None or self.truncation:
            with working("proof") as report, self.units.in_errors():
                if digits is not None and self.exact and self.every:
                    crossings = fb.exact_crossings(self.chosen, digits=digits, progress=report, **self.exactly)
                elif digits is not None and self.exact:
                    proven = fb.exact_load(self.chosen, digits=digits, **self.exactly)
                elif digits is not None:
                    proven = fb.certified_load(*of_series, digits=digits, progress=report, **self.exactly)
                if digits is not None and self.every and not self.exact:
                    report("all crossings")
                    crossings = fb.certified_crossings(*of_series, digits=digits, progress=report, **self.exactly)
                if self.truncation or (proven and proven.load and not self.exact):
                    truncation = _truncation(*of_series, proven, self.exactly)
        with working("critical load") as report, self.units.in_errors():
            loss = answer(self.question)
            report("the beam itself")
            _ = loss.beam  # computed when it is first asked for
        return Found(loss, proven, crossings, truncation)

    def record_of(self, found: Found) -> dict[str, Any]:
        """All of it for JSON."""
        loss, out = found.loss, self.units.out
        beam = loss.beam and {
            "load": out("load", loss.beam.load), "kind": loss.beam.kind, "uncertainty": loss.beam.uncertainty,
        }  # fmt: skip
        record = self.record(
            load=out("load", loss.load), kind=loss.kind, frequency=out("frequency", loss.frequency), error=loss.error,
            converged=loss.converged, beam=beam, load_max=out("load", self.question.load_max),
            touches=[[out("load", touch.load), out("frequency", touch.frequency)] for touch in loss.touches],
        )  # fmt: skip
        if found.proven is not None:
            record |= _proof(found.proven, record, self.exact)
        if found.crossings is not None:
            record["crossings"] = [_crossing(crossing) for crossing in found.crossings]
        if found.truncation is not None:
            record["truncation"] = found.truncation
        return record

    def rows(self, found: Found, record: dict[str, Any]) -> Rows:
        """All of it as a table."""
        loss, unit = found.loss, self.units.of("load")
        none = f"none up to {record['load_max']:.10g}{unit}"
        kind = loss.kind if self.exact else record["kind"]  # of the series
        if record["load"] is None:
            rows = [["critical load", none]]
        else:
            rows = [["critical load", _digits(record["load"], loss.rounding) + unit], ["kind", kind]]
            rows += [["frequency", f"{record['frequency']:.10g}{self.units.of('frequency')}"]]
        rows += [["touches", f"{load:.10g}{unit}: stability is not lost"] for load, _ in record["touches"]]
        rows += [["the beam itself", _beam(record["beam"], kind, none, unit)]]
        if record["load"] is not None:
            error = "" if record["error"] is None else f" (error {record['error']:.1e})"
            rows += [["converged", ("yes" if record["converged"] else "no") + error]]
        if found.proven is not None:
            rows += self.rows_of_proof(found.proven, kind, none)
        if found.crossings == () and self.exact:
            rows += [["proven, the beam itself", f"no crossing, stable {none.removeprefix('none ')}"]]
        if found.truncation is not None:
            rows += [["truncation error", found.truncation.get("unknown") or _difference(found.truncation, unit)]]
        return rows

    def rows_of_proof(self, proven: Certified, kind: str, none: str) -> Rows:
        of = "the beam itself" if self.exact else f"N = {self.question.modes}"
        rows = [[f"proven, {of}", f"{' to '.join(proven.load)}{self.units.of('load')}" if proven.load else none]]
        if proven.frequency:
            rows += [["kind", proven.kind]] if proven.kind != kind else []
            rows += [["frequency", _interval(proven.frequency) + self.units.of("frequency")]]
        for other, frequency in proven.at_once:
            where = _interval(frequency) + self.units.of("frequency")
            rows += [["at that load too", other + (f" at the frequency {where}" if other == "flutter" else "")]]
        if proven.lasting:
            rows += [["undamped", f"motions of {' and '.join(proven.lasting)}: stable is there that none grows"]]
        for touch in proven.touches:
            where = _interval(touch.load) + self.units.of("load")
            rows += [["proven touch", f"{where}: an eigenvalue is zero there alone, and stability is not lost"]]
        rows += [["taken exactly", ", ".join(f"{name} = {value}" for name, value in proven.inputs.items())]]
        above = " (at loads above 0)" if proven.above_zero else " (but at touches)" if proven.touches else ""
        if not proven.load:
            return [*rows, ["proven is", f"stable {none.removeprefix('none ')}{above}"]]
        shown = [
            name.replace("_", " ") + (above if name == "stable_below" else "")
            for name, yes in proven.proof.items()
            if yes
        ]
        missing = [name.replace("_", " ") for name, yes in proven.proof.items() if not yes]
        if missing and proven.missing:
            missing[-1] += f": {proven.missing}"
        return [*rows, ["proven is", ", ".join(shown)], *([["not proven", ", ".join(missing)]] if missing else [])]


def _truncation(column: Column, modes: int, series: Certified | None, exactly: dict[str, Any]) -> dict[str, Any]:
    """The truncation error as a record; where it is not known, why."""
    import freebeam as fb
    from freebeam_sym.checks import InputError

    try:
        found = fb.truncation_error(column, modes, series=series, **exactly)
    except InputError as error:
        return {"unknown": str(error)}
    exact = found.beam.load or (None, None)
    difference = dict(zip(("difference_lower", "difference_upper"), found.difference, strict=True))
    return {**difference, "relative": found.relative, "exact_lower": exact[0], "exact_upper": exact[1]}


def _proof(proven: Certified, record: dict[str, Any], exact: bool) -> dict[str, Any]:
    """What a proof adds to the record, and what it changes there."""
    added: dict[str, Any] = {**_ends("load", proven.load), **_ends("frequency", proven.frequency)}
    added |= {"proof": dict(proven.proof), "exact": exact, "kind": proven.kind, "inputs": dict(proven.inputs)}
    if not exact:
        also = [{"kind": kind, **_ends("frequency", frequency)} for kind, frequency in proven.at_once]
        added |= {"above_zero": proven.above_zero, "at_once": also, "lasting": [*proven.lasting]}
    if exact:
        added |= {"missing": proven.missing or None, "evidence": proven.evidence and dict(proven.evidence)}
        added |= {"proven_touches": [_crossing(touch) for touch in proven.touches]}
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


def _beam(beam: dict[str, Any] | None, kind: str, none: str, unit: str) -> str:
    """The load of the beam itself, with its kind where that is another than that of the series."""
    if beam is None:
        return "not known: series of polynomials do not agree"
    if beam["load"] is None:
        return none
    load = _digits(beam["load"], beam["uncertainty"]) + unit
    return load if beam["kind"] == kind else f"{beam['kind']} at {load}"


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
    from freebeam.maps.verdict import digits_that_hold

    return digits_that_hold(value, error)


# --- verify -----------------------------------------------------------------------------------------------------


@command("freebeam verify certificate.json")
class Verify(Options):
    """Check a certificate by a program that shares no code with the one that wrote it."""

    file: Path = argument("FILE", "A certificate that --certificate of another command wrote.", default=REQUIRED)

    def run(self) -> None:
        import freebeam as fb

        with working("verify"):
            found = fb.verify_certificate(str(self.file))
        if self.as_json:
            print_json({"file": str(self.file), "verified": True, **found.record(), "proves": str(found)})
        else:
            print(f"{self.file}: {found}")


# --- spectrum ---------------------------------------------------------------------------------------------------


@command("freebeam spectrum --load 50 --alpha 1e-3 --beta 0.1")
class Spectrum(ProofOptions, CaseOptions):
    """Compute the eigenvalues at a load, sorted by |Im|, then by Re, with their damping ratios -Re/|lambda|.

    A pair has one line, that of Im > 0.
    """

    load: Number = option("P", "The load P.", default=REQUIRED)
    rigid: bool = flag("Include the rigid-body functions.")
    exact: bool = flag("Prove the eigenvalues of the beam itself, not of a series.")
    digits: int | None = option("D", "With --exact: prove each eigenvalue to D digits; 15 where not given.")
    plot: Path | None = option("FILE.svg|.png|.pdf", "Draw how the first ones came there from no load: a root locus.")

    def run(self) -> None:
        digits = self.digits
        refuse(digits is not None and not self.exact, f"--digits {digits}: is for the beam itself; give --exact too")
        refuse(self.certificate and not self.exact, "--certificate: is of the beam itself; give --exact too")
        self.check_free()
        refuse(self.exact and self.rigid, "--rigid: leave it out with --exact, which proves the elastic spectrum alone")
        refuse(self.exact and self.beam, "SI units: leave them out with --exact, which is nondimensional")
        refuse(self.plot and self.beam, "--plot: is nondimensional; leave out the beam in SI units")
        record, header, rows = (
            self.proven(USUAL_DIGITS if digits is None else digits) if self.exact else self.in_floats()
        )
        if self.plot:
            with working("picture"):
                write_picture(self.plot, self.force, self.drawn, self.title(load=str(self.load)))
        if self.as_json:
            print_json(record)
            return
        title = self.title(load=f"{self.load}{self.units.of('load')}")
        print_table(rows, header, title + (", the beam itself, each proven" if self.exact else ""))

    def in_floats(self) -> tuple[dict[str, Any], list[str], Rows]:
        """Of the series: for JSON, and the table with its header."""
        import freebeam as fb

        system = self.question.system(self.units.into("load", self.load), self.rigid)
        found, unit = fb.spectrum(system), self.units.of("frequency")
        values = self.units.out("frequency", found.eigenvalues)
        reference = self.units.out("frequency", found.reference_frequency)
        ratios = found.damping_ratio
        record = self.record(
            load=self.load, rigid=self.rigid, eigenvalues=values, error=found.error, reference_frequency=reference,
            damping_ratio=ratios,
        )  # fmt: skip
        rows = [
            [
                _part(v.real, abs(v), off), ("± " if v.imag > 0 else "") + _part(v.imag, abs(v), off),
                "" if math.isnan(ratio) else _ratio(ratio, off), _verdict(v, off),
                "" if math.isnan(error) else f"{error:.1e}",
            ]
            for v, off, ratio, error in zip(values, found.rounding, ratios, found.error, strict=True)
            if v.imag >= 0
        ]  # fmt: skip
        return record, [f"Re{unit}", f"Im{unit}", "damping ratio", "motion", "error"], rows

    def drawn(self) -> Figure:
        """The root locus from no load to this one."""
        from freebeam import figures
        from freebeam.figures.look import figure

        q, drawn = self.question, figure((5.6, 4.6))
        top = self.units.into("load", self.load)
        refuse(not top > 0, f"--plot: begins at no load; load = {self.load} must be above 0")
        asked: dict[str, Any] = {"modes": q.modes, **q.values}
        figures.root_locus(q.column, top, count=min(3, q.modes), ax=drawn.subplots(), **asked)
        return drawn

    def proven(self, digits: int) -> tuple[dict[str, Any], list[str], Rows]:
        """Of the beam itself, in the same form."""
        import freebeam as fb

        own = {name: value.exact for name, value in self.assigned.items()}
        values = (self.load.exact, self.alpha.exact, self.beta.exact)
        with working("proof"):
            found = fb.exact_spectrum(self.chosen, *values, modes=self.question.modes, digits=digits, **own)
        boxes = {"eigenvalues_lower": found.lower, "eigenvalues_upper": found.upper}
        if self.certificate:
            self.keep(found, "" if found.complete_to else ", for it is not proven up to which |λ| none is missing")
        complete = {"complete_to": found.complete_to, "missing": found.missing or None, "certificate": self.certificate}
        record = self.record(load=self.load, exact=True, digits=digits, **boxes, unproven=found.unproven, **complete)
        boxes_of = zip(found.lower, found.upper, strict=True)
        rows = [[_interval(ends) for ends in zip(low, high, strict=True)] for low, high in boxes_of]
        rows += [[f"near {v.real:.6g}: not proven", f"near {v.imag:.6g}"] for v in found.unproven]
        whole = f"up to {found.complete_to}" if found.complete_to else f"not proven: {found.missing}"
        rows += [["all with |λ|", whole]]
        return record, ["Re", "Im"], rows


def _ratio(ratio: float, rounding: float) -> str:
    """A damping ratio to four digits, or as many as hold."""
    return _digits(ratio, max(5e-5, rounding / abs(ratio))) if ratio else "0"


def _verdict(value: complex, rounding: float) -> str:
    """What a motion of this eigenvalue does, beyond rounding."""
    if abs(value.real) <= rounding * abs(value):
        return "neutral"
    return "decays" if value.real < 0 else "diverges" if value.imag == 0 else "flutters"


def _part(part: float, size: float, rounding: float) -> str:
    """Real or imaginary part of a number of this size, to the digits that its relative rounding leaves."""
    return "0" if abs(part) <= rounding * size else _digits(part, rounding * size / abs(part))

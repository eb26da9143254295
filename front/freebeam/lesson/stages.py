"""The chapters that derive: from the statement to the matrices, printed from the record of the pipeline."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from freebeam.lesson.blocks import Block, Cell, Check, Equation, Erratum, Figure, Folded, Heading, Listing, Prose
from freebeam.lesson.errata import entries

if TYPE_CHECKING:
    from freebeam_derive.pipeline import Derived
    from freebeam_derive.record import Step
    from freebeam_sym.columns import Column

__all__ = ["Chapter", "derivation_chapters", "newmark_chapter"]

# What the parts of a result are called, where the record holds expressions without a left side.
NAMES: dict[str, tuple[str, ...]] = {
    "Solve for the eigenvalues": (r"\lambda_{0}^{(1)}", r"\lambda_{0}^{(2)}"),
    "Integrate products of two modes": tuple(
        rf"\int_{{0}}^{{1}} \varphi_{{i}}{primes} \varphi_{{{j}}}{primes}\,dx"
        for j in "ji"
        for primes in ("", r"^{\prime\prime}")
    ),
    "Integrate their squares": (r"\int_{0}^{1} \varphi_{d}^{2}\,dx",),
    "Newmark's two assumptions": (r"q_{+}", r"\dot{q}_{+}"),
    "the equation of motion at the end of the step": ("0",),
    "solved for the new acceleration": ("S", "r", r"\ddot{q}_{+}"),
    "a change of coordinates": ("0",),
    "the amplification matrix": ("A",),
    "characteristic polynomial and spectral radius": ("0",),
    "growth in any system": ("m", "c", "k", ""),
    "stability conditions": ("f_{2}", "f_{1}", "f_{0}"),
    "unconditional stability": ("f_{2}", "f_{1}", "f_{0}"),
    "the largest stable step": (r"\Omega_{\mathrm{crit}}",),
    "order of accuracy": ("e_{2}", "e_{3}", r"\text{order}"),
    "errors of period and damping": ("c_{2}", "c_{3}", r"\xi_{\mathrm{num}}", r"\Delta T / T"),
    "energy": (r"\Delta_{\mathrm{sym}}", r"\Delta"),
}  # fmt: skip
# Of some results only a part is shown: its other forms are for the program.
SHOWN = {"characteristic polynomial and spectral radius": 0, "the largest stable step": 1}
RIGID = "Keep what the ends let move as a rigid body"
LONG = 420
"""Characters of LaTeX beyond which a formula is folded."""

# The cells of a notebook that do a step themselves; every other one shows it from the record.
CODE: dict[str, str] = {
    "Take the first variation of the energies and add the virtual work": """\
T, V, W_c, dW_nc = (column.energies.functional(name) for name in ("T", "V", "W_c", "dW_nc"))
varied = [variation.first_variation(work) for work in (T, V.scaled(-1), W_c)]
action = varied[0] + varied[1] + varied[2] + dW_nc
show(Eq(display(action), 0, evaluate=False))""",
    "Integrate the kinetic term by parts in time": """\
show(display(varied[0]), display(variation.off_the_rates(varied[0])))""",
    "Read off the weak form": """\
weak = variation.off_the_rates(action).scaled(-1)
show(Eq(display(weak), 0, evaluate=False))""",
    "Integrate by parts along the beam until δy stands bare": """\
strong, bracket = variation.by_parts(weak.density)
show(statement.show(strong), statement.show(bracket))""",
    "State the equation of motion": """\
motion = variation.derive_column(column)
show(motion.equation)""",
    "State the natural end conditions": """\
show(*(motion.condition(*place) for place in sorted(motion.natural)))""",
    "Substitute it into the weak form": """\
system = ritz.derive(motion)
for name in "MCK":
    show(Eq(Symbol(f"{name}_ij"), getattr(system, name).expression, evaluate=False))""",
    "Split the geometric stiffness off": """\
show(Eq(Symbol("H_ij"), system.H.expression, evaluate=False))""",
    "Compare the damping with mass and elastic stiffness": """\
print("C = c_M M + c_E E with c_M =", system.c_M, "and c_E =", system.c_E)""",
    "Name the factor of χ": """\
damped = comparison.damped_modes(motion)
show(damped.quartic if damped else Symbol("none"))""",
    "Set the determinant to zero": """\
unloaded = comparison.comparison_beam(column.ends)
for n in (1, 2, 3):
    print(f"gamma_{n} =", roots.root(unloaded, n))""",
    "Solve for the coefficients": """\
show(unloaded.mode())""",
    RIGID: """\
show(*unloaded.rigid)""",
    "Integrate products of two modes": """\
for order in (0, 2):
    different = integrals.assembled(integrals.integral_modes(unloaded, 0, order, order))
    show(different, integrals.integral_same(unloaded, 0, order, order))""",
    "Write the load's matrix in closed form": """\
for (k, p, q), factor in system.H.along.items():
    show(factor * integrals.assembled(integrals.integral_modes(unloaded, k, p, q)))""",
    "Integrate their squares": """\
polynomials = legendre.polynomials(column.ends)
show(polynomials.norm)""",
}


LOUD = {
    "Compare the damping with mass and elastic stiffness", "Name the factor of χ", "Set the determinant to zero",
    "Write the load's matrix in closed form",
}  # fmt: skip
"""Steps whose cell shows something else than the record does."""


class Chapter:
    """Steps of a record as blocks: each with what it started from, its result, and its check."""

    def __init__(self, derived: Derived, paper: bool) -> None:
        from freebeam_derive.latex import printer

        self.derived, self.paper = derived, paper
        self.printer = printer(derived.column)
        self.steps = derived.steps
        self.told: set[str] = set()
        self.residuals: dict[tuple[str, str, str], float] = {}
        self.shown: set[tuple[str, ...]] = set()

    def of(self, stage: str) -> list[Step]:
        return [step for step in self.steps if step.stage == stage]

    def find(self, what: str) -> Step | None:
        return next((step for step in self.steps if step.what == what), None)

    def lines(self, step: Step, part: Any) -> tuple[str, ...]:
        """LaTeX of what a step has before or after it."""
        self.printer.own.pop("lambda", None)
        if step.stage == "modes":
            self.printer.own["lambda"] = r"\lambda_{0}"
        if part is step.after and step.what in NAMES:
            part = part[SHOWN[step.what]] if step.what in SHOWN else part
            return tuple(self.printer.labelled(part, NAMES[step.what]))
        if part is step.after and step.what == RIGID:
            names = tuple(rf"r_{{{k + 1}}}" for k in range(len(part)))
            return tuple(self.printer.labelled(part, names))
        return tuple(self.printer.lines(part))

    def step(self, step: Step, said: bool = True) -> tuple[Block, ...]:
        """One step: why, from what, what came of it, what proved it; then the errata of its equation."""
        number = step.equation.removeprefix("Eq. (").removesuffix(")") if step.equation.startswith("Eq.") else ""
        what = step.what[0].upper() + step.what[1:]
        for plain, letter in (("T", "T"), ("V", "V"), ("W_c", "W_{c}"), ("dW_nc", r"\delta W_{\mathrm{nc}}")):
            what = what.replace(f"Write {plain} in", f"Write ${letter}$ in")
        shown: list[Block] = []
        if _formula(step.before) and step.stage != "scaling":
            start = self.lines(step, step.before)
            if start not in self.shown:
                shown.append(Folded("What it started from", (Equation(start),)))
                self.shown.add(start)
        if _formula(step.after):
            after = step.after
            if step.stage == "scaling":
                name = {"W_c": "W_{c}", "dW_nc": r"\delta W_{\mathrm{nc}}"}.get(
                    step.what.split()[1], step.what.split()[1]
                )
                lines = self.scaled(step, name)
                result = Equation(lines, number)
            else:
                result = Equation(self.lines(step, after), number)
            long = sum(map(len, result.lines)) > LONG * (2 if len(result.lines) > 2 else 1) and step.stage == "newmark"
            shown.append(Folded("The formula, which is long", (result,)) if long else result)
            self.shown.add(result.lines)
        shown.append(Check(written(step.check), self.residual(step)))
        code = CODE.get(step.what, "")
        quiet = ", shown=True" if code and step.what not in LOUD else ""
        cell = Cell((code + "\n" if code else "") + f"proven(derived, {step.what!r}{quiet})", tuple(shown))
        text = f"**{what}.** {_sentence(step.why)}" if said else f"**{what}.**"
        return (Prose(text), cell, *self.errata(step.equation))

    def section(self, stage: str, title: str, opening: str, key: str = "", said: bool = True) -> list[Block]:
        """A heading, what it is about, and the steps of a stage without those that are numbered."""
        found: list[Block] = [Heading(title, 2, key or stage), Prose(opening)]
        for step in self.of(stage):
            if not _numbered(step):
                found += self.step(step, said)
        return found

    def residual(self, step: Step) -> float:
        """What the step's proof leaves; it is run once."""
        key = (step.stage, step.what, step.why)
        if key not in self.residuals:
            self.residuals[key] = step.residual()
        return self.residuals[key]

    def scaled(self, step: Step, name: str) -> tuple[str, ...]:
        with_dimensions = self.printer.labelled(step.before, (name,))
        without = self.printer.labelled(step.after, (rf"\frac{{L}}{{EI}}\,{name}",))
        return (*with_dimensions, *without)

    def errata(self, *places: str) -> tuple[Block, ...]:
        """Errata about these places of the paper, each told once."""
        if not self.paper:
            return ()
        found = []
        for entry in entries():
            if entry.title not in self.told and set(entry.places) & set(places):
                self.told.add(entry.title)
                kept = tuple(p for p in entry.paragraphs if not p.startswith("Checked by"))
                found.append(Erratum(entry.title, kept))
        return tuple(found)


def _numbered(step: Step) -> bool:
    """Whether a step is one of the four conditions on trial functions, "1)" to "4)"."""
    return step.why[1:2] == ")"


def _formula(part: Any) -> bool:
    """Whether a record's object is mathematics to print, and not a name or a list of orders."""
    if isinstance(part, tuple):
        return bool(part) and all(_formula(item) for item in part)
    return not isinstance(part, str | int) and part is not None


_LETTERS = "lambda omega Omega rho Phi Psi xi kappa gamma alpha beta".split()


def written(text: str) -> str:
    """A sentence of the record with its formulas as mathematics: e^(λt), h^2, omega, λ₀ and the like."""
    text = re.sub(r"e\^\(([^)]*)\)", lambda m: rf"$\mathrm{{e}}^{{{_greek(m[1])}}}$", text)
    text = re.sub(r"\b([a-zA-Z]+)\^(\d)\b", lambda m: rf"${_greek(m[1])}^{{{m[2]}}}$", text)
    return re.sub(rf"\b({'|'.join(_LETTERS)})\b(?![^$]*\$(?:[^$]*\$[^$]*\$)*[^$]*$)", lambda m: rf"$\{m[1]}$", text)


def _greek(text: str) -> str:
    for letter, name in {"λ₀": r"\lambda_{0} ", "λ": r"\lambda ", "γ": r"\gamma ", "−": "-"}.items():
        text = text.replace(letter, name)
    return re.sub(rf"\b({'|'.join(_LETTERS)})\b", r"\\\1", text) if "\\" not in text else text


def _sentence(text: str) -> str:
    text = text.strip()
    first = text.split()[0] if text else ""
    if (first.isascii() and first.isalpha() and len(first) > 1) or first.lower() == "a":
        text = text[0].upper() + text[1:]
    return written(text) + ("" if text.endswith(".") else ".")


def derivation_chapters(chapter: Chapter, kernels: Column, source: Path | None) -> tuple[Block, ...]:
    """From the statement to the matrices. Eqs. (1)-(23)."""
    from freebeam import figures
    from freebeam_derive.notation import P, x

    column = chapter.derived.column
    blocks: list[Block] = [
        Heading("The statement", 2, "statement"),
        Prose(
            "Everything below follows from four lines: the kinetic energy $T$, the strain energy $V$, the work "
            "$W_{c}$ of "
            "the forces that have a potential, and the virtual work $\\delta W_{\\mathrm{nc}}$ of those that have "
            "none; and "
            f"from the ends, {column.ends[0]} at $x = 0$ and {column.ends[1]} at $x = 1$. A prime is a derivative "
            "along the beam, a dot one in time, and $y'(1)$ is the slope at the end."
        ),
    ]
    blocks.append(
        Cell("", (Figure("beam", lambda: figures.beam(kernels), "Deflected as in its lowest mode.", "The column"),))
    )
    if source is not None:
        code = source.read_text(encoding="utf-8").strip()
        blocks.append(Cell(f"{code}", (Folded("The statement as the program reads it", (Listing(code),)),)))
    blocks.append(
        Cell(
            "derived = pipeline.derive(column)\n"
            'for name in ("T", "V", "W_c", "dW_nc"):\n'
            "    show(Eq(Symbol(name), display(column.energies.functional(name)), evaluate=False))",
            _statement(chapter),
        )
    )
    blocks += chapter.errata("Eq. (1)", "Eq. (2)", "Eq. (3)", "Eq. (4)")
    if chapter.derived.scaling:
        blocks += chapter.section(
            "scaling",
            "Away with the units",
            "A beam has three dimensional quantities, $EI$, $m$ and $L$; they serve as units. Lengths are "
            "measured in $L$, time in $(m L^{4} / EI)^{1/2}$, forces in $EI / L^{2}$ and energies in $EI / L$. "
            "What is left has no units, and one solution serves every beam.",
            said=False,
        )
    blocks += chapter.section(
        "variation",
        "Hamilton's principle",
        "Imagine the true motion displaced a little, by $\\delta y$, at every place and instant between two "
        "instants at which it is given. Hamilton's principle says that energies and work balance to first order, "
        "whatever $\\delta y$ is. One equation for all $\\delta y$ is an equation of motion and its end "
        "conditions at once: integration by parts pulls them apart.",
    )
    blocks += chapter.section(
        "Ritz series",
        "Ritz's series",
        (
            "The load's part of the equation of motion varies along the beam, and no solution in elementary "
            "functions is known. "
            if chapter.derived.motion.strong.coeff(P).has(x)
            else "This equation could be solved as it stands, for each load anew; a series needs the load's part once. "
        )
        + "Ritz's way is to let the beam move only in shapes $\\varphi_{j}$ chosen beforehand, and to ask the "
        "weak form to hold for $\\delta y = \\varphi_{i}$ alone. Row $i$ of every matrix then belongs to the test "
        "function and column $j$ to the motion: with a follower force the two must not be confused.",
        "ritz",
    )
    blocks += chapter.section(
        "modes",
        "Shapes to build with: the comparison beam",
        "Which shapes? Those of a uniform beam with the same ends, without load and with nothing attached to it: they "
        "meet its end conditions, are orthogonal, and there is one for every frequency. Damping changes their "
        "frequencies and leaves the shapes alone.",
    )
    blocks += _admissible(chapter, "modes", "section 3.1 asks four things of a trial function; the modes meet each:")
    blocks += chapter.errata("Section 3.1")
    blocks += chapter.section(
        "integrals",
        "Integrals without integrating",
        "The matrices hold integrals of $x^{k} \\varphi_{i}^{(p)} \\varphi_{j}^{(q)}$. The sixteen products of "
        "the first four derivatives of two modes go over into one another when differentiated, because the fourth "
        "derivative is $\\gamma^{4}$ times the mode. Differentiation is thus a matrix of sixteen rows, and an "
        "antiderivative is the solution of linear equations, exact. The end conditions strike out most of what is "
        "left.",
    )
    blocks += chapter.section(
        "polynomials",
        "A second set of shapes: polynomials",
        "Natural end conditions are the energies' own, and trial functions need not meet them. So polynomials "
        "will do, as long as they meet the geometric ones. Every integral is then a rational number, and the "
        "series converges far faster, as the last chapter of the physics shows.",
    )
    blocks += _admissible(chapter, "polynomials", "The same four conditions, for the polynomials:")
    return tuple(blocks)


def _statement(chapter: Chapter) -> tuple[Block, ...]:
    """The statement as formulas: it is what the proof of the variation evaluates."""
    step = chapter.find("Take the first variation of the energies and add the virtual work")
    assert step is not None
    lines = tuple(chapter.printer.lines(step.before))
    text = "read from the statement into its derivatives; the variation of what was read equals that of the energies"
    return (Equation(lines, "8"), Check(text, chapter.residual(step)), *chapter.errata("Eq. (8)"))


def _admissible(chapter: Chapter, stage: str, opening: str) -> tuple[Block, ...]:
    blocks: list[Block] = [Prose(opening[0].upper() + opening[1:])]
    for step in chapter.of(stage):
        if not _numbered(step):
            continue
        shown: list[Block] = []
        if _formula(step.after) and stage == "modes" and step.why[0] in "23":
            shown.append(Equation(chapter.lines(step, step.after)))
        shown.append(Check(written(step.check), chapter.residual(step)))
        blocks += [
            Prose(written(step.why) + "."),
            Cell(f"proven(derived, {step.what!r}, {step.why[:2]!r}, {stage!r})", tuple(shown)),
        ]
    return tuple(blocks)


def newmark_chapter(chapter: Chapter) -> tuple[Block, ...]:
    """Newmark's method, which the paper uses and does not print."""
    return (
        *chapter.section(
            "newmark",
            "Marching in time",
            "To see what a sensor sees, Eq. (10) is marched in time by Newmark's method. The paper names the method "
            "and prints none of it; here it is, from two assumptions. $h$ is the step, $\\Omega = \\omega h$, $\\xi$ "
            "a damping ratio, $\\rho$ the growth in one step, and a plus marks the end of the step.",
        ),
        *chapter.errata("Section 4.5", "Abstract"),
    )

"""`freebeam show`: a column at a glance."""

from __future__ import annotations

import sys
from functools import cached_property
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from freebeam.cli.application import command
from freebeam.cli.options import CaseOptions, FileOptions, SearchOptions, argument, option, refuse
from freebeam.cli.output import print_json, print_table, working, write_picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from freebeam_sym.columns import Column
    from freebeam_sym.question import Question
    from freebeam_sym.stability.critical import CriticalLoad

MOST_BRANCHES = 6
"""Eigenvalues that are followed along the load, to see which grows."""
CURVE, MAP, FEW = 33, 25, 9
"""Values of a parameter in a curve, of each damping in a map, and in one of which each point is a search."""
ENOUGH = 6
"""Functions a segment for a picture of a column of segments; they leave less than a line's width."""
DAMPINGS = {"alpha": (1e-5, 1e-1), "beta": (1e-3, 1e1)}
"""Of a map, from the first to the second: from hardly any to about critical in the first modes."""
SHADES = ".:-=+*oO#@"
"""Of a map in plain text, from the least load to the largest."""


@command("freebeam show beck --set eta=0.7 --output beck.png")
class Show(FileOptions, CaseOptions, SearchOptions):
    """Show a column in one picture: frequencies over the load, root locus, the motion that is lost first, and the
    critical load over its dampings or over a parameter of its own.

    Without --output it is drawn in plain text. Of a column that is unstable at the smallest loads the motion that grows
    there is drawn instead.
    """

    name: str | None = argument("[COLUMN]", "A column's name, or its file; as --column.")
    output: Path | None = option("FILE.svg|.png|.pdf", "Write a picture.")

    def run(self) -> None:
        refuse(self.beam, "SI units: leave them out; what is shown is nondimensional")
        if self.output is not None:
            with working("picture"):
                write_picture(self.output, self.force, self.figure, self.title())
        else:
            with working("column"):
                lines = self.lines()
        loss = self.loss
        found = {"load": loss.load, "kind": loss.kind, "frequency": loss.frequency} if loss else {"load": None}
        record = self.record(
            **found,
            **({} if loss else {"kind": "unstable", "grows": dict(zip(("load", "rate"), self.growing, strict=True))}),
        )
        if self.as_json:
            print_json(record | ({"output": self.output} if self.output else {}))
            return
        print_table(self.rows, title=self.title())
        if self.output is not None:
            print(self.output)
        else:
            sys.stdout.write("".join(f"{line}\n" for line in lines))

    @cached_property
    def chosen(self) -> Column:
        import freebeam as fb

        return fb.column(self.name or self.column, self.basis)

    @cached_property
    def question(self) -> Question:
        asked = super().question
        return asked.over(asked.column, ENOUGH) if self.modes is None and asked.column.general else asked

    @cached_property
    def loss(self) -> CriticalLoad | None:
        """None where something grows at the smallest loads."""
        from freebeam.figures import curves

        return curves.first_loss(self.question)

    @cached_property
    def scale(self) -> float:
        """A load by which something has happened: up to which a column is drawn that has no first loss of stability."""
        return min(self.question.load_max, 2 * self.question.general.unit)

    @cached_property
    def growing(self) -> tuple[float, complex]:
        """Of what grows at the smallest loads: the load, 0 or a small one, and the eigenvalue that grows most."""
        from freebeam.figures.curves import unstable
        from freebeam_sym.spectra import spectrum

        for load in (0.0, 1e-3 * self.scale):
            values = spectrum(self.question.system(load)).elastic
            if unstable(values).any():
                break
        worst = values[values.real.argmax()]
        return load, complex(worst.real, abs(worst.imag))

    @property
    def drawn_at(self) -> float | None:
        """The load at which a motion is drawn; None for the critical load."""
        if self.loss is None:
            return self.growing[0]
        return 0.0 if self.loss.load is None else None

    @property
    def rows(self) -> list[list[str]]:
        """What is found, in words."""
        loss = self.loss
        if loss is None:
            load, rate = self.growing
            grows = f"at P = {load:.4g} as exp(λt), λ = {rate.real:.6g} + {rate.imag:.6g}i"
            return [["critical load", "none: unstable at the smallest loads"], ["grows", grows]]
        if loss.load is None or loss.frequency is None:
            return [["critical load", f"none up to {self.question.load_max:.10g}"]]
        return [["critical load", f"{loss.load:.10g} by {loss.kind}"], ["frequency", f"{loss.frequency:.6g}"]]

    @property
    def top(self) -> float | None:
        """The largest load that is drawn; None for one a little beyond the critical load."""
        if self.loss is None:
            return self.scale
        return self.question.load_max if self.loss.load is None else None

    @cached_property
    def over(self) -> tuple[dict[str, Any], Any]:
        """The critical load over two dampings, over a parameter of the column's own, or over one damping: the axes by
        name, and loads over them. No axes where the column has none of these."""
        import numpy as np

        from freebeam.maps.grid import solve_grid
        from freebeam_sym.checks import InputError

        column = self.chosen
        count = FEW if column.general else MAP
        dampings = {name: np.geomspace(*DAMPINGS[name], count) for name in column.damping}
        own = {
            p.name: np.linspace(p.low, p.high, CURVE + 1)[1:] for p in column.parameters[:1]
        }  # no spring may be zero
        axes = dampings if len(dampings) == 2 else own or dampings
        try:
            return axes, solve_grid(self.question, axes).load if axes else None
        except InputError:  # at some value the column is not stable without load
            return {}, None

    @property
    def damped(self) -> bool:
        """Whether anything in the column hangs on rates."""
        q = self.question
        return bool(q.alpha or q.beta or q.column.coefficients(q.modes, False, **q.parameters).C)

    @cached_property
    def branches(self) -> int:
        """How many eigenvalues are followed along the load: two, or more where it is a higher one that grows."""
        from freebeam.figures import curves

        most = min(MOST_BRANCHES, self.question.modes)
        growing = curves.locus(self.question, self.top, count=most, points=32).unstable.any(axis=0)
        return min(most, max(2, int(growing.argmax()) + 1))

    def figure(self) -> Figure:
        """The picture."""
        from freebeam import figures
        from freebeam.figures.look import figure
        from freebeam_sym.checks import InputError

        q, drawn, count = self.question, figure((11.0, 8.2)), self.branches
        (first, second), (third, fourth) = drawn.subplots(2, 2)
        asked: dict[str, Any] = {"modes": q.modes, **q.values}
        if self.damped:
            figures.eigenvalues(q.column, self.top, count=count, ax=first, **asked)
        else:
            own = {name: value for name, value in asked.items() if name not in ("alpha", "beta")}
            figures.frequency_load(q.column, self.top, count=count, ax=first, **own)
        figures.root_locus(q.column, self.top, count=count, ax=second, **asked)
        try:
            figures.mode_shape(q.column, self.drawn_at, ax=third, **asked)
        except InputError:  # what is lost does not oscillate, or there is no beam
            self.draw_still(third) if q.column.ends else self.draw_column(third)
        if self.loss is None:
            third.set_title(
                f"{third.get_title('left')}, grows by Re $\\lambda$ = {self.growing[1].real:.4g}", loc="left"
            )
        axes, loads = self.over
        if not axes:
            self.draw_column(fourth)
        elif len(axes) == 2:
            figures.stability_map(
                loads,
                *axes.values(),
                xlabel=r"internal damping $\alpha$",
                ylabel=r"external damping $\beta$",
                ax=fourth,
            )
        else:
            ((name, values),) = axes.items()
            rest = {k: v for k, v in asked.items() if k != name}
            figures.critical_curve(q.column, name, values, load_max=q.load_max, ax=fourth, **rest)
        drawn.suptitle(q.column.title)
        return drawn

    @property
    def still(self) -> tuple[Any, Any]:
        """Places, and the deflection of least stiffness at the load of the picture, largest 1: what diverges."""
        import numpy as np

        x = np.linspace(0.0, 1.0, 101)
        load = self.loss.load if self.loss else self.growing[0]
        system = self.question.system(load or 0.0)
        shape = np.linalg.svd(system.K)[2][-1] @ system.shapes(x)
        return x, shape / shape[np.abs(shape).argmax()]

    def draw_still(self, ax: Any) -> None:
        from freebeam.figures.look import drawing

        with drawing(ax) as ax:
            ax.plot(*self.still)
            ax.axhline(0.0, color="#8A8A8A", lw=0.8)
            ax.set(xlabel="place $x$ on the beam", ylabel="deflection $y$", title="divergence")

    def draw_column(self, ax: Any) -> None:
        """The column itself, or why it cannot be drawn."""
        from freebeam import figures
        from freebeam_sym.checks import InputError

        try:
            figures.beam(self.question.column, ax=ax, **self.question.parameters)
        except InputError as reason:  # a kernel's file has no statement
            ax.axis("off")
            ax.text(0.5, 0.5, "\n".join(wrap(str(reason), 50)), ha="center", va="center", fontsize=9)

    def lines(self) -> list[str]:
        """The same in plain text."""

        from freebeam.cli.plain_plots import plotted
        from freebeam.figures import curves

        found = curves.locus(self.question, self.top, count=self.branches, points=128)
        values, marks = found.eigenvalues, "123456789"
        branches = range(values.shape[1])
        pieces = [plotted([(found.loads, values[:, k].imag, marks[k]) for k in branches], "load", "frequency Im λ")]
        locus = [(values[:, k].real, values[:, k].imag, marks[k]) for k in branches]
        pieces.append(plotted(locus, "Re λ", "root locus, Im λ"))
        if self.question.column.ends:
            pieces.append(self.lines_of_motion())
        pieces.append(self.lines_over())
        return [line for piece in pieces for line in (*piece, "")]

    def lines_of_motion(self) -> list[str]:
        """The least stable motion, or the deflection that grows."""
        import numpy as np

        from freebeam.cli.plain_plots import plotted
        from freebeam.figures import curves
        from freebeam_sym.checks import InputError

        x = np.linspace(0.0, 1.0, 101)
        try:
            Y = curves.cycle(self.question, self.drawn_at).shape(x)
            Y = Y * np.exp(-1j * np.angle(Y[np.abs(Y).argmax()]))
            motion = [(x, Y.real, "*"), (x, (Y * 1j).real, "o")]
            return plotted(motion, "place x", "least stable motion: * at t = 0, o a quarter period later")
        except InputError:
            return plotted([(*self.still, "*")], "place x", "deflection that grows")

    def lines_over(self) -> list[str]:
        """The critical load over dampings or a parameter."""
        import numpy as np

        from freebeam.cli.plain_plots import plotted

        axes, loads = self.over
        if not axes or not np.isfinite(loads).any():
            return []
        if len(axes) == 1:
            ((name, values),) = axes.items()
            return plotted([(values, loads, "*")], name, "critical load")
        low, high = np.nanmin(loads), np.nanmax(loads)
        share = (loads - low) / ((high - low) or 1.0)
        shades = np.where(np.isnan(share), " ", np.array([*SHADES])[np.nan_to_num(share * 9.99).astype(int)])
        text = [f"critical load from {low:.4g} ({SHADES[0]}) to {high:.4g} ({SHADES[-1]}); beta upwards, alpha across"]
        for k in range(len(shades) - 1, -1, -1):
            edge = f"{axes['beta'][k]:.0e}" if k in (0, len(shades) - 1) else ""
            text.append(f"{edge:>10} |" + "".join(2 * mark for mark in shades[:, k]))
        ends = [f"{axes['alpha'][k]:.0e}" for k in (0, -1)]
        return [*text, f"{'':>12}{ends[0]}{ends[1]:>{2 * len(shades) - len(ends[0])}}"]

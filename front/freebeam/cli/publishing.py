"""What is written for others to read: `freebeam figures`, `freebeam lesson` and `freebeam explore`."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import Any

import typer

from freebeam.cli.application import command
from freebeam.cli.options import REQUIRED, BasisOptions, FileOptions, NameOptions, argument, flag, option, refuse
from freebeam.cli.output import folder, print_json, working, written

# --- figures ----------------------------------------------------------------------------------------------------


@command("freebeam figures 2 10 --output figures --format png")
class Figures(FileOptions):
    """Draw the paper's figures again from computed data, each with a CSV file of what it shows.

    The first lines of the CSV file hold the caption, the settings, and the values that the figure marks.
    """

    output: Path = option("DIR", "Folder to write to; it is made if need be.", default=REQUIRED)
    number: list[str] | None = argument("[NUMBER]...", "Numbers of figures; all if none is given.")
    format: str = option("svg|png|pdf", "Kind of picture.", default="svg")

    def run(self) -> None:
        from freebeam.figures import published
        from freebeam.figures.look import style
        from freebeam.figures.saving import FORMATS, csv_of, image_of

        format, output = self.format, self.output
        refuse(format not in FORMATS, f"--format {format}: must be one of {', '.join(FORMATS)}")
        texts = self.number or [str(number) for number in published.NUMBERS]
        wanted = dict.fromkeys(_number(text, published.NUMBERS) for text in texts)
        done: list[dict[str, Any]] = []
        made: dict[Path, bytes] = {}
        with style(), working("figures") as report:
            folder(output)
            for count, n in enumerate(wanted, 1):
                report(f"Fig. {n} ({count} of {len(wanted)})")
                found = published.picture(n)
                picture, data = (output / f"figure-{n:02}.{kind}" for kind in (format, "csv"))
                made[picture] = image_of(found.draw(), format, f"Fig. {n}. {found.title}")
                made[data] = csv_of(found).encode()
                done.append({
                    "number": n, "title": found.title, "caption": found.caption, "settings": found.settings,
                    "marks": found.marks, "picture": picture, "data": data,
                })  # fmt: skip
            # a figure's data are the same beside each kind of picture: what is there already is not in the way
            new = {file: content for file, content in made.items() if not _holds(file, content)}
            kept = [str(file) for file in new if file.exists() and not self.force]
            cure = f"give another folder, or --force to replace {'them' if kept[1:] else 'it'}"
            refuse(kept, f"{', '.join(kept)}: exists with other content and is kept; {cure}")
            for file, content in new.items():
                with written(file, self.force) as stream:
                    stream.write(content)
        if self.as_json:
            print_json({"output": output, "format": format, "figures": done})
            return
        for entry in done:
            typer.echo(f"{entry['picture']}: {entry['title']}")


def _holds(file: Path, content: bytes) -> bool:
    """Whether a file is there with this content."""
    try:
        return file.read_bytes() == content
    except OSError:
        return False


def _number(text: str, known: tuple[int, ...]) -> int:
    none = not text.isdecimal() or int(text) not in known
    refuse(none, f"figure {text}: there is none; the paper's figures are {known[0]} to {known[-1]}")
    return int(text)


# --- lesson -----------------------------------------------------------------------------------------------------


@command("freebeam lesson --column beck --output lesson.html")
class Lesson(FileOptions, NameOptions):
    """Write a lesson on a column: its derivation with a proof of each step, then its physics, with exercises.

    The formats md and tex also write their drawings, to a folder beside FILE. With --solutions the lesson itself has no
    answers.
    """

    format: str | None = option("html|md|tex|ipynb|pdf", "Kind of file; if not given, the ending of --output.")
    output: Path = option("FILE", "The file to write.", default=REQUIRED)
    solutions: Path | None = option("FILE", "Write worked solutions of the exercises to this second file.")
    short: bool = flag("For one lecture of 45 minutes.", "--short")
    errata: bool = flag("With the misprints of the paper, where they arise.", "--errata")
    seed: int | None = option("NUMBER", "Other data of exercises and parameters for each number.")

    def run(self) -> None:
        from freebeam.lesson import FORMATS, printed, solutions
        from freebeam.lesson import lesson as made

        output = self.output
        format = self.format or output.suffix.removeprefix(".")
        kinds = ", ".join(FORMATS)
        refuse(
            not self.format and format not in FORMATS,
            f"--output {output}: must end in one of {kinds}; or give --format",
        )
        refuse(format not in FORMATS, f"format = {format!r}: must be one of {kinds}")
        beside = output.with_name(f"{output.stem}_files") if format in ("md", "tex") else None
        refuse(self.solutions == output, f"--solutions {output}: is the lesson's own file; give another name")
        with ExitStack() as stack, working("lesson") as report:
            text = stack.enter_context(written(output, self.force))
            second = stack.enter_context(written(self.solutions, self.force)) if self.solutions else None
            there = beside and beside.exists() and not self.force
            refuse(there, f"{beside}: exists and is kept; give another name, or --force to replace it")
            found = made(self.column, report, errata=self.errata, short=self.short, seed=self.seed)
            report(f"printing {format}")
            answers: dict[Path, bytes] = {}
            asked = found
            if self.solutions:
                asked, worked = solutions(found)
                answers = printed(worked, format, self.solutions)
            files = printed(asked, format, output)
            if beside is not None:
                beside.mkdir(exist_ok=True)
            for path, data in files.items():
                if path != output:
                    with written(path, self.force) as stream:
                        stream.write(data)
            text.write(files[output])
            if second is not None and self.solutions:
                second.write(answers[self.solutions])
        if self.as_json:
            print_json({
                "column": found.column,
                "format": format,
                "written": [*files, *answers],
                "checks": len(found.checks),
                "largest_residual": max(check.residual for check in found.checks),
            })  # fmt: skip
            return
        typer.echo(f"{output}: {found.title}; {len(found.checks)} proofs, none failed")


# --- explore ----------------------------------------------------------------------------------------------------


@command("freebeam explore --column beck --output beck.html")
class Explore(FileOptions, BasisOptions):
    """Write a page to explore a column by hand: one file that works in any browser, without a network."""

    output: Path = option("FILE", "The .html file to write.", default=REQUIRED)

    def run(self) -> None:
        output = self.output
        refuse(output.suffix not in (".html", ".htm"), f"{output}: the name must end in .html")
        with written(output, self.force) as stream, working("explorer"):
            from freebeam.explorer import page

            text = page(self.chosen, self.column).encode()
            stream.write(text)
        if self.as_json:
            told = {"column": self.chosen.name, "basis": self.chosen.basis_name, "bytes": len(text)}
            print_json({"output": output, **told})
        else:
            typer.echo(f"{output}: {len(text) / 1e3:.0f} kB; open it in a browser")

"""No certificate is had, or written, that the verifier refuses; where there is none, the proof stands."""

from __future__ import annotations

import json
from collections.abc import Callable
from copy import deepcopy
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import freebeam as fb
from freebeam import certificates
from freebeam.certificates import Proven, check
from freebeam_derive.certify import certificate, verifier
from freebeam_derive.certify.balls import Unproven
from tests.front.test_proofs import run

LOSES = ("critical", "--column", "euler-pinned", "-N", "2", "--digits", "6")


def moved(data: dict[str, Any]) -> dict[str, Any]:
    """The same of another load."""
    other = deepcopy(data)
    other["load"] = [str(Fraction(v) * 9 / 10) for v in data["load"]]
    return other


def test_the_verifier_reads_a_certificate_before_it_is_had() -> None:
    found = fb.certified_load(fb.column("euler-pinned"), 2, digits=6)
    assert (
        found.certificate == found.unverified and json.loads(certificates.text(found.certificate)) == found.unverified
    )
    with pytest.raises(fb.InputError, match=r"without a certificate: .* refuses it: stability is not"):
        replace(found, unverified=moved(dict(found.unverified))).certificate  # noqa: B018
    huge = found.unverified | {"more": "1" * 2_000_000}
    with pytest.raises(fb.InputError, match="larger than any certificate"):
        replace(found, unverified=huge).certificate  # noqa: B018
    assert replace(found, unverified=None).certificate is None


def test_every_answer_with_a_certificate_and_every_format_is_read() -> None:
    assert all(issubclass(of, Proven) for of in (fb.Certified, fb.CertifiedCrossings, fb.ExactSpectrum, fb.ExactRange))
    written = {getattr(certificate, name) for name in certificate.__all__ if name.isupper()} | {certificate.OF_SECTIONS}
    assert written == {verifier.FORMAT, verifier.GENERAL, *certificates._formats()}


def test_a_file_that_the_verifier_refuses_is_not_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write, file = certificate.write, tmp_path / "load.json"
    monkeypatch.setattr(certificate, "write", lambda *given: moved(write(*given)))
    status, out, error = run(capsys, *LOSES, "--certificate", str(file))
    assert (status, out) == (2, "") and error.count("\n") == 1 and "the verifier refuses it" in error
    assert not file.exists()
    monkeypatch.undo()
    status, _, _ = run(capsys, *LOSES, "--certificate", str(file))
    assert status == 0 and check(json.loads(file.read_bytes())) is None


def _refusing(*_: Any) -> Any:
    raise Unproven("a factor is no fraction")


@pytest.mark.parametrize(
    "name, asked",
    [
        ("write", lambda column: fb.certified_load(column, 2, digits=6)),
        ("write_crossings", lambda column: fb.certified_crossings(column, 2, digits=6, load_max=12)),
        ("write_of_beam", lambda column: fb.exact_load(column, digits=6)),
        ("write_range", lambda column: fb.exact_range(column, "beta", 1, 2)),
    ],
)
def test_what_is_proven_stands_where_its_certificate_cannot_be_written(
    name: str, asked: Callable[[fb.Column], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(certificate, name, _refusing)
    found = asked(fb.column("euler-pinned"))
    assert found.certificate is None and found.missing == "a factor is no fraction"
    assert all(of.proof["first"] for of in getattr(found, "pieces", [found]) if hasattr(of, "proof"))

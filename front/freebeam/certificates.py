"""Certificates of proofs, and the verifier that reads each before anyone gets it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from freebeam_sym.checks import InputError

if TYPE_CHECKING:
    from freebeam_derive.certify.verifier_claims import Statement

__all__ = ["Proven", "attempted", "text", "verify_certificate"]


class Proven:
    """An answer with a proof. unverified: the data that prove it, as the prover wrote them; None where it has none, and
    missing says why."""

    unverified: Mapping[str, Any] | None
    missing: str

    @cached_property
    def certificate(self) -> Mapping[str, Any] | None:
        """The data that prove it, for a file, as JSON; None where there are none, which `missing` explains.

        The verifier reads them when this is first asked for, which may take as long as the proof. Raises InputError
        with the step that it refuses; the proof stands then, its certificate does not.
        """
        if self.unverified is not None:
            check(self.unverified)
        return self.unverified


def text(certificate: Mapping[str, Any]) -> bytes:
    """What stands in a file."""
    import json

    return (json.dumps(certificate, indent=1) + "\n").encode()


def attempted(write: Callable[[], Mapping[str, Any]]) -> tuple[Mapping[str, Any] | None, str]:
    """The data of something that is proven, or why it has none: the proof stands without them."""
    from freebeam_derive.certify.balls import Unproven

    try:
        return write(), ""
    except Unproven as error:
        return None, str(error)


def check(certificate: Mapping[str, Any]) -> None:
    """That the verifier accepts a certificate as it would stand in a file. Raises InputError."""
    from freebeam_derive.certify.verifier import verify_content
    from freebeam_derive.certify.verifier_claims import Refused

    try:
        verify_content(text(certificate), _formats())
    except Refused as error:
        raise InputError(f"proven, but without a certificate: the verifier refuses it: {error}") from error


def verify_certificate(path: str) -> Statement:
    """Check a certificate file with the verifier, which shares no code with the prover.

    What is proven comes back: its text says it in full, its attributes are exact (column, modes, kind, load, …); the
    theorems stand in docs/proofs.md and docs/theorem.md. Raises InputError with the reason where the file does not
    prove what it claims.
    """
    from freebeam_derive.certify.verifier import verify_file
    from freebeam_derive.certify.verifier_claims import Refused

    try:
        return verify_file(path, _formats())
    except Refused as error:
        raise InputError(str(error)) from error


def _formats() -> dict[str, Any]:
    """What checks each format, but for the first two."""
    from freebeam_derive.certify import (
        verifier_lists,
        verifier_of_beam,
        verifier_of_matrices,
        verifier_of_sections,
        verifier_over_sections,
        verifier_spectrum,
    )

    modules = (
        verifier_lists, verifier_of_beam, verifier_of_matrices, verifier_of_sections, verifier_over_sections,
        verifier_spectrum,
    )  # fmt: skip
    return {name: check for of in modules for name, check in of.FORMATS.items()}

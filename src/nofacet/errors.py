"""Errors a user can act on, and the end of work that was called off."""

from __future__ import annotations


class InputError(ValueError):
    """The input cannot be shown. The message is one line: which file or face, what is wrong, what to do."""


def check_name(path: str) -> None:
    """Raise InputError for a name that is not UTF-8: OpenCascade and OpenImageIO take no others."""
    try:
        path.encode()
    except UnicodeEncodeError:
        raise InputError(f"{path}: the name is not UTF-8; rename it") from None


class Cancelled(Exception):
    """The work was given a `Cancel` that has been set since; it has no result."""

"""Errors a user can act on, and the end of work that was called off."""

from __future__ import annotations


class InputError(ValueError):
    """The input cannot be shown. The message is one line: which file or face, what is wrong, what to do."""


class Cancelled(Exception):
    """The work was given a `Cancel` that has been set since; it has no result."""

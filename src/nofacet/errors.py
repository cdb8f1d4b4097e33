"""Errors a user can act on."""

from __future__ import annotations


class InputError(ValueError):
    """The input cannot be shown. The message is one line: which file or face, what is wrong, what to do."""

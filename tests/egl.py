"""An OpenGL context without a window, for tests that draw."""

from __future__ import annotations

from typing import Any

import pytest


def offscreen_context() -> Any:
    """A moderngl context through EGL; skips the test where there is none."""
    moderngl = pytest.importorskip("moderngl")
    try:
        return moderngl.create_standalone_context(backend="egl", require=330)
    except Exception as error:
        pytest.skip(f"no OpenGL 3.3 through EGL here: {error}")

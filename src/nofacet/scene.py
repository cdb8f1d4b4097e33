"""What the native code prepares once for a model, kept as long as the model."""

from __future__ import annotations

import weakref

from . import _native
from .model import Model

_scenes: weakref.WeakKeyDictionary[Model, _native.Scene] = weakref.WeakKeyDictionary()


def scene_of(model: Model) -> _native.Scene:
    """The model prepared for drawing and evaluating."""
    if model not in _scenes:
        _scenes[model] = _native.Scene(model)
    return _scenes[model]

"""The programs that OpenGL runs, from shaders/."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from nofacet.light import LIGHT

from .projection import Projection

FOLDER = Path(__file__).parent / "shaders"


def program(context: moderngl.Context, vertex: str, fragment: str, shading: str | None = None) -> moderngl.Program:
    """Compile two files of the folder; `#include "FILE"` takes in another one of it.

    shading: "lit", "zebra" or "curvature", for fragments that can do each: SHADING stands for it there.
    """
    text = _source(fragment)
    if shading:
        text = text.replace("#version 330 core\n", f"#version 330 core\n#define SHADING {shading.upper()}\n", 1)
    return context.program(vertex_shader=_source(vertex), fragment_shader=text)


def _source(name: str) -> str:
    text = (FOLDER / name).read_text(encoding="utf-8")
    return re.sub(r'#include "(.+?)"\n', lambda found: _source(found[1]), text)


def set_uniforms(target: moderngl.Program, **values: Any) -> None:
    """Set uniforms: numbers, tuples, matrices (numpy, row by row as mathematics has them). Those that the compiler left
    out, because nothing depends on them, are passed over."""
    for name, value in values.items():
        if name not in target:
            continue
        if isinstance(value, np.ndarray):
            target[name].write(np.ascontiguousarray(value.T, np.float32).tobytes())
        else:
            target[name].value = value


def set_light(target: moderngl.Program, projection: Projection) -> None:
    """The light's constants, as seen by this camera."""
    up = projection.eye_from_local[:3, 2]
    set_uniforms(
        target,
        light_direction=LIGHT.direction,
        light_ambient=LIGHT.ambient,
        light_sky=LIGHT.sky,
        light_facing=LIGHT.facing,
        light_key=LIGHT.key,
        light_gloss=LIGHT.gloss,
        light_gloss_exponent=float(LIGHT.gloss_exponent),
        world_up=tuple(map(float, up)),
        perspective=projection.perspective,
    )


def bind(target: moderngl.Program, **textures: moderngl.Texture) -> None:
    """Give samplers their textures, each a unit of its own."""
    for unit, (name, texture) in enumerate(textures.items()):
        if name in target:
            texture.use(unit)
            target[name].value = unit

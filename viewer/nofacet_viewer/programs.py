"""The programs that OpenGL runs, from shaders/."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from nofacet.light import LIGHT

from .projection import Projection

FOLDER = Path(__file__).parent / "shaders"
VERSION = "#version 330 core\n"  # how each file begins


def program(context: moderngl.Context, vertex: str, fragment: str, **constants: str) -> moderngl.Program:
    """The program of two files of the folder; `#include "FILE"` takes in another one of it. constants: defined in both.

    It is compiled once and kept as long as the context: some drivers take longer for it than for a picture.
    """
    if context.extra is None:
        context.extra = {}
    key = vertex, fragment, *constants.items()
    if key not in context.extra:
        context.extra[key] = _compiled(context, vertex, fragment, constants)
    found: moderngl.Program = context.extra[key]
    return found


def _compiled(context: moderngl.Context, vertex: str, fragment: str, constants: Mapping[str, str]) -> moderngl.Program:
    defined = "".join(f"#define {name} {value}\n" for name, value in constants.items())
    shaders = [_source(name).replace(VERSION, VERSION + defined, 1) for name in (vertex, fragment)]
    return context.program(vertex_shader=shaders[0], fragment_shader=shaders[1])


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

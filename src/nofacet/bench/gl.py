"""Frames of a mesh with OpenGL, off screen: what every CAD viewer does with its triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..camera import Camera
from ..mesh import Mesh
from .child import ChildFailure, in_child
from .subject import Subject
from .timing import MESH_SECONDS, repeat

START_LIMIT = 30.0  # seconds

VERTEX_SHADER = """
#version 330
uniform mat4 clip_from_world;
uniform mat3 eye_from_world;
in vec3 position;
in vec3 normal;
out vec3 eye_normal;
void main() {
    gl_Position = clip_from_world * vec4(position, 1.0);
    eye_normal = eye_from_world * normal;
}
"""
# Phong's model with one light at the eye.
FRAGMENT_SHADER = """
#version 330
in vec3 eye_normal;
out vec4 color;
void main() {
    float cosine = abs(normalize(eye_normal).z);
    color = vec4(vec3(0.6, 0.65, 0.7) * (0.1 + 0.9 * cosine) + 0.2 * pow(cosine, 32.0), 1.0);
}
"""

_renderer: list[str | ChildFailure | TimeoutError] = []


def missing() -> str | None:
    """Why nothing can be drawn with OpenGL here; None if it can."""
    found = _found()
    return None if isinstance(found, str) else f"OpenGL frames: no off-screen context ({found})"


def renderer() -> str:
    """What draws: the name of the OpenGL renderer, "none" without one."""
    found = _found()
    return found if isinstance(found, str) else "none"


def _found() -> str | ChildFailure | TimeoutError:
    if not _renderer:
        try:
            _renderer.append(in_child(_start, START_LIMIT))
        except (ChildFailure, TimeoutError) as failure:
            _renderer.append(failure)
    return _renderer[0]


def _start() -> str:
    import moderngl

    return str(moderngl.create_standalone_context(backend="egl").info["GL_RENDERER"])


def frame_seconds(mesh: Mesh, subject: Subject) -> float:
    """Fastest wall-clock seconds of a frame: clear, one indexed draw call, finish. The mesh is uploaded before.

    llvmpipe draws on every core.
    """
    import moderngl

    context = moderngl.create_standalone_context(backend="egl")
    picture = context.framebuffer(
        [context.renderbuffer(subject.resolution)], context.depth_renderbuffer(subject.resolution)
    )
    program = context.program(VERTEX_SHADER, FRAGMENT_SHADER)
    clip, eye = _matrices(subject.camera, mesh.points, subject.resolution)
    program["clip_from_world"].write(clip.T.astype(np.float32).tobytes())
    program["eye_from_world"].write(eye.T.astype(np.float32).tobytes())
    vertices = np.hstack([mesh.points.astype(np.float32), mesh.normals])
    array = context.vertex_array(
        program,
        [(context.buffer(vertices.tobytes()), "3f 3f", "position", "normal")],
        context.buffer(mesh.triangles.astype(np.int32).tobytes()),
    )
    picture.use()
    context.enable(moderngl.DEPTH_TEST)

    def draw() -> None:
        picture.clear()
        array.render()
        context.finish()

    draw()
    return repeat(draw, MESH_SECONDS)[0].fastest


def _matrices(
    camera: Camera, points: NDArray[np.float64], resolution: tuple[int, int]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Clip from world (4, 4) of an orthographic camera, depth fitted to the points; eye from world (3, 3)."""
    axes = np.stack(camera.axes())
    depth = (points - np.array(camera.position)) @ axes[2]
    near, far = depth.min(), depth.max()
    margin = 0.01 * max(far - near, 1e-6 * abs(far))
    pixel = camera.pixel_from_world(resolution)
    scale = np.array([2 / resolution[0], -2 / resolution[1], 2 / (far - near + 2 * margin), 1.0])
    clip = scale[:, None] * pixel
    clip[:3, 3] += -1.0, 1.0, -(near + far) / (far - near + 2 * margin)
    return clip, axes

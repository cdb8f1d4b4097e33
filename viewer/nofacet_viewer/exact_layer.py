"""The exact side: a nofacet.Frame on the graphics card, as it is or in other colours."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet

from .mesh_layer import FaceColors
from .programs import bind, program, set_light, set_uniforms
from .projection import project
from .targets import BACKGROUND_DEPTH


def recoloring(context: moderngl.Context, shading: str) -> moderngl.VertexArray:
    """What draws frames in other colours, "lit", with "zebra" stripes or "curvature"; with its program."""
    return context.vertex_array(program(context, "fullscreen.vert", "exact.frag", shading), [])


class ExactLayer:
    """One frame's buffers as textures, row 0 at the top. Those that the frame lacks are None.

    curvature: (height, width) float32, mean curvature at the pixel centres, NaN where there is none.
    """

    def __init__(
        self, context: moderngl.Context, frame: nofacet.Frame, curvature: NDArray[np.float32] | None = None
    ) -> None:
        self.frame = frame
        self._context = context
        self.color = self._upload("color", frame.color)
        self.face = self._upload("face", frame.face) if "face" in frame.buffers else None
        self._normal = self._upload("normal", frame.normal) if "normal" in frame.buffers else None
        self._coverage = self._upload("coverage", frame.coverage) if "coverage" in frame.buffers else None
        self._curvature = None if curvature is None else self._upload("curvature", curvature)
        self.depth: moderngl.Texture | None = None
        if "depth" in frame.buffers:
            depth = np.where(np.isfinite(frame.depth), frame.depth, BACKGROUND_DEPTH)
            self.depth = self._upload("depth", depth.astype(np.float32))

    def can_shade(self, shading: str) -> bool:
        """Whether the frame has what recoloured() needs."""
        values = [self.face, self._normal, self._coverage]
        return all([*values, self._curvature] if shading == "curvature" else values)

    def recolored(
        self, shader: moderngl.VertexArray, colors: FaceColors, ramp: moderngl.Texture, ramp_end: float
    ) -> moderngl.Texture:
        """The frame as `shader`, of recoloring(), draws it (see MeshLayer.draw): a new texture, which the caller
        releases."""
        frame, camera = self.frame, self.frame.camera
        picture = self._context.texture(frame.resolution, 4, dtype="f4")
        framebuffer = self._context.framebuffer([picture])
        framebuffer.use()
        target = shader.program
        origin = np.zeros(3)
        set_light(target, project(camera, frame.resolution, origin, (origin, origin)))
        slope = camera.extent_at_unit_depth() / frame.height
        eye_from_world = np.array(camera.axes())
        set_uniforms(target, slope=slope, eye_from_world=eye_from_world, ramp_end=ramp_end)
        textures = {
            "face_colors": colors.texture,
            "ramp": ramp,
            "frame_color": self.color,
            "frame_face": self.face,
            "frame_normal": self._normal,
            "frame_coverage": self._coverage,
            "frame_curvature": self._curvature,
        }
        bind(target, **{name: texture for name, texture in textures.items() if texture})
        self._context.enable_only(moderngl.NOTHING)
        shader.render(moderngl.TRIANGLES, vertices=3)
        framebuffer.release()
        return picture

    def release(self) -> None:
        for texture in (self.color, self.face, self.depth, self._normal, self._coverage, self._curvature):
            if texture:
                texture.release()

    def _upload(self, name: str, values: NDArray[np.float32] | NDArray[np.int32]) -> moderngl.Texture:
        height, width = values.shape[:2]
        components = values.shape[2] if values.ndim == 3 else 1
        texture = self._context.texture(
            (width, height), components, np.ascontiguousarray(values), dtype="i4" if name == "face" else "f4"
        )
        smooth = name == "color"
        texture.filter = (moderngl.LINEAR, moderngl.LINEAR) if smooth else (moderngl.NEAREST, moderngl.NEAREST)
        texture.repeat_x = texture.repeat_y = False
        return texture

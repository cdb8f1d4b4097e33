"""The exact side: a nofacet.Frame on the graphics card, as it is or in other colours."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet

from .palette import Palette
from .programs import bind, program, set_light, set_uniforms
from .projection import project
from .srgb import RGB, encoded
from .targets import BACKGROUND_DEPTH, picture_texture

_NEEDED = {"zebra": (), "lit": (), "curvature": ("curvature",)}  # beside face, normal and coverage


def recoloring(context: moderngl.Context, shading: str) -> moderngl.VertexArray:
    """What draws frames in other colours, "lit", with "zebra" stripes or "curvature"; with its program."""
    return context.vertex_array(program(context, "fullscreen.vert", "exact.frag", SHADING=shading.upper()), [])


class ExactLayer:
    """One frame as textures, row 0 at the top. Each is made when it is first asked for: most are never needed."""

    def __init__(
        self,
        context: moderngl.Context,
        frame: nofacet.Frame,
        curvature: NDArray[np.float32] | None = None,
        pixels: NDArray[np.uint8] | None = None,
    ) -> None:
        """curvature: (height, width), mean curvature at the pixel centres, NaN where there is none. pixels: what
        frame.srgb8 gives before the background, where that has been made already."""
        self.frame = frame
        self._context = context
        self._curvature = curvature
        self._pixels = pixels
        self._pixels_before: RGB | None = None
        self._picture: moderngl.Texture | None = None
        self._values: dict[str, moderngl.Texture] = {}

    def picture(self, background: RGB) -> moderngl.Texture:
        """The frame before a background (linear RGB), 8-bit sRGB."""
        if self._pixels is None or self._pixels_before not in (None, background):
            self._pixels = self.frame.srgb8(encoded(background))
            self._forget_picture()
        self._pixels_before = background
        if self._picture is None:
            self._picture = picture_texture(self._context, self.frame.resolution, self._pixels)
        return self._picture

    def values(self, name: str) -> moderngl.Texture | None:
        """A buffer of the frame, or "curvature"; None where there is none. Depth is BACKGROUND_DEPTH on background."""
        if name not in self._values:
            values = self._curvature
            if name != "curvature":
                values = getattr(self.frame, name) if name in self.frame.buffers else None
            if values is None:
                return None
            if name == "depth":
                values = np.where(np.isfinite(values), values, BACKGROUND_DEPTH).astype(np.float32)
            self._values[name] = self._upload(values)
        return self._values[name]

    def can_shade(self, shading: str) -> bool:
        """Whether the frame has what recolored() needs."""
        return all(self.values(name) for name in ("face", "normal", "coverage", *_NEEDED[shading]))

    def recolored(self, shader: moderngl.VertexArray, palette: Palette, background: RGB) -> moderngl.Texture:
        """The frame as `shader`, of recoloring(), draws it (see MeshLayer.draw) before a background, 8-bit sRGB: a new
        texture, which the caller releases."""
        frame, camera = self.frame, self.frame.camera
        picture = picture_texture(self._context, frame.resolution)
        framebuffer = self._context.framebuffer([picture])
        framebuffer.use()
        target = shader.program
        origin = np.zeros(3)
        set_light(target, project(camera, frame.resolution, origin, (origin, origin)))
        slope = camera.extent_at_unit_depth() / frame.height
        eye_from_world = np.array(camera.axes())
        set_uniforms(target, slope=slope, eye_from_world=eye_from_world, ramp_end=palette.end, background=background)
        values = {f"frame_{name}": self.values(name) for name in ("face", "normal", "coverage", "curvature")}
        own = {"face_colors": palette.faces.texture, "ramp": palette.ramp, "frame_color": self.picture(background)}
        bind(target, **{name: texture for name, texture in {**own, **values}.items() if texture})
        self._context.enable_only(moderngl.NOTHING)
        shader.render(moderngl.TRIANGLES, vertices=6)
        framebuffer.release()
        return picture

    def release(self) -> None:
        self._forget_picture()
        for texture in self._values.values():
            texture.release()

    def _forget_picture(self) -> None:
        if self._picture:
            self._picture.release()
        self._picture = None

    def _upload(self, values: NDArray[np.float32] | NDArray[np.int32]) -> moderngl.Texture:
        height, width = values.shape[:2]
        components = values.shape[2] if values.ndim == 3 else 1
        dtype = "i4" if values.dtype == np.int32 else "f4"
        texture = self._context.texture((width, height), components, np.ascontiguousarray(values), dtype=dtype)
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
        texture.repeat_x = texture.repeat_y = False
        return texture

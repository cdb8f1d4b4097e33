"""OpenCascade's triangles, drawn as viewers draw them: interpolated normals under the light of the exact pictures.

Transparent faces come after all opaque ones, from the farthest triangle to the nearest by the triangles' middles, over
what is behind them and without hiding one another: right but for triangles that pass through each other or are very
long.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import moderngl

import nofacet

from .clipping import clipped
from .drawing_order import DrawingOrder
from .mesh_arrays import MeshArrays
from .palette import Palette
from .programs import bind, program, set_light, set_uniforms
from .projection import Projection, project
from .targets import SurfaceTarget


class MeshLayer:
    """One mesh on the graphics card. sections: planes that cut what is drawn of it; it shows no caps."""

    def __init__(self, context: moderngl.Context, mesh: nofacet.Mesh, arrays: MeshArrays | None = None) -> None:
        """arrays: of the mesh; made here where they are missing."""
        arrays = arrays or MeshArrays.of(mesh)
        self.mesh = mesh
        self.sections: Sequence[nofacet.Section] = ()
        self.bounds, self.center = arrays.bounds, arrays.center
        self._context = context
        self._vertices = context.buffer(arrays.vertices if len(arrays.vertices) else bytes(28))
        self._order = DrawingOrder(context, mesh)
        self._arrays: dict[tuple[Any, ...], moderngl.VertexArray] = {}

    def projection(self, camera: nofacet.Camera, size: tuple[int, int]) -> Projection:
        """The camera's matrices for this mesh's own coordinates."""
        return project(camera, size, self.center, self.bounds)

    def draw(self, projection: Projection, palette: Palette, shading: str) -> None:
        """Draw into the framebuffer in use: linear RGBA, alpha premultiplied.

        shading: "lit" shows the faces' colours, "zebra" and "curvature" show all faces opaque.
        """
        order = self._order
        order.part(palette.faces.alpha, blends=shading == "lit")
        order.sort(projection.eye_from_local[2, :3])
        array = self._array("mesh.frag", SHADING=shading.upper())
        self._prepare(array.program, projection)
        set_light(array.program, projection)
        set_uniforms(array.program, ramp_end=palette.end)
        bind(
            array.program,
            face_colors=palette.faces.texture,
            face_marks=palette.marks.texture,
            ramp=palette.ramp,
        )
        self._context.enable_only(moderngl.DEPTH_TEST)
        with clipped(self._context, array.program, self.sections, self.center):
            array.render(vertices=3 * order.opaque)
            if order.transparent:
                self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
                self._context.blend_equation = moderngl.FUNC_ADD
                self._context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
                self._context.fbo.depth_mask = False
                array.render(vertices=3 * order.transparent, first=3 * order.opaque)
                self._context.fbo.depth_mask = True

    def draw_surface(self, projection: Projection, palette: Palette, target: SurfaceTarget) -> None:
        """Draw depth and face of the nearest triangle at every pixel's centre."""
        order = self._order
        order.part(palette.faces.alpha)
        target.clear()
        array = self._array("surface.frag")
        self._prepare(array.program, projection)
        self._context.enable_only(moderngl.DEPTH_TEST)
        with clipped(self._context, array.program, self.sections, self.center):
            array.render(vertices=3 * (order.opaque + order.transparent))

    def release(self) -> None:
        for array in self._arrays.values():
            array.release()
        self._vertices.release()
        self._order.release()

    def _array(self, fragment: str, **constants: str) -> moderngl.VertexArray:
        """The mesh with the program that draws it so."""
        if self.sections:
            constants["CLIPPED"] = "1"
        key = fragment, *constants.items()
        if key not in self._arrays:
            vertices = [(self._vertices, "3f 3f 1i", "position", "normal", "face")]
            target = program(self._context, "mesh.vert", fragment, **constants)
            self._arrays[key] = self._context.vertex_array(target, vertices, self._order.indices, skip_errors=True)
        return self._arrays[key]

    def _prepare(self, target: moderngl.Program, projection: Projection) -> None:
        set_uniforms(target, clip_from_local=projection.clip_from_local, eye_from_local=projection.eye_from_local)

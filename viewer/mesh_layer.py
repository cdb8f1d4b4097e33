"""OpenCascade's triangles, drawn as viewers draw them: interpolated normals under the light of the exact pictures.

Transparent faces come after all opaque ones, from the farthest triangle to the nearest by the triangles' middles, over
what is behind them and without hiding one another: right but for triangles that pass through each other or are very
long.
"""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet

from .projection import Projection, project
from .shaders import bind, program, set_light, set_uniforms
from .targets import SurfaceTarget

COLOR_ROW = 1024  # faces a row of the texture of their colours
SHADINGS = {"lit": 0, "zebra": 1, "curvature": 2}


class FaceColors:
    """A texture of the faces' colours, linear RGBA."""

    def __init__(self, context: moderngl.Context, colors: NDArray[np.float32]) -> None:
        rows = max(1, -(-len(colors) // COLOR_ROW))
        padded = np.zeros((rows * COLOR_ROW, 4), np.float32)
        padded[: len(colors)] = colors
        self.texture = context.texture((COLOR_ROW, rows), 4, padded.tobytes(), dtype="f4")
        self.texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self.alpha = padded[:, 3]

    def release(self) -> None:
        self.texture.release()


class MeshLayer:
    """One mesh on the graphics card."""

    def __init__(self, context: moderngl.Context, mesh: nofacet.Mesh) -> None:
        self.mesh = mesh
        self._context = context
        self.bounds = _bounds(mesh.points)
        self.center = (self.bounds[0] + self.bounds[1]) / 2
        face = np.zeros(len(mesh.points), np.int32)
        face[mesh.triangles] = mesh.face[:, None]
        local = (mesh.points - self.center).astype(np.float32)
        vertices = np.zeros(len(local), [("position", "f4", 3), ("normal", "f4", 3), ("face", "i4")])
        vertices["position"], vertices["normal"], vertices["face"] = local, mesh.normals, face
        self._middles = local[mesh.triangles].mean(axis=1)
        self._vertices = context.buffer(vertices.tobytes() or bytes(28))
        self._indices = context.buffer(reserve=max(12, 12 * len(mesh.triangles)), dynamic=True)
        self._shaded = program(context, "mesh.vert", "mesh.frag")
        self._surface = program(context, "mesh.vert", "surface.frag")
        self._arrays = {
            target: context.vertex_array(
                target, [(self._vertices, "3f 3f 1i", "position", "normal", "face")], self._indices, skip_errors=True
            )
            for target in (self._shaded, self._surface)
        }

    def projection(self, camera: nofacet.Camera, size: tuple[int, int]) -> Projection:
        """The camera's matrices for this mesh's own coordinates."""
        return project(camera, size, self.center, self.bounds)

    def draw(
        self, projection: Projection, colors: FaceColors, shading: str, ramp: moderngl.Texture, ramp_end: float
    ) -> None:
        """Draw into the framebuffer in use: linear RGBA, alpha premultiplied.

        shading: of SHADINGS; "lit" shows the faces' colours, the others show all faces opaque. ramp, ramp_end: the
        colours of curvatures from -ramp_end to ramp_end.
        """
        opaque, transparent = self._ordered(projection, colors, shading == "lit")
        self._indices.write(self.mesh.triangles[np.concatenate([opaque, transparent])].tobytes() or bytes(12))
        self._prepare(self._shaded, projection)
        set_light(self._shaded, projection)
        set_uniforms(self._shaded, shading=SHADINGS[shading], ramp_end=ramp_end)
        bind(self._shaded, face_colors=colors.texture, ramp=ramp)
        array = self._arrays[self._shaded]
        self._context.enable_only(moderngl.DEPTH_TEST)
        array.render(vertices=3 * len(opaque))
        if len(transparent):
            self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
            self._context.blend_equation = moderngl.FUNC_ADD
            self._context.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
            self._context.fbo.depth_mask = False
            array.render(vertices=3 * len(transparent), first=3 * len(opaque))
            self._context.fbo.depth_mask = True

    def draw_surface(self, projection: Projection, colors: FaceColors, target: SurfaceTarget) -> None:
        """Draw depth and face of the nearest triangle at every pixel's centre."""
        self._indices.write(self.mesh.triangles.tobytes() or bytes(12))
        target.clear()
        self._prepare(self._surface, projection)
        bind(self._surface, face_colors=colors.texture)
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._arrays[self._surface].render(vertices=3 * len(self.mesh.triangles))

    def release(self) -> None:
        for held in (*self._arrays.values(), self._vertices, self._indices, self._shaded, self._surface):
            held.release()

    def _prepare(self, target: moderngl.Program, projection: Projection) -> None:
        set_uniforms(target, clip_from_local=projection.clip_from_local, eye_from_local=projection.eye_from_local)

    def _ordered(
        self, projection: Projection, colors: FaceColors, transparency: bool
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Triangles of opaque faces, and those of transparent ones from back to front."""
        alpha = colors.alpha[self.mesh.face]
        see_through = (alpha < 1) & transparency
        chosen = np.flatnonzero(see_through & (alpha > 0))
        depth = self._middles[chosen] @ projection.eye_from_local[2, :3].astype(np.float32)
        return np.flatnonzero(~see_through), chosen[np.argsort(-depth, kind="stable")]


def _bounds(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return (points.min(axis=0), points.max(axis=0)) if len(points) else (np.zeros(3), np.zeros(3))

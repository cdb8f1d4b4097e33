"""Draws the window's content: both sides, in each view, with overlays, into any framebuffer."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

import nofacet
from nofacet.extent import bounding_box

from .color_scale import ColorScale, outline_scale
from .compositor import Compositor
from .difference import OutlineDifference
from .line_overlays import LineOverlays
from .mesh_arrays import MeshArrays
from .overlays import ANALYSES, EXACT_LINES, OVERLAYS, analysis_of, face_colors, scale_of
from .palette import Palette
from .panes import Pane, pane_resolution, panes
from .sides import DrawnSide, ExactSide, SidePicture
from .srgb import encoded
from .state import WHITE, View, ViewState
from .targets import picture_texture

__all__ = ["OVERLAYS", "Painter"]

Size = tuple[int, int]

DIVIDER_COLOR = 0.45  # sRGB gray
WIPE_LINE = 1  # pixels on each side of the wipe's place


class Painter:
    """Both sides of the window, and how each view puts them together.

    Give it the model, OpenCascade's mesh of it and the exact frame as they come; each may be missing, and its side is
    empty then. All calls come from the thread that the OpenGL context belongs to.
    """

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._lines = LineOverlays(context)
        self._exact = ExactSide(context, self._lines)
        self._drawn = DrawnSide(context, self._lines)
        self._compositor = Compositor(context)
        self._model: nofacet.Model | None = None
        self._extent: float | None = None  # of the model, once it is known
        self._selected = np.zeros(0, bool)
        self._palette: Palette | None = None
        self._palette_of: str | None = None
        self._difference: OutlineDifference | None = None
        self._error: moderngl.Texture | None = None
        self._shows_drawn = False

    def set_model(self, model: nofacet.Model | None) -> None:
        """The model whose faces' colours both sides have; one that differs in colours only keeps its lines."""
        same_shape = model is not None and self._model is not None and model.groups is self._model.groups
        if not same_shape:
            self._lines.set_model(model)
            self._extent = None
        self._model = model
        self._forget_palette()

    def set_selected(self, selected: NDArray[np.bool_]) -> None:
        """Mark these faces (F,) of the model, on both sides."""
        self._selected = selected
        self._forget_palette()

    def set_mesh(self, mesh: nofacet.Mesh | None, arrays: MeshArrays | None = None) -> None:
        """OpenCascade's triangles of the model. arrays: of the mesh; made here where they are missing."""
        self._drawn.set_mesh(mesh, arrays)
        self._lines.set_mesh(mesh)
        self.set_difference(None)

    def set_exact(
        self,
        frame: nofacet.Frame | None,
        curvature: NDArray[np.float32] | None = None,
        pixels: NDArray[np.uint8] | None = None,
    ) -> None:
        """The exact side's frame, of any resolution; it is scaled to its pane. curvature: what
        overlays.frame_curvature gives for it, for the overlay of that name. pixels: what its srgb8() gives before the
        background; made here where it is missing, which takes milliseconds."""
        self._exact.set_frame(frame, curvature, pixels)

    def set_difference(self, difference: OutlineDifference | None) -> None:
        """The outline error of the present camera, model and mesh, for the view of that name."""
        if self._error:
            self._error.release()
        self._difference, self._error = difference, None
        if difference:
            height, width = difference.picture.shape[:2]
            self._error = self._context.texture((width, height), 2, difference.picture, dtype="f4")
            self._error.filter = moderngl.NEAREST, moderngl.NEAREST

    def exact_resolution(self, view: View, size: Size) -> Size | None:
        """Pixels of the exact side in a window of `size`; None where the view does not show it."""
        return None if view is View.TESSELLATED else pane_resolution(view, size)

    def exact_buffers(self, state: ViewState) -> tuple[str, ...]:
        """The frame's buffers that the view and its overlays need. With the overlay "edges", render with edges=True."""
        needed = {"color": None}
        if any(name in state.overlays for name in EXACT_LINES):
            needed["depth"] = None
        analysis = analysis_of(state.overlays)
        needed.update(dict.fromkeys(ANALYSES[analysis] if analysis else ()))
        if state.view is View.DIFFERENCE:
            needed["face"] = None
        return tuple(needed)

    def legend(self, state: ViewState) -> ColorScale | None:
        """What the colours of the present view or overlay mean."""
        if state.view is View.DIFFERENCE:
            error = self._difference.error if self._difference else None
            return outline_scale(error.largest if error else 0.0)
        return self._scale(state.overlays)

    @property
    def busy(self) -> bool:
        """Whether refine() has something to do, now or soon."""
        return self._lines.busy or (self._shows_drawn and self._drawn.busy)

    def refine(self) -> bool:
        """At rest: go on with what makes the picture better that was painted last, for some milliseconds; whether it
        is to be painted again."""
        refined = self._shows_drawn and self._drawn.refine()
        return self._lines.poll() or refined

    def wait(self) -> None:
        """Until a further paint() shows all that the one before asked for."""
        self._lines.wait()
        if self._shows_drawn:
            self._drawn.refine(seconds=float("inf"))

    def drawn_surface(self, camera: nofacet.Camera, size: Size) -> tuple[NDArray[np.float32], NDArray[np.int32]] | None:
        """Depth and face (height, width) of OpenCascade's triangles at the pixel centres, as a Frame has them."""
        if self._drawn.layer is None or self._model is None:
            return None
        return self._drawn.surface(camera, size, self._colors(frozenset())).read()

    def warm(self, framebuffer: moderngl.Framebuffer) -> None:
        """Draw something as the plain views do, and forget it: where a processor draws, its driver makes programs for
        it first, which takes longer than a frame."""
        corners = np.array([(3, 0, 0), (0, 3, 0), (0, 0, 3), (4, 0, 0), (0, 4, 0), (0, 0, 4)], np.float64)
        normals = np.full((6, 3), 3**-0.5, np.float32)
        triangles = np.arange(6, dtype=np.int32).reshape(2, 3)
        mesh = nofacet.Mesh(corners, normals, triangles, np.arange(2, dtype=np.int32), 0.0)
        colors = np.array([(1, 1, 1, 1), (1, 1, 1, 0.5)], np.float32)
        palette = Palette(self._context, colors, None, np.zeros(2, bool))
        camera = nofacet.Camera("orthographic", (9.0, 9.0, 9.0), (0.0, 0.0, 0.0), view_height=3.0)
        pane = Pane(View.TESSELLATED, 0, 60, 84)  # nor a quarter are powers of two, which have programs of their own
        drawn = DrawnSide(self._context, self._lines)
        drawn.set_mesh(mesh)
        for _ in range(2):  # the second is refined, and of the pane's own size
            picture = drawn.picture(camera, pane.size, frozenset(), palette, WHITE)
            framebuffer.use()
            if picture:
                self._compositor.draw(picture, pane)
            drawn.refine(seconds=float("inf"))
        drawn.release()
        palette.release()
        frame = picture_texture(self._context, (31, 33))
        for way in (moderngl.LINEAR, moderngl.NEAREST):  # as in motion and at rest
            frame.filter = way, way
            self._compositor.draw(SidePicture(frame, top_first=True), pane)
        frame.release()
        framebuffer.scissor = 0, 0, 1, 1  # clearing a part, as between two sides
        framebuffer.clear()
        framebuffer.scissor = None
        self._context.finish()

    def prepare(self, state: ViewState, camera: nofacet.Camera, size: Size) -> None:
        """Do what takes longest of paint(), which may follow later, with the same."""
        self._pictures(state, camera, size)

    def paint(self, state: ViewState, camera: nofacet.Camera, framebuffer: moderngl.Framebuffer, size: Size) -> None:
        """Draw the view into the framebuffer's lower left corner, `size` pixels of it, 8-bit sRGB."""
        shown, pictures = panes(state.view, size), self._pictures(state, camera, size)
        self._shows_drawn = any(
            picture is not None and pane.side is View.TESSELLATED for pane, picture in zip(shown, pictures, strict=True)
        )
        framebuffer.use()
        framebuffer.viewport = 0, 0, *size
        framebuffer.scissor = 0, 0, *size
        framebuffer.clear(*encoded(state.background), 1.0)
        if state.view is View.DIFFERENCE:
            self._paint_difference(state, camera, shown[0], pictures[0], framebuffer)
        else:
            for pane, picture in zip(shown, pictures, strict=True):
                if picture:
                    framebuffer.scissor = _shown_part(state, pane)
                    self._compositor.draw(picture, pane)
            self._divide(state, framebuffer, size)
        framebuffer.viewport = 0, 0, *size
        framebuffer.scissor = None

    def release(self) -> None:
        """Free what is on the graphics card."""
        self.set_difference(None)
        self._forget_palette()
        for held in (self._exact, self._drawn, self._lines, self._compositor):
            held.release()

    def _pictures(self, state: ViewState, camera: nofacet.Camera, size: Size) -> list[SidePicture | None]:
        """Of the view's panes."""
        self._drawn.cut(state.sections)
        return [self._picture(pane, state, camera) for pane in panes(state.view, size)]

    def _picture(self, pane: Pane, state: ViewState, camera: nofacet.Camera) -> SidePicture | None:
        if self._model is None or _shown_part(state, pane)[2] == 0:
            return None
        palette = self._colors(state.overlays)
        if pane.side is View.EXACT:
            recolor = analysis_of(state.overlays) is not None
            return self._exact.picture(pane.size, state.overlays, palette, state.background, recolor)
        if state.view is View.DIFFERENCE:
            return None  # only its faces are needed
        return self._drawn.picture(camera, pane.size, state.overlays, palette, state.background)

    def _paint_difference(
        self,
        state: ViewState,
        camera: nofacet.Camera,
        pane: Pane,
        exact: SidePicture | None,
        framebuffer: moderngl.Framebuffer,
    ) -> None:
        scale = self.legend(state)
        if exact is None or scale is None:
            return
        fits = self._difference is not None and self._difference.camera == camera and self._error is not None
        drawn = None
        if fits and self._drawn.layer:
            drawn = self._drawn.surface(camera, pane.size, self._colors(state.overlays))
        error = self._error if fits else None
        face = self._exact.layer.values("face") if self._exact.layer else None
        framebuffer.use()
        self._compositor.draw_difference(exact, face, drawn, error, scale, pane, state.background)

    def _divide(self, state: ViewState, framebuffer: moderngl.Framebuffer, size: Size) -> None:
        """The line between the sides."""
        width, height = size
        if state.view is View.SIDE_BY_SIDE:
            left, right = panes(state.view, size)
            framebuffer.scissor = left.width, 0, max(0, right.x - left.width), height
        elif state.view is View.WIPE:
            column = _wipe_column(state, width)
            first, last = max(0, column - WIPE_LINE), min(width, column + WIPE_LINE)
            framebuffer.scissor = first, 0, max(0, last - first), height
        else:
            return
        framebuffer.clear(DIVIDER_COLOR, DIVIDER_COLOR, DIVIDER_COLOR, 1.0)

    def _colors(self, overlays: frozenset[str]) -> Palette:
        assert self._model
        analysis = analysis_of(overlays)
        if self._palette is None or self._palette_of != analysis:
            self._forget_palette()
            scale = self._scale(overlays)
            selected = np.zeros(self._model.face_count, bool)
            selected[: len(self._selected)] = self._selected[: len(selected)]
            self._palette = Palette(self._context, face_colors(overlays, self._model), scale, selected)
            self._palette_of = analysis
        return self._palette

    def _scale(self, overlays: frozenset[str]) -> ColorScale | None:
        if self._model is None or analysis_of(overlays) is None:
            return None
        if self._extent is None:
            self._extent = _diagonal(self._model)
        return scale_of(overlays, self._model, self._extent)

    def _forget_palette(self) -> None:
        if self._palette:
            self._palette.release()
        self._palette = None
        self._drawn.forget()


def _shown_part(state: ViewState, pane: Pane) -> tuple[int, int, int, int]:
    """Left, bottom, width and height of the part of the pane that shows."""
    first, last = pane.x, pane.x + pane.width
    if state.view is View.BLINK and state.blink_exact != (pane.side is View.EXACT):
        last = first
    if state.view is View.WIPE:
        column = min(max(_wipe_column(state, pane.width), first), last)
        first, last = (first, column) if pane.side is View.EXACT else (column, last)
    return first, 0, last - first, pane.height


def _wipe_column(state: ViewState, width: int) -> int:
    return round(min(max(state.wipe, 0.0), 1.0) * width)


def _diagonal(model: nofacet.Model) -> float:
    """Of the model's bounding box, model units; 1 for a model without extent."""
    try:
        low, high = bounding_box(model)
    except nofacet.InputError:
        return 1.0
    return float(np.linalg.norm(high - low)) or 1.0

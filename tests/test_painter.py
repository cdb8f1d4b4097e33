"""What draws the window's content: both sides agree, each view shows what it says, overlays lie where they should."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cadquery as cq
import numpy as np
import pytest

import nofacet
from conftest import SHARED_MODELS
from egl import offscreen_context
from nofacet.extent import bounding_box
from scenes import GENERAL_DIRECTION, Array, look_down
from surface_distance import F3D_TEAPOT, FREECAD_FLANGE, surface_distance

pytest.importorskip("moderngl")

from nofacet_viewer.difference import outline_difference
from nofacet_viewer.meshing import Mesher, MeshResult
from nofacet_viewer.overlays import frame_curvature
from nofacet_viewer.painter import Painter
from nofacet_viewer.state import View, ViewState

SIZE = (200, 150)
WHITE = (1.0, 1.0, 1.0)
FINE = nofacet.MeshSetting("fine", 1e-3, 0.1)


@pytest.fixture(scope="module")
def context() -> Iterator[Any]:
    found = offscreen_context()
    yield found
    found.release()


@pytest.fixture
def painter(context: Any) -> Iterator[Painter]:
    made = Painter(context)
    yield made
    made.release()


def painted(painter: Painter, context: Any, state: ViewState, camera: nofacet.Camera, size: Any = SIZE) -> Array:
    """What the painter draws, 8-bit sRGB (height, width, 3), row 0 at the top, as int."""
    framebuffer = context.simple_framebuffer(size, 3)
    for _ in range(2):  # the second has the lines that the first began to make
        painter.paint(state, camera, framebuffer, size)
        painter.wait()
    pixels = np.frombuffer(framebuffer.read(components=3, alignment=1), np.uint8)
    framebuffer.release()
    return pixels.reshape(size[1], size[0], 3)[::-1].astype(int)


def state(view: View, *overlays: str, **values: Any) -> ViewState:
    return ViewState(view, overlays=frozenset(overlays), background=WHITE, **values)


def fill(
    painter: Painter,
    model: nofacet.Model,
    mesh: nofacet.Mesh | None,
    camera: nofacet.Camera,
    shown: ViewState,
    size: Any = SIZE,
) -> nofacet.Frame:
    """Give the painter all that a view needs; the exact frame."""
    painter.set_model(model)
    painter.set_mesh(mesh)
    resolution = painter.exact_resolution(shown.view, size) or size
    frame = nofacet.render(model, camera, resolution, samples=8, buffers=painter.exact_buffers(shown))
    painter.set_exact(frame, frame_curvature(model, frame) if "curvature" in shown.overlays else None)
    return frame


def box() -> cq.Workplane:
    return cq.Workplane().box(4, 3, 2)


def inner(exact_face: Array, drawn_face: Array) -> Array:
    """Pixels (height, width) whose own and eight neighbours' centres show the same face on both sides."""
    same = (exact_face == drawn_face) & (exact_face >= 0)
    padded = np.pad(np.where(same, exact_face, -2), 1, constant_values=-2)
    height, width = exact_face.shape
    around = [padded[1 + dy : 1 + dy + height, 1 + dx : 1 + dx + width] for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
    return np.all([near == exact_face for near in around], axis=0) & same


# --- both sides agree ---


@dataclass(frozen=True)
class Subject:
    """A model, its mesh and where it is seen from. excess: deflections that the triangles are off the surfaces, where
    OpenCascade leaves them farther off than it was asked to (test_tessellation)."""

    source: Any
    setting: str = "Mayo"
    excess: float = 1.0
    direction: tuple[float, float, float] = GENERAL_DIRECTION


SUBJECTS = {
    "box": Subject(cq.Workplane().box(4, 3, 2)),
    "flange": Subject("cad_models/flange.step"),
    "flange as FreeCAD": Subject("cad_models/flange.step", "FreeCAD", FREECAD_FLANGE),
    "ctc_02": Subject(SHARED_MODELS / "nist" / "nist_ctc_02_asme1_rc.stp"),
    "teapot": Subject("cad_models/teapot.step"),
    # From here a ray runs along the lid: 5.7 deflections between depths where the surfaces are 0.3 apart.
    "teapot as F3D": Subject("cad_models/teapot.step", "F3D", F3D_TEAPOT, (0.35, 0.6, -0.7)),
}


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
@pytest.mark.parametrize("subject", SUBJECTS.values(), ids=SUBJECTS)
def test_depth_of_both_sides(painter: Painter, subject: Subject, projection: Any) -> None:
    if isinstance(subject.source, Path) and not subject.source.exists():
        pytest.skip("the third-party models are not here")
    model = nofacet.load(subject.source)
    mesh = nofacet.tessellate(subject.source, nofacet.MESH_SETTINGS[subject.setting])
    low, high = bounding_box(model)
    size = float(np.linalg.norm(high - low))
    resolution = (320, 240)
    camera = nofacet.Camera.fit(model, subject.direction, projection, resolution)
    frame = nofacet.render(model, camera, resolution, samples=1, buffers=("depth", "face", "uv"))
    painter.set_model(model)
    painter.set_mesh(mesh)
    drawn = painter.drawn_surface(camera, resolution)
    assert drawn
    depth, face = drawn
    checked = inner(frame.face, face)
    assert checked.sum() > 0.25 * (frame.face >= 0).sum()
    flat = np.array(model.surface_type)[model.face_definition] == "plane"
    on_flat = checked & flat[frame.face]
    assert np.abs(frame.depth[on_flat] - depth[on_flat]).max(initial=0.0) < 1e-4 * size
    # Depths differ by more than the surfaces are apart where a ray is slanted; how much more depends on their bend.
    points = camera.position_from_depth(depth.astype(np.float64))[checked]
    apart = surface_distance(model, frame.face[checked], frame.uv[checked], points)
    assert apart.max() <= subject.excess * mesh.deflection


@pytest.mark.parametrize("name", ["as1-oc-214", "assembly"])
def test_faces_of_both_sides_in_an_assembly(painter: Painter, name: str) -> None:
    source: Any = SHARED_MODELS / "cax" / f"{name}.stp"
    if name == "assembly":
        ball = cq.Workplane().sphere(1)
        source = cq.Assembly().add(ball, loc=cq.Location((5, 0, 0))).add(cq.Workplane().box(1, 2, 3)).add(ball)
    elif not source.exists():
        pytest.skip("the third-party models are not here")
    model = nofacet.load(source)
    mesher = Mesher()
    mesher.start(source, nofacet.MESH_SETTINGS["cadquery"])
    while (answer := mesher.poll()) is None:
        time.sleep(0.02)
    mesher.cancel()
    assert isinstance(answer, MeshResult)
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=SIZE)
    painter.set_model(model)
    painter.set_mesh(answer.mesh)
    face = nofacet.render(model, camera, SIZE, samples=1, buffers=("face",)).face
    drawn = painter.drawn_surface(camera, SIZE)
    assert drawn and (drawn[1] == face).mean() > 0.99


def test_colors_of_both_sides(painter: Painter, context: Any) -> None:
    content = cq.Assembly().add(box(), color=cq.Color(0.8, 0.2, 0.1))
    model, mesh = nofacet.load(content), nofacet.tessellate(content, FINE)
    for projection in ("orthographic", "perspective"):
        camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, projection, SIZE)
        frame = fill(painter, model, mesh, camera, state(View.DIFFERENCE))
        drawn = painter.drawn_surface(camera, SIZE)
        assert drawn
        pictures = [painted(painter, context, state(view), camera) for view in (View.EXACT, View.TESSELLATED)]
        difference = np.abs(pictures[0] - pictures[1]).max(axis=2)
        assert difference[inner(frame.face, drawn[1])].max() <= 1


def test_transparent_faces_of_both_sides(painter: Painter, context: Any) -> None:
    content = box()
    model, mesh = nofacet.load(content), nofacet.tessellate(content, FINE)
    colors = model.face_color.copy()
    colors[:] = [(0.8, 0.2, 0.1, 0.4), (0.1, 0.5, 0.2, 1.0)] * 3
    model = replace(model, face_color=colors)
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, "orthographic", SIZE)
    frame = fill(painter, model, mesh, camera, state(View.DIFFERENCE))
    drawn = painter.drawn_surface(camera, SIZE)
    assert drawn
    pictures = [painted(painter, context, state(view), camera) for view in (View.EXACT, View.TESSELLATED)]
    difference = np.abs(pictures[0] - pictures[1]).max(axis=2)[inner(frame.face, drawn[1])]
    assert np.percentile(difference, 95) <= 1  # the rest: edges of the faces behind


# --- views ---


def test_exact_view_is_the_saved_picture(painter: Painter, context: Any, sphere: nofacet.Model, tmp_path: Any) -> None:
    camera = nofacet.Camera.fit(sphere, GENERAL_DIRECTION, resolution=SIZE)
    frame = fill(painter, sphere, None, camera, state(View.EXACT))
    frame.over((1, 1, 1)).save(tmp_path / "exact.png")
    stored, _, _ = nofacet.image.read(tmp_path / "exact.png")
    difference = np.abs(painted(painter, context, state(View.EXACT), camera) - np.rint(255 * stored[..., :3]))
    assert difference.max() <= 1 and (difference > 0).mean() < 1e-3


def test_background_shows_where_nothing_is(painter: Painter, context: Any) -> None:
    shown = ViewState(View.SIDE_BY_SIDE, background=(0.05, 0.2, 0.4))
    picture = painted(painter, context, shown, look_down(2.0))
    assert (picture[:, [10, -10]] == np.array([63, 124, 170])).all()


def test_wipe_and_side_by_side_show_each_side_in_its_place(painter: Painter, context: Any) -> None:
    content = cq.Workplane().sphere(1)
    model, mesh = nofacet.load(content), nofacet.tessellate(content, nofacet.MeshSetting("coarse", 0.2, 1.0))
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=SIZE)
    fill(painter, model, mesh, camera, state(View.WIPE))
    exact, drawn = (painted(painter, context, state(view), camera) for view in (View.EXACT, View.TESSELLATED))
    assert (exact != drawn).any()
    for wipe in (0.0, 0.3, 1.0):
        picture = painted(painter, context, state(View.WIPE, wipe=wipe), camera)
        column = round(wipe * SIZE[0])
        assert (picture[:, : max(0, column - 1)] == exact[:, : max(0, column - 1)]).all()
        assert (picture[:, column + 1 :] == drawn[:, column + 1 :]).all()
    for blink_exact, side in ((True, exact), (False, drawn)):
        assert (painted(painter, context, state(View.BLINK, blink_exact=blink_exact), camera) == side).all()
    wide = (2 * SIZE[0] + 2, SIZE[1])
    assert painter.exact_resolution(View.SIDE_BY_SIDE, wide) == SIZE
    both = painted(painter, context, state(View.SIDE_BY_SIDE), camera, wide)
    assert (both[:, : SIZE[0]] == exact).all() and (both[:, -SIZE[0] :] == drawn).all()
    assert (both[:, SIZE[0] : SIZE[0] + 2] == 115).all()


def test_frame_of_lower_resolution_fills_its_pane(painter: Painter, context: Any, sphere: nofacet.Model) -> None:
    camera = nofacet.Camera.fit(sphere, GENERAL_DIRECTION, resolution=SIZE)
    painter.set_model(sphere)
    pictures = []
    for resolution in (SIZE, (SIZE[0] // 2, SIZE[1] // 2)):
        painter.set_exact(nofacet.render(sphere, camera, resolution, buffers=("color",)))
        pictures.append(painted(painter, context, state(View.EXACT), camera))
    assert np.abs(pictures[0] - pictures[1])[40:-40, 60:-60].max() <= 3


def test_edges_of_triangles_are_hidden_by_them_whatever_the_deflection(painter: Painter, context: Any) -> None:
    content = box().faces(">Z").workplane().rect(2, 1.5).cutBlind(-0.1)
    model = nofacet.load(content)
    camera = nofacet.Camera.fit(model, (-0.6, 0.5, -0.3), resolution=SIZE)
    pictures = []
    for deflection in (1e-3, 1.0):
        mesh = nofacet.tessellate(content, nofacet.MeshSetting("flat faces anyway", deflection))
        fill(painter, model, mesh, camera, state(View.TESSELLATED))
        pictures.append(painted(painter, context, state(View.TESSELLATED, "edges"), camera))
    assert (pictures[0] != painted(painter, context, state(View.TESSELLATED), camera)).any()
    assert (pictures[0] == pictures[1]).all()


# --- the difference ---


def polygon(camera: nofacet.Camera, sides: int, squeeze: float = 1.0) -> nofacet.Mesh:
    """A regular polygon in the unit circle that faces the camera."""
    right, up, forward = camera.axes()
    angle = 0.3 + 2 * np.pi * np.arange(sides) / sides
    rim = np.cos(angle)[:, None] * right + squeeze * np.sin(angle)[:, None] * up
    corners = np.arange(1, sides + 1)
    triangles = np.stack([np.zeros(sides, int), corners, np.roll(corners, -1)], axis=1).astype(np.int32)
    points = np.vstack([np.zeros(3), rim])
    normals = np.broadcast_to(-forward, points.shape).astype(np.float32)
    return nofacet.Mesh(points, normals, triangles, np.zeros(sides, np.int32), 0.0)


def test_difference_of_a_polygon_is_its_sagitta(sphere: nofacet.Model) -> None:
    camera = nofacet.Camera.fit(sphere, GENERAL_DIRECTION, resolution=SIZE)
    radius = SIZE[1] / camera.extent_at_unit_depth()
    found = outline_difference(sphere, polygon(camera, 24), camera, SIZE)
    sagitta = radius * (1 - np.cos(np.pi / 24))
    assert found.error and found.error.unmatched == 0
    assert found.error.largest == pytest.approx(sagitta, rel=0.02)
    signed, where = found.picture[..., 0], found.picture[..., 1] > 0
    assert signed.max() <= 1e-6 and signed.min() == pytest.approx(-sagitta, rel=0.02)
    y, x = np.nonzero(where)
    distance = np.hypot(x + 0.5 - SIZE[0] / 2, y + 0.5 - SIZE[1] / 2)
    assert np.abs(distance - radius).max() < sagitta + 3


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_difference_of_a_box_is_zero_and_lies_on_its_outline(projection: Any) -> None:
    content = cq.Workplane().box(4, 3, 2).translate((7, -5, 3))
    model, mesh = nofacet.load(content), nofacet.tessellate(content, FINE)
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, projection, SIZE)
    found = outline_difference(model, mesh, camera, SIZE)
    assert found.error and found.error.largest < 1e-6
    face = nofacet.render(model, camera, SIZE, samples=1, buffers=("face",)).face >= 0
    border = np.zeros_like(face)
    border[:, 1:] |= face[:, 1:] != face[:, :-1]
    border[1:] |= face[1:] != face[:-1]
    spread = np.pad(border, 3)
    around = [
        spread[3 + dy : 3 + dy + SIZE[1], 3 + dx : 3 + dx + SIZE[0]] for dy in range(-2, 3) for dx in range(-3, 4)
    ]
    where = found.picture[..., 1] > 0
    assert where[border].mean() > 0.95 and np.any(around, axis=0)[where].all()


def test_difference_view_shows_the_error_in_the_legends_color(
    painter: Painter, context: Any, sphere: nofacet.Model
) -> None:
    camera = nofacet.Camera.fit(sphere, GENERAL_DIRECTION, resolution=SIZE)
    mesh = polygon(camera, 8)
    shown = state(View.DIFFERENCE)
    fill(painter, sphere, mesh, camera, shown)
    found = outline_difference(sphere, mesh, camera, SIZE)
    painter.set_difference(found)
    scale = painter.legend(shown)
    assert scale and found.error and scale.high >= found.error.largest > scale.high / 3
    picture = painted(painter, context, shown, camera)
    y, x = np.unravel_index(np.argmin(found.picture[..., 0]), SIZE[::-1])
    expected = scale.color(found.picture[y, x, 0])
    srgb = 255 * np.where(expected <= 0.0031308, 12.92 * expected, 1.055 * expected ** (1 / 2.4) - 0.055)
    assert picture[y, x] == pytest.approx(srgb, abs=3)
    assert len(np.unique(picture[SIZE[1] // 2, SIZE[0] // 2])) == 1  # gray inside
    painter.set_difference(None)
    without = painted(painter, context, shown, camera)
    assert np.ptp(without, axis=2).max() == 0  # nothing but gray while no difference is known


# --- overlays ---


def pixel_of(camera: nofacet.Camera, points: Array) -> Array:
    """Pixels (n, 2) of world points (n, 3)."""
    screen = np.column_stack([points, np.ones(len(points))]) @ camera.pixel_from_world(SIZE).T
    return screen[:, :2] / screen[:, 3:]


@pytest.mark.parametrize("side", [View.EXACT, View.TESSELLATED])
@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_patch_borders_of_a_box_are_its_visible_edges(
    painter: Painter, context: Any, side: View, projection: Any
) -> None:
    content = box()
    model, mesh = nofacet.load(content), nofacet.tessellate(content, FINE)
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, projection, SIZE)
    shown = state(side, "patch-borders")
    fill(painter, model, mesh, camera, shown)
    orange = (
        np.abs(painted(painter, context, shown, camera) - painted(painter, context, state(side), camera)).sum(2) > 60
    )
    corner = np.array([2, 1.5, 1]) * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    pairs = [(a, b) for a in range(8) for b in range(a) if (corner[a] != corner[b]).sum() == 1]
    hidden = np.argmin(corner @ -np.array(GENERAL_DIRECTION))
    t = np.linspace(0.1, 0.9, 50)[:, None]
    near = np.zeros_like(orange)
    for a, b in pairs:
        place = np.floor(pixel_of(camera, (1 - t) * corner[a] + t * corner[b])).astype(int)
        if hidden in (a, b):
            assert orange[place[10:40, 1], place[10:40, 0]].mean() < 0.1
            continue
        assert orange[place[:, 1], place[:, 0]].mean() > 0.95
        for x, y in np.floor(pixel_of(camera, corner[a] + np.linspace(0, 1, 400)[:, None] * (corner[b] - corner[a]))):
            near[max(0, int(y) - 2) : int(y) + 3, max(0, int(x) - 2) : int(x) + 3] = True
    assert near[orange].all()


@pytest.mark.parametrize("overlay", ["mesh-edges", "edges"])
def test_lines_of_the_mesh_are_on_the_tessellated_side_only(painter: Painter, context: Any, overlay: str) -> None:
    content = cq.Workplane().cylinder(2, 1)
    model, mesh = nofacet.load(content), nofacet.tessellate(content, nofacet.MeshSetting("coarse", 0.1))
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=SIZE)
    changed = []
    for side in (View.EXACT, View.TESSELLATED):
        fill(painter, model, mesh, camera, state(side, overlay))
        changed.append(
            (painted(painter, context, state(side, overlay), camera) != painted(painter, context, state(side), camera))
            .any(axis=2)
            .sum()
        )
    assert changed[0] == 0 and changed[1] > 300


def test_control_nets_reach_beyond_the_surface(painter: Painter, context: Any, sphere: nofacet.Model) -> None:
    camera = look_down(2.6)
    shown = state(View.EXACT, "control-nets")
    fill(painter, sphere, None, camera, shown)
    picture = painted(painter, context, shown, camera)
    blue = picture[..., 2] - picture[..., 0] > 50
    x, y = np.floor(pixel_of(camera, np.array([[0.9, 1.0, 0.0], [1.0, -0.9, 0.0]]))).astype(int).T
    assert blue[y, x].all()


def test_zebra_of_both_sides(painter: Painter, context: Any) -> None:
    content = cq.Workplane().sphere(1)
    model, mesh = nofacet.load(content), nofacet.tessellate(content, nofacet.MeshSetting("fine", 1e-4, 0.02))
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=SIZE)
    fill(painter, model, mesh, camera, state(View.WIPE, "zebra"))
    exact, drawn = (painted(painter, context, state(view, "zebra"), camera) for view in (View.EXACT, View.TESSELLATED))
    middle = np.s_[40:110, 60:140]
    assert 0.3 < (exact[middle] > 128).mean() < 0.7
    assert (np.abs(exact - drawn)[middle] < 40).mean() > 0.9  # the rest: the stripes' anti-aliased borders
    # Level strip lights: the stripes of a sphere are as wide on its left as on its right.
    assert (np.abs(exact - exact[:, ::-1])[middle] < 40).mean() > 0.97


def test_curvature_of_both_sides(painter: Painter, context: Any) -> None:
    content = cq.Workplane().sphere(5)
    model, mesh = nofacet.load(content), nofacet.tessellate(content, nofacet.MeshSetting("fine", 1e-3, 0.05))
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=SIZE)
    shown = state(View.WIPE, "curvature")
    fill(painter, model, mesh, camera, shown)
    scale = painter.legend(shown)
    assert scale
    painter.set_model(replace(model, face_color=np.array([[*scale.color(-1 / 5), 1.0]], np.float32)))
    expected = painted(painter, context, state(View.TESSELLATED), camera)
    painter.set_model(model)
    middle = np.s_[40:110, 60:140]
    drawn = painted(painter, context, state(View.TESSELLATED, "curvature"), camera)
    assert np.abs(drawn - expected)[middle].mean() < 12
    if not hasattr(nofacet, "evaluate"):
        pytest.skip("the exact side needs nofacet.evaluate")
    exact = painted(painter, context, state(View.EXACT, "curvature"), camera)
    assert np.abs(exact - expected)[middle].max() <= 3


def test_conversion_error_colors_faces(painter: Painter, context: Any) -> None:
    content = box()
    model, mesh = nofacet.load(content), nofacet.tessellate(content, FINE)
    errors = np.array([1e-15, 1e-12, 1e-9, 1e-6, np.nan, 1e-3])
    model = replace(model, conversion_error=errors)
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=SIZE)
    shown = state(View.WIPE, "conversion-error")
    frame = fill(painter, model, mesh, camera, shown)
    scale = painter.legend(shown)
    assert scale and scale.log and (scale.low, scale.high) == pytest.approx((1e-15, 1e-3))
    exact, drawn = (
        painted(painter, context, state(view, "conversion-error"), camera) for view in (View.EXACT, View.TESSELLATED)
    )
    inside = inner(frame.face, frame.face)
    assert np.abs(exact - drawn)[inside].max() <= 1
    assert len(np.unique(exact[inside], axis=0)) >= 3


def test_hidden_faces_are_not_drawn(painter: Painter, context: Any) -> None:
    content = box()
    model, mesh = nofacet.load(content), nofacet.tessellate(content, FINE)
    colors = model.face_color.copy()
    colors[:, 3] = 0
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=SIZE)
    painter.set_model(replace(model, face_color=colors))
    painter.set_mesh(mesh)
    assert (painted(painter, context, state(View.TESSELLATED), camera) == 255).all()


def test_a_model_far_from_the_origin_keeps_its_digits(painter: Painter) -> None:
    content = box().translate((1e6, -2e6, 3e6))
    model, mesh = nofacet.load(content), nofacet.tessellate(content, FINE)
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=SIZE)
    painter.set_model(model)
    painter.set_mesh(mesh)
    frame = nofacet.render(model, camera, SIZE, samples=1, buffers=("depth", "face"))
    drawn = painter.drawn_surface(camera, SIZE)
    assert drawn
    checked = inner(frame.face, drawn[1])
    assert checked.sum() > 5000 and np.abs(frame.depth[checked] - drawn[0][checked]).max() < 1e-4 * np.sqrt(29)


# --- selection and section planes ---


@pytest.mark.parametrize("overlays", [(), ("zebra",)])
def test_selected_faces_are_marked_alike_on_both_sides(painter: Painter, context: Any, overlays: Any) -> None:
    model, mesh = nofacet.load(box()), nofacet.tessellate(box(), FINE)
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, resolution=SIZE)
    plain, marks = {}, {}
    for view in (View.EXACT, View.TESSELLATED):
        shown = state(view, *overlays)
        painter.set_selected(np.zeros(model.face_count, bool))
        fill(painter, model, mesh, camera, shown)
        face = nofacet.render(model, camera, SIZE, buffers=("face",)).face
        painter.set_exact(
            nofacet.render(model, camera, SIZE, samples=8, buffers=(*painter.exact_buffers(shown), "face"))
        )
        plain[view] = painted(painter, context, shown, camera)
        painter.set_selected(np.arange(model.face_count) == face[75, 100])
        marks[view] = painted(painter, context, shown, camera)
    chosen = inner(np.where(face == face[75, 100], face, -1), face)
    others = inner(np.where(face == face[75, 100], -1, face), face)
    for view in plain:
        assert (marks[view][others] == plain[view][others]).all()
        assert (marks[view][chosen][:, 0] > marks[view][chosen][:, 2] + 60).all()  # orange
    assert (
        np.abs(marks[View.EXACT] - marks[View.TESSELLATED])[chosen].max()
        <= np.abs(plain[View.EXACT] - plain[View.TESSELLATED])[chosen].max() + 2
    )


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_section_planes_cut_both_sides_alike(painter: Painter, projection: Any) -> None:
    """Where the exact side shows no cap, the triangles show the same face at the same depth."""
    source = cq.Workplane(origin=(1000, 0, 0)).box(4, 3, 2).faces(">Z").hole(1)
    model, mesh = nofacet.load(source), nofacet.tessellate(source, FINE)
    camera = nofacet.Camera.fit(model, GENERAL_DIRECTION, projection, SIZE)
    sections = (nofacet.Section((1000, -0.2, 0), (0.1, -1, 0.2)), nofacet.Section((1001, 0, 0), (1, 0, 0)))
    frame = nofacet.render(model, camera, SIZE, samples=1, buffers=("depth", "face"), sections=sections)
    painter.set_model(model)
    painter.set_mesh(mesh)
    whole = painter.drawn_surface(camera, SIZE)
    painter._drawn.cut(sections)
    cut = painter.drawn_surface(camera, SIZE)
    assert whole and cut and (whole[1] != cut[1]).mean() > 0.1
    same = inner(frame.face, cut[1])
    assert same.sum() > 0.5 * (frame.face >= 0).sum() > 500
    assert np.abs(frame.depth[same] - cut[0][same]).max() < 5e-3
    background = (frame.face == -1) != (cut[1] == -1)
    assert background.sum() < 0.05 * (frame.face != -1).sum()  # only pixels of outlines


@pytest.mark.parametrize("overlay", ["zebra", "curvature", "conversion-error"])
def test_caps_are_drawn_with_every_overlay(painter: Painter, context: Any, overlay: str) -> None:
    model, shown = nofacet.load(box()), state(View.EXACT, overlay)
    sections = (nofacet.Section((0, 0, 0), (0, 0, 1)),)
    camera = look_down(6)
    painter.set_model(model)
    buffers = painter.exact_buffers(shown)
    frame = nofacet.render(model, camera, SIZE, samples=4, buffers=(*buffers, "color"), sections=sections)
    painter.set_exact(frame, frame_curvature(model, frame) if overlay == "curvature" else None)
    pixels = painted(painter, context, shown, camera)
    assert frame.face[75, 100] == -2
    linear = frame.color[75, 100, :3]
    np.testing.assert_allclose(pixels[75, 100], 255 * (1.055 * linear ** (1 / 2.4) - 0.055), atol=1)

"""One small scene for every fault that was found and fixed: it must stay fixed."""

import itertools
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest

import nofacet
from conftest import model_of, rectangle_group
from nofacet.camera import Projection
from nofacet.model import PatchGroup

RESOLUTION = (160, 120)


def fit(
    model: nofacet.Model, direction: tuple[float, float, float], projection: Projection = "orthographic"
) -> nofacet.Camera:
    return nofacet.Camera.fit(model, direction=direction, projection=projection, resolution=RESOLUTION)


@pytest.mark.parametrize("direction", [*itertools.product((-1, 1), (-0.7, 0.7), (-0.5, 0.5))])
def test_faces_that_touch_at_the_outline_keep_their_colour(direction: tuple[float, float, float]) -> None:
    """A visible face and a hidden one share the left end of their spans; the tie there decided for the whole span."""
    model = nofacet.load(cq.Workplane().box(3, 2, 1))
    frame = nofacet.render(model, fit(model, direction), RESOLUTION, samples=1)
    for face in np.unique(frame.face[frame.face >= 0]):
        inner = frame.face == face
        for axis, step in itertools.product((0, 1), (-1, 1)):
            inner &= np.roll(frame.face, step, axis) == face
        colors = frame.color[inner]
        assert len(colors) > 10
        assert np.ptp(colors, axis=0).max() < 1e-6


def test_round_hole_in_perspective_terminates() -> None:
    """A trim curve's lowest point on a plane was halved for ever: no bound of its height was asked for."""
    model = nofacet.load(cq.Workplane().box(4, 3, 0.5).faces(">Z").workplane().hole(1.5))
    frame = nofacet.render(model, fit(model, (-1, 1, -1), projection="perspective"), RESOLUTION)
    assert frame.stats["unresolved"] == 0
    assert (frame.face >= 0).any()


def test_trimmed_face_without_a_trim_in_the_picture() -> None:
    """A trimmed piece that keeps no part of its trim curves took nothing from an empty store and crashed."""
    model = nofacet.load(cq.Workplane().circle(10).extrude(1))
    camera = nofacet.Camera("orthographic", (0.0, 0.0, 50.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), view_height=1.0)
    frame = nofacet.render(model, camera, RESOLUTION)
    assert (frame.coverage == 1).all()
    assert np.abs(frame.depth - 49.0).max() < 1e-12


def wavy_edge(amplitude: float) -> cq.Edge:
    points = [(x, amplitude * np.sin(3 * x), 0) for x in np.linspace(0, 10, 15)]
    return cq.Edge.makeSpline([cq.Vector(*point) for point in points])


@pytest.mark.parametrize("amplitude", [1e-9, 1e-7, 1e-5])
def test_trim_level_to_the_last_digits_terminates(amplitude: float) -> None:
    """An edge straight but for the digits it was written with, along a scan plane: bounds never told the two apart."""
    edge = wavy_edge(amplitude)
    rest = [cq.Edge.makeLine(a, b) for a, b in itertools.pairwise([(10, 0, 0), (10, 5, 0), (0, 5, 0), (0, 0, 0)])]
    rest[0] = cq.Edge.makeLine(edge.endPoint(), cq.Vector(10, 5, 0))
    rest[-1] = cq.Edge.makeLine(cq.Vector(0, 5, 0), edge.startPoint())
    face = cq.Face.makeFromWires(cq.Wire.assembleEdges([edge, *rest]))
    # The edge lies on the pixel centres of row 60 of 121.
    camera = nofacet.Camera("orthographic", (5.0, 0.0, 50.0), (5.0, 0.0, 0.0), (0.0, 1.0, 0.0), view_height=12.1)
    frame = nofacet.render(nofacet.load(face), camera, (161, 121), samples=4)
    assert frame.coverage.sum() * 0.1**2 == pytest.approx(50.0, abs=1e-4)


@pytest.mark.parametrize("amplitude", [1e-9, 1e-7, 1e-5, 1e-3])
def test_wall_edge_on_to_the_last_digits_terminates(amplitude: float) -> None:
    """A wall seen edge-on whose waves are far below a pixel was subdivided down to the waves."""
    wall = cq.Face.makeRuledSurface(wavy_edge(amplitude), wavy_edge(amplitude).moved(cq.Location(cq.Vector(0, 0, 4))))
    model = nofacet.load(wall)
    for up in ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.3, 1.0, 0.0)):
        camera = nofacet.Camera("orthographic", (5.0, 0.0, 50.0), (5.0, 0.0, 0.0), up, view_height=12.1)
        frame = nofacet.render(model, camera, (161, 121), samples=4)
        assert frame.stats["unresolved"] == 0
        assert frame.stats["pieces"] < 20000
        assert frame.coverage.sum() < 1.0


@pytest.mark.parametrize("direction", [(0.0, 1.0, 0.0), (1.0, 0.0, 0.0)])
@pytest.mark.parametrize("up", [(0.0, 0.0, 1.0), (0.6, 0.6, 0.0)])
def test_level_edges_are_placed_between_scan_planes(
    direction: tuple[float, float, float], up: tuple[float, float, float]
) -> None:
    """A cylinder from the side: its level ends, or its level outline, fell on the nearest of 16 strips."""
    height, radius, view_height = 7.3, 2.17, 9.37
    model = nofacet.load(cq.Workplane().cylinder(height, radius))
    x, y, z = (0.123 - 50 * d for d in direction)
    camera = nofacet.Camera("orthographic", (x, y, z), (0.123, 0.123, 0.123), up, view_height=view_height)
    frame = nofacet.render(model, camera, RESOLUTION, samples=16, buffers=("coverage",))
    pixel = view_height / RESOLUTION[1]
    outline_pixels = 2 * (height + 2 * radius) / pixel
    area = float(frame.coverage.sum(dtype=np.float64)) * pixel**2
    assert abs(area - 2 * radius * height) / pixel**2 < 1e-3 * outline_pixels


def test_eye_close_above_a_face_that_passes_under_it() -> None:
    """Pieces whose depths differ much were halved in the wrong direction, and their area was never certified."""
    model = nofacet.load(cq.Workplane().rect(100, 100).extrude(1))
    camera = nofacet.Camera("perspective", (0.0, 0.0, 1.0001), (10.0, 1.0, 1.0), (0.0, 0.0, 1.0), view_angle=90.0)
    frame = nofacet.render(model, camera, RESOLUTION)
    assert frame.stats["unresolved"] == 0
    assert frame.stats["pieces"] < 2000
    assert (frame.face[62:] >= 0).all()


def test_slanted_strip_seen_almost_edge_on() -> None:
    """x and y vary together along a thin strip; only bounds along and across it could prove anything."""
    points = [[cq.Vector(x, y, 1e-4 * np.sin(x + y)) for y in np.linspace(0, 5, 9)] for x in np.linspace(0, 5, 9)]
    model = nofacet.load(cq.Face.makeSplineApprox(points, tol=1e-9, smoothing=None, minDeg=3, maxDeg=8))
    camera = nofacet.Camera("orthographic", (50.0, 2.5, 0.01), (2.5, 2.5, 0.0), (0.0, 0.4, 1.0), view_height=6.0)
    frame = nofacet.render(model, camera, RESOLUTION)
    assert frame.stats["unresolved"] == 0
    assert frame.stats["pieces"] < 3000


def test_normal_at_a_pole_seen_head_on() -> None:
    """The middle pixel shows a sphere's pole, where one derivative vanishes; the normal there is the limit."""
    model = nofacet.load(cq.Workplane().sphere(5))
    camera = nofacet.Camera("orthographic", (0.0, 0.0, 50.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), view_height=12.0)
    frame = nofacet.render(model, camera, (121, 91), buffers=("normal",))
    assert np.abs(frame.normal[45, 60] - (0, 0, 1)).max() < 1e-6


def test_loop_that_crosses_itself_shows_no_lobe() -> None:
    """Where edges overshoot their corner the lobe beyond the crossing winds the other way round: it is outside."""
    square = rectangle_group(np.array([[[0.0, 0, 0], [0, 4, 0]], [[4, 0, 0], [4, 4, 0]]]), (0, 4, 0, 4))
    # The third corner of the square is a crossing at (3, 3); both edges run on to 3.5.
    loop = np.array([[1.0, 1], [3, 1], [3, 3.5], [3.5, 3], [1, 3]])
    model = model_of([square], {0: [loop]})
    camera = nofacet.Camera("orthographic", (2.0, 2.0, 9.0), (2.0, 2.0, 0.0), (0.0, 1.0, 0.0), view_height=4.0)
    coverage = nofacet.render(model, camera, (64, 64), samples=16, buffers=("coverage",)).coverage
    assert coverage.sum(dtype=np.float64) * (4 / 64) ** 2 == pytest.approx(4.0, abs=1e-3)


def test_a_silhouette_along_a_patch_border_is_resolved() -> None:
    """A torus from above: its outlines are parameter lines, on which the screen Jacobian vanishes all along."""
    torus = nofacet.load(cq.Solid.makeTorus(3.0, 1.0))
    camera = nofacet.Camera("orthographic", (0, 0, 10), (0, 0, 0), (0, 1, 0), view_height=9.0)
    frame = nofacet.render(torus, camera, (91, 91), samples=1, buffers=("face",))
    assert frame.stats["unresolved"] == 0
    x = (np.arange(91) + 0.5) * 9.0 / 91 - 4.5
    radius = np.hypot(x[None, :], x[:, None])
    np.testing.assert_array_equal(frame.face >= 0, (radius > 2.0) & (radius < 4.0))


def test_a_stretch_as_narrow_as_rounding_says_nothing_of_the_next_scan_plane() -> None:
    """A disc whose outermost points lie on the middle row's centre line, where they touch the border of its patch."""
    disc = nofacet.load(cq.Solid.makeCylinder(5.0, 7.0))
    camera = nofacet.Camera("orthographic", (0, 0, 30), (0, 0, 0), (0, 1, 0), view_height=11.7)
    frame = nofacet.render(disc, camera, (121, 91), samples=1, buffers=("face",))
    x, y = (np.arange(121) + 0.5 - 60.5) * 11.7 / 91, (np.arange(91) + 0.5 - 45.5) * 11.7 / 91
    np.testing.assert_array_equal(frame.face >= 0, np.hypot(x[None, :], y[:, None]) < 5.0)


@pytest.mark.parametrize("sign", [1, -1])
def test_surfaces_that_meet_in_an_edge_and_cross_again_beside_it(sign: int) -> None:
    """A parabola rises from a plane's edge and dives through the plane within .4 pixels: only the far end decided."""
    pixel = 0.1
    crossing = 0.4 * pixel
    plane = rectangle_group(np.array([[[0.0, -2, 0], [0, 2, 0]], [[sign * 2.0, -2, 0], [sign * 2.0, 2, 0]]]))
    # z = x (crossing - x) for 0 <= x <= 2.
    column = np.array([[0.0, 0.0], [1.0, crossing], [2.0, 2 * (crossing - 2)]])
    points = np.array([[[sign * x, y, z, 1.0] for y in (-2.0, 2.0)] for x, z in column])
    parabola = PatchGroup(points[None], np.ones(1, np.int32), np.array([[0.0, 1, 0, 1]]), np.zeros((1, 2), np.uint8))
    # The edge lies .2 pixels beside the centres of the middle column.
    centre = 0.2 * sign * pixel
    camera = nofacet.Camera("orthographic", (centre, 0, 10), (centre, 0, 0), (0, 1, 0), view_height=3.0)
    frame = nofacet.render(model_of([plane, parabola]), camera, (81, 30), samples=1, buffers=("face",))
    from_edge = sign * ((np.arange(81) - 40) * pixel + centre)
    expected = np.where(from_edge < crossing, 1, 0)
    expected[(from_edge < 0) | (from_edge > 2)] = -1
    assert (expected == 1).sum() == 1
    np.testing.assert_array_equal(frame.face, np.broadcast_to(expected, frame.face.shape))


def bezier(points: np.ndarray, definition: int = 0) -> PatchGroup:
    """One patch from homogeneous control points."""
    return PatchGroup(
        points[None], np.array([definition], np.int32), np.array([[0.0, 1, 0, 1]]), np.ones((1, 2), np.uint8)
    )


def test_weights_that_are_equal_but_for_rounding() -> None:
    """Subdivision rounds them to 1: forms of a rational patch were then filled as those of a polynomial one."""
    rng = np.random.default_rng(2)
    for _ in range(150):
        size = 10 ** rng.uniform(-1, 0)
        camera = nofacet.Camera("orthographic", (0, 0, 10), (0, 0, 0), (0, 1, 0), view_height=size)
        patches = []
        for _ in range(2):
            n, m = rng.integers(1, 4, 2)
            grid = np.stack(
                np.meshgrid(np.linspace(-1.3, 1.3, n + 1), np.linspace(-1.3, 1.3, m + 1), indexing="ij"), -1
            )
            grid = grid * rng.choice([-1, 1], 2) + 0.1 * rng.standard_normal(grid.shape)
            points = np.concatenate([grid, rng.standard_normal((n + 1, m + 1, 1)), np.ones((n + 1, m + 1, 1))], -1)
            patches.append(points)
        faces = []
        for weight in (1.0, 1.0 - 2.0**-53):
            for points in patches:
                points[0, 0] *= weight / points[0, 0, 3]
            model = model_of([bezier(points, k) for k, points in enumerate(patches)])
            faces.append(nofacet.render(model, camera, (80, 60), samples=1, buffers=("face",)).face)
        np.testing.assert_array_equal(faces[0], faces[1])


def test_a_silhouette_along_a_parameter_line_at_high_degree() -> None:
    """A sum of two curves, P(u) + Q(v): where Q runs towards the eye J vanishes for all u. Only v was halved there."""
    p = np.array(
        [
            [0.9281263945568798, -0.8415879990444481, 0.02505088556662999],
            [0.774701055971149, -0.38567902678985777, 0.1846547115001528],
            [0.9028823242713505, -0.8759727343948754, 0.17777361457608326],
        ]
    )
    q = np.array(
        [
            [0.0, 0.0, 0.0],
            [-0.2381433765380368, 0.5885745093017179, -0.5548475987698333],
            [-0.9755586555393922, 0.2848023261786785, -0.1631200237280111],
            [-1.6745904586518386, 0.5767428979468503, 0.388373458007],
            [-1.0132128975699398, 0.9791343791746456, 0.339952117507],
        ]
    )
    points = np.concatenate([p[:, None] + q[None], np.ones((3, 5, 1))], -1)
    camera = nofacet.Camera("orthographic", (0, 0, 10), (0, 0, 0), (0, 1, 0), view_height=3.0)
    frames = [
        nofacet.render(model_of([bezier(points)]), camera, RESOLUTION, method=method, samples=1, buffers=("face",))
        for method in ("bezier_clip_scanline", "bezier_clip_ray")
    ]
    assert frames[0].stats["unresolved"] == 0
    assert frames[0].stats["pieces"] < 1000
    np.testing.assert_array_equal(frames[0].face, frames[1].face)


def test_a_section_plane_that_cuts_a_span_beyond_the_picture() -> None:
    """The middle of a span lay beyond the picture, and so did the crossing that would have told what is kept."""
    weights = np.array([[0.79, 0.83, 1.19, 0.80, 1.02], [0.98, 1.11, 0.93, 1.10, 1.03]])
    y, z = np.meshgrid([-1.0, 1.0], np.linspace(-1, 1, 5), indexing="ij")
    points = np.stack([np.zeros_like(y), y, z, np.ones_like(y)], -1) * weights[..., None]
    camera = nofacet.Camera("perspective", (0.37, 0.63, 0.11), (0.0, 0.0, 0.0), (0.94, 0.20, -0.29), view_angle=90.0)
    section = nofacet.Section((0.287, 0.143, -0.055), (0.49, -0.152, -0.858))
    frames = [
        nofacet.render(
            model_of([bezier(points)]),
            camera,
            (80, 60),
            method=method,
            samples=1,
            buffers=("face",),
            sections=[section],
        )
        for method in ("bezier_clip_scanline", "bezier_clip_ray")
    ]
    assert (frames[0].face >= 0).any()
    np.testing.assert_array_equal(frames[0].face, frames[1].face)


@pytest.mark.parametrize("normal", [(0, 1, 1), (1, 1, 1)])
def test_a_section_plane_where_faces_pass_the_eye(normal: tuple[float, float, float]) -> None:
    """What crosses the eye plane was halved by lengths that are right in the picture, not in a section plane's side
    view: along one parameter only, until it was given up."""
    model = nofacet.load(cq.Workplane().cylinder(4, 2))
    camera = nofacet.Camera("perspective", (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), view_angle=60.0)
    section = nofacet.Section((0.0, 0.0, 0.0), normal)
    frames = [
        nofacet.render(model, camera, RESOLUTION, method, samples=1, buffers=("face",), sections=[section])
        for method in ("bezier_clip_scanline", "bezier_clip_ray")
    ]
    assert (frames[0].face != -1).any()
    assert frames[0].stats["unresolved"] == 0
    np.testing.assert_array_equal(frames[0].face, frames[1].face)


@pytest.mark.parametrize("samples", [1, 16])
def test_a_flat_face_that_passes_through_a_curved_one(samples: int) -> None:
    """The depth of flat faces was not computed where they were compared with curved ones point by point."""
    shape = cq.Compound.makeCompound([cq.Solid.makeSphere(1.0, angleDegrees1=-90), cq.Solid.makeBox(2, 2, 2)])
    model = nofacet.load(shape)
    for direction in ((1.0, 0.3, 0.2), (-0.4, 0.5, -1.0), (-1.0, -2.0, -0.7)):
        camera = fit(model, direction)
        frame, other = (
            nofacet.render(model, camera, RESOLUTION, method=method, samples=count)
            for method, count in (("bezier_clip_scanline", samples), ("bezier_clip_ray", 1))
        )
        np.testing.assert_array_equal(frame.face, other.face)


@pytest.mark.parametrize("direction", [(1.19, -1.13, 0.24), (0.58, -1.45, -0.12), (2.0, -1.55, 0.11)])
def test_both_borders_of_a_trimmed_patch_turn_at_one_place(direction: tuple[float, float, float]) -> None:
    """An extrusion's borders turn together but for rounding, and a piece of no width was cut out between them: its trim
    crossings were all rounding, and a run of pixels showed it."""
    points = [(1.2, 0), (0.5, 0.85), (-0.55, 0.95), (-0.5, 0), (-0.5, -0.85), (0.75, -1.3)]
    ring = cq.Workplane(obj=cq.Solid.makeTorus(1.2, 0.4)).rotate((0, 0, 0), (1, 1, 0), 60).translate((0.5, 0.3, 0.4))
    model = nofacet.load(cq.Workplane().spline(points).close().extrude(1.5).cut(ring))
    camera = fit(model, direction)
    frame = nofacet.render(model, camera, RESOLUTION, samples=1, buffers=("face", "uv"))
    other = nofacet.render(model, camera, RESOLUTION, method="bezier_clip_ray", samples=1, buffers=("face",))
    np.testing.assert_array_equal(frame.face, other.face)
    assert np.isfinite(frame.uv[frame.face >= 0]).all()


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_an_edge_through_pixel_centres_shows_the_nearer_face(side: float, projection: Projection) -> None:
    """Rays through the centres met both of its faces at one depth; that of the lower index was shown, hidden or not."""
    model = nofacet.load(cq.Workplane().polyline([(-1, 0), (0, -1), (1, 0), (0, 1)]).close().extrude(1))
    orthographic = projection == "orthographic"
    camera = nofacet.Camera(
        projection,
        (0.0, 10.0 * side, 0.5),
        (0.0, 0.0, 0.5),
        view_height=4.0 if orthographic else None,
        view_angle=None if orthographic else float(2 * np.degrees(np.arctan(0.2))),
    )
    frames = [
        nofacet.render(model, camera, (41, 40), method, samples=1, buffers=("face",))
        for method in ("bezier_clip_scanline", "bezier_clip_ray")
    ]
    assert len(np.unique(frames[0].face)) == 3  # two faces and background
    np.testing.assert_array_equal(frames[0].face, frames[1].face)


@pytest.mark.parametrize("resolution", [(8, 6), RESOLUTION])
@pytest.mark.parametrize("name", ["full.png", "full.exr", "full.npz"])
def test_a_picture_that_does_not_fit_on_the_disk_is_an_error(
    tmp_path: Path, name: str, resolution: tuple[int, int]
) -> None:
    """The writers of PNG and of small EXR files did not notice: the file ended where the disk was full."""
    model = nofacet.load(cq.Workplane().sphere(1))
    frame = nofacet.render(model, nofacet.Camera.fit(model, resolution=resolution), resolution)
    (tmp_path / name).symlink_to("/dev/full")
    with pytest.raises(OSError):
        frame.save(tmp_path / name)

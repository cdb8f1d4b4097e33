"""One small scene for every fault that was found and fixed: it must stay fixed."""

import itertools

import cadquery as cq
import numpy as np
import pytest

import nofacet
from nofacet.camera import Projection

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

"""Edge lines: drawn where an edge is seen, unbroken, and nowhere else."""

import itertools

import cadquery as cq
import numpy as np

import nofacet

RESOLUTION = (200, 150)
DIRECTION = (-0.35, 0.8, -0.5)


def darkening(model: nofacet.Model, camera: nofacet.Camera) -> np.ndarray:
    """How much darker (height, width) the lines make each pixel, over white."""
    plain, lined = (
        nofacet.render(model, camera, RESOLUTION, edges=edges).over((1, 1, 1)).color[..., :3].sum(axis=2)
        for edges in (False, True)
    )
    return np.asarray(plain - lined)


def pixels(camera: nofacet.Camera, points: np.ndarray) -> np.ndarray:
    """Columns and rows (n, 2) of world points (n, 3)."""
    screen = np.column_stack([points, np.ones(len(points))]) @ camera.pixel_from_world(RESOLUTION).T
    return np.asarray(np.floor(screen[:, :2] / screen[:, 3:]).astype(int))


def test_visible_edges_of_a_box_and_no_others() -> None:
    model = nofacet.load(cq.Workplane().box(2, 2, 2))
    camera = nofacet.Camera.fit(model, DIRECTION, resolution=RESOLUTION)
    dark = darkening(model, camera)
    hidden_corner = np.sign(DIRECTION)  # the corner farthest along the view
    along = np.linspace(-0.9, 0.9, 50)
    for axis, (p, q) in itertools.product(range(3), itertools.product((-1, 1), (-1, 1))):
        ends = np.insert([float(p), float(q)], axis, 0.0)
        points = np.repeat(ends[None], len(along), axis=0)
        points[:, axis] = along
        hidden = all(ends[other] == hidden_corner[other] for other in range(3) if other != axis)
        columns, rows = pixels(camera, points).T
        if hidden:
            assert np.mean(dark[rows, columns] > 0.01) < 0.15  # but where a visible edge passes before it
        else:
            assert dark[rows, columns].min() > 0.1


def test_rim_of_a_floor_in_a_recess_is_unbroken() -> None:
    """Where a floor meets a steep wall, whichever of them holds the pixel's centre, the line is drawn."""
    model = nofacet.load(cq.Workplane().box(4, 4, 2).faces(">Z").workplane().cboreHole(0.6, 2.4, 0.8))
    camera = nofacet.Camera.fit(model, (0.0, 1.0, -1.0), resolution=RESOLUTION)
    angle = np.linspace(0.3, np.pi - 0.3, 60)  # the far half of the floor's rim
    rim = np.column_stack([1.2 * np.cos(angle), 1.2 * np.sin(angle), np.full(60, 0.2)])
    columns, rows = pixels(camera, rim).T
    assert darkening(model, camera)[rows, columns].min() > 0.1

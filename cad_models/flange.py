"""A filleted pipe flange with a swept handle: planes, cylinders, tori, and B-spline blends at the handle."""

from __future__ import annotations

import cadquery as cq

from _shapes import FOLDER, write_step

DISC_RADIUS, DISC_HEIGHT = 60.0, 12.0
HUB_RADIUS, HUB_HEIGHT = 28.0, 48.0
BORE_RADIUS = 18.0
BOLTS, BOLT_CIRCLE = 8, 46.0
HANDLE_PATH = [(22.0, 0.0, 31.0), (44.0, 0.0, 33.0), (68.0, 0.0, 46.0), (96.0, 0.0, 54.0), (124.0, 0.0, 50.0)]


def circle_edges(body: cq.Workplane, radius: float, height: float) -> cq.Workplane:
    """The circles of this radius in the plane z = height, selected on `body`."""
    edges = [
        edge
        for edge in body.edges("%CIRCLE").vals()
        if abs(edge.radius() - radius) < 1e-6 and abs(edge.Center().z - height) < 1e-6
    ]
    return body.newObject(edges)


def flange_body() -> cq.Workplane:
    """Disc and hub, rounded."""
    body = cq.Workplane("XY").circle(DISC_RADIUS).extrude(DISC_HEIGHT)
    body = body.union(cq.Workplane("XY").circle(HUB_RADIUS).extrude(HUB_HEIGHT))
    body = circle_edges(body, HUB_RADIUS, DISC_HEIGHT).fillet(8.0)
    body = circle_edges(body, DISC_RADIUS, DISC_HEIGHT).fillet(3.0)
    body = circle_edges(body, DISC_RADIUS, 0.0).fillet(1.5)
    return circle_edges(body, HUB_RADIUS, HUB_HEIGHT).fillet(3.0)


def handle() -> cq.Workplane:
    """An elliptic section swept along a spline in the plane y = 0, its free end rounded."""
    path = cq.Workplane("XZ").spline([(x, z) for x, _, z in HANDLE_PATH], tangents=[(1, 0), (1, -0.3)])
    grip = cq.Workplane("YZ", origin=HANDLE_PATH[0]).ellipse(9.0, 6.5).sweep(path)
    return grip.faces(">X").edges().fillet(3.5)


def build() -> cq.Assembly:
    """The flange as one solid."""
    body = flange_body().union(handle())
    # The union splits the line where the handle leaves the hub into B-spline edges at about x = 27.
    joint = [edge for edge in body.edges("%BSPLINE").vals() if 24 < edge.Center().x < HUB_RADIUS]
    body = body.newObject(joint).fillet(4.0)
    body = body.cut(cq.Workplane("XY").circle(BORE_RADIUS).extrude(HUB_HEIGHT))
    body = circle_edges(body, BORE_RADIUS, HUB_HEIGHT).chamfer(2.0)
    body = circle_edges(body, BORE_RADIUS, 0.0).fillet(2.0)
    bolts = cq.Workplane("XY").polarArray(BOLT_CIRCLE, 360 / BOLTS / 2, 360, BOLTS)
    body = body.cut(bolts.circle(4.5).extrude(DISC_HEIGHT))
    body = body.cut(bolts.circle(7.0).extrude(3.0).translate((0, 0, DISC_HEIGHT - 3.0)))
    body = circle_edges(body, 7.0, DISC_HEIGHT).fillet(0.8)
    flange = cq.Assembly(body.val(), name="flange", color=cq.Color(0.72, 0.74, 0.78))
    for face in body.faces().vals():
        if face.BoundingBox().xmax > DISC_RADIUS + 1:
            flange.addSubshape(face, color=cq.Color(0.80, 0.16, 0.12))
    return flange


if __name__ == "__main__":
    write_step(build(), FOLDER / "flange.step")

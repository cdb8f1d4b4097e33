"""A car with a free-form body (the survey's figure 11 c): trimmed B-spline hulls, four instances of a wheel."""

from __future__ import annotations

import cadquery as cq

from _shapes import FOLDER, compound, hull, pill, rings_along_x, write_step

# Sections along x in mm, front first: x, height of the middle, half width, half height.
BODY = [
    (-208.0, 46.0, 40.0, 8.0),
    (-207.0, 46.0, 72.0, 18.0),
    (-190.0, 46.0, 84.0, 28.0),
    (-130.0, 49.0, 88.0, 36.0),
    (-50.0, 51.0, 91.0, 40.0),
    (50.0, 53.0, 92.0, 43.0),
    (130.0, 55.0, 91.0, 43.0),
    (185.0, 56.0, 84.0, 36.0),
    (206.0, 56.0, 72.0, 26.0),
    (207.0, 56.0, 40.0, 12.0),
]
CABIN = [
    (-122.0, 72.0, 30.0, 3.0),
    (-119.0, 73.0, 66.0, 12.0),
    (-80.0, 76.0, 78.0, 34.0),
    (-30.0, 77.0, 79.0, 55.0),
    (30.0, 77.0, 79.0, 60.0),
    (95.0, 76.0, 77.0, 54.0),
    (150.0, 76.0, 72.0, 32.0),
    (188.0, 74.0, 60.0, 12.0),
    (190.0, 74.0, 30.0, 3.0),
]
AXLES = (-128.0, 128.0)  # x
WHEEL_RADIUS, WHEEL_WIDTH, WHEEL_HEIGHT = 33.0, 24.0, 33.0
TRACK = 70.0  # y of the wheels' middle


def car_hull(sections: list[tuple[float, float, float, float]], square: float) -> cq.Solid:
    """The smooth body on the sections, closed in the middle of the first and the last."""
    first, last = ((x, 0.0, z) for x, z, *_ in (sections[0], sections[-1]))
    return hull(rings_along_x(sections, 16, square), first, last)


def side(points: list[tuple[float, float]]) -> cq.Workplane:
    """A cutter through the whole width, its outline in (x, z) with rounded corners."""
    cutter = cq.Workplane("XZ", origin=(0, 150, 0)).polyline(points).close().extrude(300)
    return cutter.edges("|Y").fillet(5.0)


def screen(points: list[tuple[float, float]], start: float, length: float) -> cq.Workplane:
    """A cutter along x from `start`, its outline in (y, z) with rounded corners."""
    cutter = cq.Workplane("YZ", origin=(start, 0, 0)).polyline(points).close().extrude(length)
    return cutter.edges("|X").fillet(6.0)


def bodywork() -> tuple[cq.Workplane, cq.Workplane]:
    """The painted body, and the pieces of its surface that the windows cut out of it."""
    body, cabin = (cq.Workplane(car_hull(sections, square)) for sections, square in ((BODY, 0.45), (CABIN, 0.25)))
    whole = body.union(cabin)
    for x in AXLES:
        for y in (-1, 1):
            start, outward = cq.Vector(x, y * 50, WHEEL_HEIGHT), cq.Vector(0, y, 0)
            whole = whole.cut(cq.Workplane(cq.Solid.makeCylinder(WHEEL_RADIUS + 5, 60, start, outward)))
    grille = cq.Workplane("YZ", origin=(-220, 0, 0)).pushPoints([(0, 36), (0, 44), (0, 52)]).slot2D(70, 4.5)
    whole = whole.cut(grille.extrude(24))
    windows = side([(-54, 90), (10, 90), (10, 116), (-22, 116)])
    windows = windows.union(side([(18, 90), (104, 90), (78, 114), (18, 116)]))
    windows = windows.union(screen([(-58, 88), (58, 88), (44, 117), (-44, 117)], -130, 86))
    windows = windows.union(screen([(-56, 90), (56, 90), (44, 113), (-44, 113)], 114, 86))
    return whole.cut(windows), whole.intersect(windows).faces("%BSPLINE")


def wheel() -> tuple[cq.Workplane, cq.Workplane]:
    """Tyre and rim about the y axis, outside towards -y."""
    half = WHEEL_WIDTH / 2
    tyre = (
        cq.Workplane("XZ", origin=(0, half, 0)).circle(WHEEL_RADIUS).circle(21).extrude(WHEEL_WIDTH).edges().fillet(5)
    )
    rim = cq.Workplane("XZ", origin=(0, 2, 0)).circle(21).extrude(half - 5)
    rim = rim.faces("<Y").workplane().polarArray(13, 0, 360, 5).circle(4.5).cutThruAll()
    rim = rim.faces("<Y").workplane().circle(5).extrude(3).faces("<Y").edges().fillet(2)
    return tyre, rim


def build() -> cq.Assembly:
    """Body, glass, lights and wheels."""
    paint, glass = bodywork()
    car = cq.Assembly(name="car")
    car.add(paint.val(), name="body", color=cq.Color(0.10, 0.25, 0.60))
    car.add(compound(glass.vals()), name="glass", color=cq.Color(0.10, 0.13, 0.16))
    lamp, tail = pill(24, 36, 16), pill(10, 34, 14)
    tyre, rim = (part.val() for part in wheel())
    for name, y, turn in (("left", -1, 0), ("right", 1, 180)):
        car.add(lamp, name=f"lamp_{name}", loc=cq.Location((-193, 52 * y, 58)), color=cq.Color(0.95, 0.93, 0.80))
        car.add(tail, name=f"tail_{name}", loc=cq.Location((203, 50 * y, 68)), color=cq.Color(0.70, 0.05, 0.05))
        for axle, x in zip(("front", "rear"), AXLES, strict=True):
            place = cq.Location(cq.Vector(x, TRACK * y, WHEEL_HEIGHT), cq.Vector(0, 0, 1), turn)
            car.add(tyre, name=f"tyre_{axle}_{name}", loc=place, color=cq.Color(0.06, 0.06, 0.06))
            car.add(rim, name=f"rim_{axle}_{name}", loc=place, color=cq.Color(0.75, 0.76, 0.78))
    return car


if __name__ == "__main__":
    write_step(build(), FOLDER / "car.step")

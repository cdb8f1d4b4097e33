"""A handheld vacuum cleaner: a trimmed free-form body (the survey's figure 11 a).

One smooth hull, cut by a grip opening, a slanted mouth, a dust-box line and vents: nearly every face is a piece of a
B-spline surface inside a trim loop.
"""

from __future__ import annotations

import cadquery as cq

from _shapes import FOLDER, hull, pill, rings_along_x, write_step

# Sections along x in mm: x, height of the middle, half width, half height.
SECTIONS = [
    (-118.0, 18.0, 14.0, 12.0),
    (-114.0, 19.0, 30.0, 30.0),
    (-92.0, 22.0, 40.0, 46.0),
    (-50.0, 26.0, 45.0, 56.0),
    (0.0, 22.0, 47.0, 52.0),
    (45.0, 8.0, 48.0, 36.0),
    (90.0, -4.0, 46.0, 24.0),
    (125.0, -10.0, 42.0, 17.0),
    (150.0, -13.0, 36.0, 12.0),
    (152.0, -13.0, 14.0, 5.0),
]


def side() -> cq.Workplane:
    """The plane of (x, z) in which the cutters through the whole width start."""
    return cq.Workplane("XZ", origin=(0, 100, 0))


def build() -> cq.Assembly:
    """Body, dust box and switch as solids of their own colours."""
    whole = cq.Workplane("XY").newObject(
        [hull(rings_along_x(SECTIONS, 16, 0.35), (-118.0, 0, 18.0), (152.0, 0, -13.0))]
    )
    grip = side().spline(
        [(-90, 36), (-66, 55), (-32, 58), (-4, 48), (4, 30), (-16, 18), (-48, 12), (-80, 18)], periodic=True
    )
    grip = grip.close().extrude(200)
    mouth = side().polyline([(126, 40), (146, -60), (220, -60), (220, 40)]).close().extrude(200)
    box = side().moveTo(40, 120).spline([(30, 60), (12, 10), (24, -30), (18, -80)], includeCurrent=True)
    box = box.lineTo(220, -80).lineTo(220, 120).close().extrude(200)
    vents = side().pushPoints([(-96 + 11 * i, 4 - 1.6 * i) for i in range(5)]).slot2D(22, 4.5, 75).extrude(200)
    duct = cq.Workplane("YZ", origin=(85, 0, -11)).slot2D(62, 13).extrude(100)

    whole = whole.cut(grip).cut(mouth).cut(duct)
    front, back = whole.intersect(box), whole.cut(box).cut(vents)

    cleaner = cq.Assembly(name="vacuum_cleaner")
    cleaner.add(back.val(), name="body", color=cq.Color(0.72, 0.08, 0.10))
    cleaner.add(front.val(), name="dust_box", color=cq.Color(0.28, 0.30, 0.34))
    place = cq.Location(cq.Vector(-20, 0, 72), cq.Vector(0, 1, 0), 8)
    cleaner.add(pill(20, 11, 8), name="switch", loc=place, color=cq.Color(0.85, 0.85, 0.82))
    return cleaner


if __name__ == "__main__":
    write_step(build(), FOLDER / "vacuum_cleaner.step")

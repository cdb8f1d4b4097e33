"""A rounded plate with 1,000 holes: two plane faces with 1,001 loops each, and one cylinder a hole."""

from __future__ import annotations

import cadquery as cq

from _shapes import FOLDER, write_step

COLUMNS, ROWS = 40, 25
PITCH, THICKNESS = 6.0, 4.0


def hole_radius(column: int, row: int) -> float:
    """Radius in mm: larger towards the middle of the plate."""
    across, along = 2 * column / (COLUMNS - 1) - 1, 2 * row / (ROWS - 1) - 1
    return round(2.6 - 1.5 * (across**2 + along**2) / 2, 3)


def build() -> cq.Assembly:
    """The plate as one solid of 1,010 faces, extruded from one face that has all the holes."""
    outer = cq.Workplane("XY").rect((COLUMNS + 1) * PITCH, (ROWS + 1) * PITCH).extrude(1).edges("|Z").fillet(8.0)
    outline = outer.faces("<Z").wires().val()
    holes = [
        cq.Wire.makeCircle(
            hole_radius(column, row),
            cq.Vector((column - (COLUMNS - 1) / 2) * PITCH, (row - (ROWS - 1) / 2) * PITCH, 0),
            cq.Vector(0, 0, 1),
        )
        for column in range(COLUMNS)
        for row in range(ROWS)
    ]
    plate = cq.Solid.extrudeLinear(cq.Face.makeFromWires(outline, holes), cq.Vector(0, 0, THICKNESS))
    return cq.Assembly(plate, name="perforated_plate", color=cq.Color(0.70, 0.72, 0.75))


if __name__ == "__main__":
    write_step(build(), FOLDER / "perforated_plate.step", pcurves=False)

"""The parts of a patch: no more of them are subdivided than may be seen."""

import cadquery as cq

import nofacet


def test_parts_of_a_patch_that_stay_hidden_are_not_subdivided() -> None:
    ball, wall = cq.Workplane().sphere(2), cq.Workplane(origin=(0.4, 0, 3)).box(3.9, 5, 0.1)
    camera = nofacet.Camera("orthographic", (0, 0, 10), (0, 0, 0), (0, 1, 0), view_height=5.0)

    def pieces(*shapes: cq.Workplane) -> int:
        model = nofacet.combine([nofacet.load(shape) for shape in shapes])
        return int(nofacet.render(model, camera, (1200, 1000), threads=1, buffers=("face",)).stats["pieces"])

    # A ninth of the ball's width is not behind the wall.
    assert pieces(ball, wall) - pieces(wall) < 0.25 * pieces(ball)

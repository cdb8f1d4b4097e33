"""Draws the pictures in docs/images again: python docs/render_images.py"""

from __future__ import annotations

from pathlib import Path

import nofacet

ROOT = Path(__file__).resolve().parents[1]
WHITE = (1.0, 1.0, 1.0)

# name: (width, height, direction from the eye into the scene)
GALLERY = {
    "flange": (360, 270, (-1, 1, -0.8)),
    "teapot": (360, 270, (0.6, 1, -0.4)),
    "vacuum_cleaner": (360, 270, (-1, 1, -0.5)),
    "balloon": (360, 270, (-1, 1, 0.1)),
    "car": (360, 270, (1, 1, -0.5)),
    "bottle": (360, 270, (-1, 1, -0.4)),
    "crossing": (360, 270, (-1, 1, -0.5)),
    "perforated_plate": (360, 270, (-1, 1, -1)),
    "chain": (360, 270, (-1, 1, -0.6)),
    "teapots": (360, 270, (-1, 1, -0.5)),
}


def main() -> None:
    draw_section("section_flange")
    for name, (width, height, direction) in GALLERY.items():
        model = nofacet.load(ROOT / "cad_models" / f"{name}.step")
        draw(model, nofacet.Camera.fit(model, direction, resolution=(width, height)), (width, height), name)
        if name == "flange":
            size = 1200, 560
            draw(model, nofacet.Camera.fit(model, (-1, 1, -0.8), resolution=size), size, "flange_large")
            draw_mirrored(model, "flange_mirrored")


def draw(model: nofacet.Model, camera: nofacet.Camera, resolution: tuple[int, int], name: str) -> None:
    frame = nofacet.render(model, camera, resolution, samples=8, edges=True)
    frame.over(WHITE).save(ROOT / "docs" / "images" / f"{name}.png")


def draw_section(name: str) -> None:
    size = 960, 480
    model = nofacet.load(ROOT / "cad_models" / "flange.step")
    camera = nofacet.Camera.fit(model, (-0.6, 1, -0.7), resolution=size)
    frame = nofacet.render(model, camera, size, samples=16, sections=[nofacet.Section((0, 0, 0), (0, -1, 0))])
    frame.over(WHITE).save(ROOT / "docs" / "images" / f"{name}.png")


def draw_mirrored(model: nofacet.Model, name: str) -> None:
    size = 640, 360
    camera = nofacet.Camera.fit(model, (1, 0.8, -0.7), "perspective", size)
    frame = nofacet.render(model, camera, size, "bezier_clip_ray", samples=4, shadows=True, reflectance=0.3)
    frame.over(WHITE).save(ROOT / "docs" / "images" / f"{name}.png")


if __name__ == "__main__":
    main()

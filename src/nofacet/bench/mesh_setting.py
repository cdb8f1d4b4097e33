"""The meshes that are measured: deflections in pixels, and what CAD viewers use by default."""

from __future__ import annotations

from ..mesh_setting import MESH_SETTINGS, MeshSetting

PIXELS = (1.0, 0.3, 0.1, 0.03)
DELABELLA_PIXELS = 0.1


def mesh_settings(pixel: float, sides: tuple[float, float, float]) -> list[MeshSetting]:
    """All settings for a model of the bounding box's sides (model units) seen with pixels of that size."""
    settings = [MeshSetting(f"{size:g} px", size * pixel) for size in PIXELS]
    name = f"{DELABELLA_PIXELS:g} px, Delabella"
    settings.append(MeshSetting(name, DELABELLA_PIXELS * pixel, delabella=True))
    return settings + [setting.for_box(sides) for setting in MESH_SETTINGS.values()]

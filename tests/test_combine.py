"""Several models as one: same pictures, right numbers everywhere, names in the tree."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import nofacet
from conftest import SHARED_MODELS, model_of, rectangle_group, sphere_group
from nofacet import model_file
from nofacet.model import Model, Node
from scenes import ALL_BUFFERS, look_down, rectangle

NOTHING = np.empty(0, np.int32)


def disc(x: float) -> Model:
    """A trimmed rectangle: an octagon around (x, 0)."""
    angle = np.arange(8) * np.pi / 4
    corners = [[[x + u, v, 0] for v in (-1.0, 1.0)] for u in (-1.0, 1.0)]
    octagon = np.column_stack([x + np.cos(angle), np.sin(angle)])
    return model_of([rectangle_group(np.array(corners), (x - 1, x + 1, -1, 1))], {0: [octagon]})


def test_the_picture_is_that_of_all() -> None:
    """Faces, parameters and depth in each half are those of the model there."""
    wall = rectangle_group(np.array([[[1.5, -1, -3], [1.5, 1, -3]], [[4, -1, -3], [4, 1, -3]]]))
    wall = replace(wall, definition=np.ones(1, np.int32))
    left, right = disc(-2.0), model_of([sphere_group(1.0, (2, 0, 0)), wall])
    both = nofacet.combine([left, right, disc(0.0)])
    camera = look_down(6.0)
    frames = [nofacet.render(model, camera, (120, 90), buffers=ALL_BUFFERS) for model in (both, left, right, disc(0.0))]
    first = [0, left.face_count, left.face_count + right.face_count]
    seen = np.zeros((90, 120), bool)
    for one, offset in zip(frames[1:], first, strict=True):
        alone = (one.face >= 0) & (one.depth <= frames[0].depth + 1e-12)
        assert (frames[0].face[alone] == one.face[alone] + offset).all()
        np.testing.assert_array_equal(frames[0].uv[alone], one.uv[alone])
        np.testing.assert_array_equal(frames[0].depth[alone], one.depth[alone])
        seen |= alone
    assert (seen == (frames[0].face >= 0)).all() and seen.sum() > 1000


def test_files_together() -> None:
    names = ["occt/linkrods.step", "cax/as1-oc-214.stp"]
    if not (SHARED_MODELS / names[0]).exists():
        pytest.skip("the shared test models are not beside the repository")
    models = [nofacet.load(SHARED_MODELS / name, measure=True) for name in names]
    both = nofacet.combine([*models, models[0]], ["rods", None, None])
    faces = np.cumsum([0, models[0].face_count, models[1].face_count])
    assert both.face_count == faces[-1] + models[0].face_count
    assert both.patch_count == 2 * models[0].patch_count + models[1].patch_count
    part = slice(faces[1], faces[2])
    kinds = np.array(both.surface_type)[both.face_definition[part]]
    assert (kinds == np.array(models[1].surface_type)[models[1].face_definition]).all()
    np.testing.assert_array_equal(
        both.placements[both.face_placement[part]], models[1].placements[models[1].face_placement]
    )
    np.testing.assert_array_equal(
        both.conversion_error[both.face_definition[part]], models[1].conversion_error[models[1].face_definition]
    )
    uses = (both.edge_use_face >= faces[1]) & (both.edge_use_face < faces[2])
    np.testing.assert_array_equal(both.edge_use_face[uses] - faces[1], models[1].edge_use_face)
    np.testing.assert_array_equal(both.edge_use_deviation[uses], models[1].edge_use_deviation)
    assert both.tree[0].name == "rods" and [node.parent for node in both.tree].count(-1) == 3
    held = np.concatenate([node.faces for node in both.tree])
    assert sorted(held.tolist()) == list(range(both.face_count))
    for k, node in enumerate(both.tree):
        assert node.parent < k and node.faces.dtype == np.int32
    for field in fields(Model):
        mine, theirs = getattr(both, field.name), getattr(models[0], field.name)
        if isinstance(mine, np.ndarray):
            assert mine.dtype == theirs.dtype and mine.shape[1:] == theirs.shape[1:], field.name
    rng = np.random.default_rng(3)
    for k, (model, first) in enumerate(zip(models, faces, strict=False)):
        face = rng.integers(model.face_count, size=50)
        uv = np.stack([model.groups[0].domain[0, [0, 2]]] * 50)
        ours, own = nofacet.evaluate(both, face + first, uv), nofacet.evaluate(model, face, uv)
        np.testing.assert_array_equal(ours.position, own.position, err_msg=str(k))


def test_edges_of_two_models_stay_apart() -> None:
    both = nofacet.combine([disc(0.0), disc(5.0)])
    used = [set(both.segment_edge[:8]), set(both.segment_edge[8:])]
    assert not used[0] & used[1]
    welded = replace(disc(0.0), segment_edge=np.full(8, -1, np.int32))
    assert (nofacet.combine([welded, disc(0.0)]).segment_edge[:8] == -1).all()


def test_names_and_roots() -> None:
    plain = rectangle(0, 0, 1, 1)
    rooted = replace(plain, tree=[Node("root", -1, NOTHING), Node("leaf", 0, np.array([0], np.int32))])
    forest = replace(
        plain, tree=[Node("one", -1, np.array([0], np.int32)), Node("two", -1, NOTHING), Node("", 1, NOTHING)]
    )
    tree = nofacet.combine([plain, rooted, forest, rooted], ["a", None, None, "d"]).tree
    assert [(node.name, node.parent, node.faces.tolist()) for node in tree] == [
        ("a", -1, [0]),
        ("root", -1, []),
        ("leaf", 1, [1]),
        ("made by hand", -1, []),
        ("one", 3, [2]),
        ("two", 3, []),
        ("", 5, []),
        ("d", -1, []),
        ("leaf", 7, [3]),
    ]
    assert rooted.tree[0].name == "root"


def test_odd_names_and_duplicates_survive_a_file(tmp_path: Path) -> None:
    odd = ["", "a\nb", "\u00e9\U0001f600/\\\x00", "a\nb"]
    both = nofacet.combine([rectangle(0, 0, 1, 1)] * 4, odd)
    assert [node.name for node in both.tree] == odd
    path = tmp_path / "model"
    with path.open("wb") as file:
        model_file.write(both, file)
    assert [node.name for node in model_file.read(path).tree] == odd


def test_combinations_that_make_no_sense(sphere: Model) -> None:
    with pytest.raises(ValueError, match="no model to combine"):
        nofacet.combine([])
    with pytest.raises(ValueError, match="2 names for 1 models"):
        nofacet.combine([sphere], ["a", "b"])


def test_models_without_patches_are_kept(sphere: Model) -> None:
    bare = replace(sphere, groups=[], warnings=["face 0 is not drawn: it is a test"])
    both = nofacet.combine([bare, sphere], ["bare", None])
    assert both.face_count == 2 and both.warnings == ["bare: face 0 is not drawn: it is a test"]
    frame = nofacet.render(both, nofacet.Camera.fit(both), (20, 20))
    assert set(np.unique(frame.face)) == {-1, 1}

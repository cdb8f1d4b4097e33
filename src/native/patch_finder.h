// The patch of a face that holds given parameters.
#pragma once
#include <vector>

#include "scene.h"

namespace nofacet {

// Remembers what it has sorted and found, so that many queries, mostly next to each other, cost little.
class PatchFinder {
 public:
  explicit PatchFinder(const Scene& scene) : scene_(scene), rows_(scene.model.definition_count) {}

  // The patch of a definition whose domain holds (u, v), both finite; of two that share a border, the one behind it.
  // Outside all domains the nearest patch. Null for a definition without patches.
  const Scene::PatchRef* find(int32_t definition, double u, double v);

 private:
  // A definition's patches in rows of equal v0, by u0 in a row. Surfaces are cut into grids, so the row and the place
  // in it are found by bisection; whatever is not a grid is searched through.
  struct Rows {
    std::vector<const Scene::PatchRef*> patches;
    std::vector<std::size_t> start;
    const Scene::PatchRef* recent = nullptr;
    double u0 = 0.0, u1 = 0.0, v0 = 0.0, v1 = 0.0;  // all domains together
  };

  void sort(int32_t definition);

  const Scene& scene_;
  std::vector<Rows> rows_;
};

}  // namespace nofacet

#include "patch_finder.h"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace nofacet {
namespace {

// How far (u, v) is outside a patch's domain.
double outside(const Scene::PatchRef& patch, double u, double v) {
  return std::max({patch.u.u0 - u, u - patch.u.u1, patch.v.u0 - v, v - patch.v.u1, 0.0});
}

}  // namespace

void PatchFinder::sort(int32_t definition) {
  Rows& rows = rows_[definition];
  const auto first = scene_.patches.begin() + scene_.patch_offsets[definition];
  const auto last = scene_.patches.begin() + scene_.patch_offsets[definition + 1];
  for (auto patch = first; patch != last; ++patch) rows.patches.push_back(&*patch);
  std::sort(rows.patches.begin(), rows.patches.end(), [](const Scene::PatchRef* p, const Scene::PatchRef* q) {
    return std::tie(p->v.u0, p->u.u0) < std::tie(q->v.u0, q->u.u0);
  });
  for (std::size_t k = 0; k < rows.patches.size(); ++k) {
    if (k == 0 || rows.patches[k]->v.u0 != rows.patches[k - 1]->v.u0) rows.start.push_back(k);
  }
  rows.start.push_back(rows.patches.size());
  rows.recent = rows.patches.front();
  rows.u0 = rows.recent->u.u0, rows.u1 = rows.recent->u.u1, rows.v0 = rows.recent->v.u0, rows.v1 = rows.recent->v.u1;
  for (const Scene::PatchRef* patch : rows.patches) {
    rows.u0 = std::min(rows.u0, patch->u.u0), rows.u1 = std::max(rows.u1, patch->u.u1);
    rows.v0 = std::min(rows.v0, patch->v.u0), rows.v1 = std::max(rows.v1, patch->v.u1);
  }
}

const Scene::PatchRef* PatchFinder::find(int32_t definition, double u, double v) {
  if (scene_.patch_offsets[definition] == scene_.patch_offsets[definition + 1]) return nullptr;
  Rows& rows = rows_[definition];
  if (rows.patches.empty()) sort(definition);
  const Scene::PatchRef* recent = rows.recent;
  if (u >= recent->u.u0 && u < recent->u.u1 && v >= recent->v.u0 && v < recent->v.u1) return recent;

  u = std::clamp(u, rows.u0, rows.u1), v = std::clamp(v, rows.v0, rows.v1);
  const auto below = [&](std::size_t k) { return rows.patches[k]->v.u0 <= v; };
  const auto row = std::prev(std::partition_point(rows.start.begin() + 1, std::prev(rows.start.end()), below));
  const auto begin = rows.patches.begin() + *row, end = rows.patches.begin() + *std::next(row);
  rows.recent =
      *std::prev(std::partition_point(begin + 1, end, [&](const Scene::PatchRef* p) { return p->u.u0 <= u; }));
  double least = outside(*rows.recent, u, v);
  for (std::size_t k = 0; least > 0.0 && k < rows.patches.size(); ++k) {
    const double distance = outside(*rows.patches[k], u, v);
    if (distance < least) least = distance, rows.recent = rows.patches[k];
  }
  return rows.recent;
}

}  // namespace nofacet

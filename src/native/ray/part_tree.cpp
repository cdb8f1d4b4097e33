#include "ray/part_tree.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

constexpr int kLeafParts = 2;
// A part is flat when its control points are this near to its chords, in parts of its size.
constexpr double kFlat = 0.05;

double squared(const double* v) { return Camera::dot(v, v); }

// Eye-space control points (right, up, forward, weight) of a patch of a placed face.
void to_eye_space(const Scene& scene, const Camera& camera, int32_t face, const Scene::PatchRef& patch, double* out) {
  const PatchGroup& group = scene.model.groups[patch.group];
  const double* placement = scene.model.placements + 16 * std::size_t(scene.model.face_placement[face]);
  const std::size_t size = 4 * std::size_t(group.degree_u + 1) * (group.degree_v + 1);
  const double* source = group.control_points + size * patch.index;
  const double* axes[3] = {camera.right, camera.up, camera.forward};
  for (std::size_t k = 0; k < size; k += 4) {
    const double w = source[k + 3];
    double from_eye[3];
    for (int r = 0; r < 3; ++r) {
      from_eye[r] = Camera::dot(placement + 4 * r, source + k) + (placement[4 * r + 3] - camera.eye[r]) * w;
    }
    for (int c = 0; c < 3; ++c) out[k + c] = Camera::dot(axes[c], from_eye);
    out[k + 3] = w;
  }
}

// How far lines of control points along one parameter are from their chords, squared, and how long the chords are.
struct Bend {
  double deviation = 0.0, length = 0.0;

  Bend(const Net& net, bool along_a) {
    const int lines = along_a ? net.m : net.n, steps = along_a ? net.n : net.m;
    for (int line = 0; line <= lines; ++line) {
      const double* p = along_a ? net.at(0, line) : net.at(line, 0);
      const double* q = along_a ? net.at(steps, line) : net.at(line, steps);
      double chord[3];
      for (int c = 0; c < 3; ++c) chord[c] = q[c] / q[3] - p[c] / p[3];
      length = std::max(length, squared(chord));
      for (int k = 1; k < steps; ++k) {
        const double* r = along_a ? net.at(k, line) : net.at(line, k);
        double off[3];
        for (int c = 0; c < 3; ++c) off[c] = r[c] / r[3] - p[c] / p[3];
        const double share = squared(chord) > 0 ? Camera::dot(off, chord) / squared(chord) : 0.0;
        for (int c = 0; c < 3; ++c) off[c] -= share * chord[c];
        deviation = std::max(deviation, squared(off));
      }
    }
  }
};

}  // namespace

void PartTree::Box::include(const double* point) {
  for (int c = 0; c < 3; ++c) lo[c] = std::min(lo[c], point[c]), hi[c] = std::max(hi[c], point[c]);
}

void PartTree::Box::include(const Box& box) {
  include(box.lo);
  include(box.hi);
}

constexpr PartTree::Box kEmptyBox{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

PartTree::PartTree(const Scene& scene, const Camera& camera) {
  const Model& model = scene.model;
  for (std::size_t face = 0; face < model.face_count; ++face) {
    const int32_t d = model.face_definition[face];
    for (std::size_t k = scene.patch_offsets[d]; k < scene.patch_offsets[d + 1]; ++k) {
      const Scene::PatchRef& ref = scene.patches[k];
      const PatchGroup& group = model.groups[ref.group];
      RayPatch patch{{group.degree_u, group.degree_v, nullptr},
                     &ref,
                     scene.regions[d].get(),
                     int32_t(face),
                     false,
                     {},
                     {},
                     0.0,
                     0.0};
      double* points = nets_.take(patch.net.size());
      to_eye_space(scene, camera, int32_t(face), ref, points);
      patch.net.points = points;
      patches_.push_back(patch);
      add_parts(patch.net, {0.0, 1.0, 0.0, 1.0}, int32_t(patches_.size()) - 1, 0);
    }
  }
  if (parts_.empty()) return;
  build(0, int32_t(parts_.size()));
  for (int c = 0; c < 3; ++c) {
    const double lo = nodes_[0].bounds.lo[c], hi = nodes_[0].bounds.hi[c];
    magnitude_ = std::max({magnitude_, std::fabs(lo), std::fabs(hi)});
    extent_ = std::max(extent_, hi - lo);
  }
}

void PartTree::add_parts(const Net& net, const PatchBox& box, int32_t patch, int halvings) {
  const Bend a(net, true), b(net, false);
  const bool flat = std::max(a.deviation, b.deviation) <= kFlat * kFlat * std::max(a.length, b.length);
  if (flat || (2 << halvings) > kMaxParts) {
    Part part{net, box, patch, kEmptyBox};
    for (std::size_t k = 0; k < net.size(); k += 4) {
      double point[3];
      for (int c = 0; c < 3; ++c) point[c] = net.points[k + c] / net.points[k + 3];
      part.bounds.include(point);
    }
    parts_.push_back(part);
    return;
  }
  double *left = nets_.take(net.size()), *right = nets_.take(net.size());
  PatchBox first = box, second = box;
  if (a.deviation >= b.deviation) {
    split_net(net.points, net.n, net.m, 4, true, 0.5, left, right);
    first.s1 = second.s0 = 0.5 * (box.s0 + box.s1);
  } else {
    split_net(net.points, net.n, net.m, 4, false, 0.5, left, right);
    first.t1 = second.t0 = 0.5 * (box.t0 + box.t1);
  }
  add_parts({net.n, net.m, left}, first, patch, halvings + 1);
  add_parts({net.n, net.m, right}, second, patch, halvings + 1);
}

// Appends the tree over parts_[first .. first + count), halved in the middle of its longest side.
void PartTree::build(int32_t first, int32_t count) {
  const auto node = nodes_.size();
  nodes_.push_back({kEmptyBox, first, count});
  Box middles = kEmptyBox;
  const auto middle = [](const Part& part, int c) { return 0.5 * (part.bounds.lo[c] + part.bounds.hi[c]); };
  for (int32_t k = first; k < first + count; ++k) {
    const double point[3] = {middle(parts_[k], 0), middle(parts_[k], 1), middle(parts_[k], 2)};
    nodes_[node].bounds.include(parts_[k].bounds);
    middles.include(point);
  }
  if (count <= kLeafParts) return;
  int axis = 0;
  for (int c = 1; c < 3; ++c) {
    if (middles.hi[c] - middles.lo[c] > middles.hi[axis] - middles.lo[axis]) axis = c;
  }
  const auto begin = parts_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](const Part& p, const Part& q) { return middle(p, axis) < middle(q, axis); });
  nodes_[node].count = 0;
  build(first, count / 2);
  nodes_[node].first = int32_t(nodes_.size());
  build(first + count / 2, count - count / 2);
}

}  // namespace nofacet

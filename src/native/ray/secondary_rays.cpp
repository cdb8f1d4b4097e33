#include "ray/secondary_rays.h"

#include <algorithm>
#include <cmath>

#include "patch_normal.h"

namespace nofacet {
namespace {

// The scene's extent in units of the screen that a ray's planes measure in: as many as a large picture has pixels.
constexpr double kScreen = 1000.0;

// Seen along the ray: orthographic, the ray in the middle.
Camera ray_camera(double scale) {
  Camera camera{};
  camera.scale = scale;
  return camera;
}

}  // namespace

// Keeps the nearest hit, or only whether there is an opaque one.
class SecondaryRays::Sink final : public HitSink {
 public:
  Sink(const Scene& scene, double tie, bool any_opaque) : scene_(scene), tie_(tie), any_opaque_(any_opaque) {
    std::fill_n(farthest_, SolvedRays::kPadding + 1, -INFINITY);
    farthest_[0] = INFINITY;
  }

  bool hidden(double nearest) const override { return nearest > farthest_[0]; }
  const double* farthest() const override { return farthest_; }
  void add(const RayPatch& patch, const Region* region, const SolvedRays& solved) override {
    const Scene::PatchRef& ref = *patch.patch;
    for (int k = 0; k < solved.count; ++k) {
      const double distance = solved.depth[k],
                   normal[3] = {solved.normal[0][k], solved.normal[1][k], solved.normal[2][k]};
      const bool sound = Camera::dot(normal, normal) > 0.0;
      const double cosine = sound ? normal[2] : 1.0;
      if (!(distance * std::fabs(cosine) > tie_ && distance < farthest_[0])) continue;
      if (region && !region->contains(ref.u.face_from_patch(solved.s[k]), ref.v.face_from_patch(solved.t[k]))) continue;
      hit = {source, distance, solved.s[k], solved.t[k], {normal[0], normal[1], normal[2]}};
      farthest_[0] = any_opaque_ ? -INFINITY : distance;
    }
  }
  // Whether a patch need not be looked at.
  bool passes(const RayPatch& patch) const {
    return any_opaque_ && scene_.model.face_color[4 * std::size_t(patch.face) + 3] < 1.0f;
  }

  RayHit hit{nullptr, INFINITY, 0, 0, {0, 0, 0}};
  const RayPatch* source = nullptr;  // the patch being traced, as the tree holds it

 private:
  const Scene& scene_;
  double tie_;
  bool any_opaque_;
  double farthest_[SolvedRays::kPadding + 1];
};

SecondaryRays::RayFrame::RayFrame(const double o[3], const double direction[3]) {
  std::copy_n(o, 3, origin);
  std::copy_n(direction, 3, axes[2]);
  int least = 0;
  for (int c = 1; c < 3; ++c) {
    if (std::fabs(direction[c]) < std::fabs(direction[least])) least = c;
  }
  double size = 0.0;
  for (int c = 0; c < 3; ++c) axes[0][c] = (c == least) - direction[least] * direction[c];
  size = std::sqrt(Camera::dot(axes[0], axes[0]));
  for (int c = 0; c < 3; ++c) axes[0][c] /= size;
  for (int c = 0; c < 3; ++c) {
    axes[1][c] = direction[(c + 1) % 3] * axes[0][(c + 2) % 3] - direction[(c + 2) % 3] * axes[0][(c + 1) % 3];
  }
}

bool SecondaryRays::blocked(const double origin[3], const double direction[3]) {
  Sink sink(scene_, tie_, true);
  trace(RayFrame(origin, direction), sink);
  return sink.hit.patch;
}

RayHit SecondaryRays::nearest(const double origin[3], const double direction[3]) {
  Sink sink(scene_, tie_, false);
  const RayFrame frame(origin, direction);
  trace(frame, sink);
  // From the ray's frame to eye space.
  double normal[3];
  std::copy_n(sink.hit.normal, 3, normal);
  for (int c = 0; c < 3; ++c) {
    sink.hit.normal[c] = normal[0] * frame.axes[0][c] + normal[1] * frame.axes[1][c] + normal[2] * frame.axes[2][c];
  }
  return sink.hit;
}

void SecondaryRays::trace(const RayFrame& frame, Sink& sink) {
  if (tree_.nodes().empty()) return;
  const double* direction = frame.axes[2];
  const double room = 1e-12 * (tree_.magnitude() + std::sqrt(Camera::dot(frame.origin, frame.origin)));
  // Distance at which the ray enters a box; infinite if it misses it.
  const auto entry = [&](const PartTree::Box& box) {
    double near = 0.0, far = INFINITY;
    for (int c = 0; c < 3; ++c) {
      const double lo = box.lo[c] - room - frame.origin[c], hi = box.hi[c] + room - frame.origin[c];
      if (direction[c] == 0.0) {
        if (lo > 0.0 || hi < 0.0) return double(INFINITY);
        continue;
      }
      const double r = 1.0 / direction[c], p = std::min(lo * r, hi * r), q = std::max(lo * r, hi * r);
      near = std::max(near, p), far = std::min(far, q);
    }
    // A box much narrower than it is far away: the distances' own rounding.
    return near <= far * (1.0 + 1e-12) + room ? near : double(INFINITY);
  };
  const Camera camera = ray_camera(kScreen / tree_.extent());
  clipper_.begin({0.0, 0.0, 1.0, 1, 1, 0.0, 0.0}, &camera);
  stack_.assign(1, 0);
  while (!stack_.empty()) {
    const int32_t index = stack_.back();
    stack_.pop_back();
    const PartTree::Node& node = tree_.nodes()[index];
    const double at = entry(node.bounds);
    if (at == INFINITY || sink.hidden(at - room)) continue;
    for (int32_t k = node.first; k < node.first + node.count; ++k) trace_part(frame, tree_.parts()[k], sink);
    if (node.count) continue;
    const bool second_first = entry(tree_.nodes()[node.first].bounds) < entry(tree_.nodes()[index + 1].bounds);
    stack_.push_back(second_first ? index + 1 : node.first);
    stack_.push_back(second_first ? node.first : index + 1);
  }
}

// The net seen along the ray: distances from its two planes, distance along it. False if it lies beside the ray or
// behind its origin.
bool SecondaryRays::project(const RayFrame& frame, const Net& net, std::vector<double>& out) const {
  const double scale = kScreen / tree_.extent();
  if (out.size() < net.size()) out.resize(net.size());
  bool left = true, right = true, above = true, below = true, behind = true;
  for (std::size_t k = 0; k < net.size(); k += 4) {
    const double *p = net.points + k, w = p[3];
    const double from[3] = {p[0] - frame.origin[0] * w, p[1] - frame.origin[1] * w, p[2] - frame.origin[2] * w};
    double* q = out.data() + k;
    q[kX] = scale * Camera::dot(frame.axes[0], from);
    q[kY] = -scale * Camera::dot(frame.axes[1], from);
    q[kW] = w;
    q[kZ] = Camera::dot(frame.axes[2], from);
    const double room = 1e-12 * scale * (tree_.magnitude() + tree_.extent()) * w;
    left &= q[kX]<-room, right &= q[kX]> room;
    above &= q[kY]<-room, below &= q[kY]> room;
    behind &= q[kZ] < 0.0;
  }
  return !(left || right || above || below || behind);
}

void SecondaryRays::trace_part(const RayFrame& frame, const PartTree::Part& part, Sink& sink) {
  const RayPatch& source = tree_.patches()[part.patch];
  if (sink.passes(source) || !project(frame, part.net, part_points_)) return;
  RayPatch seen = source;
  project(frame, source.net, patch_points_);
  seen.net.points = patch_points_.data();
  seen.nearest = -INFINITY;
  double weight = 0.0;
  for (std::size_t k = 0; k < source.net.size(); k += 4) weight = std::max(weight, source.net.points[k + 3]);
  seen.magnitude = 4.0 * kScreen * weight * (tree_.magnitude() / tree_.extent() + 1.0);
  sink.source = &source;
  clipper_.trace_part(seen, {source.net.n, source.net.m, part_points_.data()}, part.box, {0, 1, 0, 1}, sink);
}

}  // namespace nofacet

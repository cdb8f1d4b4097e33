#include "surface_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "patch_finder.h"
#include "patch_normal.h"
#include "placed_patch.h"
#include "surface_kernel.h"

namespace nofacet {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// A derivative this much shorter than the patch's longest one has vanished: a pole, where rounding is its direction.
constexpr double kPole = 1e-6;
// Curvatures of which rounding may have changed more than this part are not known.
constexpr double kUnknown = 1e-4;
constexpr std::size_t kRun = 256;  // points that are evaluated together, at most

double square(double x) { return x * x; }
double length(const double* v) { return std::sqrt(Camera::dot(v, v)); }

// How large a patch is: how long its derivatives get, and how far from the origin of its coordinates it lies. From the
// control polygon, so all are bounds.
struct PatchSize {
  double a = 0.0, b = 0.0, reach = 0.0;

  explicit PatchSize(const Net& net) {
    for (int i = 0; i <= net.n; ++i) {
      for (int j = 0; j <= net.m; ++j) {
        const double* p = net.at(i, j);
        reach = std::max(reach, length(p) / p[3]);
        if (i) a = std::max(a, net.n * distance(p, net.at(i - 1, j)));
        if (j) b = std::max(b, net.m * distance(p, net.at(i, j - 1)));
      }
    }
  }
  static double distance(const double* p, const double* q) {
    const double apart[3] = {p[0] / p[3] - q[0] / q[3], p[1] / p[3] - q[1] / q[3], p[2] / p[3] - q[2] / q[3]};
    return length(apart);
  }
};

// Points of one patch of a placed face that were asked for one after the other.
class PointRun {
 public:
  PointRun(const Scene& scene, int32_t face, const Scene::PatchRef& patch, std::size_t first)
      : patch_(&patch), face_(face), first_(first) {
    const Model& model = scene.model;
    run_.net = patch_net(scene, patch);
    run_.placement = model.placements + 16 * std::size_t(model.face_placement[face]);
    run_.outward = model.face_outward[face];
    const PatchSize size(run_.net);
    run_.vanished_a = square(kPole * size.a), run_.vanished_b = square(kPole * size.b);
    // Control points are rounded to 1e-16 of their coordinates, second derivatives are n (n - 1) times their second
    // differences, and curvature is that over the square of a length: on a patch that is very short in one direction
    // little is left.
    const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * size.reach;
    run_.rounding_a = rounding * square(run_.net.n), run_.rounding_b = rounding * square(run_.net.m);
    run_.known = kUnknown;
    run_.flat = 1.0 / std::max(size.a, size.b);
  }

  bool takes(int32_t face, const Scene::PatchRef* patch) const {
    return patch == patch_ && face == face_ && count_ < kRun;
  }
  void start_at(std::size_t first) { first_ = first, count_ = 0; }
  void add(double u, double v) {
    a_[count_] = patch_parameter(patch_->u, u), b_[count_] = patch_parameter(patch_->v, v);
    ++count_;
  }
  void evaluate(const SurfacePointArrays& out);

 private:
  const Scene::PatchRef* patch_;
  int32_t face_;
  std::size_t first_, count_ = 0;
  SurfaceRun run_{};
  double a_[kRun + kRunPadding] = {}, b_[kRun + kRunPadding] = {};

  // A domain without length has no map.
  static double patch_parameter(const ParameterMap& map, double u) {
    return map.u0 == map.u1 ? 0.0 : map.patch_from_face(u);
  }
  void write_limit(std::size_t k) const;
};

void PointRun::evaluate(const SurfacePointArrays& out) {
  unsigned char degenerate[kRun];
  run_.a = a_, run_.b = b_, run_.count = count_, run_.degenerate = degenerate;
  run_.position = out.position + 3 * first_, run_.normal = out.normal + 3 * first_;
  run_.curvature = out.curvature + 2 * first_, run_.direction = out.direction + 6 * first_;
  evaluate_run(run_);
  for (std::size_t k = 0; k < count_; ++k) {
    if (degenerate[k]) write_limit(k);
  }
}

// The normal's limit from inside the patch, and no curvature.
void PointRun::write_limit(std::size_t k) const {
  const Tangents local = limit_tangents(run_.net, a_[k], b_[k]);
  double a[3], b[3], across[3];
  for (int r = 0; r < 3; ++r) {
    a[r] = Camera::dot(run_.placement + 4 * r, local.a);
    b[r] = Camera::dot(run_.placement + 4 * r, local.b);
  }
  for (int c = 0; c < 3; ++c) across[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
  for (int c = 0; c < 3; ++c) run_.normal[3 * k + c] = run_.outward * across[c] / length(across);
  std::fill_n(run_.curvature + 2 * k, 2, kNaN);
  std::fill_n(run_.direction + 6 * k, 6, kNaN);
}

void write_nothing(std::size_t k, const SurfacePointArrays& out) {
  std::fill_n(out.position + 3 * k, 3, kNaN);
  std::fill_n(out.normal + 3 * k, 3, kNaN);
  std::fill_n(out.curvature + 2 * k, 2, kNaN);
  std::fill_n(out.direction + 6 * k, 6, kNaN);
}

}  // namespace

void evaluate_surface(const Scene& scene, const int32_t* face, const double* uv, std::size_t n,
                      const SurfacePointArrays& out) {
  PatchFinder finder(scene);
  std::optional<PointRun> run;
  for (std::size_t k = 0; k < n;) {
    const auto patch_at = [&](std::size_t i) -> const Scene::PatchRef* {
      const double u = uv[2 * i], v = uv[2 * i + 1];
      const bool asked = face[i] >= 0 && std::isfinite(u) && std::isfinite(v);
      return asked ? finder.find(scene.model.face_definition[face[i]], u, v) : nullptr;
    };
    const Scene::PatchRef* patch = patch_at(k);
    if (!patch) {
      write_nothing(k++, out);
      continue;
    }
    if (run) run->start_at(k);
    if (!run || !run->takes(face[k], patch)) run.emplace(scene, face[k], *patch, k);
    do {
      run->add(uv[2 * k], uv[2 * k + 1]);
      ++k;
    } while (k < n && run->takes(face[k], patch_at(k)));
    run->evaluate(out);
  }
}

}  // namespace nofacet

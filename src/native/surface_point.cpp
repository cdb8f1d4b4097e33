#include "surface_point.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "bezier/second_jet.h"
#include "patch_finder.h"
#include "patch_normal.h"
#include "placed_patch.h"

namespace nofacet {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// A derivative this much shorter than the patch's longest one has vanished: a pole, where rounding is its direction.
constexpr double kPole = 1e-6;
// Curvatures of which rounding may have changed more than this part are not known.
constexpr double kUnknown = 1e-4;

double dot(const double* p, const double* q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; }

void cross(const double* p, const double* q, double* result) {
  for (int c = 0; c < 3; ++c) result[c] = p[(c + 1) % 3] * q[(c + 2) % 3] - p[(c + 2) % 3] * q[(c + 1) % 3];
}

void scale(double factor, const double* v, double* result) {
  for (int c = 0; c < 3; ++c) result[c] = factor * v[c];
}

double square(double x) { return x * x; }
double length(const double* v) { return std::sqrt(dot(v, v)); }

// World vectors from a definition's.
struct Placement {
  const double* m;  // (4, 4)

  void point(const double* p, double* world) const {
    vector(p, world);
    for (int r = 0; r < 3; ++r) world[r] += m[4 * r + 3];
  }
  void vector(const double* v, double* world) const {
    for (int r = 0; r < 3; ++r) world[r] = dot(m + 4 * r, v);
  }
};

// Position and derivatives of a surface in space.
struct Derivatives {
  double p[3], a[3], b[3], aa[3], ab[3], bb[3];

  // The quotient rule: with A = w S, A_a = w S_a + w_a S, and so on.
  explicit Derivatives(const SecondJet& jet) {
    const double r = 1.0 / jet.p[3];
    const double wa = jet.pa[3], wb = jet.pb[3];
    for (int c = 0; c < 3; ++c) {
      p[c] = jet.p[c] / jet.p[3];
      a[c] = r * (jet.pa[c] - wa * p[c]);
      b[c] = r * (jet.pb[c] - wb * p[c]);
      aa[c] = r * (jet.paa[c] - jet.paa[3] * p[c] - 2.0 * wa * a[c]);
      ab[c] = r * (jet.pab[c] - jet.pab[3] * p[c] - wa * b[c] - wb * a[c]);
      bb[c] = r * (jet.pbb[c] - jet.pbb[3] * p[c] - 2.0 * wb * b[c]);
    }
  }

  void place(const Placement& placement) {
    double local[6][3];
    double* const all[6] = {p, a, b, aa, ab, bb};
    for (int k = 0; k < 6; ++k) std::copy_n(all[k], 3, local[k]);
    placement.point(local[0], p);
    for (int k = 1; k < 6; ++k) placement.vector(local[k], all[k]);
  }
};

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

// Eigenvalues, the larger first, and unit eigenvectors of the symmetric matrix ((x, y), (y, z)).
struct SymmetricEigen {
  double high, low;
  double cosine, sine;  // direction of the first eigenvector; the second is (-sine, cosine)

  SymmetricEigen(double x, double y, double z) {
    const double mean = 0.5 * (x + z), half = 0.5 * (x - z), radius = std::sqrt(half * half + y * y);
    high = mean + radius, low = mean - radius;
    if (radius == 0.0) {
      cosine = 1.0, sine = 0.0;
    } else if (half >= 0.0) {
      cosine = std::sqrt(0.5 + 0.5 * half / radius);
      sine = 0.5 * y / (radius * cosine);
    } else {
      sine = std::copysign(std::sqrt(0.5 - 0.5 * half / radius), y);
      cosine = 0.5 * y / (radius * sine);
    }
  }
};

void write_no_curvature(double* curvature, double* direction) {
  std::fill_n(curvature, 2, kNaN);
  std::fill_n(direction, 6, kNaN);
}

// Writes curvatures and directions from the derivatives and the unit normal, which points along a x b or against it.
// The shape operator h in the orthonormal frame e, f of the tangent plane, e along a, follows from the second
// fundamental form: II(a, a) = |a|^2 h_ee and so on, with b = b_e e + b_f f.
// Control points are rounded to 1e-16 of their coordinates, second derivatives are n (n - 1) times their second
// differences, and curvature is that over the square of a length: on a patch that is very short in one direction little
// is left, and then nothing is written but NaN.
void write_curvature(const Derivatives& d, const Net& net, const PatchSize& patch, const double* normal,
                     double* curvature, double* direction) {
  const double la = length(d.a);
  double e[3], f[3];
  scale(1.0 / la, d.a, e);
  cross(normal, e, f);
  const double be = dot(d.b, e), bf = dot(d.b, f);
  const double ee = dot(d.aa, normal) / (la * la);
  const double ef = (dot(d.ab, normal) / la - be * ee) / bf;
  const double ff = (dot(d.bb, normal) - be * be * ee - 2.0 * be * bf * ef) / (bf * bf);
  const SymmetricEigen eigen(ee, ef, ff);
  const double rounding =
      4.0 * std::numeric_limits<double>::epsilon() * patch.reach * (square(net.n / la) + square(net.m / bf));
  const double scale_of_bends =
      std::max({std::fabs(eigen.high), std::fabs(eigen.low), 1.0 / std::max(patch.a, patch.b)});
  if (!(rounding <= kUnknown * scale_of_bends)) {
    write_no_curvature(curvature, direction);
    return;
  }
  curvature[0] = eigen.high, curvature[1] = eigen.low;
  for (int c = 0; c < 3; ++c) {
    direction[c] = eigen.cosine * e[c] + eigen.sine * f[c];
    direction[3 + c] = eigen.cosine * f[c] - eigen.sine * e[c];
  }
}

// One patch of a placed face, ready for many points.
class PlacedSurface {
 public:
  PlacedSurface(const Scene& scene, int32_t face, const Scene::PatchRef& patch)
      : patch_(patch),
        net_(patch_net(scene, patch)),
        placement_{scene.model.placements + 16 * std::size_t(scene.model.face_placement[face])},
        outward_(scene.model.face_outward[face]),
        size_(net_) {}

  void evaluate(double u, double v, double* position, double* normal, double* curvature, double* direction) const {
    const double s = patch_parameter(patch_.u, u), t = patch_parameter(patch_.v, v);
    Derivatives d(evaluate_second(net_, s, t));
    const bool pole = dot(d.a, d.a) <= square(kPole * size_.a) || dot(d.b, d.b) <= square(kPole * size_.b);
    d.place(placement_);
    std::copy_n(d.p, 3, position);
    double across[3];
    cross(d.a, d.b, across);
    const double squared = dot(across, across);
    if (pole || !(squared > square(kFlat) * dot(d.a, d.a) * dot(d.b, d.b))) {
      write_limit_normal(s, t, normal);
      write_no_curvature(curvature, direction);
      return;
    }
    scale(outward_ / std::sqrt(squared), across, normal);
    write_curvature(d, net_, size_, normal, curvature, direction);
  }

 private:
  const Scene::PatchRef& patch_;
  Net net_;
  Placement placement_;
  double outward_;
  PatchSize size_;

  // A domain without length has no map.
  static double patch_parameter(const ParameterMap& map, double u) {
    return map.u0 == map.u1 ? 0.0 : map.patch_from_face(u);
  }

  void write_limit_normal(double s, double t, double* normal) const {
    const Tangents local = limit_tangents(net_, s, t);
    double a[3], b[3], across[3];
    placement_.vector(local.a, a);
    placement_.vector(local.b, b);
    cross(a, b, across);
    scale(outward_ / length(across), across, normal);
  }
};

void write_nothing(std::size_t k, const SurfacePointArrays& out) {
  std::fill_n(out.position + 3 * k, 3, kNaN);
  std::fill_n(out.normal + 3 * k, 3, kNaN);
  write_no_curvature(out.curvature + 2 * k, out.direction + 6 * k);
}

}  // namespace

void evaluate_surface(const Scene& scene, const int32_t* face, const double* uv, std::size_t n,
                      const SurfacePointArrays& out) {
  PatchFinder finder(scene);
  std::optional<PlacedSurface> surface;
  int32_t surface_face = -1;
  const Scene::PatchRef* surface_patch = nullptr;
  for (std::size_t k = 0; k < n; ++k) {
    const double u = uv[2 * k], v = uv[2 * k + 1];
    const bool asked = face[k] >= 0 && std::isfinite(u) && std::isfinite(v);
    const Scene::PatchRef* patch = asked ? finder.find(scene.model.face_definition[face[k]], u, v) : nullptr;
    if (!patch) {
      write_nothing(k, out);
      continue;
    }
    if (patch != surface_patch || face[k] != surface_face) {
      surface.emplace(scene, face[k], *patch);
      surface_patch = patch, surface_face = face[k];
    }
    surface->evaluate(u, v, out.position + 3 * k, out.normal + 3 * k, out.curvature + 2 * k, out.direction + 6 * k);
  }
}

}  // namespace nofacet

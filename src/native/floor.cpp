// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "floor.cpp"
#include "floor.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "bezier/bernstein.h"
#include "camera.h"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#ifndef NOFACET_FLOOR_RUN
#define NOFACET_FLOOR_RUN
namespace nofacet {

// The samples of one placed patch.
struct FloorRun {
  int n, m;              // degrees along a and b
  bool rational;         // else all weights are 1
  const double* points;  // (n + 1, m + 1, 4): wx, wy, wz, w in the world
  const double *a, *b;   // patch parameters, padded to kFloorPadding with copies of the last
  std::size_t count;
};

inline constexpr std::size_t kFloorPadding = 16;  // no instruction set has more doubles in a register

}  // namespace nofacet
#endif

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<double>;
using Vec = hn::Vec<Lanes>;

constexpr int kAnyDegree = -1;

// Bernstein polynomials of degree n and their derivatives. With the degree known when compiling they stay in registers.
template <int N>
struct Basis {
  static constexpr int kSize = (N == kAnyDegree ? kMaxDegree : N) + 1;
  Vec value[kSize], slope[kSize];

  // B_i(t) = C(n, i) t^i s^(n - i), B_i' = n (B_{i - 1} - B_i of degree n - 1); `binomial`: C(n - 1, i).
  HWY_INLINE void evaluate(Lanes d, int degree, const double* binomial, Vec t) {
    const int n = N == kAnyDegree ? degree : N;
    const Vec s = hn::Sub(hn::Set(d, 1.0), t);
    Vec power = hn::Set(d, 1.0);
    for (int i = 0; i < n; ++i) {
      value[i] = hn::Mul(power, hn::Set(d, binomial[i]));
      power = hn::Mul(power, t);
    }
    power = s;
    for (int i = n - 2; i >= 0; --i) {
      value[i] = hn::Mul(value[i], power);
      power = hn::Mul(power, s);
    }
    const Vec factor = hn::Set(d, double(n));
    Vec before = hn::Zero(d);
    for (int i = 0; i < n; ++i) {
      const Vec lower = value[i];
      slope[i] = hn::Mul(factor, hn::Sub(before, lower));
      value[i] = hn::MulAdd(s, lower, hn::Mul(t, before));
      before = lower;
    }
    slope[n] = hn::Mul(factor, before);
    value[n] = hn::Mul(t, before);
  }
};

// Sum over the run of position . unit normal. C: components, 4 of a rational patch, 3 of a polynomial one.
template <int N, int M, int C>
double sum_run(const FloorRun& run, const double* binomial_a, const double* binomial_b) {
  const Lanes d;
  const std::size_t width = hn::Lanes(d);
  const int n = N == kAnyDegree ? run.n : N, m = M == kAnyDegree ? run.m : M;
  const Vec one = hn::Set(d, 1.0);
  Vec sum = hn::Zero(d);
  for (std::size_t first = 0; first < run.count; first += width) {
    Basis<N> in_a;
    Basis<M> in_b;
    in_a.evaluate(d, n, binomial_a, hn::LoadU(d, run.a + first));
    in_b.evaluate(d, m, binomial_b, hn::LoadU(d, run.b + first));
    Vec p[C], pa[C], pb[C];
    for (int c = 0; c < C; ++c) p[c] = pa[c] = pb[c] = hn::Zero(d);
    const double* point = run.points;
    for (int i = 0; i <= n; ++i) {
      Vec row[C], slope[C];
      for (int c = 0; c < C; ++c) row[c] = slope[c] = hn::Zero(d);
      for (int j = 0; j <= m; ++j, point += 4) {
        for (int c = 0; c < C; ++c) {
          const Vec coordinate = hn::Set(d, point[c]);
          row[c] = hn::MulAdd(in_b.value[j], coordinate, row[c]);
          slope[c] = hn::MulAdd(in_b.slope[j], coordinate, slope[c]);
        }
      }
      for (int c = 0; c < C; ++c) {
        p[c] = hn::MulAdd(in_a.value[i], row[c], p[c]);
        pa[c] = hn::MulAdd(in_a.slope[i], row[c], pa[c]);
        pb[c] = hn::MulAdd(in_a.value[i], slope[c], pb[c]);
      }
    }
    if constexpr (C == 4) {
      const Vec r = hn::Div(one, p[3]);
      for (int c = 0; c < 3; ++c) {
        p[c] = hn::Mul(p[c], r);
        pa[c] = hn::Mul(hn::NegMulAdd(p[c], pa[3], pa[c]), r);
        pb[c] = hn::Mul(hn::NegMulAdd(p[c], pb[3], pb[c]), r);
      }
    }
    const Vec nx = hn::MulSub(pa[1], pb[2], hn::Mul(pa[2], pb[1]));
    const Vec ny = hn::MulSub(pa[2], pb[0], hn::Mul(pa[0], pb[2]));
    const Vec nz = hn::MulSub(pa[0], pb[1], hn::Mul(pa[1], pb[0]));
    const Vec length = hn::Sqrt(hn::MulAdd(nx, nx, hn::MulAdd(ny, ny, hn::Mul(nz, nz))));
    const Vec inverse = hn::Div(one, length);
    const Vec dot = hn::MulAdd(p[0], nx, hn::MulAdd(p[1], ny, hn::Mul(p[2], nz)));
    const auto real = hn::FirstN(d, run.count - first);  // not padding
    sum = hn::Add(sum, hn::IfThenElseZero(real, hn::Mul(dot, inverse)));
  }
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

template <int N, int M>
double sum_run(const FloorRun& run, const double* binomial_a, const double* binomial_b) {
  return run.rational ? sum_run<N, M, 4>(run, binomial_a, binomial_b) : sum_run<N, M, 3>(run, binomial_a, binomial_b);
}

double SumRun(const FloorRun& run, const double* binomial_a, const double* binomial_b) {
  switch (run.n * 64 + run.m) {
    case 1 * 64 + 1:
      return sum_run<1, 1>(run, binomial_a, binomial_b);
    case 1 * 64 + 2:
      return sum_run<1, 2>(run, binomial_a, binomial_b);
    case 2 * 64 + 1:
      return sum_run<2, 1>(run, binomial_a, binomial_b);
    case 2 * 64 + 2:
      return sum_run<2, 2>(run, binomial_a, binomial_b);
    case 2 * 64 + 3:
      return sum_run<2, 3>(run, binomial_a, binomial_b);
    case 3 * 64 + 2:
      return sum_run<3, 2>(run, binomial_a, binomial_b);
    case 3 * 64 + 3:
      return sum_run<3, 3>(run, binomial_a, binomial_b);
    default:
      return sum_run<kAnyDegree, kAnyDegree>(run, binomial_a, binomial_b);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(SumRun);

namespace {

// Row n: C(n, 0) .. C(n, n).
std::vector<std::array<double, kMaxDegree + 1>> binomials() {
  std::vector<std::array<double, kMaxDegree + 1>> rows(kMaxDegree + 1);
  for (int n = 0; n <= kMaxDegree; ++n) {
    rows[n][0] = 1.0;
    for (int i = 1; i <= n; ++i) rows[n][i] = rows[n][i - 1] * (n - i + 1) / i;
  }
  return rows;
}

// A frame's samples, sorted by placed patch.
class FloorSamples {
 public:
  FloorSamples(const Scene& scene, const int32_t* face, const double* uv, std::size_t pixels) : scene_(scene) {
    const Model& model = scene.model;
    first_patch_.assign(model.face_count + 1, 0);
    for (std::size_t f = 0; f < model.face_count; ++f) {
      first_patch_[f + 1] = first_patch_[f] + patch_count(f);
    }
    recent_.assign(model.face_count, 0);
    std::vector<std::size_t> slot(pixels);
    std::vector<std::size_t> counts(first_patch_.back());
    for (std::size_t k = 0; k < pixels; ++k) {
      if (face[k] < 0) continue;
      slot[k] = first_patch_[face[k]] + find_patch(face[k], uv[2 * k], uv[2 * k + 1]);
      ++counts[slot[k]];
      ++samples;
    }
    std::vector<std::size_t> next(counts.size());
    std::size_t end = 0;
    for (std::size_t p = 0; p < counts.size(); ++p) {
      next[p] = end;
      end += (counts[p] + kFloorPadding - 1) / kFloorPadding * kFloorPadding;
    }
    a_.resize(end);
    b_.resize(end);
    for (std::size_t k = 0; k < pixels; ++k) {
      if (face[k] < 0) continue;
      const Scene::PatchRef& patch = patch_of(face[k], slot[k]);
      a_[next[slot[k]]] = patch.u.patch_from_face(uv[2 * k]);
      b_[next[slot[k]]++] = patch.v.patch_from_face(uv[2 * k + 1]);
    }
    add_runs(counts, next);
  }

  std::vector<FloorRun> runs;
  int64_t samples = 0;

 private:
  std::size_t patch_count(std::size_t face) const {
    const int32_t d = scene_.model.face_definition[face];
    return scene_.patch_offsets[d + 1] - scene_.patch_offsets[d];
  }
  const Scene::PatchRef& patch_of(std::size_t face, std::size_t slot) const {
    return scene_.patches[scene_.patch_offsets[scene_.model.face_definition[face]] + slot - first_patch_[face]];
  }

  // The face's patch whose domain holds (u, v), or by rounding the nearest: neighbouring pixels mostly share it.
  std::size_t find_patch(std::size_t face, double u, double v) {
    const auto distance = [&](std::size_t k) {
      const Scene::PatchRef& patch = patch_of(face, first_patch_[face] + k);
      return std::max({patch.u.u0 - u, u - patch.u.u1, patch.v.u0 - v, v - patch.v.u1, 0.0});
    };
    std::size_t& best = recent_[face];
    double nearest = distance(best);
    for (std::size_t k = 0; nearest > 0.0 && k < patch_count(face); ++k) {
      const double other = distance(k);
      if (other < nearest) best = k, nearest = other;
    }
    return best;
  }

  void add_runs(const std::vector<std::size_t>& counts, const std::vector<std::size_t>& ends) {
    const Model& model = scene_.model;
    for (std::size_t face = 0; face < model.face_count; ++face) {
      for (std::size_t slot = first_patch_[face]; slot < first_patch_[face + 1]; ++slot) {
        if (counts[slot] == 0) continue;
        const std::size_t begin = ends[slot] - counts[slot];
        const std::size_t padded = begin + (counts[slot] + kFloorPadding - 1) / kFloorPadding * kFloorPadding;
        std::fill(a_.begin() + ends[slot], a_.begin() + padded, a_[ends[slot] - 1]);
        std::fill(b_.begin() + ends[slot], b_.begin() + padded, b_[ends[slot] - 1]);
        add_run(face, patch_of(face, slot), begin, counts[slot]);
      }
    }
    // The control points stand still only now.
    std::size_t at = 0;
    for (FloorRun& run : runs) {
      run.points = points_.data() + at;
      at += 4 * std::size_t(run.n + 1) * (run.m + 1);
    }
  }

  void add_run(std::size_t face, const Scene::PatchRef& patch, std::size_t begin, std::size_t count) {
    const Model& model = scene_.model;
    const PatchGroup& group = model.groups[patch.group];
    const std::size_t size = 4 * std::size_t(group.degree_u + 1) * (group.degree_v + 1);
    const double* placement = model.placements + 16 * std::size_t(model.face_placement[face]);
    const double* source = group.control_points + size * patch.index;
    bool rational = false;
    for (std::size_t k = 7; k < size; k += 4) rational |= source[k] != source[3];
    const double scale = rational ? 1.0 : 1.0 / source[3];
    for (std::size_t k = 0; k < size; k += 4) {
      for (int r = 0; r < 3; ++r) {
        const double* axis = placement + 4 * r;
        points_.push_back(scale * (Camera::dot(axis, source + k) + axis[3] * source[k + 3]));
      }
      points_.push_back(scale * source[k + 3]);
    }
    runs.push_back({group.degree_u, group.degree_v, rational, nullptr, a_.data() + begin, b_.data() + begin, count});
  }

  const Scene& scene_;
  std::vector<std::size_t> first_patch_;  // by face, of all placed patches
  std::vector<std::size_t> recent_;       // by face: where the last sample was found
  std::vector<double> a_, b_, points_;
};

}  // namespace

FloorResult measure_floor(const Scene& scene, const int32_t* face, const double* uv, std::size_t pixels, int repeats) {
  const FloorSamples samples(scene, face, uv, pixels);
  const auto binomial = binomials();
  FloorResult result{std::numeric_limits<double>::infinity(), samples.samples, 0.0};
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    double sum = 0.0;
    for (const FloorRun& run : samples.runs) {
      sum += HWY_DYNAMIC_DISPATCH(SumRun)(run, binomial[run.n - 1].data(), binomial[run.m - 1].data());
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.seconds = std::min(result.seconds, seconds);
    result.checksum = sum;
  }
  return result;
}

}  // namespace nofacet
#endif

// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/solve_run.cpp"
#include "raster/solve_run.h"

#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<double>;
using Vec = hn::Vec<Lanes>;

// Values per lane that outgrow the registers.
struct LaneBasis {
  HWY_ALIGN double value[(kMaxDegree + 1) * HWY_MAX_BYTES / sizeof(double)];
  HWY_ALIGN double slope[(kMaxDegree + 1) * HWY_MAX_BYTES / sizeof(double)];
};

// Bernstein basis of degree n and its derivative at t, lane by lane.
HWY_INLINE void lane_basis(Lanes d, int n, Vec t, LaneBasis& out) {
  const std::size_t width = hn::Lanes(d);
  const Vec s = hn::Sub(hn::Set(d, 1.0), t);
  double* v = out.value;
  // Degree n - 1 first: the derivative is made of it.
  hn::Store(hn::Set(d, 1.0), d, v);
  for (int k = 1; k < n; ++k) {
    Vec carry = hn::Zero(d);
    for (int i = 0; i < k; ++i) {
      const Vec b = hn::Load(d, v + i * width);
      hn::Store(hn::MulAdd(s, b, carry), d, v + i * width);
      carry = hn::Mul(t, b);
    }
    hn::Store(carry, d, v + k * width);
  }
  const Vec degree = hn::Set(d, double(n));
  Vec before = hn::Zero(d);
  for (int i = 0; i < n; ++i) {
    const Vec b = hn::Load(d, v + i * width);
    hn::Store(hn::Mul(degree, hn::Sub(before, b)), d, out.slope + i * width);
    hn::Store(hn::MulAdd(s, b, hn::Mul(t, before)), d, v + i * width);
    before = b;
  }
  hn::Store(hn::Mul(degree, before), d, out.slope + n * width);
  hn::Store(hn::Mul(t, before), d, v + n * width);
}

// Homogeneous points and derivatives of one group of lanes.
struct LaneJet {
  Vec p[4], pa[4], pb[4];
};

HWY_INLINE void evaluate_lanes(Lanes d, const Net& net, const LaneBasis& in_a, const LaneBasis& in_b, LaneJet& jet) {
  const std::size_t width = hn::Lanes(d);
  for (int c = 0; c < 4; ++c) jet.p[c] = jet.pa[c] = jet.pb[c] = hn::Zero(d);
  const double* point = net.points;
  for (int i = 0; i <= net.n; ++i) {
    Vec row0 = hn::Zero(d), row1 = row0, row2 = row0, row3 = row0;
    Vec slope0 = row0, slope1 = row0, slope2 = row0, slope3 = row0;
    for (int j = 0; j <= net.m; ++j, point += 4) {
      const Vec b = hn::Load(d, in_b.value + j * width), db = hn::Load(d, in_b.slope + j * width);
      const Vec x = hn::Set(d, point[0]), y = hn::Set(d, point[1]), w = hn::Set(d, point[2]), z = hn::Set(d, point[3]);
      row0 = hn::MulAdd(b, x, row0), slope0 = hn::MulAdd(db, x, slope0);
      row1 = hn::MulAdd(b, y, row1), slope1 = hn::MulAdd(db, y, slope1);
      row2 = hn::MulAdd(b, w, row2), slope2 = hn::MulAdd(db, w, slope2);
      row3 = hn::MulAdd(b, z, row3), slope3 = hn::MulAdd(db, z, slope3);
    }
    const Vec a = hn::Load(d, in_a.value + i * width), da = hn::Load(d, in_a.slope + i * width);
    const Vec row[4] = {row0, row1, row2, row3}, slope[4] = {slope0, slope1, slope2, slope3};
    for (int c = 0; c < 4; ++c) {
      jet.p[c] = hn::MulAdd(a, row[c], jet.p[c]);
      jet.pa[c] = hn::MulAdd(da, row[c], jet.pa[c]);
      jet.pb[c] = hn::MulAdd(a, slope[c], jet.pb[c]);
    }
  }
}

// The Newton step (da, db) from the jet's screen position to (x, y).
HWY_INLINE void newton_step(Lanes d, const LaneJet& jet, Vec x, Vec y, Vec& da, Vec& db) {
  const Vec r = hn::Div(hn::Set(d, 1.0), jet.p[kW]);
  const Vec at_x = hn::Mul(jet.p[kX], r), at_y = hn::Mul(jet.p[kY], r);
  const Vec xa = hn::Mul(hn::NegMulAdd(at_x, jet.pa[kW], jet.pa[kX]), r);
  const Vec xb = hn::Mul(hn::NegMulAdd(at_x, jet.pb[kW], jet.pb[kX]), r);
  const Vec ya = hn::Mul(hn::NegMulAdd(at_y, jet.pa[kW], jet.pa[kY]), r);
  const Vec yb = hn::Mul(hn::NegMulAdd(at_y, jet.pb[kW], jet.pb[kY]), r);
  const Vec rx = hn::Sub(x, at_x), ry = hn::Sub(y, at_y);
  const Vec inverse = hn::Div(hn::Set(d, 1.0), hn::MulSub(xa, yb, hn::Mul(xb, ya)));
  da = hn::Mul(hn::MulSub(rx, yb, hn::Mul(ry, xb)), inverse);
  db = hn::Mul(hn::MulSub(ry, xa, hn::Mul(rx, ya)), inverse);
}

void SolveRun(const Net& net, double y_target, const ParameterBox& box, double tolerance, int iterations,
              PixelRun& run) {
  const Lanes d;
  const int width = int(hn::Lanes(d));
  const Vec y = hn::Set(d, y_target), limit = hn::Set(d, tolerance);
  const Vec a_lo = hn::Set(d, box.a_lo), a_hi = hn::Set(d, box.a_hi);
  const Vec b_lo = hn::Set(d, box.b_lo), b_hi = hn::Set(d, box.b_hi);
  LaneBasis in_a, in_b;
  for (int first = 0; first < run.count; first += width) {
    const Vec x = hn::Load(d, run.x + first);
    Vec a = hn::Load(d, run.a + first), b = hn::Load(d, run.b + first);
    for (int iteration = 1;; ++iteration) {
      lane_basis(d, net.n, a, in_a);
      lane_basis(d, net.m, b, in_b);
      LaneJet jet;
      evaluate_lanes(d, net, in_a, in_b, jet);
      Vec da, db;
      newton_step(d, jet, x, y, da, db);
      const Vec step = hn::Max(hn::Abs(da), hn::Abs(db));
      a = hn::Add(a, da), b = hn::Add(b, db);
      if (iteration < iterations && !hn::AllTrue(d, hn::Lt(step, limit))) {
        a = hn::Min(hn::Max(a, a_lo), a_hi), b = hn::Min(hn::Max(b, b_lo), b_hi);
        continue;
      }
      hn::Store(a, d, run.a + first);
      hn::Store(b, d, run.b + first);
      hn::Store(step, d, run.step + first);
      for (int c = 0; c < 4; ++c) {
        const Vec moved = hn::MulAdd(da, jet.pa[c], hn::MulAdd(db, jet.pb[c], jet.p[c]));
        hn::Store(moved, d, run.p[c] + first);
        hn::Store(jet.pa[c], d, run.pa[c] + first);
        hn::Store(jet.pb[c], d, run.pb[c] + first);
      }
      break;
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(SolveRun);

void solve_run(const Net& net, double y, const ParameterBox& box, double tolerance, int iterations, PixelRun& run) {
  // Lanes beyond the run repeat its last pixel.
  for (int k = run.count; k < PixelRun::kCapacity; ++k) {
    run.x[k] = run.x[run.count - 1], run.a[k] = run.a[run.count - 1], run.b[k] = run.b[run.count - 1];
  }
  HWY_DYNAMIC_DISPATCH(SolveRun)(net, y, box, tolerance, iterations, run);
}

}  // namespace nofacet
#endif

// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ray/solve_rays.cpp"
#include "ray/solve_rays.h"

#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<double>;
using Vec = hn::Vec<Lanes>;
using Mask = hn::Mask<Lanes>;

constexpr Lanes kLanes;
constexpr int kMaxSteps = 12;  // the certificate halves the error each time at the very least

HWY_INLINE Vec set(double x) { return hn::Set(kLanes, x); }

// Homogeneous points and derivatives of one group of lanes.
struct LaneJet {
  Vec p[4], pa[4], pb[4];
};

// Bernstein basis of degree N and its derivative at t, lane by lane.
template <int N>
HWY_INLINE void lane_basis(Vec t, Vec* value, Vec* slope) {
  const Vec s = hn::Sub(set(1.0), t);
  if constexpr (N == 1) {
    value[0] = s, value[1] = t;
    slope[0] = set(-1.0), slope[1] = set(1.0);
  } else if constexpr (N == 2) {
    const Vec s2 = hn::Add(s, s), t2 = hn::Add(t, t);
    value[0] = hn::Mul(s, s), value[1] = hn::Mul(s2, t), value[2] = hn::Mul(t, t);
    slope[0] = hn::Neg(s2), slope[1] = hn::Sub(s2, t2), slope[2] = t2;
  } else {
    const Vec three = set(3.0), ss = hn::Mul(s, s), tt = hn::Mul(t, t), st2 = hn::Mul(hn::Add(s, s), t);
    const Vec s3 = hn::Mul(three, ss), t3 = hn::Mul(three, tt);
    value[0] = hn::Mul(ss, s), value[1] = hn::Mul(s3, t), value[2] = hn::Mul(s, t3), value[3] = hn::Mul(tt, t);
    slope[0] = hn::Neg(s3), slope[3] = t3;
    slope[1] = hn::Mul(three, hn::Sub(ss, st2)), slope[2] = hn::Mul(three, hn::Sub(st2, tt));
  }
}

// Degrees known at compile time let the compiler unroll and keep the basis in registers.
template <int N, int M>
HWY_INLINE void evaluate_fixed(const Net& net, Vec a, Vec b, LaneJet& jet) {
  Vec va[N + 1], da[N + 1], vb[M + 1], db[M + 1];
  lane_basis<N>(a, va, da);
  lane_basis<M>(b, vb, db);
  const double* point = net.points;
  for (int i = 0; i <= N; ++i, point += 4 * (M + 1)) {
    for (int c = 0; c < 4; ++c) {
      Vec row = hn::Mul(vb[0], set(point[c])), slope = hn::Mul(db[0], set(point[c]));
      for (int j = 1; j <= M; ++j) {
        const Vec value = set(point[4 * j + c]);
        row = hn::MulAdd(vb[j], value, row), slope = hn::MulAdd(db[j], value, slope);
      }
      jet.p[c] = i == 0 ? hn::Mul(va[i], row) : hn::MulAdd(va[i], row, jet.p[c]);
      jet.pa[c] = i == 0 ? hn::Mul(da[i], row) : hn::MulAdd(da[i], row, jet.pa[c]);
      jet.pb[c] = i == 0 ? hn::Mul(va[i], slope) : hn::MulAdd(va[i], slope, jet.pb[c]);
    }
  }
}

// Values per lane that outgrow the registers.
struct LaneBasis {
  HWY_ALIGN double value[(kMaxDegree + 1) * HWY_MAX_BYTES / sizeof(double)];
  HWY_ALIGN double slope[(kMaxDegree + 1) * HWY_MAX_BYTES / sizeof(double)];
};

HWY_NOINLINE void lane_basis_any(int n, Vec t, LaneBasis& out) {
  const std::size_t width = hn::Lanes(kLanes);
  const Vec s = hn::Sub(set(1.0), t);
  double* v = out.value;
  // Degree n - 1 first: the derivative is made of it.
  hn::Store(set(1.0), kLanes, v);
  for (int k = 1; k < n; ++k) {
    Vec carry = hn::Zero(kLanes);
    for (int i = 0; i < k; ++i) {
      const Vec b = hn::Load(kLanes, v + i * width);
      hn::Store(hn::MulAdd(s, b, carry), kLanes, v + i * width);
      carry = hn::Mul(t, b);
    }
    hn::Store(carry, kLanes, v + k * width);
  }
  const Vec degree = set(double(n));
  Vec before = hn::Zero(kLanes);
  for (int i = 0; i < n; ++i) {
    const Vec b = hn::Load(kLanes, v + i * width);
    hn::Store(hn::Mul(degree, hn::Sub(before, b)), kLanes, out.slope + i * width);
    hn::Store(hn::MulAdd(s, b, hn::Mul(t, before)), kLanes, v + i * width);
    before = b;
  }
  hn::Store(hn::Mul(degree, before), kLanes, out.slope + n * width);
  hn::Store(hn::Mul(t, before), kLanes, v + n * width);
}

HWY_NOINLINE void evaluate_any(const Net& net, Vec a, Vec b, LaneJet& jet) {
  const std::size_t width = hn::Lanes(kLanes);
  LaneBasis in_a, in_b;
  lane_basis_any(net.n, a, in_a);
  lane_basis_any(net.m, b, in_b);
  for (int c = 0; c < 4; ++c) jet.p[c] = jet.pa[c] = jet.pb[c] = hn::Zero(kLanes);
  const double* point = net.points;
  for (int i = 0; i <= net.n; ++i) {
    Vec row[4], slope[4];
    for (int c = 0; c < 4; ++c) row[c] = slope[c] = hn::Zero(kLanes);
    for (int j = 0; j <= net.m; ++j, point += 4) {
      const Vec vb = hn::Load(kLanes, in_b.value + j * width), db = hn::Load(kLanes, in_b.slope + j * width);
      for (int c = 0; c < 4; ++c) {
        row[c] = hn::MulAdd(vb, set(point[c]), row[c]), slope[c] = hn::MulAdd(db, set(point[c]), slope[c]);
      }
    }
    const Vec va = hn::Load(kLanes, in_a.value + i * width), da = hn::Load(kLanes, in_a.slope + i * width);
    for (int c = 0; c < 4; ++c) {
      jet.p[c] = hn::MulAdd(va, row[c], jet.p[c]);
      jet.pa[c] = hn::MulAdd(da, row[c], jet.pa[c]);
      jet.pb[c] = hn::MulAdd(va, slope[c], jet.pb[c]);
    }
  }
}

struct AnyDegree {
  static HWY_INLINE void evaluate(const Net& net, Vec a, Vec b, LaneJet& jet) { evaluate_any(net, a, b, jet); }
};
template <int N, int M>
struct FixedDegree {
  static HWY_INLINE void evaluate(const Net& net, Vec a, Vec b, LaneJet& jet) { evaluate_fixed<N, M>(net, a, b, jet); }
};

// Rays that may hit the leaf, packed.
struct Candidates {
  HWY_ALIGN double ray[SolvedRays::kCapacity + SolvedRays::kPadding];
  HWY_ALIGN double x[SolvedRays::kCapacity + SolvedRays::kPadding];
  HWY_ALIGN double y[SolvedRays::kCapacity + SolvedRays::kPadding];
  int count = 0;
};

// Of the rays in the rectangle those that the leaf may be hit by and that are not hidden: the linear guess is within
// q / 2 of the root (of which the middle of the square is at most 1/2 away), so it must lie that near to the square.
HWY_INLINE void collect(const RayLeaf& leaf, const RayGrid& grid, const RayRect& rect, const double* farthest,
                        Candidates& out) {
  const int width = int(hn::Lanes(kLanes));
  const double room = 0.5 + 0.5 * leaf.unique.q + leaf.beyond();
  const Vec limit = set(room), nearest = set(leaf.nearest);
  const Vec end = set(rect.i1), step = set(grid.step), x0 = set(grid.x0 - leaf.unique.x);
  const Vec ax = set(leaf.unique.a[0]), bx = set(leaf.unique.b[0]);
  for (int j = rect.j0; j < rect.j1; ++j) {
    const double y = grid.y(j), dy = y - leaf.unique.y;
    const Vec ay = set(leaf.unique.a[1] * dy), by = set(leaf.unique.b[1] * dy);
    const double first = double(j) * grid.columns;
    for (int i = rect.i0; i < rect.i1; i += width) {
      const Vec index = hn::Iota(kLanes, i), dx = hn::MulAdd(index, step, x0);
      const Vec a = hn::MulAdd(ax, dx, ay), b = hn::MulAdd(bx, dx, by);
      Mask mask = hn::And(hn::Lt(index, end), hn::Le(hn::Max(hn::Abs(a), hn::Abs(b)), limit));
      if (farthest) {
        const double* depths = farthest + std::size_t(j) * grid.columns + i;
        mask = hn::And(mask, hn::Ge(hn::LoadU(kLanes, depths), nearest));
      }
      hn::CompressStore(hn::Add(index, set(first)), mask, kLanes, out.ray + out.count);
      hn::CompressStore(hn::MulAdd(index, step, set(grid.x0)), mask, kLanes, out.x + out.count);
      hn::StoreU(set(y), kLanes, out.y + out.count);
      out.count += int(hn::CountTrue(kLanes, mask));
    }
  }
}

// Screen position and derivatives of a jet by the leaf's parameters, and the inverse Jacobian's determinant.
struct LaneScreen {
  Vec x, y, xa, xb, ya, yb, inverse;

  HWY_INLINE explicit LaneScreen(const LaneJet& jet) {
    const Vec r = hn::Div(set(1.0), jet.p[kW]);
    x = hn::Mul(jet.p[kX], r), y = hn::Mul(jet.p[kY], r);
    xa = hn::Mul(hn::NegMulAdd(x, jet.pa[kW], jet.pa[kX]), r);
    xb = hn::Mul(hn::NegMulAdd(x, jet.pb[kW], jet.pb[kX]), r);
    ya = hn::Mul(hn::NegMulAdd(y, jet.pa[kW], jet.pa[kY]), r);
    yb = hn::Mul(hn::NegMulAdd(y, jet.pb[kW], jet.pb[kY]), r);
    inverse = hn::Div(set(1.0), hn::MulSub(xa, yb, hn::Mul(xb, ya)));
  }
  // The Newton step to a point (rx, ry) away.
  HWY_INLINE void step(Vec rx, Vec ry, Vec& da, Vec& db) const {
    da = hn::Mul(hn::MulSub(rx, yb, hn::Mul(ry, xb)), inverse);
    db = hn::Mul(hn::MulSub(ry, xa, hn::Mul(rx, ya)), inverse);
  }
};

// Homogeneous eye-space vector (camera.h, Camera::unproject).
HWY_INLINE void unproject(const Camera& camera, const Vec* screen, Vec* eye) {
  const Vec per = set(1.0 / camera.scale);
  eye[0] = hn::Mul(hn::NegMulAdd(set(0.5 * camera.width), screen[kW], screen[kX]), per);
  eye[1] = hn::Mul(hn::MulSub(set(0.5 * camera.height), screen[kW], screen[kY]), per);
  eye[2] = camera.perspective ? screen[kW] : screen[kZ];
  eye[3] = camera.perspective ? screen[kZ] : screen[kW];
}

HWY_INLINE Vec dot(const Vec* p, const Vec* q) {
  return hn::MulAdd(p[2], q[2], hn::MulAdd(p[1], q[1], hn::Mul(p[0], q[0])));
}

// Unit normals towards the eye; zero where the tangents span no plane or one of them is rounding (patch_normal.cpp
// states the same bounds).
// Derivatives are by a leaf's parameters, `s_width` and `t_width` long in the patch's, of which the bounds are.
HWY_INLINE void lane_normal(const Camera& camera, const LaneJet& jet, double s_width, double t_width, Vec* normal) {
  Vec p[4], pa[4], pb[4], a[3], b[3];
  unproject(camera, jet.p, p);
  unproject(camera, jet.pa, pa);
  unproject(camera, jet.pb, pb);
  const Vec r = hn::Div(set(1.0), p[3]), ra = hn::Mul(pa[3], r), rb = hn::Mul(pb[3], r);
  for (int c = 0; c < 3; ++c) {
    a[c] = hn::NegMulAdd(p[c], ra, pa[c]);
    b[c] = hn::NegMulAdd(p[c], rb, pb[c]);
  }
  for (int c = 0; c < 3; ++c) {
    const int c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    normal[c] = hn::MulSub(a[c1], b[c2], hn::Mul(a[c2], b[c1]));
  }
  const Vec la = dot(a, a), lb = dot(b, b), size = dot(normal, normal);
  const double shape = (s_width * s_width) / (t_width * t_width);
  const Mask sound =
      hn::And(hn::And(hn::Ge(la, hn::Mul(set(1e-12 * shape), lb)), hn::Ge(lb, hn::Mul(set(1e-12 / shape), la))),
              hn::Gt(size, hn::Mul(set(1e-18), hn::Mul(la, lb))));
  const Vec away = camera.perspective ? dot(normal, p) : normal[2];
  const Vec scale = hn::IfThenElseZero(sound, hn::Div(set(1.0), hn::Sqrt(size)));
  const Vec signed_scale = hn::IfThenElse(hn::Gt(away, hn::Zero(kLanes)), hn::Neg(scale), scale);
  for (int c = 0; c < 3; ++c) normal[c] = hn::Mul(normal[c], signed_scale);
}

// One group of lanes: Newton's method until every ray is decided, then what is inside goes to `out`.
template <class Degrees>
class LaneSolver {
 public:
  LaneSolver(const RayLeaf& leaf, const RayGrid& grid, const Camera* camera, SolvedRays& out)
      : leaf_(leaf),
        grid_(grid),
        camera_(camera),
        out_(out),
        s_width_(leaf.box.s1 - leaf.box.s0),
        t_width_(leaf.box.t1 - leaf.box.t0) {}

  HWY_INLINE void solve(Vec ray, Vec x, Vec y, Mask active) {
    Vec a, b;
    guess(x, y, a, b);
    const Vec zero = hn::Zero(kLanes), one = set(1.0);
    const Vec miss = set(leaf_.unique.miss()), room = set(leaf_.beyond());
    for (int k = 0; k < kMaxSteps; ++k) {
      a = hn::Min(hn::Max(a, zero), one), b = hn::Min(hn::Max(b, zero), one);
      LaneJet jet;
      evaluate(a, b, jet);
      const LaneScreen screen(jet);
      const Vec rx = hn::Sub(x, screen.x), ry = hn::Sub(y, screen.y);
      Vec da, db;
      screen.step(rx, ry, da, db);
      const Vec next_a = hn::Add(a, da), next_b = hn::Add(b, db);
      const Vec step = hn::Max(hn::Abs(da), hn::Abs(db));
      const Vec over =
          hn::Max(hn::Max(hn::Neg(next_a), hn::Sub(next_a, one)), hn::Max(hn::Neg(next_b), hn::Sub(next_b, one)));
      active = hn::And(active, hn::Le(over, hn::MulAdd(miss, step, room)));
      if (hn::AllFalse(kLanes, active)) return;
      const Mask close = close_steps(da, db);
      if (hn::AllTrue(kLanes, hn::Or(close, hn::Not(active)))) {
        // The border of the whole patch is decided exactly.
        const Vec s = s_at(next_a), t = t_at(next_b);
        const Mask in_s = hn::And(hn::Ge(s, zero), hn::Le(s, one)), in_t = hn::And(hn::Ge(t, zero), hn::Le(t, one));
        const Mask inside = hn::And(hn::And(active, hn::Le(over, room)), hn::And(in_s, in_t));
        if (hn::AllFalse(kLanes, inside)) return;
        hn::CompressStore(s, inside, kLanes, out_.s_in + out_.count);
        hn::CompressStore(t, inside, kLanes, out_.t_in + out_.count);
        // From where membership is decided to where values are solved: so short a way that the step at hand does it.
        screen.step(hn::Sub(rx, set(grid_.shift_x)), hn::Sub(ry, set(grid_.shift_y)), da, db);
        if (!hn::AllTrue(kLanes, hn::Or(close_steps(da, db), hn::Not(inside)))) {
          move_to_value(hn::Sub(x, set(grid_.shift_x)), hn::Sub(y, set(grid_.shift_y)), a, b, da, db, jet);
        }
        append(ray, a, b, da, db, jet, inside);
        return;
      }
      a = next_a, b = next_b;
    }
    out_.undecided += int(hn::CountTrue(kLanes, active));
  }

 private:
  HWY_INLINE void guess(Vec x, Vec y, Vec& a, Vec& b) const {
    const Uniqueness& unique = leaf_.unique;
    const Vec dx = hn::Sub(x, set(unique.x)), dy = hn::Sub(y, set(unique.y));
    const Vec da = hn::MulAdd(set(unique.a[0]), dx, hn::Mul(set(unique.a[1]), dy));
    const Vec db = hn::MulAdd(set(unique.b[0]), dx, hn::Mul(set(unique.b[1]), dy));
    const double *ca = leaf_.curvature.a, *cb = leaf_.curvature.b;
    const Vec aa = hn::Mul(da, da), ab = hn::Mul(da, db), bb = hn::Mul(db, db), half = set(0.5);
    a = hn::Sub(hn::Add(half, da), hn::MulAdd(set(ca[0]), aa, hn::MulAdd(set(ca[1]), ab, hn::Mul(set(ca[2]), bb))));
    b = hn::Sub(hn::Add(half, db), hn::MulAdd(set(cb[0]), aa, hn::MulAdd(set(cb[1]), ab, hn::Mul(set(cb[2]), bb))));
  }
  HWY_INLINE Vec s_at(Vec a) const { return hn::MulAdd(a, set(s_width_), set(leaf_.box.s0)); }
  HWY_INLINE Vec t_at(Vec b) const { return hn::MulAdd(b, set(t_width_), set(leaf_.box.t0)); }
  // The whole patch is evaluated, so that no digits are lost to clipping; derivatives are by the leaf's parameters.
  HWY_INLINE void evaluate(Vec a, Vec b, LaneJet& jet) const {
    Degrees::evaluate(leaf_.patch.net, s_at(a), t_at(b), jet);
    for (int c = 0; c < 4; ++c) {
      jet.pa[c] = hn::Mul(jet.pa[c], set(s_width_));
      jet.pb[c] = hn::Mul(jet.pb[c], set(t_width_));
    }
  }
  HWY_INLINE Mask close_steps(Vec da, Vec db) const {
    return hn::And(hn::Le(hn::Abs(da), set(leaf_.tolerance[0])), hn::Le(hn::Abs(db), set(leaf_.tolerance[1])));
  }
  // Beside a silhouette the way is long and bent: Newton's method again, to (x, y). If the surface ends on the way,
  // the point where membership was decided, a last step from (a, b), serves.
  HWY_NOINLINE void move_to_value(Vec x, Vec y, Vec& a, Vec& b, Vec& da, Vec& db, LaneJet& jet) const {
    const Vec start_a = a, start_b = b;
    const LaneJet start = jet;
    const LaneScreen there(jet);
    Vec start_da, start_db;
    there.step(hn::Sub(hn::Add(x, set(grid_.shift_x)), there.x), hn::Sub(hn::Add(y, set(grid_.shift_y)), there.y),
               start_da, start_db);
    Mask close = close_steps(da, db);
    for (int k = 0; k < kMaxSteps && !hn::AllTrue(kLanes, close); ++k) {
      a = hn::IfThenElse(close, a, hn::Add(a, da)), b = hn::IfThenElse(close, b, hn::Add(b, db));
      evaluate(a, b, jet);
      const LaneScreen screen(jet);
      screen.step(hn::Sub(x, screen.x), hn::Sub(y, screen.y), da, db);
      close = close_steps(da, db);
    }
    a = hn::IfThenElse(close, a, start_a), b = hn::IfThenElse(close, b, start_b);
    da = hn::IfThenElse(close, da, start_da), db = hn::IfThenElse(close, db, start_db);
    for (int c = 0; c < 4; ++c) {
      jet.p[c] = hn::IfThenElse(close, jet.p[c], start.p[c]);
      jet.pa[c] = hn::IfThenElse(close, jet.pa[c], start.pa[c]);
      jet.pb[c] = hn::IfThenElse(close, jet.pb[c], start.pb[c]);
    }
  }
  HWY_INLINE void append(Vec ray, Vec a, Vec b, Vec da, Vec db, const LaneJet& jet, Mask inside) {
    const int at = out_.count;
    hn::CompressStore(ray, inside, kLanes, out_.ray + at);
    hn::CompressStore(s_at(hn::Add(a, da)), inside, kLanes, out_.s + at);
    hn::CompressStore(t_at(hn::Add(b, db)), inside, kLanes, out_.t + at);
    Vec moved[4];
    for (int c = 0; c < 4; ++c) moved[c] = hn::MulAdd(da, jet.pa[c], hn::MulAdd(db, jet.pb[c], jet.p[c]));
    const Vec depth = hn::Div(moved[leaf_.patch.depth_numerator()], moved[leaf_.patch.depth_denominator()]);
    hn::CompressStore(depth, inside, kLanes, out_.depth + at);
    if (camera_) {
      Vec normal[3];
      lane_normal(*camera_, jet, s_width_, t_width_, normal);
      for (int c = 0; c < 3; ++c) hn::CompressStore(normal[c], inside, kLanes, out_.normal[c] + at);
    }
    out_.count += int(hn::CountTrue(kLanes, inside));
  }

  const RayLeaf& leaf_;
  const RayGrid& grid_;
  const Camera* camera_;
  SolvedRays& out_;
  double s_width_, t_width_;
};

template <class Degrees>
HWY_NOINLINE void solve_candidates(const RayLeaf& leaf, const RayGrid& grid, const Camera* camera,
                                   Candidates& candidates, SolvedRays& out) {
  const int width = int(hn::Lanes(kLanes));
  LaneSolver<Degrees> solver(leaf, grid, camera, out);
  for (int k = 0; k < candidates.count; k += width) {
    const Mask active = hn::FirstN(kLanes, std::size_t(candidates.count - k));
    solver.solve(hn::Load(kLanes, candidates.ray + k), hn::Load(kLanes, candidates.x + k),
                 hn::Load(kLanes, candidates.y + k), active);
  }
}

void SolveRays(const RayLeaf& leaf, const RayGrid& grid, const RayRect& rect, const double* farthest,
               const Camera* camera, SolvedRays& out) {
  Candidates candidates;
  collect(leaf, grid, rect, farthest, candidates);
  if (candidates.count == 0) return;
  // Lanes beyond the last ray repeat it.
  for (int k = 0; k < int(hn::Lanes(kLanes)); ++k) {
    candidates.x[candidates.count + k] = candidates.x[candidates.count - 1];
    candidates.y[candidates.count + k] = candidates.y[candidates.count - 1];
  }
  const auto solve = [&](auto degrees) { solve_candidates<decltype(degrees)>(leaf, grid, camera, candidates, out); };
  switch (leaf.patch.net.n * 64 + leaf.patch.net.m) {
    case 1 * 64 + 1:
      return solve(FixedDegree<1, 1>());
    case 1 * 64 + 2:
      return solve(FixedDegree<1, 2>());
    case 1 * 64 + 3:
      return solve(FixedDegree<1, 3>());
    case 2 * 64 + 1:
      return solve(FixedDegree<2, 1>());
    case 2 * 64 + 2:
      return solve(FixedDegree<2, 2>());
    case 2 * 64 + 3:
      return solve(FixedDegree<2, 3>());
    case 3 * 64 + 1:
      return solve(FixedDegree<3, 1>());
    case 3 * 64 + 2:
      return solve(FixedDegree<3, 2>());
    case 3 * 64 + 3:
      return solve(FixedDegree<3, 3>());
    default:
      return solve(AnyDegree());
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(SolveRays);

RayLeaf::RayLeaf(const RayPatch& p, const PatchBox& b, const Net& part, const Uniqueness& certificate)
    : patch(p), box(b), unique(certificate), curvature(part, certificate) {
  nearest = hull_range(part, p.depth_numerator(), p.depth_denominator()).lo;
  double weight = part.points[kW];
  for (std::size_t k = 0; k < part.size(); k += 4) weight = std::min(weight, part.points[k + kW]);
  const double of_screen = 0.1 * kRounding * p.magnitude / weight;  // of the patch evaluated as a whole
  rounding[0] = of_screen * (std::fabs(unique.a[0]) + std::fabs(unique.a[1]));
  rounding[1] = of_screen * (std::fabs(unique.b[0]) + std::fabs(unique.b[1]));
  // The last step is applied, so the error left is its square times the curvature, of which q is a measure: 1e-11 of
  // the leaf. Normals stay those of before the step and turn by q times the step: the digits of a float32.
  const double q = std::max(unique.q, 1e-12);
  const double last = std::min({1e-2, std::sqrt(2.5e-12 / q), 5e-8 / q});
  for (int c = 0; c < 2; ++c) tolerance[c] = std::max(last, 4.0 * rounding[c]);
}

void solve_rays(const RayLeaf& leaf, const RayGrid& grid, const RayRect& rect, const double* farthest,
                const Camera* camera, SolvedRays& out) {
  out.count = out.undecided = 0;
  HWY_DYNAMIC_DISPATCH(SolveRays)(leaf, grid, rect, farthest, camera, out);
}

}  // namespace nofacet
#endif

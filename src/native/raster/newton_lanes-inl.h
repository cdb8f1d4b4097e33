// One Newton step towards a pixel in each SIMD lane, and the normal there. Included once for every instruction set
// (Highway).
#if defined(NOFACET_RASTER_NEWTON_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NOFACET_RASTER_NEWTON_LANES_INL_H_
#undef NOFACET_RASTER_NEWTON_LANES_INL_H_
#else
#define NOFACET_RASTER_NEWTON_LANES_INL_H_
#endif

#include "light.h"
#include "patch_normal.h"
#include "raster/solve_pixels.h"
#include "raster/span_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {

// What does not change from pixel to pixel of a piece.
struct View {
  const Camera& camera;
  const Frame& frame;
  const Piece& piece;
  const float* color;
  bool values;       // whether anything but uv is written
  double calm_step;  // a Newton step that is no larger leaves a pixel accurate and its normal sound for shading
  // So does one, by the size of the determinant that it was divided by, that is_steady() says:
  double least_determinant, turn, rise, remainder;
  double half[3];  // unit vector between the key light and the eye (orthographic)

  View(const Camera& c, const Frame& f, const Piece& p, const float* face_color, bool with_values)
      : camera(c),
        frame(f),
        piece(p),
        color(face_color),
        values(with_values),
        calm_step(std::min(kShadeTolerance * p.least_tangent / (2.0 * p.bend),
                           std::sqrt(kPixelTolerance / (p.bend * p.reach)))),
        half{kKeyLight[0], kKeyLight[1], kKeyLight[2] - 1.0} {
    const double length = std::sqrt(Camera::dot(half, half));
    for (double& h : half) h /= length;
    // The determinant is the Jacobian times the weight's square; a tangent is no shorter than the Jacobian over the
    // length of the other.
    double weight = 0.0;
    for (const double *q = p.net.points, *end = q + p.net.size(); q != end; q += 4) weight = std::max(weight, q[kW]);
    const double square = weight * weight, a = p.longest_a, b = p.longest_b, longest = std::max(a, b);
    least_determinant = square * std::max(kFlat * a * b, kDegenerate * longest * longest);
    turn = kShadeTolerance / (2.0 * p.bend * longest * square);
    rise = p.depth_rise * square;
    remainder = kPixelTolerance / p.bend;
  }
};

// Key, normal and Newton step of one group of pixels. The normal, in eye space, is that of the tangent plane's equation
// key = nx x' + ny y' + const, scaled so that it points towards the eye and stays finite in single precision.
struct Point {
  Vec key, nx, ny, nz, da, db, step;  // step: the larger of da and db
  NewtonSystem<Vec> system;
  Vec inverse;         // of its determinant
  Vec ka, kb, weight;  // the key's derivatives, on the screen's scale; the weight after the step
  Vec ux, uy;          // the tangent plane's slopes, on the screen's scale
};

// What is known of a point after a step.
struct Verdict {
  Mask accurate, regular;  // the step's remainder is small; the normal is sound
  Mask normal_accurate;    // the normal may be taken before the step
  Vec reach;               // how much farther than on the screen an error reaches in depth
};

template <bool kRational>
HWY_INLINE void newton_step(Lanes d, const View& view, const Origin& origin, const LaneJet& jet, Vec x, Vec y,
                            Point& out) {
  const auto system = NewtonSystem<Vec>::at<kRational>(jet.p, jet.pa, jet.pb, hn::Sub(x, hn::Set(d, origin.x)),
                                                       hn::Sub(y, hn::Set(d, origin.y)));
  // One division serves both: by the determinant, and by the weight before the step.
  const Vec one = hn::Set(d, 1.0);
  Vec inverse, weight_inverse;
  if constexpr (kRational) {
    const Vec both = hn::Div(one, hn::Mul(system.determinant, jet.p[kW]));
    inverse = hn::Mul(both, jet.p[kW]), weight_inverse = hn::Mul(both, system.determinant);
  } else {
    inverse = hn::Div(one, system.determinant);
  }
  out.da = system.step_a(inverse), out.db = system.step_b(inverse);
  out.step = hn::Max(hn::Abs(out.da), hn::Abs(out.db));
  Vec key = hn::MulAdd(out.da, jet.pa[kZ], hn::MulAdd(out.db, jet.pb[kZ], jet.p[kZ]));
  Vec ka = jet.pa[kZ], kb = jet.pb[kZ], weight = one;
  if constexpr (kRational) {
    weight = hn::MulAdd(out.da, jet.pa[kW], hn::MulAdd(out.db, jet.pb[kW], jet.p[kW]));
    // The step changes the weight by its own size or so; twice squared, that is nothing (Newton's reciprocal).
    for (int k = 0; k < 2; ++k) {
      weight_inverse = hn::MulAdd(weight_inverse, hn::NegMulAdd(weight, weight_inverse, one), weight_inverse);
    }
    key = hn::Mul(key, weight_inverse);
    ka = hn::NegMulAdd(key, jet.pa[kW], ka), kb = hn::NegMulAdd(key, jet.pb[kW], kb);
  }
  out.key = hn::Add(key, hn::Set(d, origin.key));

  // The tangent plane's slopes: key grows by this along x and y, in pixels.
  const Camera& camera = view.camera;
  const bool perspective = kRational && camera.perspective;
  const Vec scale = hn::Set(d, camera.scale);
  const Vec size = hn::Abs(out.key), key_scale = perspective ? hn::Div(scale, size) : scale;
  const Vec by_x = hn::Mul(hn::MulSub(ka, system.fyb, hn::Mul(kb, system.fya)), inverse);
  const Vec by_y = hn::Mul(hn::MulSub(kb, system.fxa, hn::Mul(ka, system.fxb)), inverse);
  out.ux = hn::Mul(by_x, key_scale), out.uy = hn::Mul(by_y, key_scale);
  out.nx = out.ux, out.ny = hn::Neg(out.uy), out.nz = hn::Set(d, -1.0);
  if (perspective) {
    const Vec cx = hn::Set(d, 0.5 * camera.width), cy = hn::Set(d, 0.5 * camera.height);
    const Vec nz = hn::MulAdd(hn::Sub(cx, x), by_x, hn::MulAdd(hn::Sub(cy, y), by_y, out.key));
    out.nz = hn::Div(nz, size);  // the key's unit is arbitrary
  }
  out.ka = hn::Mul(ka, key_scale), out.kb = hn::Mul(kb, key_scale);
  out.system = system, out.inverse = inverse, out.weight = weight;
}

// Whether a step leaves a pixel accurate and its normal sound for shading, by bounds of the piece's tangents: much less
// work than to judge it by its own.
HWY_INLINE Mask is_steady(Lanes d, const View& view, const Point& point) {
  const Vec size = hn::Abs(point.system.determinant), square = hn::Mul(point.step, point.step);
  const Mask turns_little = hn::Le(point.step, hn::Mul(size, hn::Set(d, view.turn)));
  const Mask accurate =
      hn::Le(hn::Mul(square, hn::Add(size, hn::Set(d, view.rise))), hn::Mul(size, hn::Set(d, view.remainder)));
  return hn::And(hn::Ge(size, hn::Set(d, view.least_determinant)), hn::And(turns_little, accurate));
}

// `normal_tolerance`: how far the tangents may turn after they are taken, in radians.
HWY_INLINE Verdict judge(Lanes d, const View& view, const Point& point, double normal_tolerance) {
  Verdict verdict;
  const Vec one = hn::Set(d, 1.0);
  verdict.reach = hn::Add(one, hn::Add(hn::Abs(point.ux), hn::Abs(point.uy)));
  const Vec remainder = hn::Mul(hn::Mul(hn::Set(d, view.piece.bend), hn::Mul(point.step, point.step)), verdict.reach);
  // Squares of the tangents' lengths, times W^2.
  const auto square3 = [&](Vec p, Vec q, Vec r) HWY_ATTR { return hn::MulAdd(p, p, hn::MulAdd(q, q, hn::Mul(r, r))); };
  const NewtonSystem<Vec>& system = point.system;
  const Vec a2 = square3(system.fxa, system.fya, point.ka), b2 = square3(system.fxb, system.fyb, point.kb);
  // The tangents, taken before the step, differ from those after it by 2 bend step at most.
  const Vec turn = hn::Mul(hn::Mul(hn::Set(d, 2.0 / normal_tolerance * view.piece.bend), point.step), point.weight);
  verdict.normal_accurate = hn::Le(hn::Mul(turn, turn), hn::Min(a2, b2));
  verdict.accurate = hn::And(verdict.normal_accurate, hn::Le(remainder, hn::Set(d, kPixelTolerance)));
  const Vec n2 = hn::Mul(square3(point.ux, point.uy, one), hn::Mul(system.determinant, system.determinant));
  const Vec degenerate = hn::Set(d, kDegenerate * kDegenerate);
  verdict.regular = hn::And(hn::Gt(n2, hn::Mul(hn::Set(d, kFlat * kFlat), hn::Mul(a2, b2))),
                            hn::And(hn::Ge(a2, hn::Mul(degenerate, b2)), hn::Ge(b2, hn::Mul(degenerate, a2))));
  return verdict;
}

// A second step, from (a, b), where newton_step led to, with the derivatives that it had: all it costs is one more
// position. They differ from those at (a, b) by 2 bend step at most, so what is left after it is that times the second
// step, and the remainder of that.
template <int kN, int kM, bool kRational, class NetKind>
HWY_INLINE void second_step(Lanes d, const View& view, const NetKind& net, const Origin& origin, const LaneJet& jet,
                            Vec a, Vec b, Vec x, Vec y, Point& out, Verdict& verdict) {
  Vec p[4];
  evaluate_positions<kN, kM, kRational>(d, net, a, b, p);
  const auto system = NewtonSystem<Vec>::at<kRational>(p, jet.pa, jet.pb, hn::Sub(x, hn::Set(d, origin.x)),
                                                       hn::Sub(y, hn::Set(d, origin.y)));
  const Vec da = system.step_a(out.inverse), db = system.step_b(out.inverse);
  Vec key = hn::MulAdd(da, jet.pa[kZ], hn::MulAdd(db, jet.pb[kZ], p[kZ]));
  if constexpr (kRational) key = hn::Div(key, hn::MulAdd(da, jet.pa[kW], hn::MulAdd(db, jet.pb[kW], p[kW])));
  out.key = hn::Add(key, hn::Set(d, origin.key));
  out.da = hn::Add(out.da, da), out.db = hn::Add(out.db, db);
  const Vec step = hn::Max(hn::Abs(da), hn::Abs(db));
  const Vec both = hn::MulAdd(hn::Set(d, 2.0), out.step, step);
  const Vec remainder = hn::Mul(hn::Mul(hn::Set(d, view.piece.bend), hn::Mul(both, step)), verdict.reach);
  verdict.accurate = hn::And(verdict.normal_accurate, hn::Le(remainder, hn::Set(d, kPixelTolerance)));
}

}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#endif

// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/solve_pixels.cpp"
#include "raster/solve_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hwy/foreach_target.h"
#include "light.h"
#include "patch_normal.h"
#include "raster/fill.h"
#include "raster/shade.h"
#include "raster/span_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

constexpr int kMaxKnotNewton = 8, kMaxPixelNewton = 4;
// Largest change of direction, in radians, of the tangents that a normal is made of, as stored and for shading.
constexpr double kNormalTolerance = 3e-8, kShadeTolerance = 1e-4;
constexpr double kCentredTolerance = 2e-9;  // pixels
constexpr double kKnotStep = 1e-6;          // knots only guide: pixels are judged by themselves

// The polynomial of degree 5 with given values and slopes at three knots, for first guesses between them (Hermite
// interpolation by divided differences); of degree 3 at two.
class Guess {
 public:
  Guess(const double* t, const double* value, const double* slope, int knots)
      : t0_(t[0]), t1_(t[1]), t2_(t[knots - 1]) {
    const double f01 = (value[1] - value[0]) / (t1_ - t0_);
    const double f001 = (f01 - slope[0]) / (t1_ - t0_), f011 = (slope[1] - f01) / (t1_ - t0_);
    const double f0011 = (f011 - f001) / (t1_ - t0_);
    c_[0] = value[0], c_[1] = slope[0], c_[2] = f001, c_[3] = f0011, c_[4] = c_[5] = 0.0;
    if (knots == 3) {
      const double f12 = (value[2] - value[1]) / (t2_ - t1_);
      const double f112 = (f12 - slope[1]) / (t2_ - t1_), f122 = (slope[2] - f12) / (t2_ - t1_);
      const double f0112 = (f112 - f011) / (t2_ - t0_), f1122 = (f122 - f112) / (t2_ - t1_);
      const double f00112 = (f0112 - f0011) / (t2_ - t0_), f01122 = (f1122 - f0112) / (t2_ - t0_);
      c_[4] = f00112, c_[5] = (f01122 - f00112) / (t2_ - t0_);
    }
    for (double& c : c_) {
      if (!std::isfinite(c)) c = 0.0;  // knots in one place
    }
  }
  HWY_INLINE Vec at(Lanes d, Vec t) const {
    const Vec from0 = hn::Sub(t, hn::Set(d, t0_)), from1 = hn::Sub(t, hn::Set(d, t1_));
    Vec r = hn::MulAdd(hn::Sub(t, hn::Set(d, t2_)), hn::Set(d, c_[5]), hn::Set(d, c_[4]));
    r = hn::MulAdd(r, from1, hn::Set(d, c_[3]));
    r = hn::MulAdd(r, from1, hn::Set(d, c_[2]));
    r = hn::MulAdd(r, from0, hn::Set(d, c_[1]));
    return hn::MulAdd(r, from0, hn::Set(d, c_[0]));
  }

 private:
  double t0_, t1_, t2_;
  double c_[6];
};

// What does not change from pixel to pixel of a piece.
struct View {
  const Camera& camera;
  const Frame& frame;
  const Piece& piece;
  const float* color;
  bool values;     // whether anything but uv is written
  double half[3];  // unit vector between the key light and the eye (orthographic)

  View(const Camera& c, const Frame& f, const Piece& p, const float* face_color, bool with_values)
      : camera(c),
        frame(f),
        piece(p),
        color(face_color),
        values(with_values),
        half{kKeyLight[0], kKeyLight[1], kKeyLight[2] - 1.0} {
    const double length = std::sqrt(Camera::dot(half, half));
    for (double& h : half) h /= length;
  }
};

// Key, normal and Newton step of one group of pixels. The normal, in eye space, is that of the tangent plane's equation
// key = nx x' + ny y' + const, scaled so that it points towards the eye and stays finite in single precision.
struct Point {
  Vec key, nx, ny, nz, da, db;
  Mask accurate, regular;  // the step's remainder is small; the normal is sound
};

template <bool kRational>
HWY_INLINE void newton_step(Lanes d, const View& view, const Origin& origin, const LaneJet& jet, Vec x, Vec y,
                            double normal_tolerance, Point& out) {
  // F = P - (x, y) W vanishes at the solution; there F_a = W x_a and so on, and D = W^2 J.
  const Vec tx = hn::Sub(x, hn::Set(d, origin.x)), ty = hn::Sub(y, hn::Set(d, origin.y));
  Vec fx, fy, fxa, fxb, fya, fyb;
  if constexpr (kRational) {
    fx = hn::NegMulAdd(tx, jet.p[kW], jet.p[kX]), fy = hn::NegMulAdd(ty, jet.p[kW], jet.p[kY]);
    fxa = hn::NegMulAdd(tx, jet.pa[kW], jet.pa[kX]), fya = hn::NegMulAdd(ty, jet.pa[kW], jet.pa[kY]);
    fxb = hn::NegMulAdd(tx, jet.pb[kW], jet.pb[kX]), fyb = hn::NegMulAdd(ty, jet.pb[kW], jet.pb[kY]);
  } else {
    fx = hn::Sub(jet.p[kX], tx), fy = hn::Sub(jet.p[kY], ty);
    fxa = jet.pa[kX], fxb = jet.pb[kX], fya = jet.pa[kY], fyb = jet.pb[kY];
  }
  const Vec determinant = hn::MulSub(fxa, fyb, hn::Mul(fxb, fya));
  const Vec inverse = hn::Div(hn::Set(d, 1.0), determinant);
  out.da = hn::Mul(hn::MulSub(fy, fxb, hn::Mul(fx, fyb)), inverse);
  out.db = hn::Mul(hn::MulSub(fx, fya, hn::Mul(fy, fxa)), inverse);
  const Vec step = hn::Max(hn::Abs(out.da), hn::Abs(out.db));
  Vec key = hn::MulAdd(out.da, jet.pa[kZ], hn::MulAdd(out.db, jet.pb[kZ], jet.p[kZ]));
  Vec ka = jet.pa[kZ], kb = jet.pb[kZ], weight = hn::Set(d, 1.0);
  if constexpr (kRational) {
    weight = hn::MulAdd(out.da, jet.pa[kW], hn::MulAdd(out.db, jet.pb[kW], jet.p[kW]));
    key = hn::Div(key, weight);
    ka = hn::NegMulAdd(key, jet.pa[kW], ka), kb = hn::NegMulAdd(key, jet.pb[kW], kb);
  }
  out.key = hn::Add(key, hn::Set(d, origin.key));

  // The tangent plane's slopes: key grows by this along x and y, in pixels.
  const Camera& camera = view.camera;
  const bool perspective = kRational && camera.perspective;
  const Vec scale = hn::Set(d, camera.scale);
  const Vec size = hn::Abs(out.key), key_scale = perspective ? hn::Div(scale, size) : scale;
  const Vec by_x = hn::Mul(hn::MulSub(ka, fyb, hn::Mul(kb, fya)), inverse);
  const Vec by_y = hn::Mul(hn::MulSub(kb, fxa, hn::Mul(ka, fxb)), inverse);
  const Vec ux = hn::Mul(by_x, key_scale), uy = hn::Mul(by_y, key_scale);
  out.nx = ux, out.ny = hn::Neg(uy), out.nz = hn::Set(d, -1.0);
  if (perspective) {
    const Vec cx = hn::Set(d, 0.5 * camera.width), cy = hn::Set(d, 0.5 * camera.height);
    const Vec nz = hn::MulAdd(hn::Sub(cx, x), by_x, hn::MulAdd(hn::Sub(cy, y), by_y, out.key));
    out.nz = hn::Div(nz, size);  // the key's unit is arbitrary
  }
  const Vec remainder = hn::Mul(hn::Mul(hn::Set(d, view.piece.bend), hn::Mul(step, step)),
                                hn::Add(hn::Set(d, 1.0), hn::Add(hn::Abs(ux), hn::Abs(uy))));
  out.accurate = hn::Le(remainder, hn::Set(d, kPixelTolerance));

  // Squares of the tangents' lengths, times W^2.
  const auto square3 = [&](Vec p, Vec q, Vec r) HWY_ATTR { return hn::MulAdd(p, p, hn::MulAdd(q, q, hn::Mul(r, r))); };
  const Vec a2 = square3(fxa, fya, hn::Mul(ka, key_scale)), b2 = square3(fxb, fyb, hn::Mul(kb, key_scale));
  // The tangents, taken before the step, differ from those after it by 2 bend step at most.
  const Vec turn = hn::Mul(hn::Mul(hn::Set(d, 2.0 / normal_tolerance * view.piece.bend), step), weight);
  out.accurate = hn::And(out.accurate, hn::Le(hn::Mul(turn, turn), hn::Min(a2, b2)));
  const Vec n2 = hn::Mul(square3(ux, uy, hn::Set(d, 1.0)), hn::Mul(determinant, determinant));
  const Vec degenerate = hn::Set(d, kDegenerate * kDegenerate);
  out.regular = hn::And(hn::Gt(n2, hn::Mul(hn::Set(d, kFlat * kFlat), hn::Mul(a2, b2))),
                        hn::And(hn::Ge(a2, hn::Mul(degenerate, b2)), hn::Ge(b2, hn::Mul(degenerate, a2))));
}

using FloatLanes = hn::Rebind<float, Lanes>;
using FloatVec = hn::Vec<FloatLanes>;

struct Shade {
  FloatVec red, green, blue;
};

// As shade() in raster/shade.h, in single precision; `nx` .. `nz` a normal in eye space of any length, `x` and `y`
// pixel positions.
HWY_INLINE Shade shade_lanes(Lanes d, const View& view, Vec nx, Vec ny, Vec nz, Vec x, Vec y) {
  const FloatLanes df;
  const auto set = [&](double value) HWY_ATTR { return hn::Set(df, float(value)); };
  const auto square3 = [&](FloatVec p, FloatVec q, FloatVec r)
                           HWY_ATTR { return hn::MulAdd(p, p, hn::MulAdd(q, q, hn::Mul(r, r))); };
  const Camera& camera = view.camera;
  const FloatVec one = set(1.0), zero = hn::Zero(df);
  FloatVec fx = hn::DemoteTo(df, nx), fy = hn::DemoteTo(df, ny), fz = hn::DemoteTo(df, nz);
  const FloatVec inverse = hn::Div(one, hn::Sqrt(square3(fx, fy, fz)));
  fx = hn::Mul(fx, inverse), fy = hn::Mul(fy, inverse), fz = hn::Mul(fz, inverse);
  const auto dot = [&](FloatVec px, FloatVec py, FloatVec pz)
                       HWY_ATTR { return hn::MulAdd(fx, px, hn::MulAdd(fy, py, hn::Mul(fz, pz))); };
  FloatVec facing, gloss;
  if (camera.perspective) {
    const FloatVec scale = set(camera.scale);
    FloatVec ex = hn::DemoteTo(df, hn::Sub(hn::Set(d, 0.5 * camera.width), x));
    FloatVec ey = hn::DemoteTo(df, hn::Sub(y, hn::Set(d, 0.5 * camera.height))), ez = hn::Neg(scale);
    const FloatVec length = hn::Div(one, hn::Sqrt(square3(ex, ey, ez)));
    ex = hn::Mul(ex, length), ey = hn::Mul(ey, length), ez = hn::Mul(ez, length);
    facing = dot(ex, ey, ez);
    const FloatVec hx = hn::Add(ex, set(kKeyLight[0])), hy = hn::Add(ey, set(kKeyLight[1]));
    const FloatVec hz = hn::Add(ez, set(kKeyLight[2]));
    gloss = hn::Div(dot(hx, hy, hz), hn::Sqrt(square3(hx, hy, hz)));
  } else {
    facing = fz;
    gloss = dot(set(view.half[0]), set(view.half[1]), set(view.half[2]));
  }
  facing = hn::Min(one, hn::Abs(facing)), gloss = hn::Max(zero, gloss);
  const FloatVec key = hn::Max(zero, dot(set(kKeyLight[0]), set(kKeyLight[1]), set(kKeyLight[2])));
  const FloatVec up = dot(set(camera.right[2]), set(camera.up[2]), set(camera.forward[2]));
  const FloatVec g2 = hn::Mul(gloss, gloss), g4 = hn::Mul(g2, g2), g8 = hn::Mul(g4, g4), g16 = hn::Mul(g8, g8);
  FloatVec diffuse = hn::MulAdd(set(0.5 * kSky), up, set(kAmbient + 0.5 * kSky));
  diffuse = hn::MulAdd(set(kFacing), facing, diffuse);
  diffuse = hn::MulAdd(set(kKey), key, diffuse);
  const FloatVec highlight = hn::Mul(set(kGloss), hn::Mul(g16, g16));
  const auto channel = [&](int c) HWY_ATTR {
    return hn::Min(one, hn::MulAdd(hn::Set(df, view.color[c]), diffuse, highlight));
  };
  return {channel(0), channel(1), channel(2)};
}

HWY_INLINE void write_normal(Lanes d, const View& view, std::size_t at, int count, Vec nx, Vec ny, Vec nz) {
  const FloatLanes df;
  const Vec length2 = hn::MulAdd(nx, nx, hn::MulAdd(ny, ny, hn::Mul(nz, nz)));
  const Vec inverse = hn::Div(hn::Set(d, 1.0), hn::Sqrt(length2));
  const auto world = [&](int c) HWY_ATTR {
    const Camera& camera = view.camera;
    const Vec r = hn::Set(d, camera.right[c]), u = hn::Set(d, camera.up[c]), f = hn::Set(d, camera.forward[c]);
    return hn::DemoteTo(df, hn::Mul(inverse, hn::MulAdd(nx, r, hn::MulAdd(ny, u, hn::Mul(nz, f)))));
  };
  HWY_ALIGN float part[3 * 8];
  hn::StoreInterleaved3(world(0), world(1), world(2), df, part);
  std::copy_n(part, 3 * count, view.frame.normal + 3 * at);
}

// Writes the colour and depth of the `count` pixels from index `at` of the frame on.
HWY_INLINE void write_lanes(Lanes d, const View& view, std::size_t at, int count, Vec key, Vec nx, Vec ny, Vec nz,
                            Vec x, Vec y) {
  const Frame& frame = view.frame;
  const int width = int(hn::Lanes(d));
  if (frame.depth) {
    const Vec depth = view.camera.perspective ? hn::Div(hn::Set(d, -1.0), key) : key;
    if (count == width) {
      hn::StoreU(depth, d, frame.depth + at);
    } else {
      HWY_ALIGN double part[8];
      hn::Store(depth, d, part);
      std::copy_n(part, count, frame.depth + at);
    }
  }
  if (frame.color) {
    const FloatLanes df;
    const Shade rgb = shade_lanes(d, view, nx, ny, nz, x, y);
    float* out = frame.color + 4 * at;
    HWY_ALIGN float part[4 * 8];
    hn::StoreInterleaved4(rgb.red, rgb.green, rgb.blue, hn::Set(df, 1.0f), df, count == width ? out : part);
    if (count != width) std::copy_n(part, 4 * count, out);
  }
}

// A whole piece whose key plane is exact: depth is linear and the normal the same everywhere.
void SolvePlanar(const View& view, const PixelJob* jobs, std::size_t count) {
  const Lanes d;
  const Camera& camera = view.camera;
  const KeyPlane& plane = view.piece.key_plane;
  const int width = int(hn::Lanes(d));
  const double at_centre = plane.key(0.5 * camera.width, 0.5 * camera.height);
  const double size = camera.perspective ? std::max(std::fabs(at_centre), view.piece.key.magnitude()) : 1.0;
  const double nz = camera.perspective ? at_centre / size : -1.0;
  const Vec nx = hn::Set(d, camera.scale * plane.by_x / size), ny = hn::Set(d, -camera.scale * plane.by_y / size);
  const Vec along = hn::Set(d, plane.by_x), step = hn::Set(d, double(width));
  for (const PixelJob *job = jobs, *end = jobs + count; job != end; ++job) {
    const Vec y = hn::Set(d, job->row + 0.5), level = hn::Set(d, plane.at + plane.by_y * (job->row + 0.5));
    Vec x = hn::Add(hn::Iota(d, 0.0), hn::Set(d, job->first + 0.5));
    const std::size_t row = std::size_t(job->row) * view.frame.width;
    for (int px = job->first; px < job->last; px += width, x = hn::Add(x, step)) {
      const int part = std::min(width, job->last - px);
      write_lanes(d, view, row + px, part, hn::MulAdd(along, x, level), nx, ny, hn::Set(d, nz), x, y);
      if (view.frame.normal) write_normal(d, view, row + px, part, nx, ny, hn::Set(d, nz));
    }
  }
}

// Pixels solved first, between which the parameters are guessed by polynomials: the first and the last of each job and
// some between. Those of all jobs on a piece are solved together, a knot in each lane.
struct Knots {
  static constexpr int kSpacing = 32;  // pixels, at most
  static constexpr int kWidest = 8;    // pixels a vector, at most

  std::vector<double> x, y, progress, a, b;
  std::vector<double> a_lo, a_hi;              // of the knot's span
  std::vector<double> a_slope, b_slope, rate;  // da and db by the progress; dx / dprogress

  // Pixels from knot to knot, whole vectors of them: at least two intervals where there are two vectors.
  static int spacing(const PixelJob& job) {
    const int last = job.last - job.first - 1, most = std::max(2, (last + kSpacing - 1) / kSpacing);
    return std::max(1, (last + kWidest * most - 1) / (kWidest * most)) * kWidest;
  }
  static int intervals(const PixelJob& job) {
    return std::max(1, (job.last - job.first - 1 + spacing(job) - 1) / spacing(job));
  }

  void gather(const PixelJob* jobs, std::size_t count) {
    for (std::vector<double>* list : lists()) list->clear();
    for (const PixelJob *job = jobs, *end = jobs + count; job != end; ++job) {
      const int n = intervals(*job), last = job->last - job->first - 1;
      const int step = spacing(*job);
      for (int k = 0; k <= n; ++k) add(*job, job->first + 0.5 + std::min(k * step, last));
    }
    const std::size_t size = x.size();
    for (std::vector<double>* list : lists()) {
      list->resize((size + 7) / 8 * 8, list->back());
    }
  }

 private:
  std::array<std::vector<double>*, 10> lists() {
    return {&x, &y, &progress, &a, &b, &a_lo, &a_hi, &a_slope, &b_slope, &rate};
  }
  void add(const PixelJob& job, double at) {
    const Span& span = *job.span;
    const SpanProgress along(span);
    const double t = along.at(at);
    x.push_back(at), y.push_back(job.row + 0.5), progress.push_back(t);
    a.push_back(span.a0 + t * (span.a1 - span.a0)), b.push_back(span.b0 + t * (span.b1 - span.b0));
    a_lo.push_back(std::min(span.a0, span.a1)), a_hi.push_back(std::max(span.a0, span.a1));
    a_slope.push_back(0.0), b_slope.push_back(0.0), rate.push_back(along.rate(t));
  }
};

// NetKind: Net or CentredNet.
template <class NetKind>
struct SolveCurved {
  const View& view;
  const NetKind& net;
  const PixelJob* jobs;
  std::size_t count;
  std::vector<HardPixel>& hard;

  template <int kN, int kM, bool kRational>
  HWY_ATTR void operator()() const {
    thread_local Knots knots;
    knots.gather(jobs, count);
    solve_knots<kN, kM, kRational>(knots);
    std::size_t first_knot = 0;
    for (std::size_t k = 0; k < count; ++k) {
      solve<kN, kM, kRational>(jobs[k], knots, first_knot);
      first_knot += Knots::intervals(jobs[k]) + 1;
    }
  }

 private:
  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve_knots(Knots& knots) const {
    const Lanes d;
    for (std::size_t k = 0; k < knots.x.size(); k += hn::Lanes(d)) {
      const SpanBox box(d, hn::LoadU(d, knots.a_lo.data() + k), hn::LoadU(d, knots.a_hi.data() + k));
      Vec a = hn::LoadU(d, knots.a.data() + k), b = hn::LoadU(d, knots.b.data() + k);
      LaneScreen s;
      solve_on_span<kN, kM, kRational>(d, net, box, hn::LoadU(d, knots.x.data() + k), hn::LoadU(d, knots.y.data() + k),
                                       kMaxKnotNewton, kKnotStep, a, b, s);
      const Vec rate = hn::LoadU(d, knots.rate.data() + k);
      const Vec scale = hn::Div(rate, hn::MulSub(s.xa, s.yb, hn::Mul(s.xb, s.ya)));
      hn::StoreU(a, d, knots.a.data() + k), hn::StoreU(b, d, knots.b.data() + k);
      hn::StoreU(hn::Mul(s.yb, scale), d, knots.a_slope.data() + k);
      hn::StoreU(hn::Neg(hn::Mul(s.ya, scale)), d, knots.b_slope.data() + k);
    }
  }

  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve(const PixelJob& job, const Knots& knots, std::size_t knot) const {
    const Lanes d;
    const int width = int(hn::Lanes(d));
    const Span& span = *job.span;
    const SpanBox box(d, hn::Set(d, std::min(span.a0, span.a1)), hn::Set(d, std::max(span.a0, span.a1)));
    const SpanProgress progress(span);
    const Vec lane = hn::Iota(d, 0.5), right = hn::Set(d, job.last - 0.5);
    const int n = Knots::intervals(job), spacing = Knots::spacing(job);
    // Two intervals at a time; the last one alone, with the knot before it.
    for (int k = 0; k < n; k += 2) {
      const std::size_t at = knot + (n > 1 ? std::min(k, n - 2) : 0);
      const int order = n > 1 ? 3 : 2;
      const Guess guess_a(&knots.progress[at], &knots.a[at], &knots.a_slope[at], order);
      const Guess guess_b(&knots.progress[at], &knots.b[at], &knots.b_slope[at], order);
      const int end = k + 2 >= n ? job.last : job.first + (k + 2) * spacing;
      for (int px = job.first + k * spacing; px < end; px += width) {
        const Vec x = hn::Min(hn::Add(lane, hn::Set(d, double(px))), right);
        const Vec t = progress.at(d, x);
        solve_vector<kN, kM, kRational>(job, px, std::min(width, end - px), box, x, guess_a.at(d, t), guess_b.at(d, t));
      }
    }
  }

  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve_vector(const PixelJob& job, int px, int count, const SpanBox& box, Vec x, Vec a, Vec b) const {
    const Lanes d;
    const Vec y = hn::Set(d, job.row + 0.5);
    const Origin origin = origin_of(net);
    LaneJet jet;
    Point point;
    const auto iterate = [&](int iterations, double normal_tolerance) HWY_ATTR {
      for (int iteration = 1;; ++iteration) {
        box.clamp(a, b);
        evaluate_lanes<kN, kM, kRational>(d, net, a, b, jet);
        newton_step<kRational>(d, view, origin, jet, x, y, normal_tolerance, point);
        a = hn::Add(a, point.da), b = hn::Add(b, point.db);
        if (iteration == iterations || hn::AllTrue(d, point.accurate)) break;
      }
      return hn::And(hn::And(point.accurate, point.regular), box.contains(a, b));
    };
    const std::size_t at = std::size_t(job.row) * view.frame.width + px;
    const Mask sound = iterate(kMaxPixelNewton, kShadeTolerance);
    if (view.values) write_lanes(d, view, at, count, point.key, point.nx, point.ny, point.nz, x, y);
    if (view.frame.uv) write_uv(d, at, count, a, b);
    if (!hn::AllTrue(d, sound))
      queue_hard(d, job, px, count, sound, {nullptr, 0, 0, view.values, false, view.frame.uv != nullptr});
    if (!view.frame.normal || !view.values) return;
    const Mask exact = iterate(2, kNormalTolerance);
    write_normal(d, view, at, count, point.nx, point.ny, point.nz);
    if (!hn::AllTrue(d, exact)) queue_hard(d, job, px, count, exact, {nullptr, 0, 0, false, true, false});
  }

  HWY_INLINE void write_uv(Lanes d, std::size_t at, int count, Vec a, Vec b) const {
    HWY_ALIGN double part_a[8], part_b[8];
    hn::Store(a, d, part_a), hn::Store(b, d, part_b);
    for (int k = 0; k < count; ++k) {
      view.piece.face_from_local(part_a[k], part_b[k], view.frame.uv + 2 * (at + k), view.frame.uv + 2 * (at + k) + 1);
    }
  }

  HWY_NOINLINE void queue_hard(Lanes d, const PixelJob& job, int px, int count, Mask sound, HardPixel what) const {
    HWY_ALIGN double flags[8];
    hn::Store(hn::IfThenElse(sound, hn::Set(d, 1.0), hn::Zero(d)), d, flags);
    what.span = job.span, what.row = job.row;
    for (int k = 0; k < count; ++k) {
      what.px = px + k;
      if (flags[k] == 0.0) hard.push_back(what);
    }
  }
};

void SolvePixels(const Camera& camera, const Frame& frame, const Piece& piece, const float* color, const PixelJob* jobs,
                 std::size_t count, std::vector<HardPixel>& hard) {
  // Planes have a short way to all but uv.
  const View view(camera, frame, piece, color, !piece.planar);
  if (piece.planar) SolvePlanar(view, jobs, count);
  if (piece.planar && !frame.uv) return;
  thread_local std::vector<double> storage;
  const CentredNet centred = centre_net(piece.net, storage);
  if (centred.error < kCentredTolerance) {
    for_degrees(piece.net.n, piece.net.m, piece.rational, SolveCurved<CentredNet>{view, centred, jobs, count, hard});
  } else {
    SolveCurved<Net>{view, piece.net, jobs, count, hard}.template operator()<-1, -1, true>();
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(SolvePixels);

void solve_pixels(const Scene& scene, const Camera& camera, const Frame& frame, const Piece& piece,
                  const PixelJob* jobs, std::size_t count, std::vector<HardPixel>& hard) {
  for (const PixelJob *job = jobs, *end = jobs + count; job != end && frame.face; ++job) {
    int32_t* row = frame.face + std::size_t(job->row) * frame.width;
    fill(row + job->first, job->last - job->first, piece.face);
  }
  if ((piece.kind > CutKind::fold || is_tiny(piece)) && !piece.planar) {
    for (const PixelJob *job = jobs, *end = jobs + count; job != end; ++job) {
      for (int px = job->first; px < job->last; ++px) {
        hard.push_back({job->span, job->row, px, true, frame.normal != nullptr, frame.uv != nullptr});
      }
    }
    return;
  }
  const float* color = scene.model.face_color + 4 * std::size_t(piece.face);
  HWY_DYNAMIC_DISPATCH(SolvePixels)(camera, frame, piece, color, jobs, count, hard);
}

void solve_hard_pixel(const Scene& scene, const Camera& camera, const Frame& frame, const HardPixel& pixel) {
  const Span& span = *pixel.span;
  const Piece& piece = *span.piece;
  const double x = pixel.px + 0.5, y = pixel.row + 0.5;
  const double fraction = std::clamp((x - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  SurfaceSample sample{span.a0 + fraction * (span.a1 - span.a0), span.b0 + fraction * (span.b1 - span.b0), {}};
  solve_sample(span, x, y, &sample);
  const std::size_t at = std::size_t(pixel.row) * frame.width + pixel.px;
  if (pixel.uv) piece.face_from_local(sample.a, sample.b, frame.uv + 2 * at, frame.uv + 2 * at + 1);
  if (pixel.values && frame.depth) frame.depth[at] = camera.depth(sample.jet.p);
  if (!pixel.normal && !(pixel.values && frame.color)) return;
  double n[3];
  surface_normal(scene, piece, camera, sample, n);
  if (pixel.normal) {
    for (int c = 0; c < 3; ++c) {
      frame.normal[3 * at + c] = float(n[0] * camera.right[c] + n[1] * camera.up[c] + n[2] * camera.forward[c]);
    }
  }
  if (!pixel.values || !frame.color) return;
  shade(camera, sample, n, scene.model.face_color + 4 * std::size_t(piece.face), frame.color + 4 * at);
  frame.color[4 * at + 3] = 1.0f;
}

}  // namespace nofacet
#endif

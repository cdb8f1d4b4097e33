// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/solve_pixels.cpp"
#include "raster/solve_pixels.h"

#include <algorithm>
#include <cmath>

#include "hwy/foreach_target.h"
#include "raster/lanes-inl.h"
#include "raster/shade.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

constexpr int kMaxKnots = 8;
constexpr int kMaxKnotNewton = 8, kMaxPixelNewton = 4;
// Largest change of direction, in radians, of the tangents that a normal is made of, as stored and for shading.
constexpr double kNormalTolerance = 3e-8, kShadeTolerance = 1e-4;
constexpr double kKnotStep = 1e-5;  // knots only guide: pixels are judged by themselves

// A cubic in t for first guesses between two knots.
struct Cubic {
  double c0, c1, c2, c3;

  static Cubic hermite(double p0, double m0, double p1, double m1) {
    return {p0, m0, 3 * (p1 - p0) - 2 * m0 - m1, 2 * (p0 - p1) + m0 + m1};
  }
  HWY_INLINE Vec at(Lanes d, Vec t) const {
    Vec r = hn::MulAdd(hn::Set(d, c3), t, hn::Set(d, c2));
    r = hn::MulAdd(r, t, hn::Set(d, c1));
    return hn::MulAdd(r, t, hn::Set(d, c0));
  }
};

// Along a span the parameters are smooth in this: x, or beside a fold the root of the distance from it.
class SpanProgress {
 public:
  explicit SpanProgress(const Span& span)
      : fold0_(span.fold0), fold1_(span.fold1), x0_(span.x0), x1_(span.x1), scale_(1.0 / (span.x1 - span.x0)) {}

  HWY_INLINE Vec at(Lanes d, Vec x) const {
    const Vec zero = hn::Zero(d), one = hn::Set(d, 1.0), scale = hn::Set(d, scale_);
    const Vec t = hn::Min(hn::Max(hn::Mul(hn::Sub(x, hn::Set(d, x0_)), scale), zero), one);
    if (fold0_) return hn::Sqrt(t);
    if (fold1_) return hn::Sub(one, hn::Sqrt(hn::Max(hn::Mul(hn::Sub(hn::Set(d, x1_), x), scale), zero)));
    return t;
  }
  // dx / dprogress.
  double rate(double progress) const {
    const double length = 1.0 / scale_;
    return fold0_ ? 2.0 * length * progress : fold1_ ? 2.0 * length * (1.0 - progress) : length;
  }

 private:
  bool fold0_, fold1_;
  double x0_, x1_, scale_;
};

// What does not change from pixel to pixel of a piece.
struct View {
  const Camera& camera;
  const Frame& frame;
  const Piece& piece;
  const float* color;
};

// Screen position, surface normal (eye space, not normalised) and Newton step of one group of pixels.
struct Point {
  Vec key, nx, ny, nz, da, db;
  Mask accurate, regular;  // the step's remainder is small; the normal is sound
};

template <bool kRational>
HWY_INLINE void newton_step(Lanes d, const View& view, const LaneJet& jet, Vec x, Vec y, double normal_tolerance,
                            Point& out) {
  LaneScreen s;
  to_screen<kRational>(d, jet, s);
  const Vec j = hn::MulSub(s.xa, s.yb, hn::Mul(s.xb, s.ya));
  const Vec inverse = hn::Div(hn::Set(d, 1.0), j);
  const Vec rx = hn::Sub(x, s.x), ry = hn::Sub(y, s.y);
  out.da = hn::Mul(hn::MulSub(rx, s.yb, hn::Mul(ry, s.xb)), inverse);
  out.db = hn::Mul(hn::MulSub(ry, s.xa, hn::Mul(rx, s.ya)), inverse);
  const Vec step = hn::Max(hn::Abs(out.da), hn::Abs(out.db));

  // The plane tangent to the surface: J dkey = by_x dx + by_y dy.
  const Vec by_x = hn::MulSub(s.ka, s.yb, hn::Mul(s.kb, s.ya)), by_y = hn::MulSub(s.kb, s.xa, hn::Mul(s.ka, s.xb));
  const Camera& camera = view.camera;
  const Vec scale = hn::Set(d, camera.scale);
  const bool perspective = kRational && camera.perspective;
  const Vec key_scale = perspective ? hn::Div(scale, hn::Abs(s.key)) : scale;
  const Vec ux = hn::Mul(by_x, key_scale), uy = hn::Mul(by_y, key_scale), uj = hn::Abs(j);
  // Towards the eye: the sign of J (orthographic: of -nz; perspective: -J is the product with the point itself).
  const Vec side = hn::CopySignToAbs(hn::Set(d, 1.0), j);
  if (perspective) {
    const Vec cx = hn::Set(d, 0.5 * camera.width), cy = hn::Set(d, 0.5 * camera.height);
    const Vec nz = hn::MulAdd(hn::Sub(cx, s.x), by_x, hn::MulAdd(hn::Sub(cy, s.y), by_y, hn::Mul(s.key, j)));
    out.nx = hn::Mul(side, hn::Mul(scale, by_x)), out.ny = hn::Mul(side, hn::Neg(hn::Mul(scale, by_y)));
    out.nz = hn::Mul(side, nz);
  } else {
    out.nx = hn::Mul(side, ux), out.ny = hn::Neg(hn::Mul(side, uy)), out.nz = hn::Neg(uj);
  }
  const Vec remainder = hn::Mul(hn::Mul(hn::Set(d, view.piece.bend), hn::Mul(step, step)),
                                hn::Add(uj, hn::Add(hn::Abs(ux), hn::Abs(uy))));
  out.accurate = hn::Le(remainder, hn::Mul(hn::Set(d, kPixelTolerance), uj));
  const auto square3 = [&](Vec p, Vec q, Vec r) HWY_ATTR { return hn::MulAdd(p, p, hn::MulAdd(q, q, hn::Mul(r, r))); };
  const Vec a2 = square3(s.xa, s.ya, hn::Mul(s.ka, key_scale)), b2 = square3(s.xb, s.yb, hn::Mul(s.kb, key_scale));
  // The tangents, taken before the step, differ from those after it by 2 bend step at most.
  const Vec turn = hn::Mul(hn::Set(d, 2.0 / normal_tolerance * view.piece.bend), step);
  out.accurate = hn::And(out.accurate, hn::Le(hn::Mul(turn, turn), hn::Min(a2, b2)));
  const Vec n2 = square3(ux, uy, j), degenerate = hn::Set(d, kDegenerate * kDegenerate);
  out.regular = hn::And(hn::Gt(n2, hn::Mul(hn::Set(d, kFlat * kFlat), hn::Mul(a2, b2))),
                        hn::And(hn::Ge(a2, hn::Mul(degenerate, b2)), hn::Ge(b2, hn::Mul(degenerate, a2))));
}

// The buffers' values of a group of pixels.
struct Shade {
  Vec red, green, blue;
};

// As shade() in raster/shade.h; `nx` .. `nz` a unit normal in eye space, `x` and `y` pixel positions.
HWY_INLINE Shade shade_lanes(Lanes d, const View& view, Vec nx, Vec ny, Vec nz, Vec x, Vec y) {
  const Camera& camera = view.camera;
  const Vec one = hn::Set(d, 1.0), zero = hn::Zero(d);
  const auto dot = [&](Vec px, Vec py, Vec pz) HWY_ATTR {
    return hn::MulAdd(nx, px, hn::MulAdd(ny, py, hn::Mul(nz, pz)));
  };
  const Vec kx = hn::Set(d, kKeyLight[0]), ky = hn::Set(d, kKeyLight[1]), kz = hn::Set(d, kKeyLight[2]);
  Vec ex = zero, ey = zero, ez = hn::Neg(one);  // towards the eye
  Vec hx = kx, hy = ky, hz = hn::Set(d, kKeyLight[2] - 1.0), h2;
  if (camera.perspective) {
    const Vec scale = hn::Set(d, camera.scale);
    ex = hn::Sub(hn::Set(d, 0.5 * camera.width), x), ey = hn::Sub(y, hn::Set(d, 0.5 * camera.height));
    const Vec length = hn::Sqrt(hn::MulAdd(ex, ex, hn::MulAdd(ey, ey, hn::Mul(scale, scale))));
    const Vec inverse = hn::Div(one, length);
    ex = hn::Mul(ex, inverse), ey = hn::Mul(ey, inverse), ez = hn::Neg(hn::Mul(scale, inverse));
    hx = hn::Add(kx, ex), hy = hn::Add(ky, ey), hz = hn::Add(kz, ez);
  }
  h2 = hn::MulAdd(hx, hx, hn::MulAdd(hy, hy, hn::Mul(hz, hz)));
  const Vec facing = hn::Min(one, hn::Abs(dot(ex, ey, ez)));
  const Vec key = hn::Max(zero, dot(kx, ky, kz));
  const Vec up = dot(hn::Set(d, camera.right[2]), hn::Set(d, camera.up[2]), hn::Set(d, camera.forward[2]));
  const Vec gloss = hn::Max(zero, hn::Div(dot(hx, hy, hz), hn::Sqrt(h2)));
  const Vec g2 = hn::Mul(gloss, gloss), g4 = hn::Mul(g2, g2), g8 = hn::Mul(g4, g4), g16 = hn::Mul(g8, g8);
  Vec diffuse = hn::MulAdd(hn::Set(d, 0.5 * kSky), up, hn::Set(d, kAmbient + 0.5 * kSky));
  diffuse = hn::MulAdd(hn::Set(d, kFacing), facing, diffuse);
  diffuse = hn::MulAdd(hn::Set(d, kKey), key, diffuse);
  const Vec highlight = hn::Mul(hn::Set(d, kGloss), hn::Mul(g16, g16));
  const auto channel = [&](int c) HWY_ATTR {
    return hn::Min(one, hn::MulAdd(hn::Set(d, double(view.color[c])), diffuse, highlight));
  };
  return {channel(0), channel(1), channel(2)};
}

// Writes the colour, normal and depth of the `count` pixels from index `at` of the frame on.
HWY_INLINE void write_lanes(Lanes d, const View& view, std::size_t at, int count, Vec key, Vec nx, Vec ny, Vec nz, Vec x,
                            Vec y) {
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
  if (!frame.color && !frame.normal) return;
  const Vec length2 = hn::MulAdd(nx, nx, hn::MulAdd(ny, ny, hn::Mul(nz, nz)));
  const Vec inverse = hn::Div(hn::Set(d, 1.0), hn::Sqrt(length2));
  nx = hn::Mul(nx, inverse), ny = hn::Mul(ny, inverse), nz = hn::Mul(nz, inverse);
  const hn::Rebind<float, Lanes> df;
  HWY_ALIGN float part[4 * 8];
  if (frame.color) {
    const Shade rgb = shade_lanes(d, view, nx, ny, nz, x, y);
    const auto red = hn::DemoteTo(df, rgb.red), green = hn::DemoteTo(df, rgb.green), blue = hn::DemoteTo(df, rgb.blue);
    float* out = frame.color + 4 * at;
    hn::StoreInterleaved4(red, green, blue, hn::Set(df, 1.0f), df, count == width ? out : part);
    if (count != width) std::copy_n(part, 4 * count, out);
  }
  if (frame.normal) {
    const auto world = [&](int c) HWY_ATTR {
      const Camera& camera = view.camera;
      const Vec r = hn::Set(d, camera.right[c]), u = hn::Set(d, camera.up[c]), f = hn::Set(d, camera.forward[c]);
      return hn::DemoteTo(df, hn::MulAdd(nx, r, hn::MulAdd(ny, u, hn::Mul(nz, f))));
    };
    hn::StoreInterleaved3(world(0), world(1), world(2), df, part);
    std::copy_n(part, 3 * count, frame.normal + 3 * at);
  }
}

// A whole piece whose key plane is exact: depth is linear and the normal the same everywhere.
void SolvePlanar(const View& view, const PixelJob* jobs, std::size_t count) {
  const Lanes d;
  const Camera& camera = view.camera;
  const KeyPlane& plane = view.piece.key_plane;
  const int width = int(hn::Lanes(d));
  const double nz =
      camera.perspective ? plane.by_x * 0.5 * camera.width + plane.by_y * 0.5 * camera.height + plane.at : -1.0;
  const Vec nx = hn::Set(d, camera.scale * plane.by_x), ny = hn::Set(d, -camera.scale * plane.by_y);
  const Vec along = hn::Set(d, plane.by_x), step = hn::Set(d, double(width));
  for (const PixelJob *job = jobs, *end = jobs + count; job != end; ++job) {
    const Vec y = hn::Set(d, job->row + 0.5), level = hn::Set(d, plane.at + plane.by_y * (job->row + 0.5));
    Vec x = hn::Add(hn::Iota(d, 0.0), hn::Set(d, job->first + 0.5));
    const std::size_t row = std::size_t(job->row) * view.frame.width;
    for (int px = job->first; px < job->last; px += width, x = hn::Add(x, step)) {
      write_lanes(d, view, row + px, std::min(width, job->last - px), hn::MulAdd(along, x, level), nx, ny,
                  hn::Set(d, nz), x, y);
    }
  }
}

struct SolveCurved {
  const View& view;
  const PixelJob* jobs;
  std::size_t count;
  std::vector<PixelJob>& failed;

  template <int kN, int kM, bool kRational>
  HWY_ATTR void operator()() const {
    for (std::size_t k = 0; k < count; ++k) solve<kN, kM, kRational>(jobs[k]);
  }

 private:
  // The parameters' box of one span.
  struct Box {
    Vec a_lo, a_hi, b_lo, b_hi;

    HWY_INLINE Box(Lanes d, const Span& span)
        : a_lo(hn::Set(d, std::min(span.a0, span.a1))),
          a_hi(hn::Set(d, std::max(span.a0, span.a1))),
          b_lo(hn::Zero(d)),
          b_hi(hn::Set(d, 1.0)) {}
    HWY_INLINE void clamp(Vec& a, Vec& b) const {
      a = hn::Min(hn::Max(a, a_lo), a_hi), b = hn::Min(hn::Max(b, b_lo), b_hi);
    }
    HWY_INLINE Mask contains(Vec a, Vec b) const {
      return hn::And(hn::And(hn::Ge(a, a_lo), hn::Le(a, a_hi)), hn::And(hn::Ge(b, b_lo), hn::Le(b, b_hi)));
    }
  };

  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve(const PixelJob& job) const {
    const Lanes d;
    const int width = int(hn::Lanes(d)), length = job.last - job.first;
    const Span& span = *job.span;
    const Box box(d, span);
    const SpanProgress progress(span);
    const Vec lane = hn::Iota(d, 0.0);
    // Knots every `spacing` pixels, a whole number of vectors apart, and at the last pixel.
    const int spacing = width * ((length - 1 + width * (kMaxKnots - 1) - 1) / (width * (kMaxKnots - 1)));
    Cubic guess_a{span.a0, span.a1 - span.a0, 0, 0}, guess_b{span.b0, span.b1 - span.b0, 0, 0};
    Knots knots;
    const bool with_knots = length > 2 * width;
    if (with_knots) find_knots<kN, kM, kRational>(job, spacing, box, progress, knots);
    double from = 0.0, scale = 1.0;  // of the progress within one interval
    for (int offset = 0; offset < length; offset += width) {
      if (with_knots && offset % spacing == 0) {
        const int k = std::min(offset / spacing, knots.count - 2);
        const double h = knots.progress[k + 1] - knots.progress[k];
        from = knots.progress[k], scale = 1.0 / h;
        guess_a = Cubic::hermite(knots.a[k], h * knots.a_slope[k], knots.a[k + 1], h * knots.a_slope[k + 1]);
        guess_b = Cubic::hermite(knots.b[k], h * knots.b_slope[k], knots.b[k + 1], h * knots.b_slope[k + 1]);
      }
      const int px = job.first + offset;
      const Vec x = hn::Min(hn::Add(lane, hn::Set(d, px + 0.5)), hn::Set(d, job.last - 0.5));
      const Vec t = hn::Mul(hn::Sub(progress.at(d, x), hn::Set(d, from)), hn::Set(d, scale));
      solve_vector<kN, kM, kRational>(job, px, box, x, guess_a.at(d, t), guess_b.at(d, t));
    }
  }

  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve_vector(const PixelJob& job, int px, const Box& box, Vec x, Vec a, Vec b) const {
    const Lanes d;
    const Vec y = hn::Set(d, job.row + 0.5);
    const double normal_tolerance = view.frame.normal ? kNormalTolerance : kShadeTolerance;
    LaneJet jet;
    Point point;
    for (int iteration = 1;; ++iteration) {
      box.clamp(a, b);
      evaluate_lanes<kN, kM, kRational>(d, view.piece.net, a, b, jet);
      newton_step<kRational>(d, view, jet, x, y, normal_tolerance, point);
      a = hn::Add(a, point.da), b = hn::Add(b, point.db);
      if (iteration == kMaxPixelNewton || hn::AllTrue(d, point.accurate)) break;
    }
    Vec key = hn::MulAdd(point.da, jet.pa[kZ], hn::MulAdd(point.db, jet.pb[kZ], jet.p[kZ]));
    if constexpr (kRational) {
      key = hn::Div(key, hn::MulAdd(point.da, jet.pa[kW], hn::MulAdd(point.db, jet.pb[kW], jet.p[kW])));
    }
    const int count = std::min(int(hn::Lanes(d)), job.last - px);
    const std::size_t at = std::size_t(job.row) * view.frame.width + px;
    write_lanes(d, view, at, count, key, point.nx, point.ny, point.nz, x, y);
    if (view.frame.uv) write_uv(d, at, count, a, b);
    const Mask sound = hn::And(hn::And(point.accurate, point.regular), box.contains(a, b));
    if (!hn::AllTrue(d, sound)) queue_failed(d, job, px, count, sound);
  }

  HWY_INLINE void write_uv(Lanes d, std::size_t at, int count, Vec a, Vec b) const {
    HWY_ALIGN double part_a[8], part_b[8];
    hn::Store(a, d, part_a), hn::Store(b, d, part_b);
    for (int k = 0; k < count; ++k) {
      view.piece.face_from_local(part_a[k], part_b[k], view.frame.uv + 2 * (at + k), view.frame.uv + 2 * (at + k) + 1);
    }
  }

  HWY_NOINLINE void queue_failed(Lanes d, const PixelJob& job, int px, int count, Mask sound) const {
    HWY_ALIGN double flags[8];
    hn::Store(hn::IfThenElse(sound, hn::Set(d, 1.0), hn::Zero(d)), d, flags);
    for (int k = 0; k < count; ++k) {
      if (flags[k] == 0.0) failed.push_back({job.span, job.row, px + k, px + k + 1});
    }
  }

  // Points of the span, solved first; between them the parameters are guessed by cubics.
  struct Knots {
    int count;
    HWY_ALIGN double x[kMaxKnots], progress[kMaxKnots], a[kMaxKnots], b[kMaxKnots];
    HWY_ALIGN double a_slope[kMaxKnots], b_slope[kMaxKnots];  // by the progress
  };

  template <int kN, int kM, bool kRational>
  HWY_INLINE void find_knots(const PixelJob& job, int spacing, const Box& box, const SpanProgress& progress,
                             Knots& knots) const {
    const Lanes d;
    const Span& span = *job.span;
    const int last = job.last - job.first - 1;
    knots.count = (last + spacing - 1) / spacing + 1;
    for (int k = 0; k < kMaxKnots; ++k) knots.x[k] = job.first + 0.5 + std::min(k * spacing, last);
    const Vec y = hn::Set(d, job.row + 0.5);
    for (int k = 0; k < knots.count; k += int(hn::Lanes(d))) {
      const Vec x = hn::Load(d, knots.x + k), t = progress.at(d, x);
      Vec a = hn::MulAdd(t, hn::Set(d, span.a1 - span.a0), hn::Set(d, span.a0));
      Vec b = hn::MulAdd(t, hn::Set(d, span.b1 - span.b0), hn::Set(d, span.b0));
      LaneScreen s;
      for (int iteration = 1;; ++iteration) {
        LaneJet jet;
        evaluate_lanes<kN, kM, kRational>(d, view.piece.net, a, b, jet);
        to_screen<kRational>(d, jet, s);
        const Vec inverse = hn::Div(hn::Set(d, 1.0), hn::MulSub(s.xa, s.yb, hn::Mul(s.xb, s.ya)));
        const Vec rx = hn::Sub(x, s.x), ry = hn::Sub(y, s.y);
        const Vec da = hn::Mul(hn::MulSub(rx, s.yb, hn::Mul(ry, s.xb)), inverse);
        const Vec db = hn::Mul(hn::MulSub(ry, s.xa, hn::Mul(rx, s.ya)), inverse);
        a = hn::Add(a, da), b = hn::Add(b, db);
        box.clamp(a, b);
        const Vec step = hn::Max(hn::Abs(da), hn::Abs(db));
        if (iteration < kMaxKnotNewton && !hn::AllTrue(d, hn::Lt(step, hn::Set(d, kKnotStep)))) continue;
        hn::Store(a, d, knots.a + k), hn::Store(b, d, knots.b + k);
        hn::Store(t, d, knots.progress + k);
        hn::Store(hn::Mul(s.yb, inverse), d, knots.a_slope + k);
        hn::Store(hn::Neg(hn::Mul(s.ya, inverse)), d, knots.b_slope + k);
        break;
      }
    }
    for (int k = 0; k < knots.count; ++k) {
      const double rate = progress.rate(knots.progress[k]);
      knots.a_slope[k] *= rate, knots.b_slope[k] *= rate;
    }
  }
};

void SolvePixels(const Camera& camera, const Frame& frame, const Piece& piece, const float* color, const PixelJob* jobs,
                 std::size_t count, std::vector<PixelJob>& failed) {
  const View view{camera, frame, piece, color};
  if (piece.planar && !frame.uv) return SolvePlanar(view, jobs, count);
  for_degrees(piece.net.n, piece.net.m, piece.rational, SolveCurved{view, jobs, count, failed});
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(SolvePixels);

void solve_pixels(const Scene& scene, const Camera& camera, const Frame& frame, const Piece& piece,
                  const PixelJob* jobs, std::size_t count, std::vector<PixelJob>& failed) {
  for (const PixelJob *job = jobs, *end = jobs + count; job != end && frame.face; ++job) {
    int32_t* row = frame.face + std::size_t(job->row) * frame.width;
    std::fill(row + job->first, row + job->last, piece.face);
  }
  if ((piece.kind > CutKind::fold || is_tiny(piece)) && !piece.planar) {
    for (const PixelJob *job = jobs, *end = jobs + count; job != end; ++job) {
      for (int px = job->first; px < job->last; ++px) failed.push_back({job->span, job->row, px, px + 1});
    }
    return;
  }
  const float* color = scene.model.face_color + 4 * std::size_t(piece.face);
  HWY_DYNAMIC_DISPATCH(SolvePixels)(camera, frame, piece, color, jobs, count, failed);
}

void solve_hard_pixel(const Scene& scene, const Camera& camera, const Frame& frame, const PixelJob& job) {
  const Span& span = *job.span;
  const Piece& piece = *span.piece;
  const double x = job.first + 0.5, y = job.row + 0.5;
  const double fraction = std::clamp((x - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  SurfaceSample sample{span.a0 + fraction * (span.a1 - span.a0), span.b0 + fraction * (span.b1 - span.b0), {}};
  solve_sample(span, x, y, &sample);
  const std::size_t at = std::size_t(job.row) * frame.width + job.first;
  if (frame.depth) frame.depth[at] = camera.depth(sample.jet.p);
  if (frame.uv) piece.face_from_local(sample.a, sample.b, frame.uv + 2 * at, frame.uv + 2 * at + 1);
  if (!frame.normal && !frame.color) return;
  double n[3];
  surface_normal(scene, piece, camera, sample, n);
  if (frame.normal) {
    for (int c = 0; c < 3; ++c) {
      frame.normal[3 * at + c] = float(n[0] * camera.right[c] + n[1] * camera.up[c] + n[2] * camera.forward[c]);
    }
  }
  if (!frame.color) return;
  shade(camera, sample, n, scene.model.face_color + 4 * std::size_t(piece.face), frame.color + 4 * at);
  frame.color[4 * at + 3] = 1.0f;
}

}  // namespace nofacet
#endif

// First guesses for the pixels of a span, from points of it solved before. Included once for every instruction set
// (Highway).
#if defined(NOFACET_RASTER_KNOTS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NOFACET_RASTER_KNOTS_LANES_INL_H_
#undef NOFACET_RASTER_KNOTS_LANES_INL_H_
#else
#define NOFACET_RASTER_KNOTS_LANES_INL_H_
#endif

#include <array>
#include <cmath>

#include "raster/solve_pixels.h"
#include "raster/span_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {

// Where the pixels of a job stand: x = x0 + length ((1 - q) p + q p^2), the progress p being 0 at its first pixel and 1
// at its last. With q from how fast x grows with a at both ends, a grows almost evenly with p: beside a fold, where
// x = p^2, as well as far from one.
class Progress {
 public:
  // `a_by_x0`, `a_by_x1`: da / dx at the ends.
  Progress(double x0, double length, double a_by_x0, double a_by_x1) : x0_(x0), length_(length), scale_(1.0 / length) {
    const double g0 = std::fabs(a_by_x0), g1 = std::fabs(a_by_x1), q = (g0 - g1) / (g0 + g1);
    // Evenly enough; at 1 the formula below would divide by zero.
    q_ = std::fabs(q) > kEven ? std::clamp(q, kSmallest - 1.0, 1.0 - kSmallest) : 0.0;
  }
  // The root of q p^2 + (1 - q) p - t by the formula in single precision, and a step of Newton's method, whose slope is
  // the formula's own square root: many times faster than a root and a division in double.
  HWY_INLINE Vec at(Lanes d, Vec x) const {
    const Vec t = hn::Mul(hn::Sub(x, hn::Set(d, x0_)), hn::Set(d, scale_));
    if (q_ == 0.0) return t;
    const hn::Rebind<float, Lanes> half;
    const Vec q = hn::Set(d, q_), linear = hn::Set(d, 1.0 - q_);
    const Vec square = hn::MulAdd(hn::Set(d, 4.0 * q_), t, hn::Mul(linear, linear));
    const auto wide = hn::Max(hn::DemoteTo(half, square), hn::Set(half, kSmallestSquare));
    const Vec by_root = hn::PromoteTo(d, inverse_root(half, wide)), root = hn::Mul(hn::PromoteTo(d, wide), by_root);
    const Vec p = hn::Mul(hn::Sub(root, linear), hn::Set(d, 0.5 / q_));
    return hn::NegMulAdd(hn::MulSub(hn::MulAdd(q, p, linear), p, t), by_root, p);
  }
  double x(double p) const { return x0_ + length_ * p * (1.0 - q_ + q_ * p); }
  // dx / dp.
  double rate(double p) const { return length_ * (1.0 - q_ + 2.0 * q_ * p); }

 private:
  static constexpr double kEven = 0.05, kSmallest = 1e-9;
  static constexpr float kSmallestSquare = 1e-24f;

  double x0_, length_, scale_, q_;
};

// A function of t by its values and slopes at t = 0, 1 and 2, or at 0 and 1 only (Hermite interpolation by divided
// differences): the first guesses between knots.
class Guess {
 public:
  Guess(const double* f, const double* slope, int knots) {
    const double f01 = f[1] - f[0], f001 = f01 - slope[0], f011 = slope[1] - f01;
    c_[0] = f[0], c_[1] = slope[0], c_[2] = f001, c_[3] = f011 - f001, c_[4] = c_[5] = 0.0;
    if (knots == 3) {
      const double f12 = f[2] - f[1], f112 = f12 - slope[1], f122 = slope[2] - f12;
      const double f0112 = 0.5 * (f112 - f011), f1122 = f122 - f112;
      const double f00112 = 0.5 * (f0112 - c_[3]), f01122 = 0.5 * (f1122 - f0112);
      c_[4] = f00112, c_[5] = 0.5 * (f01122 - f00112);
    }
  }
  HWY_INLINE Vec at(Lanes d, Vec t) const {
    const Vec from1 = hn::Sub(t, hn::Set(d, 1.0)), from2 = hn::Sub(t, hn::Set(d, 2.0));
    Vec r = hn::MulAdd(from2, hn::Set(d, c_[5]), hn::Set(d, c_[4]));
    r = hn::MulAdd(r, from1, hn::Set(d, c_[3]));
    r = hn::MulAdd(r, from1, hn::Set(d, c_[2]));
    r = hn::MulAdd(r, t, hn::Set(d, c_[1]));
    return hn::MulAdd(r, t, hn::Set(d, c_[0]));
  }
  double at(double t) const {
    return c_[0] + t * (c_[1] + t * (c_[2] + (t - 1.0) * (c_[3] + (t - 1.0) * (c_[4] + (t - 2.0) * c_[5]))));
  }

 private:
  double c_[6];
};

// Points of spans, solved with one in each lane.
struct Knots {
  std::vector<double> x, y, a, b;
  std::vector<double> a_lo, a_hi;      // where a may lie
  std::vector<double> a_by_x, b_by_x;  // slopes along the cut

  void clear() {
    for (std::vector<double>* list : lists()) list->clear();
  }
  void add(const PixelJob& job, double at, double start_a, double start_b) {
    const Span& span = *job.span;
    x.push_back(at), y.push_back(job.row + 0.5), a.push_back(start_a), b.push_back(start_b);
    a_lo.push_back(std::min(span.a0, span.a1)), a_hi.push_back(std::max(span.a0, span.a1));
  }
  // Newton's method from the starts. Knots only guide: pixels are judged by themselves.
  template <int kN, int kM, bool kRational, class NetKind>
  HWY_INLINE void solve(const NetKind& net) {
    if (x.empty()) return;
    const Lanes d;
    const std::size_t width = hn::Lanes(d), size = (x.size() + width - 1) / width * width;
    for (std::vector<double>* list : {&x, &y, &a, &b, &a_lo, &a_hi}) list->resize(size, list->back());
    a_by_x.resize(size), b_by_x.resize(size);
    for (std::size_t k = 0; k < size; k += width) solve<kN, kM, kRational>(d, net, k);
  }

 private:
  // The vector of knots from k on.
  template <int kN, int kM, bool kRational, class NetKind>
  HWY_INLINE void solve(Lanes d, const NetKind& net, std::size_t k) {
    const Origin origin = origin_of(net);
    const SpanBox box(d, hn::LoadU(d, a_lo.data() + k), hn::LoadU(d, a_hi.data() + k));
    const Vec to_x = hn::Sub(hn::LoadU(d, x.data() + k), hn::Set(d, origin.x));
    const Vec to_y = hn::Sub(hn::LoadU(d, y.data() + k), hn::Set(d, origin.y));
    Vec at_a = hn::LoadU(d, a.data() + k), at_b = hn::LoadU(d, b.data() + k);
    for (int iteration = 1;; ++iteration) {
      LaneJet jet;
      evaluate_lanes<kN, kM, kRational>(d, net, at_a, at_b, jet);
      const auto system = NewtonSystem<Vec>::at<kRational>(jet.p, jet.pa, jet.pb, to_x, to_y);
      Vec inverse = hn::Div(hn::Set(d, 1.0), system.determinant);
      const Vec da = system.step_a(inverse), db = system.step_b(inverse);
      at_a = hn::Add(at_a, da), at_b = hn::Add(at_b, db);
      box.clamp(at_a, at_b);
      const Vec step = hn::Max(hn::Abs(da), hn::Abs(db));
      if (iteration < kMaxNewton && !hn::AllTrue(d, hn::Lt(step, hn::Set(d, kStep)))) continue;
      if constexpr (kRational) inverse = hn::Mul(inverse, jet.p[kW]);
      hn::StoreU(at_a, d, a.data() + k), hn::StoreU(at_b, d, b.data() + k);
      hn::StoreU(hn::Mul(system.fyb, inverse), d, a_by_x.data() + k);
      hn::StoreU(hn::Neg(hn::Mul(system.fya, inverse)), d, b_by_x.data() + k);
      return;
    }
  }

  static constexpr int kMaxNewton = 8;
  static constexpr double kStep = 1e-6;

  std::array<std::vector<double>*, 8> lists() { return {&x, &y, &a, &b, &a_lo, &a_hi, &a_by_x, &b_by_x}; }
};

// First guesses for the pixels of jobs that all lie on one piece: at both ends of a job and, in longer ones, between
// them points are solved first.
class JobGuesses {
  static double finite(double value) { return std::isfinite(value) ? value : 0.0; }

 public:
  template <int kN, int kM, bool kRational, class NetKind>
  HWY_INLINE void solve(const NetKind& net, const std::vector<const PixelJob*>& jobs) {
    ends_.clear(), inner_.clear(), courses_.clear();
    for (const PixelJob* job : jobs) {
      add_end(*job, false);
      add_end(*job, true);
    }
    ends_.solve<kN, kM, kRational>(net);
    constexpr int spacing = kN < 0 ? kSpacingCostly : kSpacing;
    for (std::size_t j = 0; j < jobs.size(); ++j) place_inner(*jobs[j], 2 * j, spacing);
    inner_.solve<kN, kM, kRational>(net);
    a_.clear(), b_.clear();
    for (std::size_t j = 0; j < jobs.size(); ++j) assemble(courses_[j], 2 * j);
  }

  // A job's way from knot to knot.
  struct Course {
    Progress progress;
    int intervals;
    std::size_t first_inner, first;  // the first one of its knots between the ends; of all of them
  };
  const Course& course(std::size_t j) const { return courses_[j]; }
  // Values and slopes by the progress, in intervals, at the knots of all jobs.
  struct Values {
    std::vector<double> value, slope;

    void clear() { value.clear(), slope.clear(); }
    void add(double v, double s) { value.push_back(v), slope.push_back(finite(s)); }
    Guess guess(std::size_t knot, int knots) const { return Guess(&value[knot], &slope[knot], knots); }
  };
  const Values& a() const { return a_; }
  const Values& b() const { return b_; }

 private:
  static constexpr int kSpacing = 16;        // pixels from knot to knot, on average and at most
  static constexpr int kSpacingCostly = 12;  // where a second step costs more than a knot
  static constexpr int kSingle = 5;          // a job up to this long has no knots between its ends
  static constexpr double kNearEnd = 1.5;    // pixels

  // The end of the job, or the span's own, which is known, where that is near; a fold has no slope there.
  void add_end(const PixelJob& job, bool right) {
    const Span& span = *job.span;
    const double x = right ? job.last - 0.5 : job.first + 0.5, end = right ? span.x1 : span.x0;
    if (!(right ? span.fold1 : span.fold0) && std::fabs(x - end) <= kNearEnd) {
      ends_.add(job, end, right ? span.a1 : span.a0, right ? span.b1 : span.b0);
      return;
    }
    const double p = SpanProgress(span).at(x);
    ends_.add(job, x, span.a0 + p * (span.a1 - span.a0), span.b0 + p * (span.b1 - span.b0));
  }

  void place_inner(const PixelJob& job, std::size_t end, int spacing) {
    const double length = ends_.x[end + 1] - ends_.x[end];
    const int intervals = length < kSingle ? 1 : std::max(2, int(std::ceil(length / spacing)));
    const Progress progress(ends_.x[end], length, ends_.a_by_x[end], ends_.a_by_x[end + 1]);
    courses_.push_back({progress, intervals, inner_.x.size(), 0});
    if (intervals == 1) return;
    const double rate[2] = {progress.rate(0.0), progress.rate(1.0)};
    const auto between = [&](const std::vector<double>& value, const std::vector<double>& by_x) {
      const double slope[2] = {finite(by_x[end] * rate[0]), finite(by_x[end + 1] * rate[1])};
      return Guess(&value[end], slope, 2);
    };
    const Guess guess_a = between(ends_.a, ends_.a_by_x), guess_b = between(ends_.b, ends_.b_by_x);
    const double step = 1.0 / intervals;
    for (int k = 1; k < intervals; ++k)
      inner_.add(job, progress.x(k * step), guess_a.at(k * step), guess_b.at(k * step));
  }

  void assemble(Course& course, std::size_t end) {
    const double step = 1.0 / course.intervals;
    const auto add = [&](const Knots& from, std::size_t at, int knot) {
      const double rate = course.progress.rate(knot * step) * step;
      a_.add(from.a[at], from.a_by_x[at] * rate), b_.add(from.b[at], from.b_by_x[at] * rate);
    };
    course.first = a_.value.size();
    add(ends_, end, 0);
    for (int k = 1; k < course.intervals; ++k) add(inner_, course.first_inner + k - 1, k);
    add(ends_, end + 1, course.intervals);
  }

  Knots ends_, inner_;
  std::vector<Course> courses_;
  Values a_, b_;
};

// A job whose pixels are being guessed from left to right.
struct GuessedJob {
  const JobGuesses& guesses;
  const JobGuesses::Course& course;
  const PixelJob& job;
  int px, knot = 0;  // the next pixel; the first knot of the present guess

  GuessedJob(const JobGuesses& all, std::size_t index, const PixelJob& of)
      : guesses(all), course(all.course(index)), job(of), px(of.first) {}

  bool done() const { return px >= job.last; }

  // Writes guesses for the pixels up to `last`, in whole vectors: there must be room for one beyond.
  HWY_INLINE void guess_until(int last, double* a, double* b) {
    const Lanes d;
    const int width = int(hn::Lanes(d));
    const Vec lane = hn::Iota(d, 0.5), right = hn::Set(d, job.last - 0.5);
    const Vec intervals = hn::Set(d, double(course.intervals));
    while (px < last) {
      // Three knots at a time; the last ones with the one before them, if need be.
      const int from = std::max(0, std::min(knot, course.intervals - 2)), knots = std::min(3, course.intervals + 1);
      const Guess guess_a = guesses.a().guess(course.first + from, knots);
      const Guess guess_b = guesses.b().guess(course.first + from, knots);
      const bool to_end = knot + 2 >= course.intervals;
      const double until = course.progress.x((knot + 2.0) / course.intervals) - 0.5 * width;
      const int end = to_end ? last : std::min(last, int(std::ceil(until)));
      const Vec start = hn::Set(d, double(from));
      for (; px < end; px += width, a += width, b += width) {
        const Vec x = hn::Min(hn::Add(lane, hn::Set(d, double(px))), right);
        const Vec t = hn::MulSub(course.progress.at(d, x), intervals, start);
        hn::StoreU(guess_a.at(d, t), d, a), hn::StoreU(guess_b.at(d, t), d, b);
      }
      if (px < last) knot += 2;
    }
    px = last;
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#endif

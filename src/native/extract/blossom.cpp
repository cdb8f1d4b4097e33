// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "extract/blossom.cpp"
#include "extract/blossom.h"

#include <algorithm>

#include "bezier/bernstein.h"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<double>;
using Vec = hn::Vec<Lanes>;

constexpr std::size_t kMaxLanes = HWY_MAX_BYTES / sizeof(double);

// A few pieces side by side, one in each lane. Nothing is fused, so that results do not depend on the instruction set.
class Block {
 public:
  Block(int degree, std::size_t count, const double* knots, const double* start, const double* stop, std::size_t first)
      : p_(degree), width_(hn::Lanes(d_)), used_(std::min(width_, count - first)), stride_(count) {
    for (int k = 0; k < 2 * p_; ++k) fetch(knots + k * stride_ + first, knots_ + k * width_);
    fetch(start + first, ends_[0]);
    fetch(stop + first, ends_[1]);
    prepare_left();
    prepare_right();
  }

  // Makes one component's control points the Bezier points.
  void apply(double* points) const {
    HWY_ALIGN double rows[(kMaxDegree + 1) * kMaxLanes];
    for (int i = 0; i <= p_; ++i) fetch(points + i * stride_, rows + i * width_);
    const double* s = left_;
    for (int r = 0; r < from_left_; ++r) {
      for (int i = 0; i < from_left_ - r; ++i, s += width_) {
        const Vec pole = load(rows, i);
        store(hn::Add(pole, hn::Mul(hn::Load(d_, s), hn::Sub(load(rows, i + 1), pole))), rows, i);
      }
    }
    for (int r = 0; r < from_right_; ++r) {
      for (int i = p_; i > p_ - from_right_ + r; --i) {  // downwards: each needs its neighbour's old value
        const Vec value = load(rows, i);
        const Vec rest = hn::Load(d_, right_ + (i - r - 1) * width_);
        store(hn::Add(value, hn::Mul(rest, hn::Sub(load(rows, i - 1), value))), rows, i);
      }
    }
    for (int i = 0; i <= p_; ++i) {
      std::copy_n(rows + i * width_, used_, points + i * stride_);
    }
  }

 private:
  const Lanes d_;
  const int p_;
  const std::size_t width_, used_, stride_;
  int from_left_ = 0, from_right_ = 0;  // knots to replace on either side of the span, the most of any lane
  HWY_ALIGN double knots_[2 * kMaxDegree * kMaxLanes], ends_[2][kMaxLanes];
  HWY_ALIGN double left_[(kMaxDegree * (kMaxDegree + 1) / 2) * kMaxLanes], right_[kMaxDegree * kMaxLanes];

  Vec load(const double* rows, int i) const { return hn::Load(d_, rows + i * width_); }
  void store(Vec value, double* rows, int i) const { hn::Store(value, d_, rows + i * width_); }

  // Lanes without a piece repeat the last one.
  void fetch(const double* from, double* to) const {
    if (used_ == width_) return hn::Store(hn::LoadU(d_, from), d_, to);
    for (std::size_t k = 0; k < width_; ++k) to[k] = from[std::min(k, used_ - 1)];
  }

  bool differ(int knot, const double* end) const {
    return !hn::AllTrue(d_, hn::Eq(load(knots_, knot), hn::Load(d_, end)));
  }

  // f(a^(p - i), t_{k+1} .. t_{k+i}) from the poles: a = start replaces one knot left of the span after the other.
  void prepare_left() {
    for (int k = 0; k < p_; ++k) {
      if (differ(k, ends_[0])) from_left_ = k + 1;
    }
    const Vec a = hn::Load(d_, ends_[0]);
    double* s = left_;
    for (int r = 0; r < from_left_; ++r) {
      for (int i = 0; i < from_left_ - r; ++i, s += width_) {
        const Vec low = load(knots_, r + i), high = load(knots_, p_ + i);
        hn::Store(hn::Div(hn::Sub(a, low), hn::Sub(high, low)), d_, s);
      }
    }
  }

  // f(a^(p - i), b^i) from those: b = stop replaces the knots right of it.
  void prepare_right() {
    const Vec a = hn::Load(d_, ends_[0]), b = hn::Load(d_, ends_[1]);
    for (int k = p_ - 1; k >= 0; --k) {
      if (differ(p_ + k, ends_[1])) from_right_ = p_ - k;
      const Vec right = load(knots_, p_ + k);
      hn::Store(hn::Div(hn::Sub(right, b), hn::Sub(right, a)), d_, right_ + k * width_);
    }
  }
};

}  // namespace

void blossom_blocks(double* points, std::size_t components, int degree, std::size_t count, const double* knots,
                    const double* start, const double* stop) {
  const std::size_t width = hn::Lanes(Lanes());
  for (std::size_t first = 0; first < count; first += width) {
    const Block block(degree, count, knots, start, stop, first);
    for (std::size_t c = 0; c < components; ++c) block.apply(points + c * (degree + 1) * count + first);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(blossom_blocks);

void blossom(double* points, std::size_t components, int degree, std::size_t count, const double* knots,
             const double* start, const double* stop) {
  HWY_DYNAMIC_DISPATCH(blossom_blocks)(points, components, degree, count, knots, start, stop);
}

}  // namespace nofacet
#endif  // HWY_ONCE

#include "extract/use_order.h"

#include <algorithm>
#include <cmath>

#include "extract/corners.h"

namespace nofacet {
namespace {

// An end that meets only one start within this part of a wire's extent is taken to belong to it.
constexpr double kJoint = 1e-3;
constexpr std::size_t kLongestMatched = 64;  // uses of a wire whose ends are compared each with each

class WireOrder {
 public:
  explicit WireOrder(const UseView& uses) : uses_(uses) {}

  // The loops of the wire with uses [first, last); false where they are not plain.
  bool add(std::size_t first, std::size_t last, UseOrder* order) {
    if (last - first == 1 || joined_as_stored(first, last)) {
      for (std::size_t k = first; k < last; ++k) push(order, k);
      ++loop_;
      return true;
    }
    for (const double tolerance : {kSnap, kJoint}) {
      if (last - first <= kLongestMatched && match(first, last, tolerance)) {
        follow(first, last, order);
        return true;
      }
    }
    ++loop_;  // the numbers count unclear wires too
    return false;
  }

 private:
  const UseView& uses_;
  int64_t loop_ = 0;
  std::vector<std::ptrdiff_t> following_, before_;  // within the wire; -1 for none

  void push(UseOrder* order, std::size_t use) {
    order->use.push_back(int64_t(use));
    order->loop.push_back(loop_);
  }

  // Distance from the end of one use to the start of another, in parts of the wire's extent.
  double gap(std::size_t one, std::size_t other) const {
    const double *end = uses_.end + 2 * one, *start = uses_.start + 2 * other, *size = uses_.size + 2 * one;
    return std::hypot((end[0] - start[0]) / size[0], (end[1] - start[1]) / size[1]);
  }

  bool joined_as_stored(std::size_t first, std::size_t last) const {
    for (std::size_t k = first; k < last; ++k) {
      if (!(gap(k, k + 1 < last ? k + 1 : first) <= kSnap)) return false;
    }
    return true;
  }

  // Whether the uses fall into cycles that each meet exactly one other within the tolerance, one gap allowed.
  bool match(std::size_t first, std::size_t last, double tolerance) {
    const std::size_t count = last - first;
    following_.assign(count, -1);
    before_.assign(count, -1);
    for (std::size_t one = 0; one < count; ++one) {
      for (std::size_t other = 0; other < count; ++other) {
        if (!(gap(first + one, first + other) <= tolerance)) continue;
        if (following_[one] >= 0 || before_[other] >= 0) return false;
        following_[one] = std::ptrdiff_t(other);
        before_[other] = std::ptrdiff_t(one);
      }
    }
    std::ptrdiff_t loose_end = -1, loose_start = -1;
    for (std::size_t k = 0; k < count; ++k) {
      if (following_[k] < 0) {
        if (loose_end >= 0) return false;
        loose_end = std::ptrdiff_t(k);
      }
      if (before_[k] < 0) loose_start = std::ptrdiff_t(k);
    }
    if (loose_end >= 0) following_[loose_end] = loose_start;  // what is left can only follow each other
    return true;
  }

  void follow(std::size_t first, std::size_t last, UseOrder* order) {
    for (std::size_t begin = 0; begin < last - first; ++begin) {
      if (following_[begin] < 0) continue;  // already in a loop
      for (std::ptrdiff_t k = std::ptrdiff_t(begin); following_[k] >= 0;) {
        push(order, first + std::size_t(k));
        const std::ptrdiff_t next = following_[k];
        following_[k] = -1;
        k = next;
      }
      ++loop_;
    }
  }
};

}  // namespace

UseEnds use_ends(std::size_t count, const int64_t* wire, const bool* reversed, const int64_t* offsets,
                 const SegmentView& table) {
  UseEnds ends{std::vector<double>(2 * count), std::vector<double>(2 * count), std::vector<double>(2 * count)};
  auto point = [&](int64_t segment, bool last) {
    return table.points + 3 * (table.first_point[segment] + (last ? table.degree[segment] : 0));
  };
  for (std::size_t first = 0, last; first < count; first = last) {
    double low[2], high[2], size[2];
    for (int c = 0; c < 2; ++c) low[c] = high[c] = point(offsets[first], false)[c];
    for (last = first; last < count && wire[last] == wire[first]; ++last) {
      for (int64_t k = offsets[last]; k < offsets[last + 1]; ++k) {
        for (int c = 0; c < 2; ++c) {
          low[c] = std::min({low[c], point(k, false)[c], point(k, true)[c]});
          high[c] = std::max({high[c], point(k, false)[c], point(k, true)[c]});
        }
      }
      for (int c = 0; c < 2; ++c) {
        const double from = point(offsets[last], false)[c], to = point(offsets[last + 1] - 1, true)[c];
        ends.start[2 * last + c] = reversed[last] ? to : from;
        ends.end[2 * last + c] = reversed[last] ? from : to;
      }
    }
    const double largest = std::max(high[0] - low[0], high[1] - low[1]);
    for (int c = 0; c < 2; ++c) {
      size[c] = high[c] - low[c];
      if (!(size[c] > 0)) size[c] = largest > 0 ? largest : 1.0;
    }
    for (std::size_t k = first; k < last; ++k) std::copy_n(size, 2, ends.size.data() + 2 * k);
  }
  return ends;
}

UseOrder order_uses(const UseView& uses) {
  UseOrder order;
  order.use.reserve(uses.count);
  order.loop.reserve(uses.count);
  WireOrder wires(uses);
  for (std::size_t first = 0, last; first < uses.count; first = last) {
    for (last = first + 1; last < uses.count && uses.wire[last] == uses.wire[first];) ++last;
    if (!wires.add(first, last, &order)) order.unclear.push_back(uses.wire[first]);
  }
  return order;
}

}  // namespace nofacet

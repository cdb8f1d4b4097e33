// Lines that bound the depth key along a span.
#pragma once
#include "raster/span.h"

namespace nofacet {

struct KeyLine {
  double at, slope;

  double key(double x) const { return at + slope * x; }
};

// All along the span the key is no less than each of `near` and no more than each of `far`.
struct KeyLines {
  static constexpr int kMost = 3;

  KeyLine near[kMost], far[kMost];
  int near_count = 0, far_count = 0;

  explicit KeyLines(const Span& span);

 private:
  void add_near(double slope, double x, double key) { near[near_count++] = {key - slope * x, slope}; }
  void add_far(double slope, double x, double key) { far[far_count++] = {key - slope * x, slope}; }
};

// How far key - c x may be from running evenly with the parameter between the ends of a span.
Interval sag(const Span& span, double c);

}  // namespace nofacet

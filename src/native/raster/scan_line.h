// Hidden surface removal on one scan plane: which span is nearest, over which stretch of x.
#pragma once
#include <vector>

#include "raster/key_lines.h"

namespace nofacet {

// A stretch [x0, x1] of the scan plane on which `span` is the nearest surface.
struct VisibleSegment {
  double x0, x1;
  const Span* span;
};

// What one scan plane meets.
struct ScanLine {
  double y = 0.0;
  std::vector<VisibleSegment> segments;  // nearest opaque spans: disjoint, ascending in x
  std::vector<const Span*> transparent;  // in the order of insertion
  mutable std::size_t hint = 0;          // where a segment was looked for last: the next is often near

  void clear(double plane_y) {
    y = plane_y;
    hint = 0;
    segments.clear();
    transparent.clear();
  }
  // Whether what lies between two x and no nearer than `nearest`, and no nearer than the line `near`, cannot be seen.
  // `tie`: keys closer than this may be those of one surface.
  bool hides(Interval x, double nearest, const KeyLine& near, double tie) const;
  // Index of the first segment that ends right of x.
  std::size_t first_after(double x) const;
  // The stretches of x covered by anything, disjoint and ascending, into `out`.
  void covered(double width, std::vector<Interval>& out) const;
};

// Sorts stretches of x and joins those that overlap or meet.
void merge_stretches(std::vector<Interval>& stretches);

// `depth_tie`: depths closer than this are one and the same surface, for coincident faces computed from different
// patches differ by rounding only; the face with the lower index is then shown.
//
// Where two surfaces pass through each other the crossing is solved to 1e-6 px; a second crossing of the same two spans
// within half a pixel along x may be missed, and so may one within 1e-5 px of where they touch. Spans are inserted in a
// fixed order, which decides only on overlaps below kNegligiblePixels. One per thread.
class Visibility {
 public:
  Visibility(const Camera& camera, double depth_tie) : camera_(camera), depth_tie_(depth_tie) {}

  // The difference of keys that stands for the depth tie, near a key.
  double tie(double key) const { return camera_.perspective ? depth_tie_ * key * key : depth_tie_; }
  // Makes `span` compete with the line's segments; whether it is seen anywhere. Else it need not be kept.
  bool insert(const Span& span, ScanLine& line);
  // Appends the stretches of `span` that no segment of the line hides: how a transparent face lies before opaque ones.
  void append_visible(const Span& span, const ScanLine& line, std::vector<VisibleSegment>& out);

 private:
  // How much farther one span's key is than another's at x.
  struct KeyDifference {
    double x, d;
  };

  std::size_t merge(const Span& span, const std::vector<VisibleSegment>& segments, std::size_t first);
  void push(double x0, double x1, const Span* span);
  const Span* decide(bool fresh_behind, bool old_behind, const Span& fresh, const Span& old) const;
  const Span* decide(Interval fresh_key, Interval old_key, double tie, const Span& fresh, const Span& old) const;
  const Span* decide_by_lines(const Span& fresh, const Span& old, double x0, double x1, double tie) const;
  const Span* decide_by_shears(const Span& fresh, const Span& old, double x0, double tie) const;
  bool show(const Span* winner, const Span& fresh, double x0, double x1);
  bool compare(const Span& fresh, const Span& old, double x0, double x1);
  bool compare_points(const Span& fresh, const Span& old, double x0, double x1);
  bool cross(const Span& fresh, const Span& old, KeyDifference left, KeyDifference right, double tie);
  KeyDifference leave_touch(const Span& fresh, const Span& old, double end, KeyDifference* far, double tie) const;
  double solve_crossing(const Span& fresh, const Span& old, KeyDifference left, KeyDifference right) const;

  const Camera& camera_;
  double depth_tie_;
  std::vector<VisibleSegment> merged_;
  bool shown_ = false;
};

}  // namespace nofacet

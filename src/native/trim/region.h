// A face definition's trim region: is (u, v) inside its loops, and which arcs run through a box?
//
// Inside is where the loops wind an odd and positive number of times, in the orientation of all of them together. On
// sound loops this is the even-odd rule; where edges overshoot a corner or cross near a pole, the lobe beyond the
// crossing winds the other way round and is outside.
#pragma once
#include <vector>

#include "model.h"
#include "trim/curve.h"

namespace nofacet {

class Region {
 public:
  // Reads the loops of one definition of the model, whose arrays must outlive the region.
  Region(const Model& model, std::size_t definition);

  const std::vector<TrimArc>& arcs() const { return arcs_; }
  bool contains(double u, double v) const;
  // Whether no arc's box meets the box [u] x [v]: then all of it is inside, or all of it outside.
  bool clear(Interval u, Interval v) const;

 private:
  std::vector<TrimArc> arcs_;
  // Arcs by v: bin k holds the arcs whose v range meets [v_min + k * step, v_min + (k + 1) * step].
  std::vector<int32_t> bin_offsets_, bin_arcs_;
  double v_min_ = 0.0, v_max_ = 0.0, bins_per_v_ = 0.0;
  int bins_ = 0;
  int orientation_ = 1;
  // Points on curved arcs, kKnots + 1 each, at equal steps of their parameters: between two of them an arc's box is so
  // much smaller. The first one's index for each arc; -1: straight.
  static constexpr int kKnots = 16;
  struct Knot {
    double u, v;
  };
  std::vector<int32_t> first_knot_;
  std::vector<Knot> knots_;

  void add_segment(const double* points, int degree);
  double signed_area() const;
  void fill_bins();
  void add_knots();
  bool passes_left_of(std::size_t arc, double u, double v) const;
  int bin(double v) const;
};

}  // namespace nofacet

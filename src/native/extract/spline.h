// B-splines, many at once, to the Bezier pieces that intervals of their parameters meet.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "extract/byte_reader.h"

namespace nofacet {

// A span narrower than this part of the wanted interval is dropped and its neighbour continued across it: real files
// hold spans of 2.5e-12 of the range (two writers' rounding of one knot), which no image can show.
inline constexpr double kSliver = 1e-11;

// The flat knots of a spline, those of a periodic one over all periods that an interval touches. A span that starts at
// flat knot j depends on the degree + 1 poles from j - degree + first_pole, modulo pole_count.
class KnotVector {
 public:
  // Knots are strictly increasing. OpenCascade's conventions: in a periodic spline the first and the last knot are the
  // same place, and pole 0 belongs to the span that starts at the last copy of the first knot.
  KnotVector(int degree, bool periodic, const std::vector<double>& knots, const std::vector<int>& multiplicities,
             double low, double high);

  int degree() const { return degree_; }
  double knot(int64_t j) const { return flat_[std::size_t(j)]; }
  int64_t size() const { return int64_t(flat_.size()); }
  std::size_t pole_count() const { return std::size_t(pole_count_); }
  // The pole with this number, counted on beyond a period.
  int64_t pole(int64_t number) const {
    if (number >= 0 && number < pole_count_) return number;
    return ((number % pole_count_) + pole_count_) % pole_count_;
  }
  // The first pole, not yet modulo pole_count, of the span that starts at flat knot j.
  int64_t first_pole(int64_t j) const { return j - degree_ + first_pole_; }

 private:
  int degree_;
  std::vector<double> flat_;
  int64_t first_pole_ = 0, pole_count_ = 0;

  void unroll(const std::vector<double>& knots, const std::vector<int>& multiplicities, double low, double high);
};

// A polynomial span: the flat knot where it starts, and the ends of the Bezier piece wanted.
struct KnotSpan {
  int64_t flat;
  double start, stop;
};

// The spans that [low, high] meets; end spans are continued where it leaves the domain.
std::vector<KnotSpan> spans(const KnotVector& vector, double low, double high);

// Bezier pieces of curves that are all of one degree p and in `dim` dimensions. owner: (m,), the interval; start, stop:
// (m,), parameters; points: (m, p + 1, dim + 1), homogeneous.
struct CurvePieces {
  int degree;
  std::vector<int64_t> owner;
  std::vector<double> start, stop, points;
};

// The pieces over [first[k], last[k]] of the B-spline curve whose record has its header at byte at[k], for each k;
// those of one curve are all in one of the results.
std::vector<CurvePieces> spline_pieces(Bytes bytes, int dim, std::size_t count, const int64_t* at, const double* first,
                                       const double* last);

// Patches of surfaces that are all of one bidegree. owner: (m,), the box; domain: (m, 4), u0, u1, v0, v1; points: (m,
// degree_u + 1, degree_v + 1, 4), homogeneous.
struct SurfacePatches {
  int degree_u, degree_v;
  std::vector<int64_t> owner;
  std::vector<double> domain, points;
};

// The patches over the boxes (count, 4) of the B-spline (or, all of them, Bezier) surfaces with headers at bytes at[k].
std::vector<SurfacePatches> spline_patches(Bytes bytes, bool bezier, std::size_t count, const int64_t* at,
                                           const double* boxes);

// The pieces of one curve with poles (n, components) over [low, high]: points (m, degree + 1, components).
CurvePieces curve_pieces(const KnotVector& vector, const double* poles, std::size_t components, double low,
                         double high);

}  // namespace nofacet

// The curves in which scan planes cut a piece.
#pragma once
#include <vector>

#include "raster/cut_kernels.h"
#include "raster/piece.h"

namespace nofacet {

struct CutPoint {
  double a, b;
  double x, key;
  bool fold = false;  // x turns here
};

// A part of the cut by one plane, without regard to trim curves, along which x moves one way only: from.a < to.a.
struct CutArc {
  int32_t plane;
  int32_t curve;  // a plane may cut a piece in several curves, and a curve is one arc, or two that share a fold
  CutPoint from, to;
};

// Cuts pieces by many planes at once. One per thread; holds scratch memory for the planes of a band.
class PieceCutter {
 public:
  // The arcs of `piece` on the planes y[0] .. y[count - 1], ascending in a plane; valid until the next call.
  const std::vector<CutArc>& cut(const Piece& piece, const double* y, int count);

 private:
  // A part of a border along which y moves one way: its points, its parameters from (a, b) to (a + da, b + db), the
  // planes [first, last) that cross it, and where they do.
  struct Border {
    const double* points;
    std::size_t stride;
    double a, da, b, db;
    int first, last;
    PlaneRoots roots;

    void solve(int degree, const double* y, int count);
    CutPoint point(int plane) const;
  };

  Border& next_border();
  void cut_at_borders(const Piece& piece, const double* y, int count);
  void cross_end(const Piece& piece, int end, const double* y, int count);
  void cross_side(const Piece& piece, int side, const double* y, int count);
  void split_at_folds(const Piece& piece, const double* y);

  std::vector<CutArc> arcs_;
  std::vector<Border> borders_;  // the first border_count_ are the piece's
  std::size_t border_count_ = 0;
  std::vector<double> parts_;  // control points of parts of a border
  std::vector<CutPoint> points_;
  PlaneRoots folds_, to_folds_;
  std::vector<int> fold_arcs_;
  std::vector<CutArc> split_;
};

// The dependent parameter on the cut at a, where the cut must exist; NaN for no guess.
double cut_at(const Piece& piece, double y, double a, double guess);

}  // namespace nofacet

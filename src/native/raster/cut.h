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

// A part of the cut by one plane, without regard to trim curves, along which x moves one way only: from.a < to.a. A
// plane cuts a piece in one arc, or in two that share a fold.
struct CutArc {
  int plane;
  CutPoint from, to;
};

// Cuts pieces by many planes at once. One per thread; holds scratch memory for the planes of a band.
class PieceCutter {
 public:
  // The arcs of `piece` on the planes y[0] .. y[count - 1], ascending in a plane; valid until the next call.
  const std::vector<CutArc>& cut(const Piece& piece, const double* y, int count);

 private:
  // A border that the planes [first, last) cross, and where they do.
  struct Border {
    int first = 0, last = 0;
    PlaneRoots roots;

    void solve(const double* points, std::size_t stride, int degree, const double* y);
  };

  void cut_at_borders(const Piece& piece, const double* y, int count);
  void split_at_folds(const Piece& piece, const double* y);

  std::vector<CutArc> arcs_;
  Border borders_[4];  // b = 0, b = 1, a = 0 and a = 1
  PlaneRoots folds_, to_folds_;
  std::vector<int> fold_arcs_;
  std::vector<CutArc> split_;
};

// The dependent parameter on the cut at a, where the cut must exist; NaN for no guess.
double cut_at(const Piece& piece, double y, double a, double guess);

}  // namespace nofacet

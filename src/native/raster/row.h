// One pixel row: values at the pixel centres, colour and coverage over the pixels' areas.
#pragma once
#include <vector>

#include "frame.h"
#include "raster/scan_cut.h"
#include "raster/visibility.h"

namespace nofacet {

// Draws rows of one frame. One per thread; holds the row's scratch memory (about 200 bytes a pixel of width).
class RowPainter {
 public:
  RowPainter(const Scene& scene, const Camera& camera, const ScanPlanes& planes, double tie, const Frame& frame);

  // `pieces`: those whose y range may meet the row, in a fixed order.
  void paint(int row, const std::vector<const Piece*>& pieces);

 private:
  void intersect_scan_plane(const std::vector<const Piece*>& pieces, double y);
  void solve_values(int row);
  void solve_span(const Span& span, int row);
  void write_values(int row);
  void accumulate(const VisibleSegment& segment, double weight);
  void fragment_color(const VisibleSegment& segment, double x, float rgb[3]);
  void write_color(int row);

  const Scene& scene_;
  const Camera& camera_;
  const ScanPlanes& planes_;
  double tie_;
  const Frame& frame_;

  std::vector<Span> spans_;
  std::vector<VisibleSegment> segments_;
  // Per pixel of the row: what is visible at its centre.
  std::vector<double> depth_;
  std::vector<SurfaceSample> sample_;
  std::vector<const Piece*> piece_;
  std::vector<float> centre_rgb_;       // (width, 3), shade at the centre
  std::vector<double> rgb_, coverage_;  // (width, 3) and (width,): sums over the row's scan planes
};

}  // namespace nofacet

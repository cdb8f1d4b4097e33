// One pixel row: values at the pixel centres, colour and coverage over the pixels' areas.
#pragma once
#include <vector>

#include "frame.h"
#include "raster/scan_cut.h"
#include "raster/solve_run.h"
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
  void solve_pixels(const Span& span, int row, int first, int last);
  void solve_chunk(const Span& span, int row, int first, int last, const SurfaceSample& from, const SurfaceSample& to);
  void keep(const Span& span, int px, const SurfaceSample& sample);
  void write_values(int row);
  void separate_transparent();
  void accumulate(const VisibleSegment& segment, double weight);
  void accumulate_layers(double weight);
  void add_layers(double x0, double x1, double weight);
  void fragment_color(const Span& span, double x, int px, float rgb[3]);
  void write_color(int row);

  const Scene& scene_;
  const Camera& camera_;
  const ScanPlanes& planes_;
  double tie_;
  const Frame& frame_;

  std::vector<Span> spans_, transparent_;
  std::vector<VisibleSegment> segments_;  // of the nearest opaque faces
  std::vector<VisibleSegment> veils_;     // of transparent faces before them, in any order
  std::vector<double> borders_;           // x of the ends of both
  struct Layer {
    double depth;
    const Span* span;
  };
  std::vector<Layer> layers_;
  PixelRun run_;
  // Per pixel of the row: what is visible at its centre.
  std::vector<double> depth_;
  std::vector<SurfaceSample> sample_;
  std::vector<const Piece*> piece_;
  std::vector<float> centre_rgb_;  // (width, 3), shade at the centre
  // Sums over the row's scan planes: (width, 3), (width,) and (width,).
  std::vector<double> rgb_, alpha_, coverage_;
};

}  // namespace nofacet

// One pixel row: values at the pixel centres, colour and coverage over the pixels' areas.
#pragma once
#include <deque>
#include <vector>

#include "frame.h"
#include "raster/plane_cut.h"
#include "raster/solve_run.h"

namespace nofacet {

// Draws rows of one frame. One per thread; holds the row's scratch memory (about 200 bytes a pixel of width).
class RowPainter {
 public:
  RowPainter(const Scene& scene, const Camera& camera, const ScanPlanes& planes, double tie, const Frame& frame);

  // `pieces`: those whose y range may meet the row, in a fixed order.
  void paint(int row, const std::vector<const Piece*>& pieces);

 private:
  const PlaneCut& sample_cut(int64_t index, const std::vector<const Piece*>& pieces);
  void collect_cuts(int row, const std::vector<const Piece*>& pieces);
  void locate_level_edges(const PlaneCut& above, const PlaneCut& below, const std::vector<const Piece*>& pieces);
  void solve_values(const PlaneCut& cut, int row);
  void solve_span(const Span& span, int row);
  void solve_pixels(const Span& span, int row, int first, int last);
  void solve_chunk(const Span& span, int row, int first, int last, const SurfaceSample& from, const SurfaceSample& to);
  void keep(const Span& span, int px, const SurfaceSample& sample);
  void write_values(int row);
  void accumulate(const VisibleSegment& segment, double weight);
  void accumulate_layers(const PlaneCut& cut, double weight);
  void add_layers(const PlaneCut& cut, double x0, double x1, double weight);
  void fragment_color(const Span& span, double x, int px, float rgb[3]);
  void write_color(int row);

  const Scene& scene_;
  const Camera& camera_;
  const ScanPlanes& planes_;
  double tie_;
  const Frame& frame_;

  PlaneCut centre_cut_;
  // The last few sample planes, by index modulo the capacity: neighbouring rows share them.
  std::vector<PlaneCut> sample_cuts_;
  std::vector<int64_t> sample_index_;
  PlaneCut edge_cuts_[2];            // stand in for the neighbouring rows' planes where only their y matters
  std::deque<PlaneCut> level_cuts_;  // planes added to locate level edges; the first level_count_ are in use
  std::size_t level_count_ = 0;
  std::vector<const PlaneCut*> cuts_;  // of one row, ascending in y, with a neighbour before and after
  std::vector<VisibleSegment> veils_;  // of transparent faces before the opaque ones, in any order
  std::vector<double> borders_;        // x of the ends of segments and veils
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

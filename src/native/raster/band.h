// A band of pixel rows: its scan planes, what they meet, and the rows' buffers.
#pragma once
#include <deque>
#include <optional>
#include <vector>

#include "arena.h"
#include "frame.h"
#include "raster/frame_patches.h"
#include "raster/row_average.h"
#include "raster/scan_line.h"
#include "raster/section_cuts.h"
#include "raster/solve_pixels.h"
#include "stopwatch.h"

namespace nofacet {

// Seconds spent in the stages of a band.
struct BandTimes {
  double subdivide = 0.0, spans = 0.0, visibility = 0.0, shade = 0.0, average = 0.0;
};

// Draws bands of one frame. One per thread; holds a band's scratch memory.
class BandPainter {
 public:
  // `sections`: of the frame; null: none.
  BandPainter(const Scene& scene, const Camera& camera, const ScanPlanes& planes, FramePatches& patches,
              Sections* sections, int thread, const Frame& frame);

  // Draws the rows [first_row, end_row), a band of them. `patches`: indices of those whose y range
  // may meet them, in a fixed order, best those first that may hide others.
  void paint(int first_row, int end_row, const std::vector<int32_t>& patches);
  const BandTimes& times() const { return times_; }

 private:
  void lay_planes();
  int centre_plane(int row) const;
  int sample_plane(int row, int k) const;
  void cut_patches();
  void cut_piece(const Piece& piece, bool sectioned);
  void insert_caps(const double* y, int count, ScanLine* lines);
  bool hidden(const HullBounds& hull, const ScanLine& line) const;
  bool hidden(const HullBounds& hull) const;
  std::pair<int, int> planes_in(Interval y) const;
  void insert_spans(const Piece& piece, ScanLine* lines);

  void solve_values();
  const ScanLine& front(int row);
  void collect_jobs(int row);
  void fill_background(int row, int first, int last) const;

  void weigh_planes(int row);
  void locate_level_edges(const ScanLine& above, const std::vector<Interval>& covered_above, const ScanLine& below,
                          const std::vector<Interval>& covered_below);
  const ScanLine& cut_level(double y);

  const Scene& scene_;
  const Camera& camera_;
  const ScanPlanes& planes_;
  FramePatches& patches_;
  int thread_;
  const Frame& frame_;
  SpanMaker maker_;
  Visibility visibility_;
  RowAverage average_;
  std::optional<SectionCuts> cuts_;
  Stopwatch watch_;
  BandTimes times_;

  int first_row_ = 0, end_row_ = 0;
  const std::vector<int32_t>* band_patches_ = nullptr;
  std::vector<double> plane_y_;  // ascending
  std::vector<ScanLine> lines_;  // of these planes
  Arena<Span> spans_;
  std::vector<Span> made_;
  int32_t order_ = 0;  // of the next piece inserted
  ScanLine front_;

  std::vector<PixelJob> jobs_, sorted_;
  std::vector<HardPixel> hard_;
  std::vector<int32_t> job_starts_;

  std::deque<ScanLine> level_lines_;  // planes added to locate level edges; the first level_count_ are in use
  std::size_t level_count_ = 0;
  std::vector<const ScanLine*> row_lines_;
  std::vector<WeightedLine> weighted_;
  std::vector<Interval> covered_[2];
};

}  // namespace nofacet

// Colour and coverage of one pixel row, averaged over the pixels' areas.
#pragma once
#include <vector>

#include "frame.h"
#include "raster/scan_line.h"

namespace nofacet {

// A scan plane and the height of the strip of the row that it stands for.
struct WeightedLine {
  const ScanLine* line;
  double weight;
};

// Averages rows. One per thread.
class RowAverage {
 public:
  RowAverage(const Scene& scene, const Camera& camera, const Frame& frame, Visibility& visibility);

  // Finishes the row's colour and coverage. `front`: what the row's pixels show at their centres; the frame's colour
  // holds its shade there. Where every line shows, over a whole pixel, the face that its centre shows, that is the
  // pixel's colour; only the others are averaged one by one.
  void average(int row, const std::vector<VisibleSegment>& front, const std::vector<WeightedLine>& lines);

 private:
  // The pixels [first, last) that show one face at their centres, or none (-1).
  struct FaceRun {
    int first, last;
    int32_t face;
  };
  // Segments of one face that meet, but for rounding: from `first` of their line on.
  struct Stretch {
    double x0, x1;
    int32_t face;
    std::size_t first;
  };

  void find_runs(const std::vector<VisibleSegment>& front);
  void find_stretches(const ScanLine& line, std::vector<Stretch>& out) const;
  void find_mixed(const ScanLine& line, const std::vector<Stretch>& stretches);
  void mark(int first, int last);
  void find_veils(const std::vector<WeightedLine>& lines);
  void average_pixel(int row, int px, std::size_t run, const std::vector<WeightedLine>& lines);
  void add_opaque(const WeightedLine& weighted, const std::vector<Stretch>& stretches, std::size_t& cursor, int px);
  void add_layers(const ScanLine& line, const std::vector<VisibleSegment>& veils, int px, double weight);
  void add_stack(double from, double to, double weight);
  void stretch_color(const ScanLine& line, const Stretch& stretch, double x, float rgb[3]);
  const float* known_color(int32_t face) const;
  const float* neighbour_color(const Stretch& stretch) const;
  void fragment_color(const Span& span, double x, float rgb[3]);

  const Scene& scene_;
  const Camera& camera_;
  const Frame& frame_;
  Visibility& visibility_;

  std::vector<FaceRun> runs_;
  std::vector<std::vector<Stretch>> stretches_;  // of each line
  std::vector<std::size_t> cursors_;  // of each line: the first stretch that reaches into the pixel, or beyond
  std::vector<uint8_t> mixed_;        // (width,)
  std::vector<std::vector<VisibleSegment>> veils_;  // of each line: transparent faces before the opaque ones
  // Of the pixel being averaged.
  int32_t centre_face_ = -1;
  int px_ = 0;
  std::size_t run_ = 0;  // that it is in
  float centre_rgb_[3];
  const float* row_rgb_ = nullptr;  // of the frame; from the pixel on, what centres show
  int before_px_ = -1;              // the pixel averaged before this one, and what its centre showed
  float before_rgb_[3];
  struct FaceColor {
    int32_t face;
    float rgb[3];
  };
  std::vector<FaceColor> face_colors_;  // of the opaque faces in it so far
  double rgb_[3], alpha_, coverage_;
  std::vector<VisibleSegment> stack_;  // the segments and veils in it
  std::vector<double> borders_;        // their ends
  struct Layer {
    double key;
    const Span* span;
  };
  std::vector<Layer> layers_;
};

}  // namespace nofacet

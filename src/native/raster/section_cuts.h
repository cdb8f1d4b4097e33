// The scan planes of a band cut by the section planes: where surfaces end, and the caps between their ends.
#pragma once
#include <vector>

#include "raster/sections.h"
#include "raster/span.h"

namespace nofacet {

// A cap's spans on the scan planes.
struct CapSpans {
  const Span *first, *last;
};

// One per thread.
class SectionCuts {
 public:
  SectionCuts(const Scene& scene, Sections& sections, int thread)
      : scene_(scene), sections_(sections), thread_(thread) {}

  // Finds where surfaces meet both the scan planes y[0] .. y[count - 1] (ascending) of a band of rows and the section
  // planes, and the caps. What the functions below return holds until the next call.
  void cut(std::size_t band, const double* y, int count);

  // Takes from the spans of a piece, made for the planes of cut(), what the section planes remove.
  void remove(const Piece& piece, std::vector<Span>& spans);
  const std::vector<CapSpans>& caps() const { return caps_; }

 private:
  // A point in which a surface, a section plane and a scan plane meet, inside the trim loops.
  struct Crossing {
    int32_t face;
    const Scene::PatchRef* patch;
    int32_t plane;  // index of the scan plane
    double s, t;    // of the patch
  };
  // Where a body's outline in a section plane crosses a scan plane: along the growing x its winding number grows by
  // `winds`.
  struct Border {
    int32_t view, body, plane;
    double x;
    int32_t winds;
  };
  struct Run {
    std::size_t first, last;  // borders of one body on one scan plane
    bool closed;              // they bound stretches
  };

  void cut_piece(std::size_t view, const Piece& piece, const double* y, int first, int last);
  void add_crossing(std::size_t view, const Span& span);
  void split(const Piece& piece, const Span& span, std::vector<Span>& out);
  void make_caps(const double* y);
  void find_runs(std::size_t first, std::size_t last, const double* y);
  int winding_before(const Run& run) const;
  bool is_closed(const Run& run) const;
  void fill(const Run& run, int32_t plane, double y);
  void fill_stretch(const Border& of, double x0, double x1, int32_t plane, double y);

  const Scene& scene_;
  Sections& sections_;
  int thread_;
  SpanMaker maker_;
  std::vector<Span> made_, kept_;
  std::vector<Crossing> crossings_;  // by face, patch and plane
  std::vector<Border> borders_;      // by view, body, plane and x
  std::vector<Run> runs_;
  std::vector<Span> cap_spans_;
  std::vector<CapSpans> caps_;
  struct Stop {
    double progress, a, b;
  };
  std::vector<Stop> stops_;
};

}  // namespace nofacet

// Pixels on their way through the solver: a few hundred at a time, so that all of it stays in the cache.
#pragma once
#include <cstdint>
#include <vector>

#include "raster/solve_pixels.h"

namespace nofacet {

// The pixels [first, last) of a job, which have the batch's entries from `offset` on.
struct BatchRun {
  const PixelJob* job;
  int first, last, offset;
};

// Solved pixels that wait to be shaded and written. The normals are in eye space, of any length.
struct PixelBatch {
  static constexpr int kSize = 384, kWidest = 16;  // pixels; the widest vector of any kind

  alignas(64) double a[kSize + kWidest], b[kSize + kWidest], key[kSize + kWidest];
  alignas(64) float nx[kSize + kWidest], ny[kSize + kWidest], nz[kSize + kWidest];
  alignas(64) float x[kSize + kWidest], y[kSize + kWidest];  // pixel centres, where shading needs them
  alignas(64) float color[4 * (kSize + kWidest)];
  std::vector<BatchRun> runs;
  int size = 0;

  int room() const { return kSize - size; }
  void clear() {
    runs.clear();
    size = 0;
  }
};

// Pixels that need more than one step: entries of the batch, packed without gaps, with the part of the piece in which
// the solution must lie.
struct RetryBatch {
  static constexpr int kSize = PixelBatch::kSize + PixelBatch::kWidest;

  alignas(64) double x[kSize], y[kSize], a[kSize], b[kSize], a_lo[kSize], a_hi[kSize];
  int entry[kSize];
  const PixelJob* job[kSize];
  int size = 0;

  void add(int batch_entry, const PixelJob& from, int px, double start_a, double start_b) {
    const Span& span = *from.span;
    x[size] = px + 0.5, y[size] = from.row + 0.5, a[size] = start_a, b[size] = start_b;
    a_lo[size] = span.a0 < span.a1 ? span.a0 : span.a1, a_hi[size] = span.a0 < span.a1 ? span.a1 : span.a0;
    entry[size] = batch_entry, job[size] = &from;
    ++size;
  }
  // Fills a last, incomplete vector of `width` with copies.
  void pad(int width) {
    for (int k = size; k % width != 0; ++k) {
      x[k] = x[size - 1], y[k] = y[size - 1], a[k] = a[size - 1], b[k] = b[size - 1];
      a_lo[k] = a_lo[size - 1], a_hi[k] = a_hi[size - 1];
    }
  }
};

}  // namespace nofacet

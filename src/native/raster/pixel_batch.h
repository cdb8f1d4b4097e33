// Pixels on their way through the solver: a few hundred at a time, so that all of it stays in the cache.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>

#include "raster/solve_pixels.h"

namespace nofacet {

// The pixels [first, last) of a job, which have the batch's entries from `offset` on.
struct BatchRun {
  const PixelJob* job;
  int first, last, offset;
};

// Pixels of one piece, one after the other without gaps. The normals are in eye space, of any length.
struct PixelBatch {
  static constexpr int kSize = 256;
  static constexpr int kRoom = kSize + 16;  // whole vectors are written; the widest of any kind has 16 floats

  alignas(64) double x[kRoom], y[kRoom];        // centres
  alignas(64) double a_lo[kRoom], a_hi[kRoom];  // where the certificate allows one solution only
  alignas(64) double a[kRoom], b[kRoom], key[kRoom];
  alignas(64) float nx[kRoom], ny[kRoom], nz[kRoom];
  alignas(64) float pixel_x[kRoom], pixel_y[kRoom];  // centres, where shading needs them
  alignas(64) float color[4 * kRoom];
  BatchRun runs[kSize];
  int size = 0, run_count = 0;
  int failed[kRoom];  // entries that need more steps
  int failed_count = 0;

  int room() const { return kSize - size; }
  void clear() { size = run_count = failed_count = 0; }
  // Appends as many of the job's pixels as there is room for, from `first` on, but for their values.
  const BatchRun& add(const PixelJob& job, int first) {
    BatchRun& run = runs[run_count++];
    run.job = &job, run.first = first, run.last = first + std::min(job.last - first, room()), run.offset = size;
    size += run.last - first;
    return run;
  }
  std::span<const BatchRun> all_runs() const { return {runs, std::size_t(run_count)}; }
  // The run that an entry belongs to.
  const BatchRun& run_of(int entry) const {
    std::size_t k = 0;
    while (entry >= runs[k].offset + runs[k].last - runs[k].first) ++k;
    return runs[k];
  }
};

// The same pixels in single precision, about the middle of the piece's net: for first steps from poor guesses.
struct CoarseBatch {
  alignas(64) float x[PixelBatch::kRoom], y[PixelBatch::kRoom];
  alignas(64) float a_lo[PixelBatch::kRoom], a_hi[PixelBatch::kRoom];
  alignas(64) float a[PixelBatch::kRoom], b[PixelBatch::kRoom];
};

}  // namespace nofacet

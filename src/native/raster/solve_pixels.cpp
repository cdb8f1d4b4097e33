// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/solve_pixels.cpp"
#include "raster/solve_pixels.h"

#include <algorithm>
#include <cmath>

#include "hwy/foreach_target.h"
#include "raster/fill.h"
#include "raster/knots_lanes-inl.h"
#include "raster/newton_lanes-inl.h"
#include "raster/pixel_batch.h"
#include "raster/shade.h"
#include "raster/shade_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

// A pixel takes one step from its guess, and this many more if that was not enough.
constexpr int kMaxRetries = 8;
// Pixels of jobs up to this long are solved without knots, with pixels of other jobs in the same vector.
constexpr int kLooseJob = 4;
// Largest change of direction, in radians, of the tangents that a normal is made of, as stored and for shading.
constexpr double kNormalTolerance = 3e-8, kShadeTolerance = 1e-4;
constexpr double kCentredTolerance = 2e-9;  // pixels

// A thread's memory. The functions that use it get it as an argument: a thread's own variables are slow to find.
struct PixelScratch {
  std::vector<const PixelJob*> long_jobs;
  JobGuesses guesses;
  PixelBatch batch;
  RetryBatch retries;
};

// Writes what the batch holds but for uv and normals, which are solved once more.
void write_batch(const View& view, PixelBatch& batch) {
  if (view.frame.color) shade_batch(view, batch);
  for (const BatchRun& run : batch.runs) {
    const std::size_t at = std::size_t(run.job->row) * view.frame.width + run.first;
    const int length = run.last - run.first;
    if (view.frame.depth) write_depths(view, at, length, batch.key + run.offset);
    if (view.frame.color) stream_copy(batch.color + 4 * run.offset, 4 * length, view.frame.color + 4 * at);
  }
}

// A whole piece whose key plane is exact: depth is linear and the normal the same everywhere.
HWY_NOINLINE void SolvePlanar(const View& view, const PixelJob* jobs, std::size_t count, PixelBatch& batch) {
  const Lanes d;
  const Camera& camera = view.camera;
  const KeyPlane& plane = view.piece.key_plane;
  const int width = int(hn::Lanes(d));
  const double at_centre = plane.key(0.5 * camera.width, 0.5 * camera.height);
  const double size = camera.perspective ? std::max(std::fabs(at_centre), view.piece.key.magnitude()) : 1.0;
  const double nx = camera.scale * plane.by_x / size, ny = -camera.scale * plane.by_y / size;
  const double nz = camera.perspective ? at_centre / size : -1.0;
  std::fill_n(batch.nx, PixelBatch::kSize, float(nx));
  std::fill_n(batch.ny, PixelBatch::kSize, float(ny));
  std::fill_n(batch.nz, PixelBatch::kSize, float(nz));
  batch.clear();
  for (const PixelJob *job = jobs, *end = jobs + count; job != end; ++job) {
    const double level = plane.at + plane.by_y * (job->row + 0.5);
    for (int px = job->first; px < job->last;) {
      if (batch.room() == 0) write_batch(view, batch), batch.clear();
      const int part = std::min(batch.room(), job->last - px);
      batch.runs.push_back({job, px, px + part, batch.size});
      for (int k = 0; k < part; ++k) batch.key[batch.size + k] = plane.by_x * (px + k + 0.5) + level;
      const std::size_t at = std::size_t(job->row) * view.frame.width + px;
      for (int k = 0; k < part && view.frame.normal; k += width) {
        write_normals(d, view, at + k, std::min(width, part - k), hn::Set(d, nx), hn::Set(d, ny), hn::Set(d, nz));
      }
      batch.size += part, px += part;
    }
  }
  write_batch(view, batch);
}

// NetKind: Net or CentredNet.
template <class NetKind>
struct SolveCurved {
  const View& view;
  const NetKind& net;
  const PixelJob* jobs;
  std::size_t count;
  std::vector<HardPixel>& hard;
  PixelScratch& scratch;

  template <int kN, int kM, bool kRational>
  HWY_NOINLINE HWY_ATTR void operator()() const {
    std::vector<const PixelJob*>& long_jobs = scratch.long_jobs;
    JobGuesses& guesses = scratch.guesses;
    PixelBatch& batch = scratch.batch;
    RetryBatch& retries = scratch.retries;
    batch.clear();
    retries.size = 0;
    long_jobs.clear();
    const auto make_room = [&](int most) {
      if (batch.room() < most) finish<kN, kM, kRational>(batch, retries);
    };
    for (const PixelJob *job = jobs, *end = jobs + count; job != end; ++job) {
      if (job->last - job->first > kLooseJob) {
        long_jobs.push_back(job);
        continue;
      }
      make_room(kLooseJob);
      add_loose(*job, batch, retries);
    }
    batch.size = (batch.size + kWidest - 1) / kWidest * kWidest;
    guesses.solve<kN, kM, kRational>(net, long_jobs);
    for (std::size_t j = 0; j < long_jobs.size(); ++j) {
      GuessedJob guessed(guesses, j, *long_jobs[j]);
      while (!guessed.done()) {
        make_room(kWidest);
        step_run<kN, kM, kRational>(guess_run(guessed, batch), batch, retries);
      }
    }
    finish<kN, kM, kRational>(batch, retries);
  }

 private:
  static constexpr int kWidest = 8;  // doubles in a register, at most
  static constexpr int kGroup = 8;   // vectors

  static void add_loose(const PixelJob& job, PixelBatch& batch, RetryBatch& retries) {
    const Span& span = *job.span;
    const SpanProgress along(span);
    batch.runs.push_back({&job, job.first, job.last, batch.size});
    for (int px = job.first; px < job.last; ++px) {
      const double p = along.at(px + 0.5);
      retries.add(batch.size++, job, px, span.a0 + p * (span.a1 - span.a0), span.b0 + p * (span.b1 - span.b0));
    }
  }

  // Appends as many pixels of the job as there is room for, with guesses of their parameters.
  static HWY_INLINE BatchRun guess_run(GuessedJob& guessed, PixelBatch& batch) {
    const BatchRun run{&guessed.job, guessed.px, std::min(guessed.job.last, guessed.px + batch.room()), batch.size};
    guessed.guess_until(run.last, batch.a + run.offset, batch.b + run.offset);
    batch.runs.push_back(run);
    batch.size += (run.last - run.first + kWidest - 1) / kWidest * kWidest;
    return run;
  }

  // One step for the run's pixels.
  template <int kN, int kM, bool kRational>
  HWY_INLINE void step_run(const BatchRun& run, PixelBatch& batch, RetryBatch& retries) const {
    const Lanes d;
    const int width = int(hn::Lanes(d)), length = run.last - run.first;
    const Span& span = *run.job->span;
    const SpanBox box(d, hn::Set(d, std::min(span.a0, span.a1)), hn::Set(d, std::max(span.a0, span.a1)));
    const Origin origin = origin_of(net);
    const Vec y = hn::Set(d, run.job->row + 0.5), right = hn::Set(d, run.job->last - 0.5), step = hn::Set(d, width);
    Vec centre = hn::Iota(d, run.first + 0.5);
    uint8_t sound[PixelBatch::kSize / 2 + 8];  // bits of each vector; at least two doubles in each
    const int vectors = (length + width - 1) / width;
    // The step waits for a division and what follows from it: several vectors are under way at once.
    LaneJet jets[kGroup];
    for (int group = 0; group < vectors; group += kGroup) {
      const int end = std::min(vectors, group + kGroup);
      for (int v = group; v < end; ++v) {
        const int at = run.offset + v * width;
        Vec a = hn::LoadU(d, batch.a + at), b = hn::LoadU(d, batch.b + at);
        box.clamp(a, b);
        hn::StoreU(a, d, batch.a + at), hn::StoreU(b, d, batch.b + at);
        evaluate_lanes<kN, kM, kRational>(d, net, a, b, jets[v - group]);
      }
      for (int v = group; v < end; ++v, centre = hn::Add(centre, step)) {
        const int at = run.offset + v * width;
        const Vec x = hn::Min(centre, right), from_a = hn::LoadU(d, batch.a + at), from_b = hn::LoadU(d, batch.b + at);
        const LaneJet& jet = jets[v - group];
        Point point;
        newton_step<kRational>(d, view, origin, jet, x, y, kShadeTolerance, point);
        if (!hn::AllTrue(d, point.accurate)) {
          second_step<kN, kM, kRational>(d, view, net, origin, jet, hn::Add(from_a, point.da),
                                         hn::Add(from_b, point.db), x, y, point);
        }
        const Vec a = hn::Add(from_a, point.da), b = hn::Add(from_b, point.db);
        const Mask good = hn::And(hn::And(point.accurate, point.regular), box.contains(a, b));
        hn::StoreMaskBits(d, good, sound + v);
        store(d, batch, at, a, b, point);
      }
    }
    const int whole = (1 << width) - 1;
    for (int v = 0; v < vectors; ++v) {
      if ((sound[v] & whole) != whole) retry(batch, run, v * width, width, sound[v], retries);
    }
  }

  static HWY_INLINE void store(Lanes d, PixelBatch& batch, int at, Vec a, Vec b, const Point& point) {
    const hn::Rebind<float, Lanes> df;
    hn::StoreU(a, d, batch.a + at), hn::StoreU(b, d, batch.b + at), hn::StoreU(point.key, d, batch.key + at);
    hn::StoreU(hn::DemoteTo(df, point.nx), df, batch.nx + at);
    hn::StoreU(hn::DemoteTo(df, point.ny), df, batch.ny + at);
    hn::StoreU(hn::DemoteTo(df, point.nz), df, batch.nz + at);
  }

  static void retry(const PixelBatch& batch, const BatchRun& run, int first, int width, uint8_t sound,
                    RetryBatch& retries) {
    for (int k = 0; k < width && run.first + first + k < run.last; ++k) {
      const int entry = run.offset + first + k;
      if (!(sound >> k & 1)) retries.add(entry, *run.job, run.first + first + k, batch.a[entry], batch.b[entry]);
    }
  }

  // Solves what is left of the batch, writes it, and empties it.
  template <int kN, int kM, bool kRational>
  HWY_NOINLINE HWY_ATTR void finish(PixelBatch& batch, RetryBatch& retries) const {
    const Lanes d;
    const int width = int(hn::Lanes(d));
    if (retries.size > 0) retries.pad(width);
    for (int k = 0; k < retries.size; k += width) solve_retries<kN, kM, kRational>(retries, k, batch);
    retries.size = 0;
    if (view.values) write_batch(view, batch);
    for (const BatchRun& run : batch.runs) {
      if (view.frame.uv) write_uv(run, batch);
      if (view.values && view.frame.normal) solve_normals<kN, kM, kRational>(run, batch);
    }
    batch.clear();
  }

  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve_retries(const RetryBatch& retries, int first, PixelBatch& batch) const {
    const Lanes d;
    const SpanBox box(d, hn::LoadU(d, retries.a_lo + first), hn::LoadU(d, retries.a_hi + first));
    const Vec x = hn::LoadU(d, retries.x + first), y = hn::LoadU(d, retries.y + first);
    Vec a = hn::LoadU(d, retries.a + first), b = hn::LoadU(d, retries.b + first);
    Point point;
    const Mask good = iterate<kN, kM, kRational>(d, box, x, y, kMaxRetries, kShadeTolerance, a, b, point);
    HWY_ALIGN double values[6][8];
    uint8_t sound[8];
    const Vec results[6] = {a, b, point.key, point.nx, point.ny, point.nz};
    for (int c = 0; c < 6; ++c) hn::Store(results[c], d, values[c]);
    hn::StoreMaskBits(d, good, sound);
    for (int k = 0; k < int(hn::Lanes(d)) && first + k < retries.size; ++k) {
      const int entry = retries.entry[first + k];
      batch.a[entry] = values[0][k], batch.b[entry] = values[1][k], batch.key[entry] = values[2][k];
      batch.nx[entry] = float(values[3][k]), batch.ny[entry] = float(values[4][k]),
      batch.nz[entry] = float(values[5][k]);
      if (sound[0] >> k & 1) continue;
      const PixelJob& job = *retries.job[first + k];
      hard.push_back({job.span, job.row, int(retries.x[first + k]), view.values, false, view.frame.uv != nullptr});
    }
  }

  // Steps until all lanes are accurate; returns which of them are sound too.
  template <int kN, int kM, bool kRational>
  HWY_INLINE Mask iterate(Lanes d, const SpanBox& box, Vec x, Vec y, int iterations, double normal_tolerance, Vec& a,
                          Vec& b, Point& point) const {
    const Origin origin = origin_of(net);
    for (int iteration = 1;; ++iteration) {
      LaneJet jet;
      box.clamp(a, b);
      evaluate_lanes<kN, kM, kRational>(d, net, a, b, jet);
      newton_step<kRational>(d, view, origin, jet, x, y, normal_tolerance, point);
      a = hn::Add(a, point.da), b = hn::Add(b, point.db);
      if (iteration == iterations || hn::AllTrue(d, point.accurate)) break;
    }
    return hn::And(hn::And(point.accurate, point.regular), box.contains(a, b));
  }

  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve_normals(const BatchRun& run, const PixelBatch& batch) const {
    const Lanes d;
    const int width = int(hn::Lanes(d)), length = run.last - run.first;
    const Span& span = *run.job->span;
    const SpanBox box(d, hn::Set(d, std::min(span.a0, span.a1)), hn::Set(d, std::max(span.a0, span.a1)));
    const Vec y = hn::Set(d, run.job->row + 0.5), right = hn::Set(d, run.last - 0.5);
    for (int k = 0; k < length; k += width) {
      const int part = std::min(width, length - k);
      const Vec x = hn::Min(hn::Iota(d, run.first + k + 0.5), right);
      Vec a = hn::LoadU(d, batch.a + run.offset + k), b = hn::LoadU(d, batch.b + run.offset + k);
      Point point;
      const Mask good = iterate<kN, kM, kRational>(d, box, x, y, 2, kNormalTolerance, a, b, point);
      const std::size_t at = std::size_t(run.job->row) * view.frame.width + run.first + k;
      write_normals(d, view, at, part, point.nx, point.ny, point.nz);
      uint8_t sound[8];
      hn::StoreMaskBits(d, good, sound);
      for (int i = 0; i < part; ++i) {
        if (!(sound[0] >> i & 1)) hard.push_back({&span, run.job->row, run.first + k + i, false, true, false});
      }
    }
  }

  void write_uv(const BatchRun& run, const PixelBatch& batch) const {
    double* uv = view.frame.uv + 2 * (std::size_t(run.job->row) * view.frame.width + run.first);
    for (int k = run.offset; k < run.offset + run.last - run.first; ++k, uv += 2) {
      view.piece.face_from_local(batch.a[k], batch.b[k], uv, uv + 1);
    }
  }
};

void SolvePixels(const Camera& camera, const Frame& frame, const Piece& piece, const float* color, const PixelJob* jobs,
                 std::size_t count, std::vector<HardPixel>& hard) {
  // Planes have a short way to all but uv.
  const View view(camera, frame, piece, color, !piece.planar);
  thread_local PixelScratch scratch;
  if (piece.planar) SolvePlanar(view, jobs, count, scratch.batch);
  if (piece.planar && !frame.uv) return;
  thread_local std::vector<double> storage;
  const CentredNet centred = centre_net(piece.net, storage);
  if (centred.error < kCentredTolerance) {
    for_degrees(piece.net.n, piece.net.m, piece.rational,
                SolveCurved<CentredNet>{view, centred, jobs, count, hard, scratch});
  } else {
    SolveCurved<Net>{view, piece.net, jobs, count, hard, scratch}.template operator()<-1, -1, true>();
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nofacet {

HWY_EXPORT(SolvePixels);

void solve_pixels(const Scene& scene, const Camera& camera, const Frame& frame, const Piece& piece,
                  const PixelJob* jobs, std::size_t count, std::vector<HardPixel>& hard) {
  for (const PixelJob *job = jobs, *end = jobs + count; job != end && frame.face; ++job) {
    int32_t* row = frame.face + std::size_t(job->row) * frame.width;
    fill(row + job->first, job->last - job->first, scene.face_number(piece.face));
  }
  if (!frame.depth && !frame.color && !frame.uv && !frame.normal) return;
  if ((piece.kind > CutKind::fold || is_tiny(piece)) && !piece.planar) {
    for (const PixelJob *job = jobs, *end = jobs + count; job != end; ++job) {
      for (int px = job->first; px < job->last; ++px) {
        hard.push_back({job->span, job->row, px, true, frame.normal != nullptr, frame.uv != nullptr});
      }
    }
    return;
  }
  const float* color = scene.color(piece.face);
  HWY_DYNAMIC_DISPATCH(SolvePixels)(camera, frame, piece, color, jobs, count, hard);
}

void solve_hard_pixel(const Scene& scene, const Camera& camera, const Frame& frame, const HardPixel& pixel) {
  const Span& span = *pixel.span;
  const Piece& piece = *span.piece;
  const double x = pixel.px + 0.5, y = pixel.row + 0.5;
  const double fraction = std::clamp((x - span.x0) / (span.x1 - span.x0), 0.0, 1.0);
  SurfaceSample sample{span.a0 + fraction * (span.a1 - span.a0), span.b0 + fraction * (span.b1 - span.b0), {}};
  solve_sample(span, x, y, &sample);
  const std::size_t at = std::size_t(pixel.row) * frame.width + pixel.px;
  if (pixel.uv) piece.face_from_local(sample.a, sample.b, frame.uv + 2 * at, frame.uv + 2 * at + 1);
  if (pixel.values && frame.depth) frame.depth[at] = camera.depth(sample.jet.p);
  if (!pixel.normal && !(pixel.values && frame.color)) return;
  double n[3];
  surface_normal(scene, piece, camera, sample, n);
  if (pixel.normal) {
    for (int c = 0; c < 3; ++c) {
      frame.normal[3 * at + c] = float(n[0] * camera.right[c] + n[1] * camera.up[c] + n[2] * camera.forward[c]);
    }
  }
  if (!pixel.values || !frame.color) return;
  shade(camera, sample, n, scene.color(piece.face), frame.color + 4 * at);
  frame.color[4 * at + 3] = 1.0f;
}

}  // namespace nofacet
#endif

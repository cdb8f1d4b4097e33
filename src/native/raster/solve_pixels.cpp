// Compiled once for every instruction set that Highway knows of; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/solve_pixels.cpp"
#include "raster/solve_pixels.h"

#include <algorithm>
#include <cmath>

#include "hwy/foreach_target.h"
#include "raster/coarse_lanes-inl.h"
#include "raster/knots_lanes-inl.h"
#include "raster/newton_lanes-inl.h"
#include "raster/pixel_batch.h"
#include "raster/shade.h"
#include "raster/shade_lanes-inl.h"
#include "raster/stream.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {
namespace {

// Jobs up to this long have no knots: their pixels are guessed evenly along the span, and take their first steps in
// single precision. Where a step costs more, knots pay sooner.
constexpr int kShortJob = 96, kShortCostlyJob = 24;
constexpr int kCoarseSteps = 6;
// A step of this size leaves an error of about its square, where single precision ends.
constexpr float kCoarseStep = 2e-4f;
// Every pixel then takes a step, and this many more if that was not enough.
constexpr int kMaxRetries = 8;
// A thread's memory. The functions that use it get it as an argument: a thread's own variables are slow to find.
struct PixelScratch {
  std::vector<const PixelJob*> long_jobs;
  JobGuesses guesses;
  PixelBatch batch;
  CoarseBatch coarse;
  std::vector<float> coarse_net;
};

// Appends pixels of the job to the batch, from `first` on, and fetches what will be written of them.
HWY_INLINE const BatchRun& start_run(const View& view, PixelBatch& batch, const PixelJob& job, int first) {
  const BatchRun& run = batch.add(job, first);
  const std::size_t at = std::size_t(job.row) * view.frame.width + run.first, length = run.last - run.first;
  if (view.frame.depth) prefetch_ends(view.frame.depth + at, length);
  if (view.frame.color) prefetch_ends(view.frame.color + 4 * at, 4 * length);
  return run;
}

// Writes what the batch holds but for uv and normals, which are solved once more.
void write_batch(const View& view, PixelBatch& batch) {
  if (view.frame.color) shade_batch(view, batch);
  for (const BatchRun& run : batch.all_runs()) {
    const std::size_t at = std::size_t(run.job->row) * view.frame.width + run.first;
    const int length = run.last - run.first;
    if (view.frame.depth) write_depths(view, at, length, batch.key + run.offset);
    if (view.frame.color) copy_stretch(batch.color + 4 * run.offset, 4 * length, view.frame.color + 4 * at);
  }
}

// A whole piece whose key plane is exact: depth is linear and the normal the same everywhere.
HWY_NOINLINE void SolvePlanar(const View& view, const PixelJob* jobs, std::size_t count, PixelBatch& batch) {
  const Lanes d;
  const Camera& camera = view.camera;
  const KeyPlane& plane = view.piece.hull.plane;
  const int width = int(hn::Lanes(d));
  const double at_centre = plane.key(0.5 * camera.width, 0.5 * camera.height);
  const double size = camera.perspective ? std::max(std::fabs(at_centre), view.piece.hull.key.magnitude()) : 1.0;
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
      const BatchRun& run = start_run(view, batch, *job, px);
      const int part = run.last - px;
      for (int k = 0; k < part; ++k) batch.key[run.offset + k] = plane.by_x * (px + k + 0.5) + level;
      const std::size_t at = std::size_t(job->row) * view.frame.width + px;
      for (int k = 0; k < part && view.frame.normal; k += width) {
        write_normals(d, view, at + k, std::min(width, part - k), hn::Set(d, nx), hn::Set(d, ny), hn::Set(d, nz));
      }
      px += part;
    }
  }
  write_batch(view, batch);
}

// NetKind: Net or CentredNet. `centred` is the same net, good enough for first steps.
template <class NetKind>
struct SolveCurved {
  const View& view;
  const NetKind& net;
  const CentredNet& centred;
  const PixelJob* jobs;
  std::size_t count;
  std::vector<HardPixel>& hard;
  PixelScratch& scratch;

  template <int kN, int kM, bool kRational>
  HWY_NOINLINE HWY_ATTR void operator()() const {
    PixelBatch& batch = scratch.batch;
    batch.clear();
    scratch.long_jobs.clear();
    const CoarseNet coarse_net(centred, scratch.coarse_net);
    for (const PixelJob *job = jobs, *end = jobs + count; job != end; ++job) {
      if (job->last - job->first > (kN < 0 ? kShortCostlyJob : kShortJob)) {
        scratch.long_jobs.push_back(job);
        continue;
      }
      for (int px = job->first; px < job->last;) {
        if (batch.room() == 0) finish_short<kN, kM, kRational>(coarse_net);
        const BatchRun& run = add_run(*job, px);
        guess_evenly(run);
        px = run.last;
      }
    }
    finish_short<kN, kM, kRational>(coarse_net);
    JobGuesses& guesses = scratch.guesses;
    guesses.solve<kN, kM, kRational>(net, scratch.long_jobs);
    for (std::size_t j = 0; j < scratch.long_jobs.size(); ++j) {
      GuessedJob guessed(guesses, j, *scratch.long_jobs[j]);
      while (!guessed.done()) {
        if (batch.room() == 0) finish<kN, kM, kRational>();
        const BatchRun& run = add_run(guessed.job, guessed.px);
        guessed.guess_until(run.last, batch.a + run.offset, batch.b + run.offset);
      }
    }
    finish<kN, kM, kRational>();
  }

 private:
  static constexpr int kGroup = 8;    // vectors
  static constexpr int kWidest = 16;  // numbers in a register, at most

  // Appends pixels to the batch: their centres and where their parameters may lie.
  HWY_INLINE const BatchRun& add_run(const PixelJob& job, int first) const {
    const Lanes d;
    PixelBatch& batch = scratch.batch;
    const BatchRun& run = start_run(view, batch, job, first);
    const Span& span = *job.span;
    const Vec y = hn::Set(d, job.row + 0.5), width = hn::Set(d, double(hn::Lanes(d)));
    const Vec lo = hn::Set(d, std::min(span.a0, span.a1)), hi = hn::Set(d, std::max(span.a0, span.a1));
    Vec x = hn::Iota(d, first + 0.5);
    for (int k = run.offset, end = batch.size; k < end; k += int(hn::Lanes(d))) {
      hn::StoreU(x, d, batch.x + k), hn::StoreU(y, d, batch.y + k);
      hn::StoreU(lo, d, batch.a_lo + k), hn::StoreU(hi, d, batch.a_hi + k);
      x = hn::Add(x, width);
    }
    return run;
  }

  HWY_INLINE void guess_evenly(const BatchRun& run) const {
    const Lanes d;
    PixelBatch& batch = scratch.batch;
    const SpanProgress along(*run.job->span);
    for (int k = run.offset; k < run.offset + run.last - run.first; k += int(hn::Lanes(d))) {
      Vec a, b;
      guess_on_span(d, *run.job->span, along.at(d, hn::LoadU(d, batch.x + k)), a, b);
      hn::StoreU(a, d, batch.a + k), hn::StoreU(b, d, batch.b + k);
    }
  }

  // Fills a last, incomplete vector with copies of the last entry.
  void pad() const {
    PixelBatch& batch = scratch.batch;
    const int end = (batch.size + kWidest - 1) / kWidest * kWidest;
    for (double* list : {batch.x, batch.y, batch.a_lo, batch.a_hi, batch.a, batch.b}) {
      std::fill(list + batch.size, list + end, list[batch.size - 1]);
    }
  }

  template <int kN, int kM, bool kRational>
  HWY_NOINLINE HWY_ATTR void finish_short(const CoarseNet& coarse_net) const {
    if (scratch.batch.size == 0) return;
    pad();
    take_coarse_steps<kN, kM, kRational>(coarse_net);
    finish<kN, kM, kRational>();
  }

  // First steps for the whole batch.
  template <int kN, int kM, bool kRational>
  HWY_INLINE void take_coarse_steps(const CoarseNet& coarse_net) const {
    const Lanes d;
    const hn::Rebind<float, Lanes> half;
    const FloatLanes df;
    const Origin origin = origin_of(centred);
    PixelBatch& batch = scratch.batch;
    CoarseBatch& coarse = scratch.coarse;
    const int width = int(hn::Lanes(d)), wide = int(hn::Lanes(df));
    const int size = (batch.size + wide - 1) / wide * wide;
    const auto demote = [&](const double* from, double middle, float* to) HWY_ATTR {
      const Vec shift = hn::Set(d, middle);
      for (int k = 0; k < size; k += width) {
        hn::StoreU(hn::DemoteTo(half, hn::Sub(hn::LoadU(d, from + k), shift)), half, to + k);
      }
    };
    demote(batch.x, origin.x, coarse.x), demote(batch.y, origin.y, coarse.y);
    demote(batch.a_lo, 0.5, coarse.a_lo), demote(batch.a_hi, 0.5, coarse.a_hi);
    demote(batch.a, 0.5, coarse.a), demote(batch.b, 0.5, coarse.b);
    for (int k = 0; k < size; k += wide) {
      const auto at = [&](const float* list) HWY_ATTR { return hn::LoadU(df, list + k); };
      FloatVec a = at(coarse.a), b = at(coarse.b);
      solve_coarse<kN, kM, kRational>(df, coarse_net, at(coarse.a_lo), at(coarse.a_hi), at(coarse.x), at(coarse.y),
                                      kCoarseSteps, kCoarseStep, a, b);
      hn::StoreU(a, df, coarse.a + k), hn::StoreU(b, df, coarse.b + k);
    }
    const auto promote = [&](const float* from, double* to) HWY_ATTR {
      const Vec shift = hn::Set(d, 0.5);
      for (int k = 0; k < size; k += width) {
        hn::StoreU(hn::Add(hn::PromoteTo(d, hn::LoadU(half, from + k)), shift), d, to + k);
      }
    };
    promote(coarse.a, batch.a), promote(coarse.b, batch.b);
  }

  // Solves the batch from its guesses, writes it and empties it.
  template <int kN, int kM, bool kRational>
  HWY_NOINLINE HWY_ATTR void finish() const {
    PixelBatch& batch = scratch.batch;
    if (batch.size == 0) return;
    pad();
    take_steps<kN, kM, kRational>();
    for (int k = 0; k < batch.failed_count; k += int(hn::Lanes(Lanes()))) retry<kN, kM, kRational>(k);
    if (view.values) write_batch(view, batch);
    for (const BatchRun& run : batch.all_runs()) {
      if (view.frame.uv) write_uv(run, batch);
      if (view.values && view.frame.normal) solve_normals<kN, kM, kRational>(run);
    }
    batch.clear();
  }

  SpanBox box_at(Lanes d, int entry) const {
    return SpanBox(d, hn::LoadU(d, scratch.batch.a_lo + entry), hn::LoadU(d, scratch.batch.a_hi + entry));
  }

  // One step for all pixels, or two with the same derivatives; what that does not solve is noted.
  template <int kN, int kM, bool kRational>
  HWY_INLINE void take_steps() const {
    const Lanes d;
    PixelBatch& batch = scratch.batch;
    const int width = int(hn::Lanes(d));
    const Origin origin = origin_of(net);
    const Vec calm = hn::Set(d, view.calm_step);
    // The step waits for a division and what follows from it: several vectors are under way at once.
    LaneJet jets[kGroup];
    for (int group = 0; group < batch.size; group += kGroup * width) {
      const int end = std::min(batch.size, group + kGroup * width);
      LaneJet* jet = jets;
      for (int k = group; k < end; k += width) {
        Vec a = hn::LoadU(d, batch.a + k), b = hn::LoadU(d, batch.b + k);
        box_at(d, k).clamp(a, b);
        hn::StoreU(a, d, batch.a + k), hn::StoreU(b, d, batch.b + k);
        evaluate_lanes<kN, kM, kRational>(d, net, a, b, *jet++);
      }
      jet = jets;
      for (int k = group; k < end; k += width, ++jet) {
        const Vec x = hn::LoadU(d, batch.x + k), y = hn::LoadU(d, batch.y + k);
        const Vec from_a = hn::LoadU(d, batch.a + k), from_b = hn::LoadU(d, batch.b + k);
        Point point;
        newton_step<kRational>(d, view, origin, *jet, x, y, point);
        Mask good = hn::Le(point.step, calm);
        if (!hn::AllTrue(d, good)) good = is_steady(d, view, point);
        if (!hn::AllTrue(d, good)) {
          Verdict verdict = judge(d, view, point, kShadeTolerance);
          if (!hn::AllTrue(d, verdict.accurate)) {
            second_step<kN, kM, kRational>(d, view, net, origin, *jet, hn::Add(from_a, point.da),
                                           hn::Add(from_b, point.db), x, y, point, verdict);
          }
          good = hn::And(verdict.accurate, verdict.regular);
        }
        const Vec a = hn::Add(from_a, point.da), b = hn::Add(from_b, point.db);
        good = hn::And(good, box_at(d, k).contains(a, b));
        store(d, k, a, b, point);
        if (!hn::AllTrue(d, good)) note_failed(d, good, k);
      }
    }
  }

  HWY_INLINE void store(Lanes d, int entry, Vec a, Vec b, const Point& point) const {
    const hn::Rebind<float, Lanes> df;
    PixelBatch& batch = scratch.batch;
    hn::StoreU(a, d, batch.a + entry), hn::StoreU(b, d, batch.b + entry), hn::StoreU(point.key, d, batch.key + entry);
    hn::StoreU(hn::DemoteTo(df, point.nx), df, batch.nx + entry);
    hn::StoreU(hn::DemoteTo(df, point.ny), df, batch.ny + entry);
    hn::StoreU(hn::DemoteTo(df, point.nz), df, batch.nz + entry);
  }

  void note_failed(Lanes d, Mask good, int first) const {
    PixelBatch& batch = scratch.batch;
    uint8_t sound[8];
    hn::StoreMaskBits(d, good, sound);
    for (int k = 0; k < int(hn::Lanes(d)) && first + k < batch.size; ++k) {
      if (!(sound[0] >> k & 1)) batch.failed[batch.failed_count++] = first + k;
    }
  }

  // Iterates a vector of failed pixels, from the one in place `first` of their list on.
  template <int kN, int kM, bool kRational>
  HWY_INLINE void retry(int first) const {
    const Lanes d;
    PixelBatch& batch = scratch.batch;
    const int width = int(hn::Lanes(d)), part = std::min(width, batch.failed_count - first);
    HWY_ALIGN double packed[6][8];
    for (int k = 0; k < width; ++k) {
      const int entry = batch.failed[first + std::min(k, part - 1)];
      const double* lists[6] = {batch.x, batch.y, batch.a, batch.b, batch.a_lo, batch.a_hi};
      for (int c = 0; c < 6; ++c) packed[c][k] = lists[c][entry];
    }
    const auto at = [&](int c) HWY_ATTR { return hn::Load(d, packed[c]); };
    const SpanBox box(d, at(4), at(5));
    Vec a = at(2), b = at(3);
    Point point;
    const Mask good = iterate<kN, kM, kRational>(d, box, at(0), at(1), kMaxRetries, kShadeTolerance, a, b, point);
    const Vec results[6] = {a, b, point.key, point.nx, point.ny, point.nz};
    for (int c = 0; c < 6; ++c) hn::Store(results[c], d, packed[c]);
    uint8_t sound[8];
    hn::StoreMaskBits(d, good, sound);
    for (int k = 0; k < part; ++k) {
      const int entry = batch.failed[first + k];
      batch.a[entry] = packed[0][k], batch.b[entry] = packed[1][k], batch.key[entry] = packed[2][k];
      batch.nx[entry] = float(packed[3][k]), batch.ny[entry] = float(packed[4][k]),
      batch.nz[entry] = float(packed[5][k]);
      if (sound[0] >> k & 1) continue;
      const PixelJob& job = *batch.run_of(entry).job;
      hard.push_back({job.span, job.row, int(batch.x[entry]), view.values, false, view.frame.uv != nullptr});
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
      newton_step<kRational>(d, view, origin, jet, x, y, point);
      a = hn::Add(a, point.da), b = hn::Add(b, point.db);
      const Verdict verdict = judge(d, view, point, normal_tolerance);
      if (iteration < iterations && !hn::AllTrue(d, verdict.accurate)) continue;
      return hn::And(hn::And(verdict.accurate, verdict.regular), box.contains(a, b));
    }
  }

  template <int kN, int kM, bool kRational>
  HWY_INLINE void solve_normals(const BatchRun& run) const {
    const Lanes d;
    const PixelBatch& batch = scratch.batch;
    const int width = int(hn::Lanes(d)), length = run.last - run.first;
    for (int k = 0; k < length; k += width) {
      const int part = std::min(width, length - k), entry = run.offset + k;
      Vec a = hn::LoadU(d, batch.a + entry), b = hn::LoadU(d, batch.b + entry);
      Point point;
      const Mask good = iterate<kN, kM, kRational>(d, box_at(d, entry), hn::LoadU(d, batch.x + entry),
                                                   hn::LoadU(d, batch.y + entry), 2, kNormalTolerance, a, b, point);
      const std::size_t at = std::size_t(run.job->row) * view.frame.width + run.first + k;
      write_normals(d, view, at, part, point.nx, point.ny, point.nz);
      uint8_t sound[8];
      hn::StoreMaskBits(d, good, sound);
      for (int i = 0; i < part; ++i) {
        if (!(sound[0] >> i & 1)) hard.push_back({run.job->span, run.job->row, run.first + k + i, false, true, false});
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
  const CentredNet& centred = piece.centred;
  if (piece.has_accurate_centred_net()) {
    for_degrees(centred.n, centred.m, piece.rational,
                SolveCurved<CentredNet>{view, centred, centred, jobs, count, hard, scratch});
  } else {
    SolveCurved<Net>{view, piece.net, centred, jobs, count, hard, scratch}.template operator()<-1, -1, true>();
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
    fill_stretch(row + job->first, job->last - job->first, scene.face_number(piece.face));
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

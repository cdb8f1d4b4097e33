// Colours, depths and normals of a row of solved pixels. Included once for every instruction set (Highway).
#if defined(NOFACET_RASTER_SHADE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NOFACET_RASTER_SHADE_LANES_INL_H_
#undef NOFACET_RASTER_SHADE_LANES_INL_H_
#else
#define NOFACET_RASTER_SHADE_LANES_INL_H_
#endif

#include "light.h"
#include "raster/newton_lanes-inl.h"
#include "raster/pixel_batch.h"
#include "raster/stream.h"

HWY_BEFORE_NAMESPACE();
namespace nofacet {
namespace HWY_NAMESPACE {

struct Shade {
  FloatVec red, green, blue;
};

// As shade() in raster/shade.h, in single precision; `fx` .. `fz` a normal in eye space of any length, (`x`, `y`) the
// pixels' centres, read in perspective only.
HWY_INLINE Shade shade_lanes(const View& view, FloatVec fx, FloatVec fy, FloatVec fz, FloatVec x, FloatVec y) {
  const FloatLanes df;
  const auto set = [&](double value) HWY_ATTR { return hn::Set(df, float(value)); };
  const auto square3 = [&](FloatVec p, FloatVec q, FloatVec r)
                           HWY_ATTR { return hn::MulAdd(p, p, hn::MulAdd(q, q, hn::Mul(r, r))); };
  const Camera& camera = view.camera;
  const FloatVec one = set(1.0), zero = hn::Zero(df);
  const FloatVec inverse = inverse_root(df, square3(fx, fy, fz));
  fx = hn::Mul(fx, inverse), fy = hn::Mul(fy, inverse), fz = hn::Mul(fz, inverse);
  const auto dot = [&](FloatVec px, FloatVec py, FloatVec pz)
                       HWY_ATTR { return hn::MulAdd(fx, px, hn::MulAdd(fy, py, hn::Mul(fz, pz))); };
  FloatVec facing, gloss;
  if (camera.perspective) {
    FloatVec ex = hn::Sub(set(0.5 * camera.width), x), ey = hn::Sub(y, set(0.5 * camera.height)),
             ez = set(-camera.scale);
    const FloatVec length = inverse_root(df, square3(ex, ey, ez));
    ex = hn::Mul(ex, length), ey = hn::Mul(ey, length), ez = hn::Mul(ez, length);
    facing = dot(ex, ey, ez);
    const FloatVec hx = hn::Add(ex, set(kKeyLight[0])), hy = hn::Add(ey, set(kKeyLight[1]));
    const FloatVec hz = hn::Add(ez, set(kKeyLight[2]));
    gloss = hn::Mul(dot(hx, hy, hz), inverse_root(df, square3(hx, hy, hz)));
  } else {
    facing = fz;
    gloss = dot(set(view.half[0]), set(view.half[1]), set(view.half[2]));
  }
  facing = hn::Min(one, hn::Abs(facing)), gloss = hn::Max(zero, gloss);
  const FloatVec key = hn::Max(zero, dot(set(kKeyLight[0]), set(kKeyLight[1]), set(kKeyLight[2])));
  const FloatVec up = dot(set(camera.right[2]), set(camera.up[2]), set(camera.forward[2]));
  const FloatVec g2 = hn::Mul(gloss, gloss), g4 = hn::Mul(g2, g2), g8 = hn::Mul(g4, g4), g16 = hn::Mul(g8, g8);
  FloatVec diffuse = hn::MulAdd(set(0.5 * kSky), up, set(kAmbient + 0.5 * kSky));
  diffuse = hn::MulAdd(set(kFacing), facing, diffuse);
  diffuse = hn::MulAdd(set(kKey), key, diffuse);
  const FloatVec highlight = hn::Mul(set(kGloss), hn::Mul(g16, g16));
  const auto channel = [&](int c) HWY_ATTR {
    return hn::Min(one, hn::MulAdd(hn::Set(df, view.color[c]), diffuse, highlight));
  };
  return {channel(0), channel(1), channel(2)};
}

// Shades the whole batch.
HWY_INLINE void shade_batch(const View& view, PixelBatch& batch) {
  const FloatLanes df;
  const int width = int(hn::Lanes(df));
  for (const BatchRun& run : batch.all_runs()) {
    if (!view.camera.perspective) break;
    for (int k = 0; k < run.last - run.first; ++k) {
      batch.pixel_x[run.offset + k] = float(run.first + k) + 0.5f;
      batch.pixel_y[run.offset + k] = float(run.job->row) + 0.5f;
    }
  }
  for (int k = 0; k < batch.size; k += width) {
    const auto at = [&](const float* list) HWY_ATTR { return hn::LoadU(df, list + k); };
    const Shade rgb = shade_lanes(view, at(batch.nx), at(batch.ny), at(batch.nz), at(batch.pixel_x), at(batch.pixel_y));
    hn::StoreInterleaved4(rgb.red, rgb.green, rgb.blue, hn::Set(df, 1.0f), df, batch.color + 4 * k);
  }
}

// Writes the world normals of a vector's first `count` pixels.
HWY_INLINE void write_normals(Lanes d, const View& view, std::size_t at, int count, Vec nx, Vec ny, Vec nz) {
  const hn::Rebind<float, Lanes> df;
  const Camera& camera = view.camera;
  const Vec length2 = hn::MulAdd(nx, nx, hn::MulAdd(ny, ny, hn::Mul(nz, nz)));
  const Vec inverse = hn::Div(hn::Set(d, 1.0), hn::Sqrt(length2));
  const auto world = [&](int c) HWY_ATTR {
    const Vec r = hn::Set(d, camera.right[c]), u = hn::Set(d, camera.up[c]), f = hn::Set(d, camera.forward[c]);
    return hn::DemoteTo(df, hn::Mul(inverse, hn::MulAdd(nx, r, hn::MulAdd(ny, u, hn::Mul(nz, f)))));
  };
  HWY_ALIGN float part[3 * 8];
  hn::StoreInterleaved3(world(0), world(1), world(2), df, part);
  std::copy_n(part, 3 * count, view.frame.normal + 3 * at);
}

// Writes the depths of `count` pixels.
HWY_INLINE void write_depths(const View& view, std::size_t at, int count, double* key) {
  for (int k = 0; k < count && view.camera.perspective; ++k) key[k] = -1.0 / key[k];
  copy_stretch(key, count, view.frame.depth + at);
}

}  // namespace HWY_NAMESPACE
}  // namespace nofacet
HWY_AFTER_NAMESPACE();

#endif

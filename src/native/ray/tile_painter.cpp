#include "ray/tile_painter.h"

#include <algorithm>
#include <cmath>

#include "raster/scan_planes.h"

namespace nofacet {

void TilePainter::paint(const PixelRect& tile, const std::vector<const RayPatch*>& patches) {
  const bool color = frame_.color || frame_.coverage;
  if (frame_.needs_values() || samples_ == 1) {
    const RayGrid grid = trace(tile, 1, frame_.normal || frame_.color, patches);
    if (frame_.needs_values()) write_values(tile);
    if (color && samples_ == 1) write_color(tile, grid, 1);
  }
  if (color && samples_ > 1) paint_samples(tile, patches);
}

// So many rays a pixel that a tile's are traced in parts.
void TilePainter::paint_samples(const PixelRect& tile, const std::vector<const RayPatch*>& patches) {
  const int side = std::clamp(kTileSide / samples_, 1, kTile);
  for (int y = tile.y0; y < tile.y1; y += side) {
    for (int x = tile.x0; x < tile.x1; x += side) {
      const PixelRect part{x, std::min(x + side, tile.x1), y, std::min(y + side, tile.y1)};
      write_color(part, trace(part, samples_, frame_.color, patches), samples_);
    }
  }
}

// Traces samples x samples rays through each of the pixels. Leaves in hits_ what they hit.
RayGrid TilePainter::trace(const PixelRect& pixels, int samples, bool normals,
                           const std::vector<const RayPatch*>& patches) {
  const double step = 1.0 / samples;
  const RayGrid grid{pixels.x0 + 0.5 * step + kSampleShiftX,
                     pixels.y0 + 0.5 * step + kSampleShiftY,
                     step,
                     samples * (pixels.x1 - pixels.x0),
                     samples * (pixels.y1 - pixels.y0),
                     kSampleShiftX,
                     kSampleShiftY};
  hits_.reset(grid.columns * grid.rows);
  if (sections_) sections_->reset();
  clipper_.begin(grid, normals ? &camera_ : nullptr);
  for (const RayPatch* patch : patches) {
    if (sections_) {
      clipper_.trace(*patch, {0, grid.columns, 0, grid.rows}, *sections_);
      continue;
    }
    if (hits_.hidden(patch->nearest)) continue;
    clipper_.trace(*patch, {0, grid.columns, 0, grid.rows}, hits_);
    hits_.end_patch();
  }
  if (sections_) sections_->resolve(grid, hits_);
  hits_.sort_veils();
  return grid;
}

// Direction of the primary ray through a point of the screen, in eye space, of depth 1.
void TilePainter::eye_direction(double x, double y, double direction[3]) const {
  direction[0] = camera_.perspective ? (x - 0.5 * camera_.width) / camera_.scale : 0.0;
  direction[1] = camera_.perspective ? (0.5 * camera_.height - y) / camera_.scale : 0.0;
  direction[2] = 1.0;
}

void TilePainter::write_values(const PixelRect& tile) {
  auto veil = hits_.veils().begin();
  const auto end = hits_.veils().end();
  int ray = 0;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x, ++ray) {
      const RayHit* shown = &hits_.opaque(ray);
      for (; veil != end && veil->ray == ray; ++veil) {
        if (hits_.shown_before(veil->hit, *shown)) shown = &veil->hit;
      }
      const std::size_t pixel = std::size_t(y) * frame_.width + x;
      if (!shown->patch) {
        write_background(pixel);
        continue;
      }
      double direction[3];
      eye_direction(x + 0.5, y + 0.5, direction);
      write_hit(pixel, *shown, direction);
    }
  }
}

void TilePainter::write_background(std::size_t pixel) {
  if (frame_.depth) frame_.depth[pixel] = INFINITY;
  if (frame_.face) frame_.face[pixel] = -1;
  if (frame_.uv) frame_.uv[2 * pixel] = frame_.uv[2 * pixel + 1] = 0.0;
  if (frame_.normal) std::fill_n(frame_.normal + 3 * pixel, 3, 0.0f);
}

void TilePainter::write_hit(std::size_t pixel, const RayHit& hit, const double eye_direction[3]) {
  if (frame_.depth) frame_.depth[pixel] = hit.depth;
  if (frame_.face) frame_.face[pixel] = scene_.face_number(hit.patch->face);
  if (frame_.uv) {
    frame_.uv[2 * pixel] = hit.patch->patch->u.face_from_patch(hit.s);
    frame_.uv[2 * pixel + 1] = hit.patch->patch->v.face_from_patch(hit.t);
  }
  if (!frame_.normal) return;
  double n[3];
  shader_.normal(hit, eye_direction, n);
  for (int c = 0; c < 3; ++c) {
    frame_.normal[3 * pixel + c] = float(n[0] * camera_.right[c] + n[1] * camera_.up[c] + n[2] * camera_.forward[c]);
  }
}

// Adds what the hit of the ray through (x, y) sends to the eye through what stands before it.
void TilePainter::add_color(const RayHit& hit, double x, double y, double transmitted, double rgba[4]) {
  double direction[3], point[3];
  eye_direction(x, y, direction);
  for (int c = 0; c < 3; ++c) point[c] = hit.depth * direction[c];
  if (camera_.perspective) {
    const double length = std::sqrt(Camera::dot(direction, direction));
    for (int c = 0; c < 3; ++c) direction[c] /= length;
  } else {
    point[0] = (x - 0.5 * camera_.width) / camera_.scale;
    point[1] = (0.5 * camera_.height - y) / camera_.scale;
  }
  shader_.add(hit, point, direction, transmitted, rgba);
}

// Means over the pixels' samples.
void TilePainter::write_color(const PixelRect& tile, const RayGrid& grid, int samples) {
  auto first_veil = hits_.veils().begin();
  const auto end = hits_.veils().end();
  const double share = 1.0 / (double(samples) * samples);
  const int across = tile.x1 - tile.x0;
  std::vector<double> sums(5 * across);
  for (int y = tile.y0; y < tile.y1; ++y) {
    std::fill(sums.begin(), sums.end(), 0.0);
    for (int j = (y - tile.y0) * samples, last = j + samples; j < last; ++j) {
      for (int i = 0; i < grid.columns; ++i) {
        const int ray = j * grid.columns + i;
        const RayHit& opaque = hits_.opaque(ray);
        auto veil = first_veil;
        while (veil != end && veil->ray == ray) ++veil;
        if (!opaque.patch && veil == first_veil) continue;
        double* sum = sums.data() + 5 * (i / samples);
        sum[4] += 1.0;
        if (!frame_.color) {
          first_veil = veil;
          continue;
        }
        const double x = grid.x(i) - grid.shift_x, y_ray = grid.y(j) - grid.shift_y;
        double transmitted = 1.0;
        for (; first_veil != veil; ++first_veil) {
          add_color(first_veil->hit, x, y_ray, transmitted, sum);
          transmitted *= 1.0 - scene_.color(first_veil->hit.patch->face)[3];
        }
        if (opaque.patch) add_color(opaque, x, y_ray, transmitted, sum);
      }
    }
    for (int x = 0; x < across; ++x) {
      const std::size_t pixel = std::size_t(y) * frame_.width + tile.x0 + x;
      const double* sum = sums.data() + 5 * x;
      if (frame_.coverage) frame_.coverage[pixel] = float(sum[4] * share);
      if (!frame_.color) continue;
      for (int c = 0; c < 4; ++c) frame_.color[4 * pixel + c] = float(sum[c] * share);
    }
  }
}

}  // namespace nofacet

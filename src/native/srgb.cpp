#include "srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "parallel.h"

namespace nofacet {
namespace {

double decoded(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

// Rounds exactly, without a power for each pixel: a table says which code holds at the beginning of a step of linear
// values. Steps are finer than codes, so at most one more begins within a step.
class Encoder {
 public:
  Encoder() {
    for (int code = 0; code < 257; ++code) begin_[code] = code ? decoded((code - 0.5) / 255) : 0.0;
    begin_[256] = std::numeric_limits<double>::infinity();
    for (int step = 0, code = 0; step <= kSteps; ++step) {
      while (double(step) / kSteps >= begin_[code + 1]) ++code;
      code_at_[step] = uint8_t(code);
    }
  }
  uint8_t operator()(float linear) const {
    const float x = linear > 0 ? std::min(linear, 1.0f) : 0.0f;  // NaN, too, is 0
    const uint8_t code = code_at_[int(x * kSteps)];
    return uint8_t(code + (x >= begin_[code + 1]));
  }

 private:
  static constexpr int kSteps = 4096;  // a code takes 1 / (12.92 * 255), 1.24 steps, or more
  std::array<double, 257> begin_;      // linear value from which a code holds
  std::array<uint8_t, kSteps + 1> code_at_;
};

const Encoder& encoder() {
  static const Encoder instance;
  return instance;
}

void encode_before(const float* color, std::size_t pixels, const double* background, uint8_t* out) {
  const Encoder& encode = encoder();
  const float behind[3] = {float(background[0]), float(background[1]), float(background[2])};
  const uint8_t empty[4] = {encode(behind[0]), encode(behind[1]), encode(behind[2]), 255};
  for (const float* end = color + 4 * pixels; color != end; color += 4, out += 4) {
    if (color[3] <= 0) {
      std::copy_n(empty, 4, out);
      continue;
    }
    const float through = 1 - std::min(color[3], 1.0f);
    for (int c = 0; c < 3; ++c) out[c] = encode(color[c] + through * behind[c]);
    out[3] = 255;
  }
}

void encode_straight(const float* color, std::size_t pixels, uint8_t* out) {
  const Encoder& encode = encoder();
  for (const float* end = color + 4 * pixels; color != end; color += 4, out += 4) {
    const float alpha = std::clamp(color[3], 0.0f, 1.0f);
    for (int c = 0; c < 3; ++c) out[c] = encode(alpha > 0 ? color[c] / alpha : color[c]);
    out[3] = uint8_t(std::lrint(255 * alpha));
  }
}

}  // namespace

void srgb8(const float* color, std::size_t pixels, const double* background, int threads, uint8_t* out) {
  constexpr std::size_t kTask = 1 << 15;  // pixels
  parallel_for((pixels + kTask - 1) / kTask, threads, [&](std::size_t task, int) {
    const std::size_t first = task * kTask, count = std::min(kTask, pixels - first);
    if (background) {
      encode_before(color + 4 * first, count, background, out + 4 * first);
    } else {
      encode_straight(color + 4 * first, count, out + 4 * first);
    }
  });
}

}  // namespace nofacet

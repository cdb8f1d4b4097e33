// What a screen or a PNG file shows of linear colours.
#pragma once
#include <cstddef>
#include <cstdint>

namespace nofacet {

// 8-bit sRGB RGBA from linear RGBA with premultiplied alpha: before `background` (linear RGB) and opaque or, where that
// is null, with straight alpha. Values beyond 0 and 1 are clamped, each is rounded to the nearest code.
void srgb8(const float* color, std::size_t pixels, const double* background, int threads, uint8_t* out);

}  // namespace nofacet

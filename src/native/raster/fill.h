// Filling stretches of frame buffers that will not be read soon.
#pragma once
#include <cstddef>
#include <cstdint>

namespace nofacet {

// Write past the caches where that pays: large stretches would only push out what is still needed.
void fill(double* out, std::size_t count, double value);
void fill(float* out, std::size_t count, float value);
void fill(int32_t* out, std::size_t count, int32_t value);

}  // namespace nofacet

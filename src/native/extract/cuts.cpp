#include "extract/cuts.h"

#include <algorithm>
#include <cmath>

namespace nofacet {
namespace {

constexpr double kRounding = 1e-9, kMostPieces = 10'000;

std::size_t pieces_of(double width, double limit) {
  const double count = std::ceil(width / limit - kRounding);
  return std::isnan(count) ? 1 : std::size_t(std::clamp(count, 1.0, kMostPieces));
}

}  // namespace

Cuts cut_evenly(std::size_t count, const double* low, const double* high, double limit) {
  Cuts cuts;
  for (std::size_t k = 0; k < count; ++k) {
    const double width = high[k] - low[k];
    const std::size_t pieces = pieces_of(width, limit);
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      cuts.owner.push_back(int64_t(k));
      cuts.start.push_back(piece ? low[k] + width * double(piece) / double(pieces) : low[k]);
      cuts.stop.push_back(piece + 1 < pieces ? low[k] + width * double(piece + 1) / double(pieces) : high[k]);
    }
  }
  return cuts;
}

}  // namespace nofacet

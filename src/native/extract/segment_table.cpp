#include "extract/segment_table.h"

namespace nofacet {

SegmentTable segment_table(const std::vector<PieceView>& parts, std::size_t uses) {
  SegmentTable table;
  table.offsets.assign(uses + 1, 0);
  std::size_t points = 0;
  for (const PieceView& part : parts) {
    for (std::size_t k = 0; k < part.count; ++k) ++table.offsets[std::size_t(part.owner[k]) + 1];
    points += part.count * std::size_t(part.degree + 1);
  }
  for (std::size_t use = 0; use < uses; ++use) table.offsets[use + 1] += table.offsets[use];
  table.first_point.resize(std::size_t(table.offsets.back()));
  table.degree.resize(table.first_point.size());
  table.points.reserve(3 * points);
  std::vector<int64_t> next(table.offsets.begin(), table.offsets.end() - 1);
  for (const PieceView& part : parts) {
    const auto before = int64_t(table.points.size() / 3);
    for (std::size_t k = 0; k < part.count; ++k) {
      const auto segment = std::size_t(next[std::size_t(part.owner[k])]++);
      table.first_point[segment] = before + int64_t(k) * (part.degree + 1);
      table.degree[segment] = part.degree;
    }
    table.points.insert(table.points.end(), part.points, part.points + 3 * part.count * std::size_t(part.degree + 1));
  }
  return table;
}

}  // namespace nofacet

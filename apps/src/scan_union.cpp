#include "orbifit/apps/scan_union.h"

#include <algorithm>
#include <cstddef>

namespace orbifit {

namespace {

const Motion kStill;

struct Part {
  const PointCloud* scan;
  const Motion* into;
};

Eigen::Index count(const Part& part) {
  return part.scan->points.rows();
}

// Rows of all parts, one for each point; none where they are not known of a part. A single row is of all its points.
template <class Rows>
Points stacked(const std::vector<Part>& parts, const Rows& rows_of) {
  Eigen::Index total = 0;
  for (const Part& part : parts) {
    const Eigen::Index rows = rows_of(part).rows();
    if (rows != count(part) && rows != 1) return Points(0, 3);
    total += count(part);
  }
  Points result(total, 3);
  Eigen::Index row = 0;
  for (const Part& part : parts) {
    const Points rows = rows_of(part);
    if (rows.rows() == count(part)) {
      result.middleRows(row, count(part)) = rows;
    } else {
      result.middleRows(row, count(part)).rowwise() = rows.row(0);
    }
    row += count(part);
  }
  return result;
}

PointCloud scan_union_of(const std::vector<Part>& parts) {
  const auto turned = [](const Points& rows, const Part& part) -> Points {
    return rows * part.into->linear.transpose();
  };
  const auto moved = [&](const Points& rows, const Part& part) -> Points {
    return turned(rows, part).rowwise() + part.into->translation.transpose();
  };
  PointCloud result;
  result.points = stacked(parts, [&](const Part& part) { return moved(part.scan->points, part); });
  result.normals = stacked(parts, [&](const Part& part) { return turned(part.scan->normals, part); });
  result.viewpoints = stacked(parts, [&](const Part& part) { return moved(part.scan->viewpoints, part); });
  for (const Part& part : parts) result.dropped += part.scan->dropped;
  return result;
}

}  // namespace

PointCloud scan_union(const std::vector<const PointCloud*>& scans) {
  if (scans.size() == 1) return *scans.front();
  std::vector<Part> parts;
  for (const PointCloud* scan : scans) parts.push_back({scan, &kStill});
  return scan_union_of(parts);
}

PointCloud scan_union(const std::vector<const PointCloud*>& scans, const std::vector<Motion>& into,
                      const std::vector<char>& used) {
  std::vector<Part> parts{{scans.front(), &kStill}};
  for (std::size_t k = 0; k < into.size(); ++k) {
    if (used[k] != 0) parts.push_back({scans[k + 1], &into[k]});
  }
  return parts.size() == 1 ? *scans.front() : scan_union_of(parts);
}

}  // namespace orbifit

#include "placement/placement_data.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kTemplateSamples = 450;
constexpr int kCells = 56;  // of the field, along its longest side

// The diagonal of the box that holds nearly all points along each axis.
double scan_extent(const PreparedScan& scan) {
  constexpr double kOutside = 0.03;
  Vector3d extent;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> at(scan.points.col(k).begin(), scan.points.col(k).end());
    std::ranges::sort(at);
    const auto off = static_cast<std::size_t>(kOutside * static_cast<double>(at.size()));
    extent[k] = at[at.size() - 1 - off] - at[off];
  }
  return extent.norm();
}

}  // namespace

PlacementData::PlacementData(const MatchSurface& template_surface, const PointCloud& cloud, PreparedScan prepared,
                             const RunContext& context)
    : PlacementData(template_surface, cloud, std::move(prepared), context, Random(context.seed, "placement")) {}

PlacementData::PlacementData(const MatchSurface& template_surface, const PointCloud& cloud, PreparedScan prepared,
                             const RunContext& context, Random random)
    : surface(template_surface),
      size(diagonal(surface.mesh().vertices)),
      samples(sample_surface(surface.mesh(), kTemplateSamples, random)),
      field(surface.mesh(), surface.index, kCells, context),
      scan(std::move(prepared)),
      extent(scan_extent(scan)),
      seen(cloud, scan.points) {
  order.resize(static_cast<std::size_t>(scan.points.rows()));
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
}

}  // namespace orbifit

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace orbifit {

/// A polyline by its points' numbers; of a closed one the first is not repeated.
struct WallCurve {
  std::vector<int> points;
  bool closed = false;
};

/// The curves that edges form, divided at nodes and where other than two edges meet.
/// \param node  by point's number, whether curves end there
std::vector<WallCurve> curves_of(const std::vector<std::array<int, 2>>& edges, const std::vector<char>& node);

using Polyline = std::vector<Eigen::Vector3d>;

/// Largest distance of a vertex of either from the other; infinite where it is certain to exceed `reach`.
double polyline_distance(const Polyline& a, const Polyline& b, double reach);

/// Vertices of two polylines that mean the same: pairs ascending in both, the first and the last ones among them.
/// \param snap  share of the edges at them within which they must be
std::vector<std::array<int, 2>> common_vertices(const Polyline& a, const Polyline& b, double snap);

}  // namespace orbifit

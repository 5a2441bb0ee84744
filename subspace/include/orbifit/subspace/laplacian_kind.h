#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace orbifit {

/// The Laplacians of the samples to choose from (method notes, section 3).
enum class LaplacianKind {
  graph,      ///< degree less adjacency of neighbouring samples (the paper)
  cotangent,  ///< the surface's, restricted to the samples (Huang et al. 2006)
  point       ///< of the samples as a point cloud (Liu, Prabhakaran and Guo 2012)
};

std::string to_string(LaplacianKind kind);  ///< "graph", "cotangent", "point"
std::optional<LaplacianKind> parse_laplacian_kind(std::string_view text);

}  // namespace orbifit

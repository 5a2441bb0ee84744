#include "orbifit/subspace/deformer.h"

namespace orbifit {

std::string to_string(LaplacianKind kind) {
  switch (kind) {
    case LaplacianKind::cotangent:
      return "cotangent";
    case LaplacianKind::point:
      return "point";
    case LaplacianKind::graph:
      break;
  }
  return "graph";
}

std::optional<LaplacianKind> parse_laplacian_kind(std::string_view text) {
  for (const LaplacianKind kind : {LaplacianKind::graph, LaplacianKind::cotangent, LaplacianKind::point}) {
    if (text == to_string(kind)) return kind;
  }
  return std::nullopt;
}

}  // namespace orbifit

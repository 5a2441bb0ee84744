#pragma once

#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/subspace/handles.h"

namespace orbifit::benchmarks {

/// A row of the paper's Table 1; times in milliseconds on one thread of a Xeon E5-1620 at 3.6 GHz.
struct PaperRow {
  int vertices = 0, triangles = 0;  ///< rounded to thousands there
  int groups = 0, samples = 0, degrees_of_freedom = 0;
  double prefactor_ms = 0, solve5_ms = 0, lift_ms = 0;
};

/// An analogue of one of the paper's models, with handles that bend it.
struct BenchmarkModel {
  std::string name;
  Mesh mesh;
  SymmetryAnnotation annotation;
  std::vector<Handle> handles;
  PaperRow paper;
};

/// In the order of Table 1.
const std::vector<std::string>& benchmark_model_names();

/// \throw UsageError for an unknown name
BenchmarkModel benchmark_model(const std::string& name);

}  // namespace orbifit::benchmarks

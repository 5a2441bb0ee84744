#pragma once

#include <optional>
#include <string>

#include "models.h"

namespace orbifit::benchmarks {

/// What the peer program orbifit-benchmark-arap measured: full-space as-rigid-as-possible deformation by CGAL.
struct ArapTimes {
  std::optional<double> prefactor_ms, solve5_ms;  ///< none where it could not
  std::string note;                               ///< why not, or what was done to the mesh before
};

/// Runs the peer on the model where it lies beside this program.
ArapTimes arap_times(const BenchmarkModel& model, int repetitions);

}  // namespace orbifit::benchmarks

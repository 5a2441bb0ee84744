#pragma once

#include <vector>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/run_context.h"

namespace orbifit::benchmarks {

/// Vertices far from one another, the first one far from the middle.
std::vector<int> spread_vertices(const Points& vertices, int count);

/// A shape of the same symmetries that differs from a model's in more than lengths: bent, tapered and swollen by a few
/// hundredths of the diagonal, with bulges. Its parts stay where their groups are; #V by 3, drawn by the context's
/// seed.
Points reshaped(const GeneratedModel& model, RunContext& context);

}  // namespace orbifit::benchmarks

#pragma once

#include <cstddef>

#include "orbifit/model/run_context.h"

namespace orbifit {

/// For tasks side by side: a context that tells nothing where they are several.
inline RunContext quiet_context(const RunContext& context, std::size_t tasks) {
  RunContext result = context;
  if (tasks <= 1 || context.threads <= 1) return result;
  result.on_progress = nullptr;
  result.on_message = nullptr;
  return result;
}

}  // namespace orbifit

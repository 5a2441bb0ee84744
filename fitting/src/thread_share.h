#pragma once

#include <algorithm>
#include <cstddef>

#include "orbifit/model/run_context.h"

namespace orbifit {

/// For tasks side by side: a context with a task's share of the threads, which tells nothing where they are several.
inline RunContext share_of_threads(const RunContext& context, std::size_t tasks) {
  RunContext result = context;
  if (tasks <= 1 || context.threads <= 1) return result;
  result.threads = std::max(1, context.threads / static_cast<int>(tasks));
  result.on_progress = nullptr;
  result.on_message = nullptr;
  return result;
}

}  // namespace orbifit

#pragma once

#include <functional>
#include <vector>

#include "orbifit/model/run_context.h"

namespace orbifit {

using SideTask = std::function<void(const RunContext& own)>;

/// Runs tasks, of which none needs what another makes: side by side where the context has several threads, else one
/// after the other. Each has a context of its own, whose messages are told in the tasks' order; side by side the last
/// one alone tells its progress.
void side_by_side(const std::vector<SideTask>& tasks, const RunContext& context);

}  // namespace orbifit

#include "side_by_side.h"

#include <string>
#include <string_view>

namespace orbifit {

void side_by_side(const std::vector<SideTask>& tasks, const RunContext& context) {
  if (context.threads <= 1 || tasks.size() <= 1) {
    for (const SideTask& task : tasks) task(context);
    return;
  }
  std::vector<std::vector<std::string>> messages(tasks.size());
  const auto tell = [&] {
    for (const std::vector<std::string>& of_task : messages) {
      for (const std::string& message : of_task) context.message(message);
    }
  };
  try {
    parallel_for(context, tasks.size(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        RunContext own = context;
        if (i + 1 < tasks.size()) own.on_progress = nullptr;
        own.on_message = [&messages, i](std::string_view text) { messages[i].emplace_back(text); };
        tasks[i](own);
      }
    });
  } catch (...) {
    tell();
    throw;
  }
  tell();
}

}  // namespace orbifit

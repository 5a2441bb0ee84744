#include "side_by_side.h"

#include <string>
#include <string_view>

namespace orbifit {

namespace {

// Keeps what the tasks have to say until they are done, or one has failed.
class Messages {
 public:
  Messages(std::size_t tasks, const RunContext& context) : of_task_(tasks), context_(context) {}
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;
  Messages(Messages&&) = delete;
  Messages& operator=(Messages&&) = delete;
  ~Messages() {
    for (const auto& messages : of_task_) {
      for (const std::string& message : messages) context_.message(message);
    }
  }

  void keep(std::size_t task, std::string_view text) { of_task_[task].emplace_back(text); }

 private:
  std::vector<std::vector<std::string>> of_task_;
  const RunContext& context_;
};

}  // namespace

void side_by_side(const std::vector<SideTask>& tasks, const RunContext& context) {
  if (context.threads <= 1 || tasks.size() <= 1) {
    for (const SideTask& task : tasks) task(context);
    return;
  }
  Messages messages(tasks.size(), context);
  parallel_for(context, tasks.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      RunContext own = context;
      if (i + 1 < tasks.size()) own.on_progress = nullptr;
      own.on_message = [&messages, i](std::string_view text) { messages.keep(i, text); };
      tasks[i](own);
    }
  });
}

}  // namespace orbifit

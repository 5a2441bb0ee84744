#include "fit_systems.h"

#include <utility>

#include "quiet_context.h"

namespace orbifit {

std::vector<Contact> contacts_to_keep(const PlacedScan& start, const Subspace& subspace, const Mesh& mesh,
                                      const FitOptions& options, const RunContext& context) {
  if (!options.contacts) return {};
  return start.shared ? start.shared->contacts(subspace, context) : find_contacts(subspace, mesh, {}, context);
}

FitSystems::FitSystems(const Subspace& subspace, const Mesh& mesh, double stretch, std::vector<Contact> contacts)
    : subspace_(subspace), mesh_(mesh), stretch_(stretch), contacts_(std::move(contacts)) {}

std::unique_ptr<FitSystem> FitSystems::take() {
  {
    const std::lock_guard lock(guard_);
    if (!idle_.empty()) {
      std::unique_ptr<FitSystem> system = std::move(idle_.back());
      idle_.pop_back();
      return system;
    }
  }
  return std::make_unique<FitSystem>(subspace_, mesh_, stretch_, contacts_);
}

void FitSystems::share(std::size_t count, const RunContext& context, const Task& task) {
  const RunContext own = quiet_context(context, count);
  parallel_for(context, count, [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<FitSystem> system = take();
    for (std::size_t i = begin; i < end; ++i) task(i, *system, own);
    const std::lock_guard lock(guard_);
    idle_.push_back(std::move(system));
  });
}

}  // namespace orbifit

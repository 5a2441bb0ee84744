#include "solver/shared_template.h"

#include <utility>

namespace orbifit {

SharedTemplate::SharedTemplate(const Mesh& mesh, bool contacts, std::shared_ptr<const Subspace> given,
                               std::shared_ptr<const SurfaceIndex> index, const RunContext& context)
    : given_(std::move(given)), surface_(mesh, std::move(index)), tree_(std::make_shared<const MovingSurface>(mesh)) {
  if (contacts) search_ = std::make_unique<const ContactSearch>(mesh, tree_, ContactOptions{}, context);
}

std::vector<Contact> SharedTemplate::contacts(const Subspace& subspace, const RunContext& context) const {
  if (!search_) return {};
  const auto is_first = [&] { return first_.operator->() == subspace.operator->(); };
  {
    const std::lock_guard lock(mutex_);
    if (is_first()) return of_first_;
  }
  std::vector<Contact> found = search_->in(subspace, context);
  const std::lock_guard lock(mutex_);
  if (first_.operator->() == nullptr) {
    first_ = subspace;
    of_first_ = found;
  }
  return found;
}

}  // namespace orbifit

#include "domains/vertex_images.h"

#include <algorithm>

namespace orbifit {

Eigen::Vector3d VertexImages::Images::place_of(int vertex) const {
  return motion_(of_.vertices_.row(vertex).transpose());
}

void VertexImages::Images::ask(const std::vector<int>& vertices, const RunContext& context) {
  constexpr std::size_t kLeastShare = 1000;  // a tenth of a millisecond
  if (known_.empty()) return;
  const auto body = [&](std::size_t begin, std::size_t end) {
    VertexFinder::Walk walk(of_.finder_);
    for (std::size_t i = begin; i < end; ++i) {
      int& known = known_[static_cast<std::size_t>(vertices[i])];
      if (known == kUnknown) known = walk.at(vertices[i], place_of(vertices[i]));
    }
  };
  parallel_for(context, vertices.size(), body, kLeastShare);
}

VertexImages::Images& VertexImages::of(const Motion& motion) {
  std::array<double, 12> key{};
  std::copy_n(motion.linear.data(), 9, key.begin());
  std::copy_n(motion.translation.data(), 3, key.begin() + 9);
  const auto found = by_motion_.find(key);
  if (found != by_motion_.end()) return found->second;
  finder_.prepare_walks();
  const bool remembers = (by_motion_.size() + 1) * static_cast<std::size_t>(vertices_.rows()) <= most_remembered_;
  return by_motion_.emplace(key, Images(*this, motion, remembers)).first->second;
}

}  // namespace orbifit

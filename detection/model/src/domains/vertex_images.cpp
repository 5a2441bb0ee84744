#include "domains/vertex_images.h"

#include <algorithm>

namespace orbifit {

Eigen::Vector3d VertexImages::Images::place_of(int vertex) const {
  return motion_(of_.vertices_.row(vertex).transpose());
}

int VertexImages::Images::look(const Eigen::Vector3d& place) const {
  int result = kNone;
  of_.grid_.visit(place, [&](int other) { result = result == kNone ? other : kSeveral; });
  return result;
}

void VertexImages::Images::ask(const std::vector<int>& vertices, const RunContext& context) {
  constexpr std::size_t kLeastShare = 1000;  // a tenth of a millisecond
  if (known_.empty()) return;
  const auto body = [&](std::size_t begin, std::size_t end) {
    constexpr std::size_t kTogether = 64;  // what a processor can wait for at once, several times over
    std::vector<int> open;
    std::vector<Eigen::Vector3d> places;
    for (std::size_t i = begin; i < end;) {
      open.clear();
      places.clear();
      for (; i < end && open.size() < kTogether; ++i) {
        if (known_[static_cast<std::size_t>(vertices[i])] != kUnknown) continue;
        open.push_back(vertices[i]);
        places.push_back(place_of(vertices[i]));
      }
      of_.grid_.fetch(places);
      for (std::size_t k = 0; k < open.size(); ++k) known_[static_cast<std::size_t>(open[k])] = look(places[k]);
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
  const bool remembers = (by_motion_.size() + 1) * static_cast<std::size_t>(vertices_.rows()) <= most_remembered_;
  return by_motion_.emplace(key, Images(*this, motion, remembers)).first->second;
}

}  // namespace orbifit

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

// Neighbours have neighbouring numbers mostly, and so have their images: the next one's is looked for there first.
void VertexImages::Images::ask_in_turn(const int* vertices, std::size_t count) {
  int before = 0;  // the last one that has an image, and that
  int image = kNone;
  int direction = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const int vertex = vertices[i];
    int& known = known_[static_cast<std::size_t>(vertex)];
    if (known == kUnknown) {
      const Eigen::Vector3d place = place_of(vertex);
      if (image >= 0) {
        const int step = vertex - before;
        if (of_.alone_at(image + direction * step, place)) {
          known = image + direction * step;
        } else if (of_.alone_at(image - direction * step, place)) {
          direction = -direction;
          known = image + direction * step;
        }
      }
      if (known == kUnknown) known = look(place);
    }
    if (known < 0) continue;
    before = vertex;
    image = known;
  }
}

void VertexImages::Images::ask(const std::vector<int>& vertices, const RunContext& context) {
  constexpr std::size_t kLeastShare = 1000;  // a tenth of a millisecond
  if (known_.empty()) return;
  const auto body = [&](std::size_t begin, std::size_t end) { ask_in_turn(vertices.data() + begin, end - begin); };
  parallel_for(context, vertices.size(), body, kLeastShare);
}

void VertexImages::find_lone() {
  constexpr double kTwice =
      2 * (1 + 1e-9);  // so far apart are two at most that lie at one place, whatever rounding does
  lone_.resize(static_cast<std::size_t>(vertices_.rows()));
  for (std::size_t v = 0; v < lone_.size(); ++v) {
    int near = 0;
    grid_.visit_within(vertices_.row(static_cast<Eigen::Index>(v)).transpose(), kTwice * grid_.tolerance(),
                       [&](int) { ++near; });
    lone_[v] = near == 1 ? 1 : 0;
  }
}

bool VertexImages::alone_at(int vertex, const Eigen::Vector3d& place) const {
  return vertex >= 0 && vertex < static_cast<int>(lone_.size()) && lone_[static_cast<std::size_t>(vertex)] != 0 &&
         (vertices_.row(vertex).transpose() - place).squaredNorm() <= grid_.tolerance() * grid_.tolerance();
}

VertexImages::Images& VertexImages::of(const Motion& motion) {
  std::array<double, 12> key{};
  std::copy_n(motion.linear.data(), 9, key.begin());
  std::copy_n(motion.translation.data(), 3, key.begin() + 9);
  const auto found = by_motion_.find(key);
  if (found != by_motion_.end()) return found->second;
  if (lone_.empty()) find_lone();
  const bool remembers = (by_motion_.size() + 1) * static_cast<std::size_t>(vertices_.rows()) <= most_remembered_;
  return by_motion_.emplace(key, Images(*this, motion, remembers)).first->second;
}

}  // namespace orbifit

#include "geometry/vertex_finder.h"

namespace orbifit {

int VertexFinder::at(const Eigen::Vector3d& place) const {
  int result = kNone;
  grid_.visit(place, [&](int vertex) { result = result == kNone ? vertex : kSeveral; });
  return result;
}

void VertexFinder::prepare_walks() {
  constexpr double kTwice =
      2 * (1 + 1e-9);  // so far apart are two at most that lie at one place, whatever rounding does
  if (!lone_.empty()) return;
  lone_.resize(static_cast<std::size_t>(vertices_.rows()));
  for (std::size_t v = 0; v < lone_.size(); ++v) {
    int near = 0;
    grid_.visit_within(vertices_.row(static_cast<Eigen::Index>(v)).transpose(), kTwice * grid_.tolerance(),
                       [&](int) { ++near; });
    lone_[v] = near == 1 ? 1 : 0;
  }
}

bool VertexFinder::alone_at(int vertex, const Eigen::Vector3d& place) const {
  return vertex >= 0 && vertex < static_cast<int>(lone_.size()) && lone_[static_cast<std::size_t>(vertex)] != 0 &&
         (vertices_.row(vertex).transpose() - place).squaredNorm() <= grid_.tolerance() * grid_.tolerance();
}

int VertexFinder::Walk::at(int number, const Eigen::Vector3d& place) {
  int result = kNone;
  if (vertex_ >= 0) {
    const int step = direction_ * (number - number_);
    if (of_.alone_at(vertex_ + step, place)) {
      result = vertex_ + step;
    } else if (of_.alone_at(vertex_ - step, place)) {
      direction_ = -direction_;
      result = vertex_ - step;
    }
  }
  if (result < 0) result = of_.at(place);
  if (result < 0) return result;
  number_ = number;
  vertex_ = result;
  return result;
}

}  // namespace orbifit

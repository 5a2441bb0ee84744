#include "remeshing/glued_images.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <Eigen/LU>

#include "remeshing/indices.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

// One vertex of the domain for all that pairings relate.
struct VertexOrbit {
  std::vector<int> members;     // the first is the orbit's own
  std::vector<int> elements;    // that take the first to each
  std::vector<int> stabiliser;  // of the first, the identity among them
  Vector3d place;
};

class Gluing {
 public:
  Gluing(const ClippedSurface& surface, const FiniteGroup& group, const Seams& seams, double reach)
      : surface_(surface), group_(group), reach_(reach), related_(surface.points.size()) {
    for (const WallPairing& pairing : seams.pairings) {
      related_[at(pairing.other)].push_back({pairing.point, pairing.element});
      related_[at(pairing.point)].push_back({pairing.other, group.inverses[at(pairing.element)]});
    }
  }

  GluedImages run() {
    find_orbits();
    for (int e = 0; e < group_.order(); ++e) {
      const bool turned = group_.elements[at(e)].linear.determinant() < 0;
      for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
        std::array<int, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) corners[k] = vertex(e, surface_.triangles[t][k]);
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
        std::array<int, 3> key = corners;
        std::ranges::sort(key);
        if (!seen_.insert({surface_.sources[t], key}).second) continue;
        if (turned) std::swap(corners[1], corners[2]);
        result_.triangles.push_back(corners);
        result_.sources.push_back(surface_.sources[t]);
        result_.elements.push_back(e);
      }
    }
    return std::move(result_);
  }

 private:
  int product(int a, int b) const { return group_.products[at(a)][at(b)]; }

  void find_orbits() {
    orbit_of_.assign(surface_.points.size(), -1);
    element_of_.assign(surface_.points.size(), 0);
    for (std::size_t v = 0; v < surface_.points.size(); ++v) {
      if (orbit_of_[v] >= 0) continue;
      orbits_.push_back(orbit_from(static_cast<int>(v)));
    }
  }

  VertexOrbit orbit_from(int first) {
    const int number = static_cast<int>(orbits_.size());
    VertexOrbit orbit{{first}, {0}, {0}, Vector3d::Zero()};
    orbit_of_[at(first)] = number;
    std::set<int> fixing;
    for (std::size_t next = 0; next < orbit.members.size(); ++next) {
      for (const auto& [other, step] : related_[at(orbit.members[next])]) {
        const int element = product(step, element_of_[at(orbit.members[next])]);
        if (orbit_of_[at(other)] < 0) {
          orbit_of_[at(other)] = number;
          element_of_[at(other)] = element;
          orbit.members.push_back(other);
          orbit.elements.push_back(element);
        } else {
          fixing.insert(product(group_.inverses[at(element_of_[at(other)])], element));
        }
      }
    }
    place(orbit);
    close(orbit, fixing);
    return orbit;
  }

  void place(VertexOrbit& orbit) const {
    Vector3d sum = Vector3d::Zero();
    double weight = 0;
    for (std::size_t m = 0; m < orbit.members.size(); ++m) {
      // What was put in for a counterpart lies on a chord, and is farther from the surface than that.
      const double own = surface_.cut[at(orbit.members[m])] == 2 ? 1e-9 : 1;
      sum += own * back(orbit, m);
      weight += own;
    }
    orbit.place = sum / weight;
  }

  Vector3d back(const VertexOrbit& orbit, std::size_t m) const {
    return group_.elements[at(group_.inverses[at(orbit.elements[m])])](surface_.points[at(orbit.members[m])]);
  }

  void close(VertexOrbit& orbit, const std::set<int>& fixing) {
    bool fits = true;
    for (std::size_t m = 0; m < orbit.members.size(); ++m) fits &= (back(orbit, m) - orbit.place).norm() <= reach_;
    for (std::size_t next = 0; next < orbit.stabiliser.size(); ++next) {
      for (const int generator : fixing) {
        const int element = product(generator, orbit.stabiliser[next]);
        if (std::ranges::find(orbit.stabiliser, element) != orbit.stabiliser.end()) continue;
        orbit.stabiliser.push_back(element);
      }
    }
    Vector3d mean = Vector3d::Zero();
    for (const int element : orbit.stabiliser) {
      const Vector3d image = group_.elements[at(element)](orbit.place);
      fits &= (image - orbit.place).norm() <= reach_;
      mean += image / static_cast<double>(orbit.stabiliser.size());
    }
    orbit.place = mean;
    if (!fits) ++result_.contradictions;
  }

  // The result's vertex that is image `element` of a vertex of the domain.
  int vertex(int element, int point) {
    const int number = orbit_of_[at(point)];
    const VertexOrbit& orbit = orbits_[at(number)];
    const int total = product(element, element_of_[at(point)]);
    int coset = total;
    for (const int fixing : orbit.stabiliser) coset = std::min(coset, product(total, fixing));
    const auto [entry, added] = vertices_.try_emplace({number, coset}, static_cast<int>(result_.points.size()));
    if (added) result_.points.push_back(group_.elements[at(coset)](orbit.place));
    return entry->second;
  }

  const ClippedSurface& surface_;
  const FiniteGroup& group_;
  double reach_;
  std::vector<std::vector<std::pair<int, int>>> related_;  // (other, element): other is element of this
  std::vector<VertexOrbit> orbits_;
  std::vector<int> orbit_of_, element_of_;
  std::map<std::pair<int, int>, int> vertices_;
  std::set<std::pair<int, std::array<int, 3>>> seen_;
  GluedImages result_;
};

}  // namespace

GluedImages glued_images(const ClippedSurface& surface, const FiniteGroup& group, const Seams& seams, double reach) {
  return Gluing(surface, group, seams, reach).run();
}

}  // namespace orbifit

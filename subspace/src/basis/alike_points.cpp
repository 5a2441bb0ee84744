#include "basis/alike_points.h"

#include <algorithm>
#include <map>
#include <utility>

#include "geometry/vertex_grid.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kMeets = 1e-8;  // of r: samples and ways this far apart are one

// Where a way takes a displacement, under one displacement of the basis: to frame u + shift.
struct Way {
  Matrix3d frame;
  Vector3d shift;
};

Way way_of(const Transport& transport, const Eigen::VectorXd& carriers) {
  Way result{transport.frame, transport.shift};
  if (carriers.size() == 0) return result;
  for (const auto& [carrier, matrix] : transport.carried) {
    result.shift += matrix * carriers.segment<3>(3 * carrier);
  }
  return result;
}

Way composed(const Way& step, const Way& from) {
  return {step.frame * from.frame, step.frame * from.shift + step.shift};
}

// A motion that takes each place to a place and each sample to a sample of those places.
struct Whole {
  Motion back;
  Way way_back;
  std::vector<int> image, origin;  // by place
};

// The set of places to which, or from which, a motion takes the places of a set.
int mapped_set(const RegionMap& regions, int set, const std::vector<int>& map) {
  std::vector<int> result;
  for (const int place : regions.set_places(set)) result.push_back(map[static_cast<std::size_t>(place)]);
  std::ranges::sort(result);
  return regions.set_of(result);
}

// False where the annotation lacks an image of a place. \param rough  by place: 1 where its surface is not quite that
// of its image, as where triangles are cut otherwise
bool find_images(const RegionMap& regions, int place, int element, Whole& motion, std::vector<char>& rough) {
  motion.image = regions.exact_images(place, element);
  motion.origin.assign(motion.image.size(), -1);
  for (std::size_t p = 0; p < motion.image.size(); ++p) {
    int& image = motion.image[p];
    const auto other = static_cast<int>(p);
    if (regions.whole(other)) image = other;
    if (image < 0) {
      const std::vector<int> nearly = regions.images_of(other, place, element);
      if (nearly.size() != 1) return false;
      image = nearly.front();
      rough[p] = 1;
    }
    if (motion.origin[static_cast<std::size_t>(image)] >= 0) return false;
    motion.origin[static_cast<std::size_t>(image)] = other;
  }
  return true;
}

bool keeps_samples(const SymmetricSampling& sampling, const RegionMap& regions, const VertexGrid& grid,
                   const Motion& motion, const std::vector<int>& image) {
  std::map<int, int> image_of_set;
  for (Eigen::Index k = 0; k < sampling.points.rows(); ++k) {
    const auto s = static_cast<std::size_t>(k);
    const auto set = image_of_set.try_emplace(sampling.sets[s], -1);
    if (set.second) set.first->second = mapped_set(regions, sampling.sets[s], image);
    const int image_set = set.first->second;
    bool met = false;
    grid.visit(motion(sampling.points.row(k).transpose()), [&](int other) {
      const auto o = static_cast<std::size_t>(other);
      met = met || (sampling.sets[o] == image_set && sampling.radii[other] == sampling.radii[k] &&
                    sampling.shares[o] == sampling.shares[s] && sampling.copy_counts[o] == sampling.copy_counts[s]);
    });
    if (!met) return false;
  }
  return true;
}

struct WholeGroup {
  std::vector<Whole> motions;
  std::vector<int> rough;  // places whose surfaces are not quite their images'
};

// All elements of the finite group of the whole shape, of several the largest; none where the samples or the places
// lack some of them.
WholeGroup whole_group(const SymmetricSampling& sampling, const RegionMap& regions, bool floating,
                       const Eigen::VectorXd& carriers) {
  const VertexGrid grid(sampling.points, kMeets * sampling.radius);
  WholeGroup largest;
  for (int place = 0; place < regions.count(); ++place) {
    const std::vector<Motion>& elements = regions.elements(place);
    if (!regions.whole(place) || regions.continuum(place) != nullptr || elements.size() <= largest.motions.size())
      continue;
    std::vector<Whole> group;
    std::vector<char> rough(static_cast<std::size_t>(regions.places()), 0);
    for (std::size_t e = 0; e < elements.size(); ++e) {
      const auto element = static_cast<int>(e);
      Whole motion;
      if (!find_images(regions, place, element, motion, rough)) break;
      if (!keeps_samples(sampling, regions, grid, elements[e], motion.image)) break;
      motion.back = inverse(elements[e]);
      motion.way_back = way_of(inverse(step_transport(regions, place, element, elements[e], floating)), carriers);
      group.push_back(std::move(motion));
    }
    if (group.size() != elements.size()) continue;
    largest = {std::move(group), {}};
    for (int other = 0; other < regions.places(); ++other) {
      if (rough[static_cast<std::size_t>(other)] != 0) largest.rough.push_back(other);
    }
  }
  return largest;
}

// Words in classes: those of one are one another's after a motion of the whole group.
class WordClasses {
 public:
  struct Member {
    int of = -1;         // the class: a word of it
    std::size_t by = 0;  // the motion after a way that is the same for all of the class
  };

  WordClasses(const std::vector<Whole>& group, const SymmetricSampling& sampling, const GroupWords& words,
              const Eigen::VectorXd& carriers, const std::vector<int>& used)
      : members_(static_cast<std::size_t>(words.count())) {
    // Where no motion takes a point to itself, and along a direction in which no two of its images are as far.
    const Vector3d point = sampling.points.row(0).transpose() + sampling.radius * Vector3d(0.37, 0.91, 0.58);
    const Vector3d along = Vector3d(0.53, 0.29, 0.71);
    struct Entry {
      double height;
      int word;
      Way way;
    };
    std::vector<Entry> entries;
    for (const int word : used) {
      const Vector3d image = words.motion(word)(point);
      std::size_t highest = 0;
      for (std::size_t e = 1; e < group.size(); ++e) {
        if (along.dot(group[e].back(image)) > along.dot(group[highest].back(image))) highest = e;
      }
      members_[static_cast<std::size_t>(word)] = {word, highest};
      entries.push_back({along.dot(group[highest].back(image)), word,
                         composed(group[highest].way_back, way_of(words.transport(word), carriers))});
    }
    std::ranges::sort(entries, [](const Entry& a, const Entry& b) {
      return std::pair(a.height, a.word) < std::pair(b.height, b.word);
    });
    const double tolerance = kMeets * sampling.radius;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      for (std::size_t j = i; j > 0 && entries[i].height - entries[j - 1].height < tolerance; --j) {
        const Entry& other = entries[j - 1];
        if ((other.way.frame - entries[i].way.frame).norm() > kMeets) continue;
        if ((other.way.shift - entries[i].way.shift).norm() > kMeets * (sampling.radius + other.way.shift.norm())) {
          continue;
        }
        member(entries[i].word).of = member(other.word).of;
        break;
      }
    }
  }

  const Member& of(int word) const { return members_[static_cast<std::size_t>(word)]; }

 private:
  Member& member(int word) { return members_[static_cast<std::size_t>(word)]; }

  std::vector<Member> members_;
};

// Points on circles have canonical places, which are not taken to one another; and how far a place's surface is, is
// asked about places that do not hold a point.
bool stands_alone(const RegionMap& regions, int set, const std::vector<int>& rough) {
  return std::ranges::any_of(regions.set_places(set), [&](int p) { return regions.continuum(p) != nullptr; }) ||
         std::ranges::any_of(rough, [&](int p) { return !regions.holds(set, p); });
}

}  // namespace

std::vector<int> points_stood_for(const SymmetricSampling& sampling, const RegionMap& regions, const GroupWords& words,
                                  const Eigen::VectorXd& carriers, const VertexOrbits& vertices) {
  std::vector<int> result(vertices.point_words.size(), 1);
  const WholeGroup whole = whole_group(sampling, regions, words.floating(), carriers);
  const std::vector<Whole>& group = whole.motions;
  if (group.size() < 2) return result;
  std::vector<int> used = vertices.point_words;
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const WordClasses classes(group, sampling, words, carriers, used);

  constexpr int kUnknown = -1;
  constexpr int kAlone = -2;
  std::vector<std::vector<int>> origins(group.size());  // by motion and set
  const auto origin_of = [&](std::size_t motion, int set) {
    std::vector<int>& known = origins[motion];
    if (known.size() <= static_cast<std::size_t>(set)) known.resize(static_cast<std::size_t>(set) + 64, kUnknown);
    int& origin = known[static_cast<std::size_t>(set)];
    if (origin == kUnknown) {
      origin = stands_alone(regions, set, whole.rough) ? kAlone : mapped_set(regions, set, group[motion].origin);
    }
    return origin;
  };
  struct First {
    std::size_t point;
    int orbit = -1;
    int origin = -1;
  };
  std::vector<First> firsts(static_cast<std::size_t>(words.count()));  // by class
  for (int orbit = 0; orbit < vertices.representatives(); ++orbit) {
    const auto r = static_cast<std::size_t>(orbit);
    for (auto k = vertices.first_point[r]; k < vertices.first_point[r + 1]; ++k) {
      const auto point = static_cast<std::size_t>(k);
      const WordClasses::Member& member = classes.of(vertices.point_words[point]);
      const int origin = origin_of(member.by, vertices.point_sets[point]);
      if (origin == kAlone) continue;
      First& first = firsts[static_cast<std::size_t>(member.of)];
      if (first.orbit != orbit) {
        first = {point, orbit, origin};
      } else if (first.origin == origin) {
        ++result[first.point];
        result[point] = 0;
      }
    }
  }
  return result;
}

}  // namespace orbifit

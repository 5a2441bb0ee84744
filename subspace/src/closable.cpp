#include "orbifit/subspace/closable.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "orbifit/model/errors.h"
#include "orbifit/subspace/orbit.h"
#include "orbifit/subspace/region_map.h"
#include "orbifit/subspace/shared_axes.h"

#include "vertex_places.h"

namespace orbifit {

namespace {

constexpr std::size_t kTrialPoints = 128;  // of each region
constexpr double kParallel = 1e-6;         // radians

// Orbits of groups that fit together have no more points than the product of the orders of the places on the way, and
// a few times that where mirrors meet at an angle.
int most_points(const RegionMap& regions, const std::vector<char>& followed, const std::vector<int>& here) {
  constexpr double kLeast = 64;
  constexpr double kMost = 6000;
  double product = 4;
  for (const int place : here) {
    if (followed[static_cast<std::size_t>(place)] == 0) continue;
    product = std::min(kMost, product * static_cast<double>(regions.elements(place).size()));
  }
  return static_cast<int>(std::max(kLeast, product));
}

// \param sets places of the vertices
bool closes(const Mesh& mesh, const std::vector<int>& faces, const RegionMap& regions, const std::vector<int>& sets,
            const std::vector<char>& followed) {
  GroupWords words(regions, false);
  ClosureOptions options;
  options.doublet = kDoublet * diagonal(mesh.vertices);
  options.followed = &followed;
  const std::size_t step = 1 + faces.size() / kTrialPoints;
  for (std::size_t i = 0; i < faces.size(); i += step) {
    const int face = faces[i];
    const Eigen::Vector3d centroid = mesh.vertices(mesh.faces.row(face), Eigen::all).colwise().mean();
    const int vertex = mesh.faces(face, 0);
    const int set = sets[static_cast<std::size_t>(vertex)];
    try {
      options.most_points = most_points(regions, followed, regions.regions_of_face(face));
      orbit_of(centroid, regions.set_of_face(face), regions, words, options);
      options.most_points = most_points(regions, followed, regions.set_places(set));
      orbit_of(mesh.vertices.row(vertex).transpose(), set, regions, words, options);
    } catch (const InputError&) {  // the orbit has more points than it may
      return false;
    }
  }
  return true;
}

// Whether the motion takes the axis or centre of one continuous group to that of the other.
bool takes_to(const Motion& motion, const Continuum& from, const Continuum& to, double tolerance) {
  if (from.spherical != to.spherical || to.distance(motion(from.centre)) > tolerance) return false;
  return from.spherical || to.axis.cross(motion.linear * from.axis).norm() < kParallel;
}

// A followed region with an element that takes the continuous region `number`, or what they have in common, to no
// followed region; -1: none. Its circles would become circles about an axis that nothing names.
int without_image(const RegionMap& regions, int number, const std::vector<char>& followed, double tolerance) {
  const auto is_followed = [&](int place) { return followed[static_cast<std::size_t>(place)] != 0; };
  for (const int other : regions.meeting(number)) {
    if (other >= regions.count() || !is_followed(other)) continue;
    for (std::size_t e = 0; e < regions.elements(other).size(); ++e) {
      if (std::ranges::any_of(regions.images_of(number, other, static_cast<int>(e)), is_followed)) continue;
      // Else one that turns alike, of whatever faces.
      const bool alike = std::ranges::any_of(regions.meeting(other), [&](int place) {
        const Continuum* continuum = regions.continuum(place);
        return continuum != nullptr && is_followed(place) &&
               takes_to(regions.elements(other)[e], *regions.continuum(number), *continuum, tolerance);
      });
      if (!alike) return other;
    }
  }
  return -1;
}

// Until none is left without image.
void drop_without_image(const RegionMap& regions, std::vector<char>& followed, double tolerance,
                        const std::function<void(std::size_t, const std::string&)>& drop) {
  for (bool changed = true; changed;) {
    changed = false;
    for (int i = 0; i < regions.count(); ++i) {
      const auto region = static_cast<std::size_t>(i);
      if (followed[region] == 0 || regions.continuum(i) == nullptr) continue;
      const int other = without_image(regions, i, followed, tolerance);
      if (other < 0) continue;
      followed[region] = 0;
      changed = true;
      drop(region, "the group of \"" + regions.name(other) + "\" takes it where there is no region of its kind");
    }
  }
}

struct Attempt {
  SymmetryAnnotation kept;
  std::vector<std::string> messages;
  int first_dropped = -1;  // a region
};

// Shares axes and keeps what closes, region after region.
Attempt attempt(const Mesh& mesh, const SymmetryAnnotation& detected, MayMove which, const RunContext& context) {
  const SymmetryAnnotation annotation = share_axes(mesh, detected, detected.tolerance, which);
  const RegionMap regions(mesh, annotation, context);
  const std::vector<int> sets = sets_of_vertices(mesh, regions);
  const double tolerance = kDoublet * diagonal(mesh.vertices);
  Attempt result;
  const auto drop = [&](std::size_t region, const std::string& why) {
    const int number = static_cast<int>(region);
    if (result.first_dropped < 0 || number < result.first_dropped) result.first_dropped = number;
    result.messages.push_back("left out region \"" + regions.name(number) + "\" (" +
                              annotation.regions[region].group.symbol() + "): " + why);
  };
  std::vector<char> followed(static_cast<std::size_t>(regions.places()), 0);
  std::vector<char> wanted = followed;
  std::fill_n(wanted.begin(), annotation.regions.size(), 1);
  drop_without_image(regions, wanted, tolerance, drop);
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) {
    if (wanted[i] == 0) continue;
    context.progress("closure", static_cast<double>(i) / static_cast<double>(annotation.regions.size()));
    followed[i] = 1;
    if (closes(mesh, annotation.regions[i].faces, regions, sets, followed)) continue;
    followed[i] = 0;
    drop(i, "its group does not close with those of larger regions");
  }
  drop_without_image(regions, followed, tolerance, drop);
  result.kept = annotation;
  result.kept.regions.clear();
  result.kept.patterns.clear();
  for (std::size_t i = 0; i < annotation.regions.size(); ++i) {
    if (followed[i] != 0) result.kept.regions.push_back(annotation.regions[i]);
  }
  for (std::size_t i = 0; i < annotation.patterns.size(); ++i) {
    const Pattern& pattern = annotation.patterns[i];
    const auto first = followed.begin() + regions.first_place_of_pattern(static_cast<int>(i));
    const auto mark = [&](char value) { std::fill_n(first, pattern.instances.size(), value); };
    mark(1);
    const bool fits = std::ranges::all_of(pattern.instances, [&](const PatternInstance& instance) {
      return closes(mesh, instance.faces, regions, sets, followed);
    });
    if (!fits) {
      mark(0);
      result.messages.push_back("left out pattern \"" + pattern.name + "\" (" + to_string(pattern.kind) +
                                "): its steps do not close with the groups of the regions");
      continue;
    }
    result.kept.patterns.push_back(pattern);
  }
  set_parents(result.kept.regions);
  return result;
}

}  // namespace

// A region that does not fit pulls at the axes of others before it is found out: they are shared anew without it.
SymmetryAnnotation closable(const Mesh& mesh, const SymmetryAnnotation& detected, const RunContext& context) {
  constexpr int kMostAttempts = 6;
  SymmetryAnnotation rest = detected;
  std::vector<std::string> given_up;
  // What fits exactly where it is stays there, if all closes then.
  Attempt best = attempt(mesh, rest, MayMove::inexact, context);
  if (best.first_dropped < 0) {
    for (const std::string& message : best.messages) context.message(message);
    return best.kept;
  }
  std::vector<std::string> best_messages = best.messages;
  for (int round = 0; round < kMostAttempts; ++round) {
    Attempt now = attempt(mesh, rest, MayMove::all, context);
    const int dropped = now.first_dropped;
    std::vector<std::string> messages = given_up;
    messages.insert(messages.end(), now.messages.begin(), now.messages.end());
    if (dropped >= 0) {
      const Region& region = rest.regions[static_cast<std::size_t>(dropped)];
      given_up.push_back("left out region \"" + region.name + "\" (" + region.group.symbol() +
                         "): its group does not close with those of larger regions");
    }
    if (now.kept.regions.size() > best.kept.regions.size()) {
      best = std::move(now);
      best_messages = std::move(messages);
    }
    if (dropped < 0) break;
    rest.regions.erase(rest.regions.begin() + dropped);
  }
  for (const std::string& message : best_messages) context.message(message);
  return best.kept;
}

}  // namespace orbifit

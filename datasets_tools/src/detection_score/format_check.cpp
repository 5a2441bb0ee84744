#include "detection_score/format_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

#include "base/dense.h"

namespace orbifit::scoring {

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Kind = Pattern::Kind;

constexpr double kIdentity = 1e-6;     // of linear parts; of translations, as a fraction of the diagonal
constexpr double kTranslation = 1e-5;  // of a generator's linear part
constexpr double kIndependent = 1e-6;  // of the diagonal
constexpr double kOnLattice = 2e-3;    // of the diagonal
constexpr double kTurned = 1e-4;       // of an instance's linear part in a lattice of translations
constexpr double kMaxPitch = 1e-3;     // of the diagonal, for a rotation
constexpr double kMinPitch = 1e-6;     // of the diagonal, for a screw
constexpr double kOffPower = 1e-2;     // of linear parts; a fifth of it for places, of the diagonal

void check_translations(const Pattern& pattern, double diagonal, std::vector<std::string>& breaches) {
  MatrixXd steps(3, pattern.generators.size());
  for (std::size_t k = 0; k < pattern.generators.size(); ++k) {
    const Motion& step = pattern.generators[k];
    steps.col(static_cast<Eigen::Index>(k)) = step.translation;
    if ((step.linear - Matrix3d::Identity()).cwiseAbs().maxCoeff() > kTranslation) {
      breaches.push_back("a generator of a " + to_string(pattern.kind) + " is not a translation");
    }
  }
  const Eigen::JacobiSVD<MatrixXd> svd(steps);
  if (svd.singularValues()[steps.cols() - 1] <= kIndependent * diagonal) {
    breaches.emplace_back("the generators are linearly dependent");
    return;
  }
  for (std::size_t j = 0; j < pattern.instances.size(); ++j) {
    const Motion& motion = pattern.instances[j].motion;
    const Eigen::VectorXd whole = shortest_solution(steps, motion.translation, kIndependent).array().round();
    if ((motion.linear - Matrix3d::Identity()).cwiseAbs().maxCoeff() > kTurned ||
        (steps * whole - motion.translation).cwiseAbs().maxCoeff() > kOnLattice * diagonal) {
      breaches.push_back("the motion of instance " + std::to_string(j) +
                         " is no whole-number combination of the generators");
    }
  }
}

void check_turns(const MeasuredMesh& measured, const Pattern& pattern, std::vector<std::string>& breaches) {
  const double diagonal = measured.diagonal;
  const Motion& step = pattern.generators.front();
  const AxisAngle turn = axis_angle(step.linear);
  if (turn.determinant < 0 || turn.angle < kTurned) {
    breaches.push_back("the generator of a " + to_string(pattern.kind) + " must be a proper rotation");
    return;
  }
  const double pitch = std::abs(turn.axis.dot(step.translation)) / diagonal;
  if (pattern.kind == Kind::rotation && pitch > kMaxPitch) {
    breaches.emplace_back("the generator of a rotation moves along its axis");
  }
  if (pattern.kind == Kind::screw && pitch < kMinPitch) {
    breaches.emplace_back("the generator of a screw does not move along its axis");
  }
  FaceSet all;
  for (const PatternInstance& instance : pattern.instances) all = united(all, face_set(instance.faces));
  const Vector3d middle = measured.middle_of(members(all));
  std::vector<Motion> powers{Motion{}};
  for (const Motion& generator : {step, inverse(step)}) {
    Motion power;
    for (std::size_t k = 0; k < 4 * pattern.instances.size(); ++k) powers.push_back(power = generator * power);
  }
  for (std::size_t j = 0; j < pattern.instances.size(); ++j) {
    const Motion& motion = pattern.instances[j].motion;
    const bool is_power = std::ranges::any_of(powers, [&](const Motion& power) {
      return (motion.linear - power.linear).cwiseAbs().maxCoeff() <= kOffPower &&
             5 * (motion(middle) - power(middle)).cwiseAbs().maxCoeff() <= kOffPower * diagonal;
    });
    if (!is_power) {
      breaches.push_back("the motion of instance " + std::to_string(j) + " is no power of the generator");
    }
  }
}

template <typename Items>
bool repeats_an_id(const Items& items) {
  std::vector<int> ids;
  for (const auto& item : items) ids.push_back(item.id);
  std::ranges::sort(ids);
  return std::ranges::adjacent_find(ids) != ids.end();
}

// A parent is the smallest region that strictly contains the child.
void check_parents(const std::vector<Region>& regions, std::vector<std::string>& breaches) {
  std::vector<FaceSet> sets;
  std::vector<int> sizes;
  for (const Region& region : regions) {
    sets.push_back(face_set(region.faces));
    sizes.push_back(sets.back().size());
  }
  const auto contains = [&](std::size_t large, std::size_t small) {
    return sizes[large] > sizes[small] && sizes[small] > 0 &&
           intersection(sets[large], sets[small]).size() == sizes[small];
  };
  for (std::size_t i = 0; i < regions.size(); ++i) {
    int least = std::numeric_limits<int>::max();
    for (std::size_t j = 0; j < regions.size(); ++j) {
      if (sizes[j] < least && contains(j, i)) least = sizes[j];
    }
    const std::string name = "region " + std::to_string(regions[i].id) + ": parent ";
    const bool contained = least < std::numeric_limits<int>::max();
    if (!regions[i].parent) {
      if (contained) breaches.push_back(name + "is null, but a region strictly contains it");
      continue;
    }
    const auto parent = std::ranges::find(regions, *regions[i].parent, &Region::id);
    const auto place = static_cast<std::size_t>(parent - regions.begin());
    const std::string given = name + std::to_string(*regions[i].parent);
    if (parent == regions.end()) {
      breaches.push_back(given + " does not exist");
    } else if (!contains(place, i)) {
      breaches.push_back(given + " does not strictly contain it");
    } else if (sizes[place] > least) {
      breaches.push_back(given + " is not the smallest region that contains it");
    }
  }
}

}  // namespace

std::vector<std::string> pattern_breaches(const MeasuredMesh& measured, const Pattern& pattern) {
  std::vector<std::string> breaches;
  if (!(pattern.residual.rms >= 0 && pattern.residual.rms <= pattern.residual.max * (1 + 1e-9) + 1e-15)) {
    breaches.emplace_back("residual must satisfy 0 <= rms <= max");
  }
  if (pattern.instances.size() < 2) {
    breaches.emplace_back("needs at least two instances");
    return breaches;
  }
  FaceSet seen;
  for (std::size_t j = 0; j < pattern.instances.size(); ++j) {
    const PatternInstance& instance = pattern.instances[j];
    const std::string name = "instance " + std::to_string(j);
    const FaceSet set = face_set(instance.faces);
    if (set.empty()) breaches.push_back(name + " has no faces");
    if (!(orthogonality_error(instance.motion.linear) <= kIdentity) || !instance.motion.translation.allFinite()) {
      breaches.push_back("the motion of " + name + " is not orthogonal to 1e-6");
      return breaches;
    }
    if (!intersection(seen, set).empty()) breaches.push_back(name + " shares faces with an earlier instance");
    seen = united(seen, set);
  }
  const Motion& first = pattern.instances.front().motion;
  if ((first.linear - Matrix3d::Identity()).cwiseAbs().maxCoeff() > kIdentity ||
      first.translation.cwiseAbs().maxCoeff() > kIdentity * std::max(1.0, measured.diagonal)) {
    breaches.emplace_back("the motion of instance 0 is not the identity");
  }
  if (static_cast<int>(pattern.generators.size()) != generator_count(pattern.kind)) {
    breaches.push_back(to_string(pattern.kind) + " needs " + std::to_string(generator_count(pattern.kind)) +
                       " generators, not " + std::to_string(pattern.generators.size()));
    return breaches;
  }
  const bool orthogonal = std::ranges::all_of(pattern.generators, [](const Motion& step) {
    return step.translation.allFinite() && orthogonality_error(step.linear) <= kIdentity;
  });
  if (!orthogonal) {
    breaches.emplace_back("a generator is not orthogonal to 1e-6");
  } else if (pattern.kind == Kind::rotation || pattern.kind == Kind::screw) {
    check_turns(measured, pattern, breaches);
  } else if (pattern.kind != Kind::congruent) {
    check_translations(pattern, measured.diagonal, breaches);
  }
  return breaches;
}

FormatReport check_format(const MeasuredMesh& measured, const SymmetryAnnotation& annotation) {
  FormatReport report;
  if (!(std::abs(annotation.mesh_diagonal - measured.diagonal) <= 1e-3 * measured.diagonal)) {
    report.breaches.push_back("mesh: diagonal is " + std::to_string(annotation.mesh_diagonal) + ", the mesh has " +
                              std::to_string(measured.diagonal));
  }
  if (!(annotation.tolerance > 0)) report.breaches.emplace_back("tolerance must be a positive number");
  for (const Region& region : annotation.regions) {
    const std::vector<std::string> found = region_breaches(measured, region);
    report.regions.push_back(found.empty() ? 1 : 0);
    for (const std::string& text : found)
      report.breaches.push_back("region " + std::to_string(region.id) + ": " + text);
  }
  for (const Pattern& pattern : annotation.patterns) {
    const std::vector<std::string> found = pattern_breaches(measured, pattern);
    report.patterns.push_back(found.empty() ? 1 : 0);
    for (const std::string& text : found) {
      report.breaches.push_back("pattern " + std::to_string(pattern.id) + ": " + text);
    }
  }
  if (repeats_an_id(annotation.regions)) report.breaches.emplace_back("regions: an id occurs twice");
  if (repeats_an_id(annotation.patterns)) report.breaches.emplace_back("patterns: an id occurs twice");
  check_parents(annotation.regions, report.breaches);
  return report;
}

}  // namespace orbifit::scoring

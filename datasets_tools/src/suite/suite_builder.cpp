#include "suite/suite_builder.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <Eigen/LU>

#include "orbifit/datasets_tools/symmetry_residual.h"

#include "base/dense.h"
#include "models/primitives.h"

namespace orbifit {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Family = PointGroup::Family;

constexpr double kSame = 1e-9;
// Of two regions that differ by less the smaller is no news (as score_detection.py sees it).
constexpr double kInside = 0.95;
constexpr double kNoLarger = 1.02;

// A point that all of the motions leave fixed, nearest to `near`.
Vector3d fixed_point(const std::vector<Motion>& motions, const Vector3d& near) {
  Eigen::MatrixXd rows(3 * static_cast<Eigen::Index>(motions.size()), 3);
  Eigen::VectorXd right(rows.rows());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    rows.middleRows<3>(row) = Matrix3d::Identity() - motions[i].linear;
    right.segment<3>(row) = motions[i](near) - near;
  }
  return near + shortest_solution(rows, right, 1e-6);
}

// What two groups have in common, if that is finite and more than the identity.
std::optional<Region> common_group(const Region& a, const Region& b, double length) {
  const Region& finite = a.group.continuous() ? b : a;
  const Region& other = a.group.continuous() ? a : b;
  if (finite.group.continuous()) return std::nullopt;
  std::vector<Motion> common;
  std::vector<Matrix3d> linear;
  for (const Motion& element : finite.elements) {
    if (!holds(other, element, length)) continue;
    common.push_back(element);
    linear.push_back(element.linear);
  }
  if (common.size() < 2 || common.size() == finite.elements.size()) return std::nullopt;
  const auto formed = classify(linear, 1e-6);
  if (!formed) throw std::logic_error("what two groups have in common is no group");
  return make_region(formed->group, fixed_point(common, finite.centre), formed->frame, {}, {});
}

bool group_within(const Region& inner, const Region& outer, double length) {
  return std::ranges::all_of(inner.generators, [&](const Motion& g) { return holds(outer, g, length); });
}

double shared_area(const std::vector<int>& a, const std::vector<int>& b, const Eigen::VectorXd& areas) {
  std::vector<int> both;
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return areas(both).sum();
}

}  // namespace

bool holds(const Region& region, const Motion& motion, double length) {
  if ((motion(region.centre) - region.centre).norm() > kSame * length) return false;
  if (region.group.continuous()) return belongs_to_continuous(motion.linear, region.group, region.axis, kSame);
  if (region.group.family == Family::C1) return motion.linear.isIdentity(kSame);
  return std::ranges::any_of(region.elements, [&](const Motion& element) {
    return (element.linear - motion.linear).cwiseAbs().maxCoeff() < kSame;
  });
}

int SuiteBuilder::kind(PartKind kind) {
  own_.push_back(make_region(kind.own, kind.centre, kind.frame, {}, kind.name));
  kinds_.push_back(std::move(kind));
  return static_cast<int>(kinds_.size()) - 1;
}

int SuiteBuilder::add(int kind, const Motion& at) {
  Part part{kind, at,
            std::vector<int>(static_cast<std::size_t>(kinds_.at(static_cast<std::size_t>(kind)).mesh.faces.rows()))};
  std::iota(part.faces.begin(), part.faces.end(), faces_);
  faces_ += static_cast<int>(part.faces.size());
  parts_.push_back(std::move(part));
  return static_cast<int>(parts_.size()) - 1;
}

int SuiteBuilder::image_of(const Part& part, const Motion& motion) const {
  const Motion image = motion * part.at;
  const Region& own = own_[static_cast<std::size_t>(part.kind)];
  const double length = diagonal(kind_of(part).mesh.vertices) + image.translation.norm();
  for (std::size_t q = 0; q < parts_.size(); ++q) {
    if (parts_[q].kind == part.kind && holds(own, inverse(parts_[q].at) * image, length)) return static_cast<int>(q);
  }
  return -1;
}

std::vector<int> SuiteBuilder::orbit(int kind, const Motion& at, const PointGroup& group, const LocalFrame& about) {
  std::vector<int> copies;
  for (const Matrix3d& element : elements(group, about.frame)) {
    const Motion motion = Motion::about(element, about.origin);
    const int present = image_of({kind, at, {}}, motion);
    if (present < 0) copies.push_back(add(kind, motion * at));
  }
  expect(group, about);
  return copies;
}

void SuiteBuilder::expect(const PointGroup& group, const LocalFrame& about, const std::string& name) {
  asked_.push_back({make_region(group, about.origin, about.frame, {}, name), true});
}

Pattern SuiteBuilder::pattern(const std::string& name, Pattern::Kind kind, const std::vector<Motion>& generators,
                              const std::vector<std::vector<int>>& copies) const {
  Pattern pattern;
  pattern.name = name;
  pattern.kind = kind;
  pattern.generators = generators;
  const auto part = [&](int number) -> const Part& { return parts_.at(static_cast<std::size_t>(number)); };
  for (const std::vector<int>& copy : copies) {
    PatternInstance instance{part(copy.at(0)).at * inverse(part(copies.front().at(0)).at), {}};
    if (pattern.instances.empty()) instance.motion = {};
    for (std::size_t k = 0; k < copy.size(); ++k) {
      if (image_of(part(copies.front()[k]), instance.motion) < 0) throw std::logic_error(name + ": no copies");
      instance.faces.insert(instance.faces.end(), part(copy[k]).faces.begin(), part(copy[k]).faces.end());
    }
    std::ranges::sort(instance.faces);
    pattern.instances.push_back(std::move(instance));
  }
  return pattern;
}

void SuiteBuilder::expect_pattern(const std::string& name, Pattern::Kind kind, const std::vector<Motion>& generators,
                                  const std::vector<std::vector<int>>& copies) {
  patterns_.push_back(pattern(name, kind, generators, copies));
}

std::vector<int> SuiteBuilder::parts_under(const Region& group) const {
  std::vector<bool> kept(parts_.size(), true);
  std::vector<std::vector<int>> images;
  for (const Motion& generator : group.generators) {
    std::vector<int>& list = images.emplace_back();
    for (const Part& part : parts_) list.push_back(image_of(part, generator));
  }
  // A part goes with its whole orbit or not at all.
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::vector<int>& image : images) {
      for (std::size_t p = 0; p < parts_.size(); ++p) {
        if (!kept[p] || (image[p] >= 0 && kept[static_cast<std::size_t>(image[p])])) continue;
        kept[p] = false;
        changed = true;
      }
    }
  }
  std::vector<int> result;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (kept[p]) result.push_back(static_cast<int>(p));
  }
  return result;
}

std::vector<SuiteBuilder::Candidate> SuiteBuilder::candidates() const {
  std::vector<Candidate> result = asked_;
  double length = 0;
  for (const Part& part : parts_) {
    length = std::max(length, part.at.translation.norm() + diagonal(kind_of(part).mesh.vertices));
  }
  for (std::size_t a = 0; a < result.size(); ++a) {
    if (!result[a].expected) continue;
    for (std::size_t b = 0; b < a; ++b) {
      if (!result[b].expected) continue;
      const auto common = common_group(result[a].region, result[b].region, length);
      if (!common) continue;
      const bool known = std::ranges::any_of(result, [&](const Candidate& other) {
        return other.region.group == common->group && group_within(*common, other.region, length);
      });
      if (!known) result.push_back({*common, true});
    }
  }
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Part& part = parts_[p];
    const PartKind& kind = kind_of(part);
    if (kind.own.family == Family::C1 || kind.report == OwnRegion::silent) continue;
    const LocalFrame about = image(part.at, LocalFrame{kind.frame, kind.centre});
    result.push_back({make_region(kind.own, about.origin, about.frame, {}, {}), kind.report == OwnRegion::expected,
                      static_cast<int>(p)});
  }
  return result;
}

std::string SuiteBuilder::name_of(const std::vector<int>& parts) const {
  if (parts.size() == parts_.size()) return "whole";
  std::vector<int> kinds;
  for (const int part : parts) {
    const int kind = parts_[static_cast<std::size_t>(part)].kind;
    if (std::ranges::find(kinds, kind) == kinds.end()) kinds.push_back(kind);
  }
  if (parts.size() == 1) {
    int before = 0;
    int copies = 0;
    for (int p = 0; p < static_cast<int>(parts_.size()); ++p) {
      if (parts_[static_cast<std::size_t>(p)].kind != kinds.front()) continue;
      ++copies;
      if (p <= parts.front()) ++before;
    }
    const std::string& name = kinds_[static_cast<std::size_t>(kinds.front())].name;
    return copies > 1 ? name + " " + std::to_string(before) : name;
  }
  std::string text;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (k > 0) text += k + 1 < kinds.size() ? ", " : " and ";
    text += kinds_[static_cast<std::size_t>(kinds[k])].name;
  }
  return text;
}

TruthModel SuiteBuilder::finish() const {
  ModelBuilder assembly;
  for (const Part& part : parts_) assembly.add(kind_of(part).mesh, part.at);
  TruthModel model;
  model.mesh = assembly.finish().mesh;
  DetectionTruth& truth = model.truth;
  truth.expected = empty_annotation(model.mesh, 0.005);
  const Eigen::VectorXd areas = face_areas(model.mesh);
  for (Candidate& candidate : candidates()) {
    const std::vector<int> parts = parts_under(candidate.region);
    for (const int part : parts) {
      const std::vector<int>& faces = parts_[static_cast<std::size_t>(part)].faces;
      candidate.region.faces.insert(candidate.region.faces.end(), faces.begin(), faces.end());
    }
    std::ranges::sort(candidate.region.faces);
    if (areas(candidate.region.faces).sum() < kSmallestShare * areas.sum()) continue;
    if (candidate.region.name.empty()) {
      const bool joins_others = candidate.part >= 0 && parts.size() > 1 && parts.size() < parts_.size();
      candidate.region.name = joins_others ? "about " + name_of({candidate.part}) : name_of(parts);
    }
    (candidate.expected ? truth.expected.regions : truth.optional_regions).push_back(std::move(candidate.region));
  }
  truth.expected.patterns = patterns_;
  leave_out_repeated(model.mesh, truth);

  // Products of exact motions add rounding only: the generators are enough. Continuous groups are measured at the
  // turns that the facets have.
  RunContext context;
  const auto measure = [&](std::vector<Region>& regions, std::vector<Pattern>& patterns) {
    SymmetryAnnotation measured = truth.expected;
    measured.regions = regions;
    measured.patterns = patterns;
    for (Region& region : measured.regions) {
      if (!region.group.continuous()) {
        region.group = {};
        region.elements = region.generators;
      }
    }
    const SymmetryReport report = symmetry_residual(model.mesh, measured, nullptr, CarriedMotions::fixed, context);
    for (std::size_t r = 0; r < regions.size(); ++r) regions[r].residual = report.regions[r].floor;
    for (std::size_t p = 0; p < patterns.size(); ++p) patterns[p].residual = report.patterns[p].floor;
  };
  measure(truth.expected.regions, truth.expected.patterns);
  measure(truth.optional_regions, truth.optional_patterns);
  return model;
}

void leave_out_repeated(const Mesh& mesh, DetectionTruth& truth) {
  const Eigen::VectorXd areas = face_areas(mesh);
  const double length = diagonal(mesh.vertices) + bounding_box_centre(mesh.vertices).norm();
  std::vector<Region> all = truth.expected.regions;
  const std::size_t expected = all.size();
  all.insert(all.end(), truth.optional_regions.begin(), truth.optional_regions.end());
  std::vector<double> area;
  for (const Region& region : all) area.push_back(areas(region.faces).sum());
  const auto says_nothing_new = [&](std::size_t a, std::size_t b) {
    if (area[a] > kNoLarger * area[b] || !group_within(all[a], all[b], length)) return false;
    return shared_area(all[a].faces, all[b].faces, areas) >= kInside * area[a];
  };
  truth.expected.regions.clear();
  truth.optional_regions.clear();
  for (std::size_t a = 0; a < all.size(); ++a) {
    bool repeated = false;
    for (std::size_t b = 0; b < all.size() && !repeated; ++b) {
      if (a == b || !says_nothing_new(a, b)) continue;
      // Of two that say the same of each other the first stays.
      repeated = b < a || !says_nothing_new(b, a);
    }
    if (!repeated) (a < expected ? truth.expected.regions : truth.optional_regions).push_back(all[a]);
  }
  int id = 0;
  for (Region& region : truth.expected.regions) region.id = id++;
  for (Region& region : truth.optional_regions) region.id = id++;
  id = 0;
  for (Pattern& pattern : truth.expected.patterns) pattern.id = id++;
  for (Pattern& pattern : truth.optional_patterns) pattern.id = id++;
  set_parents(truth.expected.regions);
}

}  // namespace orbifit

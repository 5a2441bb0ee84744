#include "truth/transferred_truth.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>

#include "orbifit/model/errors.h"

#include "base/random.h"
#include "detection_score/face_set.h"
#include "detection_score/region_validity.h"
#include "truth/transferred_faces.h"

namespace orbifit {

namespace {

using scoring::MeasuredMesh;

// Share of a region's area from which on it lies in another one.
constexpr double kContained = 0.99;

// Share of a region's visible area from which on all of it counts as kept, or lies in a region that is to contain it.
constexpr double kWhole = 0.97;

// Share of the kept faces that must be kept again, with only themselves to lie on.
constexpr double kSymmetric = 0.9;

// Fraction of the region's own diagonal within which an image is on it.
constexpr double kRegionTolerance = 0.02;

// Share of the largest instance's visible area below which one ends its pattern.
constexpr double kMinInstance = 0.5;

void check_share(const char* name, double value, double most) {
  if (value >= 0 && value <= most) return;
  std::ostringstream text;
  text << "transferred truth: " << name << " is " << value << "; it must be in [0, " << most << "]";
  throw UsageError(text.str());
}

// Faces of the new mesh by the model's faces.
class SourceMap {
 public:
  SourceMap(const std::vector<int>& source_face, Eigen::Index model_faces)
      : source_face_(source_face), chosen_(static_cast<std::size_t>(model_faces), 0) {}

  std::vector<int> operator()(const std::vector<int>& model_faces) {
    for (const int face : model_faces) chosen_[static_cast<std::size_t>(face)] = 1;
    std::vector<int> result;
    for (std::size_t f = 0; f < source_face_.size(); ++f) {
      if (chosen_[static_cast<std::size_t>(source_face_[f])] != 0) result.push_back(static_cast<int>(f));
    }
    for (const int face : model_faces) chosen_[static_cast<std::size_t>(face)] = 0;
    return result;
  }

 private:
  const std::vector<int>& source_face_;
  std::vector<char> chosen_;
};

// All elements but the identity; of a continuous group so many that a gap of a hundredth of a turn is found.
std::vector<Motion> tested_motions(const Region& region, Random& random) {
  if (!region.group.continuous()) {
    return {region.elements.begin() + (region.elements.empty() ? 0 : 1), region.elements.end()};
  }
  std::vector<Motion> result;
  for (int pass = 0; pass < 4; ++pass) {
    const std::vector<Motion> more = scoring::tried_elements(region, random);
    result.insert(result.end(), more.begin(), more.end());
  }
  return result;
}

class Carrier {
 public:
  Carrier(const TruthModel& model, const Mesh& mesh, const std::vector<int>& source_face, const CarryOptions& options,
          RunContext& context)
      : model_(model),
        options_(options),
        context_(context),
        measured_(mesh),
        source_normals_(face_normals(model.mesh)(source_face, Eigen::all)),
        new_faces_(source_face, model.mesh.faces.rows()) {
    truth_.expected = empty_annotation(mesh, model.truth.expected.tolerance);
  }

  DetectionTruth operator()() {
    const DetectionTruth& old = model_.truth;
    const double count = static_cast<double>(old.expected.regions.size() + old.optional_regions.size());
    double done = 0;
    for (const Region& region : old.expected.regions) {
      context_.progress("truth", done++ / count);
      transfer(region, true);
    }
    for (const Region& region : old.optional_regions) {
      context_.progress("truth", done++ / count);
      transfer(region, false);
    }
    demote_contained();
    nest();
    set_parents(truth_.expected.regions);
    for (const Pattern& pattern : old.expected.patterns) transfer(pattern, true);
    for (const Pattern& pattern : old.optional_patterns) transfer(pattern, false);
    return std::move(truth_);
  }

 private:
  double area_of(const std::vector<int>& faces) const {
    double sum = 0;
    for (const int face : faces) sum += measured_.areas[face];
    return sum;
  }

  double tolerance_of(const std::vector<int>& faces) const {
    return std::min(options_.tolerance * measured_.diagonal, kRegionTolerance * measured_.diagonal_of(faces));
  }

  void transfer(const Region& old, bool expected) {
    const std::vector<int> visible = new_faces_(old.faces);
    Random random(context_.seed, "carried truth " + std::to_string(old.id));
    const std::vector<Motion> motions = tested_motions(old, random);
    const auto stay = [&](const std::vector<int>& faces) {
      return kept_faces(measured_, faces, faces, motions, old.group.continuous(), tolerance_of(visible), context_);
    };
    KeptFaces kept = stay(visible);
    bool whole = true;
    if (area_of(kept.faces) >= kWhole * area_of(visible)) {
      // Triangles that cut creases off fail here and there: not worth a ragged face set.
      kept.faces = visible;
    } else if (area_of(kept.faces) > 0) {
      // Too ragged a set is not symmetric by itself.
      whole = area_of(stay(kept.faces).faces) >= kSymmetric * area_of(kept.faces);
    }
    const double area = area_of(kept.faces);
    if (kept.faces.empty() || area < options_.least_area * measured_.area) return;
    expected = expected && whole && area >= options_.least_expected * measured_.area &&
               area >= options_.least_kept * area_of(visible) && !slides(measured_, source_normals_, kept.faces, old);
    Region region = old;
    region.parent.reset();
    region.residual = kept.residual;
    region.faces = std::move(kept.faces);

    std::vector<std::vector<int>> accepted{visible};
    const auto others = model_.truth.also_accepted.find(old.id);
    if (others != model_.truth.also_accepted.end()) {
      for (const std::vector<int>& faces : others->second) accepted.push_back(new_faces_(faces));
    }
    for (std::vector<int>& faces : accepted) {
      std::vector<std::vector<int>>& list = truth_.also_accepted[old.id];
      if (!faces.empty() && faces != region.faces && std::ranges::find(list, faces) == list.end()) {
        list.push_back(std::move(faces));
      }
    }
    if (truth_.also_accepted[old.id].empty()) truth_.also_accepted.erase(old.id);
    (expected ? truth_.expected.regions : truth_.optional_regions).push_back(std::move(region));
  }

  // Where hidden parts made the difference between two regions, only the one with more elements is left to be found.
  void demote_contained() {
    std::vector<Region>& regions = truth_.expected.regions;
    std::vector<scoring::FaceSet> sets;
    sets.reserve(regions.size());
    for (const Region& region : regions) sets.push_back(scoring::face_set(region.faces));
    std::vector<Region> kept;
    for (std::size_t r = 0; r < regions.size(); ++r) {
      bool contained = false;
      for (std::size_t other = 0; other < regions.size() && !contained; ++other) {
        contained =
            other != r &&
            measured_.area_of(scoring::intersection(sets[r], sets[other])) > kContained * measured_.area_of(sets[r]) &&
            has_all_elements(regions[other], regions[r], measured_.diagonal);
      }
      (contained ? truth_.optional_regions : kept).push_back(regions[r]);
    }
    regions = std::move(kept);
  }

  // What lies in another region but for a few faces at creases does so wholly.
  void nest() {
    std::vector<Region*> regions;
    for (Region& region : truth_.expected.regions) regions.push_back(&region);
    std::ranges::stable_sort(regions, {}, [&](const Region* region) { return -area_of(region->faces); });
    for (std::size_t r = 1; r < regions.size(); ++r) {
      for (std::size_t larger = 0; larger < r; ++larger) {
        std::vector<int> shared;
        std::ranges::set_intersection(regions[r]->faces, regions[larger]->faces, std::back_inserter(shared));
        if (area_of(shared) >= kWhole * area_of(regions[r]->faces)) regions[r]->faces = std::move(shared);
      }
    }
  }

  // What all instances show: other parts hide more of some than of others.
  void transfer(const Pattern& old, bool expected) {
    Pattern pattern = old;
    std::vector<PatternInstance>& instances = pattern.instances;
    if (instances.empty()) return;
    std::vector<double> visible;
    for (PatternInstance& instance : instances) {
      instance.faces = new_faces_(instance.faces);
      visible.push_back(area_of(instance.faces));
    }
    if (std::ranges::min(visible) < kMinInstance * std::ranges::max(visible)) return;
    PatternInstance& first = instances.front();
    const double tolerance = tolerance_of(first.faces);
    const auto kept = [&](const std::vector<int>& from, const std::vector<int>& to, const Motion& motion) {
      return kept_faces(measured_, from, to, {motion}, false, tolerance, context_);
    };
    for (std::size_t i = 1; i < instances.size(); ++i) {
      first.faces = kept(first.faces, instances[i].faces, instances[i].motion).faces;
    }
    double area = area_of(first.faces);
    double least = area;
    double squares = 0;
    pattern.residual = {};
    for (std::size_t i = 1; i < instances.size(); ++i) {
      KeptFaces common = kept(instances[i].faces, first.faces, inverse(instances[i].motion));
      instances[i].faces = std::move(common.faces);
      squares += common.residual.rms * common.residual.rms;
      pattern.residual.max = std::max(pattern.residual.max, common.residual.max);
      least = std::min(least, area_of(instances[i].faces));
      area += area_of(instances[i].faces);
    }
    if (instances.size() > 1) pattern.residual.rms = std::sqrt(squares / static_cast<double>(instances.size() - 1));
    if (!(least > 0) || area < options_.least_area * measured_.area) return;
    expected = expected && area >= options_.least_expected * measured_.area &&
               least >= options_.least_kept * std::ranges::max(visible);
    (expected ? truth_.expected.patterns : truth_.optional_patterns).push_back(std::move(pattern));
  }

  const TruthModel& model_;
  const CarryOptions& options_;
  RunContext& context_;
  MeasuredMesh measured_;
  Points source_normals_;  // of the new faces: exact, also where they cut a crease off
  SourceMap new_faces_;
  DetectionTruth truth_;
};

}  // namespace

void CarryOptions::validate() const {
  if (!(tolerance > 0)) {
    std::ostringstream text;
    text << "transferred truth: tolerance is " << tolerance << ": must be positive";
    throw UsageError(text.str());
  }
  check_share("least_kept", least_kept, 1);
  check_share("least_expected", least_expected, 1);
  check_share("least_area", least_area, least_expected);
}

DetectionTruth transferred_truth(const TruthModel& model, const Mesh& mesh, const std::vector<int>& source_face,
                                 const CarryOptions& options, RunContext& context) {
  options.validate();
  if (static_cast<Eigen::Index>(source_face.size()) != mesh.faces.rows()) {
    throw InputError("", "source_face",
                     "has " + std::to_string(source_face.size()) + " entries; the mesh has " +
                         std::to_string(mesh.faces.rows()) + " faces");
  }
  for (std::size_t f = 0; f < source_face.size(); ++f) {
    if (source_face[f] < 0 || source_face[f] >= model.mesh.faces.rows()) {
      throw InputError("", "source_face[" + std::to_string(f) + "]",
                       "is " + std::to_string(source_face[f]) + "; the model has " +
                           std::to_string(model.mesh.faces.rows()) + " faces");
    }
  }
  return Carrier(model, mesh, source_face, options, context)();
}

}  // namespace orbifit

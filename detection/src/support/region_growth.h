#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "orbifit/model/run_context.h"

#include "geometry/point_index.h"
#include "group/refinement.h"
#include "surface/components.h"
#include "surface/surface_patch.h"

namespace orbifit {

struct SubgroupRegion {
  GroupPlacement placement;
  std::vector<int> components;  ///< ascending
};

/// Finds maximal regions S(G) among whole components by the orbit test: a component stays when the elements carry it
/// onto components of like size that stay too.
class ComponentMover {
 public:
  /// All arguments are kept by reference. \param whole index of the whole mesh \param tolerance a length
  ComponentMover(const PreparedMesh& prepared, const ComponentSurvey& survey, const SurfaceIndex& whole,
                 double tolerance, const RunContext& context);

  /// Tells the own group of the first member of one of the survey's classes. Where a motion differs by an element of
  /// it from those by which the survey carries the members onto one another, nothing need be measured.
  void know(std::size_t number, const GroupPlacement& own);

  /// The components that the group permutes, ascending.
  /// \param seed components known to belong \param strictness how far images may be off, in tolerances
  std::vector<int> permuted(const GroupPlacement& placement, const std::vector<int>& seed, double strictness = 1) const;

  /// The same of some components: those of the seed and those `among`, ascending, that the group permutes together.
  std::vector<int> permuted_among(const std::vector<int>& among, const GroupPlacement& placement,
                                  const std::vector<int>& seed, double strictness = 1) const;

  /// For subgroups H of a finite group known on `seed`: the components that H permutes where they are more than the
  /// seed, largest subgroup first.
  std::vector<SubgroupRegion> subgroup_regions(const GroupPlacement& placement, const std::vector<int>& seed) const;

 private:
  // The component onto which the motion carries this one, or that share of it; -1 for none.
  int image(std::size_t component, const Motion& motion, double reach, double least_share) const;
  // Whether the motion carries the component onto the other by what is known of their class, to half the reach.
  bool carries(std::size_t component, std::size_t target, const Motion& motion, double reach) const;
  // Where the elements of a group carry each component, -1 for nowhere. None of the seed's, which stay in it.
  std::vector<std::vector<int>> element_images(const std::vector<Eigen::Matrix3d>& linear,
                                               const GroupPlacement& placement, const std::vector<char>& in_seed) const;
  double reach_of(std::size_t component, const PointGroup& group) const;
  SurfaceSamples samples_of(std::size_t component) const;

  const PreparedMesh& prepared_;
  const ComponentSurvey& survey_;
  const SurfaceIndex& whole_;
  double tolerance_;
  const RunContext& context_;
  std::unique_ptr<PointIndex> centroids_;
  struct Place {
    int number = -1;  // of the class
    Motion motion;    // from its first member
  };
  std::vector<Place> places_;                                  // by component
  std::vector<std::optional<GroupPlacement>> continuous_own_;  // by class
  std::vector<std::vector<Motion>> own_;                       // by class: elements of a finite own group
  std::vector<SurfaceSamples> samples_;                        // of each component
};

/// The elements of a group, the identity among them, to ask whether motions are some of them.
class GroupElements {
 public:
  explicit GroupElements(const GroupPlacement& placement);

  /// Whether the motion is one of the elements: of a finite group to three times `tolerance` (a length) on points
  /// within `reach` of `centre`; of a continuous one by angles of tolerance / reach, and to twice the tolerance where
  /// the group's centre or axis goes.
  bool hold(const Motion& motion, const Eigen::Vector3d& centre, double reach, double tolerance) const;

 private:
  GroupPlacement placement_;
  std::vector<Motion> finite_;
};

/// Whether every element of `inner` is one of `outer`, see GroupElements.
bool contains_group(const GroupPlacement& outer, const GroupPlacement& inner, const Eigen::Vector3d& centre,
                    double reach, double tolerance);

}  // namespace orbifit

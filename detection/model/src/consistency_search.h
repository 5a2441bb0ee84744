#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "orbifit/model/consistent_annotation.h"

#include "group_place.h"
#include "region_shapes.h"

namespace orbifit {

/// Thresholds of consistent_annotation(). Lengths count in the annotation's tolerance.
struct ConsistencyPolicy {
  /// How far the image of a region's surface may lie from the surface that it stands for: the region that is moved, the
  /// group that moves it and the other region are each that far off, rarely all in one direction.
  double reach = 2.5;
  /// How far the image of a group may be from the group that it stands for, on the region's extent.
  double same_group = 4;
  /// How far a group may be moved on its region.
  double movement = 2;
  /// Share of a region's samples that must arrive for two regions to be images of one another: borders of regions are
  /// drawn face by face, and detection ends them within a few tolerances.
  double arrived = 0.6;
  /// Share of the samples of an added image that its group must keep, and of its source's area that it must have.
  double kept = 0.85;
  /// A pattern whose residual is below this share of a region's is right about directions.
  double far_more_exact = 0.1;
  /// What counts as met, as a fraction of the size of the coordinates: some hundred roundings.
  double exact = 1e-13;
};

/// Regions and patterns on the way to a consistent annotation. See consistent_annotation().
class ConsistencySearch {
 public:
  ConsistencySearch(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context);

  ConsistentAnnotation run();

 private:
  enum class State { waiting, placed, out };
  struct KnownRegion {
    Region region;
    int shape = -1;
    std::optional<GroupPlace> place;
    State state = State::waiting;
    int source = -1;  // of an added image: number of the region it is the image of
  };
  struct KnownPattern {
    Pattern pattern;
    std::vector<int> shapes;  // of the instances
    State state = State::waiting;
  };
  // A motion that takes what lies in one shape to another.
  struct Move {
    int domain, arrival;
    Motion motion;
    int region, pattern;   // whose it is; -1
    bool turning = false;  // stands for all rotations of a continuous group
  };
  struct Member {
    std::size_t region;
    Motion way;  // from the family's first
  };
  // Regions that the moves so far take to one another, and what they ask of the first.
  struct Family {
    std::vector<Member> members;
    std::vector<Tie> ties;
    std::vector<std::size_t> replaced;  // waiting regions whose place added images take
  };

  double length(double tolerances) const { return tolerances * tolerance_; }
  const Extent& extent(std::size_t region) const { return shapes_.extent(regions_[region].shape); }
  std::string name_of(const Move& move) const;
  std::string label(std::size_t region) const;

  void place_family(std::size_t first);
  std::optional<std::string> gather(std::size_t first, Family& family);
  std::optional<std::string> follow(const Move& move, std::size_t from, Family& family);
  std::optional<std::string> turn_with(const Move& move, std::size_t at, Family& family) const;
  std::optional<std::string> add_image(const Move& move, std::size_t at, Family& family);
  std::optional<std::string> ask_of_overlaps(Family& family);
  std::optional<std::size_t> image_region(std::size_t region, int domain, const Motion& motion, int arrival) const;
  std::optional<std::size_t> nearest_image(std::size_t region, int domain, const Motion& motion, int arrival) const;
  std::vector<Eigen::Vector3d> exact_steps(std::size_t region) const;
  std::optional<std::string> accept_family(const Family& family);
  void leave_out_region(std::size_t region, const std::string& reason);

  void place_pattern(std::size_t number);
  std::optional<std::string> fit_pattern(KnownPattern& known) const;
  std::optional<std::string> fit_copies(KnownPattern& known, const std::vector<Motion>& ways,
                                        const std::vector<int>& roots,
                                        const std::vector<std::vector<Motion>>& stabilisers) const;
  std::optional<std::string> fit_lattice(KnownPattern& known, const std::vector<Motion>& normalisers) const;
  bool symmetry_of_instance(const KnownPattern& known, const Motion& motion) const;
  void leave_out_pattern(std::size_t number, const std::string& reason);

  void add_moves_of_region(std::size_t region);
  void add_moves_of_pattern(std::size_t pattern);
  bool drop_contradictions();
  void trim_slivers();
  ConsistentAnnotation result();

  const Mesh& mesh_;
  const SymmetryAnnotation& annotation_;
  const RunContext& context_;
  ConsistencyPolicy policy_;
  double diagonal_;
  double tolerance_;  // mesh units
  double rounding_;   // mesh units
  RegionShapes shapes_;
  std::vector<KnownRegion> regions_;
  std::vector<KnownPattern> patterns_;
  std::vector<Move> moves_;
  std::vector<LeftOut> left_out_;
  double largest_movement_ = 0;  // mesh units
};

}  // namespace orbifit

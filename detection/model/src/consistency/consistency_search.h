#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "orbifit/model/consistent_annotation.h"

#include "consistency/group_place.h"
#include "consistency/region_shapes.h"
#include "domains/closed_sets.h"

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
  /// Share of its area that a region must keep where it gives up what another takes of it.
  double left = 0.5;
  /// Share of the mesh's area that is all of it: what has no area need not be held, and sums round.
  double everything = 1 - 1e-9;
  /// To what positions are told, as a fraction of the diagonal: what files of single precision hold.
  double told = 1e-6;
  /// What counts as met, as a fraction of the size of the coordinates: some hundred roundings.
  double exact = 1e-13;
  /// Places on a circle that count as different, of continuous groups: about as many as facets show.
  int circle = 36;
  /// Faces and samples looked at (RegionShapes::work()) until no further change of what is kept is tried, of claims
  /// that contradict one another: what takes about ten seconds.
  std::size_t work = 20000000;
};

/// A region whose motions take part of a claim past an end of the surface, as where it was cut or something broke off,
/// and the faces that it could leave, so that it says nothing of what has lost its image.
struct Bar {
  Claim claim;
  std::vector<int> faces;  ///< ascending
};

/// Claims that stand or fall together: a region and those that the groups around take it to; or a pattern.
struct Refused {
  std::vector<Claim> claims;  ///< not empty
  std::string reason;
  double saving = 0;                        ///< what they would have saved
  std::vector<std::vector<Claim>> against;  ///< families that are in the way, of which leaving out one may do
  std::optional<Bar> bar;                   ///< or letting this leave faces
};

/// What one search keeps.
struct ConsistencyOutcome {
  ConsistentAnnotation kept;
  double saving = 0;  ///< of all that is kept
  std::vector<Refused> refused;

  double refused_saving() const {
    double sum = 0;
    for (const Refused& each : refused) sum += each.saving;
    return sum;
  }
};

/// Whether the region's elements are, to `tolerance`, those of its group at `place`.
bool stands_at(const Region& region, const GroupPlace& place, const Extent& extent, double tolerance);

/// Regions and patterns on the way to a consistent annotation, largest first. See consistent_annotation().
class ConsistencySearch {
 public:
  /// \param shapes  of the regions' faces, then of the patterns' instances' (shapes_of()); more are added
  /// \param excluded  what is left out from the start, and why
  /// \param preferred  patterns, by number, with which all else is to agree
  ConsistencySearch(const Mesh& mesh, const SymmetryAnnotation& annotation, RegionShapes& shapes,
                    const std::map<Claim, std::string>& excluded, const std::set<std::size_t>& preferred,
                    const RunContext& context);
  ~ConsistencySearch();
  ConsistencySearch(const ConsistencySearch&) = delete;
  ConsistencySearch& operator=(const ConsistencySearch&) = delete;

  /// Of a mesh, for annotations of this tolerance (a fraction of the diagonal).
  static ShapeSurface surface_of(const Mesh& mesh, double tolerance, const RunContext& context);
  static RegionShapes shapes_of(const ShapeSurface& surface, const SymmetryAnnotation& annotation);

  /// Whether all regions and patterns agree as they are, to rounding: nothing is to be done then.
  bool agrees();

  ConsistencyOutcome run();

  /// Its area, as often as its motions halve it.
  double saving(const Claim& claim) const;

 private:
  enum class State { waiting, placed, out };
  struct KnownRegion {
    Region region;
    int shape = -1;
    std::optional<GroupPlace> place;
    State state = State::waiting;
    int source = -1;         // of an added image: number of the region it is the image of
    std::size_t family = 0;  // number of the family's first
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
    std::vector<Claim> asking;          // whose motions the ties are of
  };
  // What the members of a family gave up to others that overlap them.
  struct GivenUp {
    std::map<std::size_t, std::pair<int, std::vector<int>>> before;  // by region: shape and faces, whole
    std::vector<Claim> takers;
    bool alike = true;  // whether all members have given up the same

    void remember(std::size_t region, const KnownRegion& known) {
      before.try_emplace(region, known.shape, known.region.faces);
    }
  };
  // A move that takes one of a pattern's instances to another.
  struct InstanceStep {
    std::size_t from, to;
    Motion motion;
  };
  // The orbits of a pattern's instances under the moves.
  struct InstanceOrbits {
    explicit InstanceOrbits(std::size_t count) : roots(count, -1), ways(count), stabilisers(count), turns(count) {}
    std::vector<int> roots;                        // by instance: the first of its orbit
    std::vector<Motion> ways;                      // from the root
    std::vector<std::vector<Motion>> stabilisers;  // of the roots
    std::vector<std::vector<Motion>> turns;  // by instance: of each continuous group around it the half-turn about
                                             // its axis, or the inversion in its centre
    std::vector<InstanceStep> steps;
    std::vector<Motion> normalisers;  // of the pattern's steps: the motions of regions among the moves
    std::vector<Claim> asking;        // whose the moves are
  };
  // Why something cannot be placed, and what is in its way.
  struct Refusal {
    std::string reason;
    std::vector<Claim> by;
    std::optional<std::size_t> across{};  // the region that overlaps `shape`, where neither holds the other
    int shape = -1;
    std::vector<std::size_t> first{};  // regions to be placed before it can be
    std::optional<Bar> bar{};
  };
  using Verdict = std::optional<Refusal>;  // nothing: it can

  double length(double tolerances) const { return tolerances * tolerance_; }
  const Extent& extent(std::size_t region) const { return shapes_.extent(regions_[region].shape); }
  std::string name_of(const Move& move) const;
  std::string label(std::size_t region) const;

  void place_family(std::size_t first);
  bool give_up_alike(const Family& family, std::size_t regions_before, int shapes_before, GivenUp& given_up);
  void note_given_up(const Family& family, const std::vector<Claim>& takers);
  void refuse_family(const Family& family, std::size_t regions_before, const GivenUp& given_up, Refusal refusal);
  bool trim(std::size_t region, int other);
  bool trim_alike(const Family& family);
  Verdict gather(std::size_t first, Family& family);
  Verdict follow(const Move& move, std::size_t from, Family& family);
  Verdict turn_with(const Move& move, std::size_t at, Family& family) const;
  Verdict add_image(const Move& move, std::size_t at, Family& family);
  Verdict ask_of_overlaps(Family& family);
  Verdict ask_of_common(std::size_t other, Family& family);
  std::optional<std::size_t> image_region(std::size_t region, int domain, const Motion& motion, int arrival) const;
  std::optional<std::size_t> nearest_image(std::size_t region, int domain, const Motion& motion, int arrival) const;
  std::vector<std::size_t> holding_both(std::size_t a, std::size_t b, bool placed) const;
  bool follows(std::size_t a, std::size_t b, bool placed) const;
  std::vector<Eigen::Vector3d> exact_steps(std::size_t region) const;
  Verdict accept_family(const Family& family);
  void leave_out_region(std::size_t region, const std::string& reason);
  void refuse(std::vector<Claim> claims, const Refusal& refusal);
  std::vector<Claim> family_of(const Claim& claim) const;
  std::vector<std::vector<Claim>> against(const std::vector<Claim>& claims) const;
  bool may_leave_faces(const Bar& bar) const;
  bool is_everything(const Claim& claim) const;
  double credit(const Region& region) const;
  double saving(std::size_t region) const;
  double own_saving(std::size_t region) const;
  double common_halvings(std::size_t a, std::size_t b) const;
  Claim mover_of(const Move& move) const;

  void place_pattern(std::size_t number);
  void yield_to_preferred(std::size_t region);
  bool takes_along(const KnownPattern& known, std::size_t instance, std::size_t region) const;
  std::vector<int> given_up(const KnownPattern& known, std::size_t instance) const;
  double trimmed_area(std::size_t number);
  bool trim_pattern(KnownPattern& known);
  std::variant<KnownPattern, Refusal> fitted(const KnownPattern& known);
  Verdict fit_pattern(KnownPattern& known) const;
  Verdict follow_from(std::size_t root, const KnownPattern& known, InstanceOrbits& orbits) const;
  std::optional<std::size_t> arrival_of(const KnownPattern& known, std::size_t from, const Move& move,
                                        bool meets) const;
  bool closes(const KnownPattern& known, const std::vector<InstanceStep>& steps) const;
  bool keeps_axes(const KnownPattern& known, const InstanceOrbits& orbits) const;
  std::optional<std::string> fit_copies(KnownPattern& known, const InstanceOrbits& orbits) const;
  std::optional<std::string> fit_lattice(KnownPattern& known, const InstanceOrbits& orbits) const;
  Motion with_told_directions(const KnownPattern& known, const Motion& motion) const;
  bool symmetry_of_instance(const KnownPattern& known, const std::vector<Motion>& kept_by, const Motion& motion) const;
  void leave_out_pattern(std::size_t number, const std::string& reason);
  bool stands(const KnownPattern& known) const;

  void add_moves_of_region(std::size_t region);
  void add_moves_of_pattern(std::size_t pattern);
  void find_moves();
  bool drop_contradictions();
  void leave_out_repeated();
  void trim_slivers();
  void trim_to_common(std::size_t a, std::size_t b);
  ConsistentAnnotation result();
  double total_saving() const;

  const Mesh& mesh_;
  const SymmetryAnnotation& annotation_;
  const RunContext& context_;
  ConsistencyPolicy policy_;
  double diagonal_;
  double tolerance_;  // mesh units
  double rounding_;   // mesh units
  RegionShapes& shapes_;
  int given_shapes_;
  std::vector<KnownRegion> regions_;
  std::vector<KnownPattern> patterns_;
  std::vector<Move> moves_;
  std::set<std::size_t> preferred_;  // patterns
  std::set<std::size_t> placing_;    // regions whose families are being placed, each for the one before
  std::vector<LeftOut> left_out_;
  std::vector<Refused> refused_;
  double largest_movement_ = 0;  // mesh units
};

}  // namespace orbifit

#pragma once

#include <string>
#include <vector>

#include "orbifit/datasets_tools/truth.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/point_group.h"

#include "models/model_builder.h"

namespace orbifit {

/// Of the area: smaller regions are right, but no picture and no measure would show them.
inline constexpr double kSmallestShare = 0.0025;

/// What the truth says of the symmetry that a part has by itself.
enum class OwnRegion {
  expected,  ///< a region to find
  optional,  ///< right, but hidden in other parts, or debatable
  silent     ///< nothing
};

/// A part as it is made, about its own origin.
struct PartKind {
  std::string name;
  Mesh mesh;
  PointGroup own;  ///< all motions that map the part onto itself; C1 for none
  OwnRegion report = OwnRegion::expected;
  GroupFrame frame = GroupFrame::Identity();         ///< in which `own` is written
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< fixed by `own`
};

/// Whether the region's group holds the motion, to 1e-9 in the linear part and 1e-9 `length` in what it does to the
/// region's centre. A C1 region holds the identity only.
bool holds(const Region& region, const Motion& motion, double length);

/// Puts a model together from placed copies of parts and derives what is symmetric: a group maps a part to another one
/// when both are copies of one kind and the motion between them belongs to the kind's own group. The region of a group
/// is all that it maps onto parts (docs/method.md 6). No geometry is compared.
class SuiteBuilder {
 public:
  /// \return the kind's number
  int kind(PartKind kind);

  /// Places a copy. \return the part's number
  int add(int kind, const Motion& at = {});

  /// Places the images of a copy under a group, each once, and expects the group's region.
  /// \return the parts' numbers, in the order of the group's elements
  std::vector<int> orbit(int kind, const Motion& at, const PointGroup& group, const LocalFrame& about = {});

  /// Expects the group's region; without a name it is named after its parts.
  void expect(const PointGroup& group, const LocalFrame& about = {}, const std::string& name = {});

  /// Expects a pattern. \param copies the parts of each instance, those of one kind at the same place of every list
  void expect_pattern(const std::string& name, Pattern::Kind kind, const std::vector<Motion>& generators,
                      const std::vector<std::vector<int>>& copies);

  /// The mesh and its truth. Expected are the regions of the groups asked for, of what two of them have in common, and
  /// of the parts' own groups; not those below 0.25 % of the area nor those inside a region whose group says it all.
  TruthModel finish() const;

 private:
  struct Part {
    int kind = 0;
    Motion at;
    std::vector<int> faces;
  };
  struct Candidate {
    Region region;  // faces unset
    bool expected = true;
    int part = -1;  // whose own group it is
  };

  Pattern pattern(const std::string& name, Pattern::Kind kind, const std::vector<Motion>& generators,
                  const std::vector<std::vector<int>>& copies) const;
  const PartKind& kind_of(const Part& part) const { return kinds_[static_cast<std::size_t>(part.kind)]; }
  int image_of(const Part& part, const Motion& motion) const;
  std::vector<int> parts_under(const Region& group) const;
  std::vector<Candidate> candidates() const;
  std::string name_of(const std::vector<int>& parts) const;

  std::vector<PartKind> kinds_;
  std::vector<Region> own_;  // of each kind
  std::vector<Part> parts_;
  int faces_ = 0;
  std::vector<Candidate> asked_;
  std::vector<Pattern> patterns_;
};

/// Moves the regions that say nothing new, of `expected` and `optional_regions`, out of the truth: those inside another
/// region whose group holds theirs. Then numbers what is left and sets parents.
void leave_out_repeated(const Mesh& mesh, DetectionTruth& truth);

}  // namespace orbifit

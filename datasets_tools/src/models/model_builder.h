#pragma once

#include <string>
#include <vector>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/point_group.h"

namespace orbifit {

/// Some of a model's faces, ascending.
using PartFaces = std::vector<int>;

/// The union of disjoint parts.
PartFaces joined(const std::vector<PartFaces>& parts);

/// A right-handed frame in space: where a part is put and about what it is symmetric.
struct LocalFrame {
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();

  operator Motion() const { return {frame, origin}; }  // NOLINT(google-explicit-constructor)
};

LocalFrame image(const Motion& motion, const LocalFrame& placement);

/// Copies of a part, and where each is placed.
struct PartCopies {
  std::vector<PartFaces> faces;
  std::vector<LocalFrame> places;
};

/// Puts a model together from parts and says what is symmetric.
class ModelBuilder {
 public:
  /// \param smallest_share of the model's area that a region needs; smaller ones are left out
  explicit ModelBuilder(double smallest_share = 0.0025) : smallest_share_(smallest_share) {}

  /// The part's image under `motion`; its faces.
  PartFaces add(const Mesh& part, const Motion& motion = {});

  /// Adds one more copy of the part.
  void add_copy(const Mesh& part, const LocalFrame& place, PartCopies& copies);

  /// Declares `faces` symmetric under the group about a place; column 2 of its frame is the axis. Regions of under
  /// 0.25 % of the model's area are left out where nothing else was asked for: no picture and no measure would show
  /// them.
  void declare(const std::string& name, const PointGroup& group, const LocalFrame& about, const PartFaces& faces);

  /// Declares every copy symmetric under the group about its place; they are named `name` 1, `name` 2 ...
  void declare_each(const std::string& name, const PointGroup& group, const PartCopies& copies);

  /// Declares a turned part: Cinfv, or Dinfh if its two ends are `alike`; Cnv or Dnh of its facets where these count.
  /// \param round whether to take the part as round
  void declare_turned(const std::string& name, bool alike, bool round, int facets, const LocalFrame& about,
                      const PartFaces& faces);

  /// Declares copies one step apart each.
  void declare_row(const std::string& name, const Eigen::Vector3d& step, const std::vector<PartFaces>& copies);

  /// Gives every face so far a second one that looks the other way, as two-sided models have, and so for all regions.
  void double_faces() { doubled_ = true; }

  /// The model with all counts, parents and residuals. Residuals are measured up to a million vertices; of larger
  /// models they are left 0: the parts are the same, only finer.
  GeneratedModel finish() const;

 private:
  struct Declared {
    Region region;
    std::vector<Motion> measured;  // generators of the group that the tessellation has
  };
  Mesh mesh() const;

  double smallest_share_ = 0;
  bool doubled_ = false;
  std::vector<Mesh> parts_;
  int faces_ = 0;
  std::vector<Declared> regions_;
  std::vector<Pattern> patterns_;
};

}  // namespace orbifit

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "registration/correspondences.h"
#include "scan/scan_preparation.h"
#include "solver/deformation_system.h"
#include "solver/pulls.h"
#include "solver/scan_views.h"
#include "start/placed_scan.h"
#include "symmetry/moving_surface.h"

namespace orbifit {

/// Where a fit has come to.
struct FitState {
  Similarity pose;    ///< template -> scan
  Eigen::VectorXd q;  ///< of the system's unknowns
  /// Of the scans but the first, from where they were put at the start; empty where they are as they were put.
  std::vector<Motion> others = {};
};

/// The iterations of a fit. First the stiffness falls along a schedule, and what counts as far with it. Then the
/// stiffness stays, and so does what counts as far until a step gains next to nothing with it: there is one energy to
/// lower, and a step that does not lower it is taken back. What the data do not determine holds still instead of
/// swaying from one iteration to the next.
class FitLoop {
 public:
  /// All references are kept. \param start  its scan and views \param system  turned as the iterations go
  FitLoop(const FitInput& input, const PlacedScan& start, DeformationSystem& system, const FitOptions& options,
          const RunContext& context);

  /// Improves the state in place. \param first_level  of FitOptions::levels, where to begin \param scale_open  whether
  /// the template's scale is sought as well, once it is soft \return why it stopped
  std::string run(FitState& state, int first_level, bool scale_open, std::vector<FitIteration>& iterations);

 private:
  struct Stage {
    double progress = 1;  // of the schedule, in [0, 1]
    double stiffness = 0;
    double robust = 0;  // Geman-McClure's scale, template units as the fit began
    int every = 1;      // each so manieth point of the scan is looked at
    bool scale_open = false;
    bool others_open = false;  // whether the other scans move
  };
  struct Matches {
    std::vector<Correspondence> pairs;  // those of silhouettes after those of the scan
    Points points;                      // the scan's, in the template's frame
    int of_scan = 0;
    double rms = 0;     // fraction of the diagonal
    double spread = 0;  // likewise, of the distances, whatever the outliers
    double energy = 0;  // robust, of all points: an unmatched one counts as one infinitely far; squared units of now
    std::vector<Pull> pulls;
    double pull_energy = 0;  // of landmarks, robust, and handles
  };
  Stage stage(int iteration) const;
  // The least that offsets of this size from the surface, fractions of the diagonal, warrant.
  double stiffness_for(double noise) const;
  Matches match(const FitState& state, const Stage& now);
  double share_of(const Matches& matches, int every) const;
  // Farther apart than this, places that belong together count for little or nothing: template units.
  double reach_of(const Stage& now) const;
  // The landmarks, each by how near it is, and the handles, which are to be followed.
  void add_pulls(const FitState& state, const Stage& now, Matches& matches) const;
  double energy(const FitState& state, const Matches& matches, double share, const Stage& now) const;
  FitIteration record_of(const Matches& matches, const Stage& now, double energy) const;
  // One solve from there. \param share of each pair; what the record says of the step is filled in
  void step(FitState& state, const Matches& matches, const Stage& now, double share, double damping,
            FitIteration& record);
  struct Minimum {
    std::string reason;  // why no lower one was sought
    double spread = 0;   // as Matches has it, there
    double gained = 0;   // share by which the last step lowered the energy; negative: raised it, and was taken back
  };
  // Steps that lower the energy of one stage, each by more than the share `gain`.
  Minimum minimise(FitState& state, const Stage& now, double gain, std::vector<FitIteration>& iterations);
  // For a fit that has converged on a coarser subspace, and has only what is left to settle.
  std::string go_on(FitState& state, Stage now, std::vector<FitIteration>& iterations);
  void move_to(const FitState& state);
  // A length of the template's as the fit began, in its units now.
  double unit(const FitState& state) const { return first_scale_ / state.pose.scale; }

  const FitInput& input_;
  const PlacedScan& start_;
  const PreparedScan& scan_;
  const ScanViews& views_;
  DeformationSystem& system_;
  const FitOptions& options_;
  const RunContext& context_;
  double size_;                 // the template's diagonal
  Eigen::Vector3d centre_;      // of its box
  double first_scale_ = 1;      // of the pose, where the fit began
  double last_stiffness_ = 0;   // as the scan's noise allows
  double least_stiffness_ = 0;  // as what is left unexplained allows
  Mesh deformed_;
  MovingSurface surface_;  // of deformed_
  std::vector<int> likely_;
  std::optional<bool> cut_off_;  // what viewpoints saw, once the pose is known
};

}  // namespace orbifit

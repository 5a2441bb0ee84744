#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "orbifit/fitting/group_agreement.h"
#include "orbifit/fitting/landmarks.h"
#include "orbifit/fitting/placement.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/motion.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit {

class SurfaceIndex;

struct FitOptions {
  SubspaceOptions subspace;
  int levels = 12;                ///< of stiffness, from stiff to soft, >= 1
  int iterations = 3;             ///< at each level, >= 1
  int max_iterations = 80;        ///< in all, >= levels * iterations
  double first_stiffness = 10;    ///< Laplace energy against data, > last_stiffness
  double last_stiffness = 0.01;   ///< of a scan without noise; noisier ones are followed less closely, > 0
  double least_stiffness = 0;     ///< in the last iterations, however little noise there is, >= 0
  double stretch = 0.3;           ///< weight of the stretching energy within the Laplace energy, >= 0
  double trim = 0.9;              ///< share of the nearest correspondences kept, in (0, 1]
  int scan_points = 4000;         ///< points of the scan used, >= 10
  double landmark_weight = 10;    ///< of one landmark or handle, against one sample's share of the data, > 0
  double inlier_distance = 0.01;  ///< of the diagonal: a scan point nearer than this is explained, > 0
  double min_inlier_ratio = 0.5;  ///< explained share of the whole scan below which a fit failed, in [0, 1]
  /// Find the pose first, whatever it is, where landmarks do not determine it; the rough one is one candidate.
  bool place = false;
  PlacementOptions placement;
  bool fixed_scale = false;  ///< the template has the size that FitInput::pose says, wherever it is found
  double tie = 0.8;          ///< placements of at least this share of the best one's score are fitted too, in (0, 1]
  int max_tried = 8;  ///< of those, by their score: where there are more than `max_tied` short fits choose among them
  int max_tied = 3;   ///< placements fitted in full, >= 1, <= max_tried
  bool judge_groups = false;  ///< compare with a fit without groups: see GroupAgreement; may take as long again
  /// Leave out the regions whose groups disagree with the scan, and fit anew; at most five times. Judges them.
  bool drop_unsupported = false;
  bool contacts = true;    ///< parts of the template that touch are to touch afterwards: held together at their joints
  bool condition = false;  ///< estimate the condition number of the last linear system
  /// How often the subspace may be made finer, by three times the degrees of freedom, where the scan asks for it; not
  /// where `subspace` says how fine it is. >= 0
  int refinements = 2;
  /// Then displace the vertices along their normals by what all points of the scan show beyond the subspace, one height
  /// for the vertices that are images of one another; as far as points that are held out come nearer.
  bool detail = false;
  /// Refine the rough pose by rigid ICP first; not where it is found or landmarks give it. Without this and `place` the
  /// pose is known, and landmarks do not change it.
  bool align = true;

  void validate() const;  ///< \throw UsageError naming the field, its value and the rule
};

/// A subspace that was tried, each finer than the one before (docs/method.md 7.1). Distances are root mean squares over
/// points of the scan that were held out of this fit, not of the coarser one; fractions of the template's diagonal,
/// what is far counting as at .7 %; 0 for the coarsest.
struct ResolutionLevel {
  int samples = 0, degrees_of_freedom = 0;
  double held_out_before = 0;  ///< from the coarser fit
  double held_out = 0;         ///< from this one
  bool kept = false;           ///< nearer by more than chance, or the coarsest
};

/// Detail that was tried, each finer than the one before: heights alike over a length. As in ResolutionLevel.
struct DetailLevel {
  double length = 0;           ///< fraction of the template's diagonal
  double held_out_before = 0;  ///< with the detail before, or none
  double held_out = 0;
  bool kept = false;
};

struct FitIteration {
  double stiffness = 0;
  int correspondences = 0;
  double rms = 0;      ///< weighted, of the distances to the surface, fraction of the template's diagonal
  double energy = 0;   ///< robust data and regularisation before this iteration's step, in mean squared diagonals
  double damping = 0;  ///< of the step
  double change = 0;   ///< largest movement of a sample by the step, fraction of the diagonal
  double seconds = 0;  ///< of this iteration: correspondences, solve and the surface's move
};

struct StageTime {
  std::string stage;
  double seconds = 0;
};

/// What a fit makes of a landmark.
struct LandmarkAgreement {
  int vertex = 0;
  double residual = 0;    ///< distance of the fitted vertex from the target, of the fitted mesh's diagonal
  bool left_out = false;  ///< it contradicts the other landmarks, or the scan
};

/// A way in which a fitted shape can be stretched, and explains the scan as well.
struct OpenStretch {
  /// Projection onto the directions that are stretched, scan's frame: of rank 1, 2 (across an axis) or 3 (all of it)
  Eigen::Matrix3d along;
  double shorter = 0, longer = 0;  ///< up to this share of the length, in [0, 0.2]: more was not tried
  double most() const { return std::max(shorter, longer); }
};

/// Another pose of a fitted surface in which it explains the scan as well.
struct OpenPose {
  Motion move;                                   ///< from where it was fitted to there, scan's frame
  double apart = 0;                              ///< the farthest that it then lies from there, of its diagonal
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< where that is, scan's frame: a view of it tells the poses apart
};

struct FitResult {
  Mesh fitted;                         ///< template's connectivity, scan's frame
  SymmetryAnnotation rest_annotation;  ///< the template's, as it was kept
  SymmetryAnnotation annotation;       ///< the same, carried along into the scan's frame
  Similarity pose;                     ///< template -> scan
  std::vector<Motion> others;          ///< of FitInput::others each into the scan's frame
  std::vector<char> other_used;        ///< of each, whether it took part: a scan in which nothing is found does not
  std::vector<Placement> placements;   ///< where the template may be, best first; empty where that was not asked
  Subspace subspace;                   ///< in which the template was deformed; finer than the one given, if refined
  Eigen::VectorXd q;                   ///< coordinates of the deformation in that subspace
  /// The basis of q where groups have turned (mode moving); null: the subspace's own, at rest.
  std::shared_ptr<const ConjugatedBasis> basis;
  /// What has been added to it along the normals, where FitOptions::detail asked for it; null: nothing.
  std::shared_ptr<const SurfaceDetail> detail;
  std::vector<DetailLevel> detail_levels;  ///< from coarse to fine; the last one that was kept is the result's
  double detail_rms = 0;  ///< of the vertices' displacements by it, fraction of the template's diagonal
  SubspaceState state() const { return {q, basis, detail}; }
  int samples = 0, degrees_of_freedom = 0;
  double condition = 0;  ///< of the last linear system, where FitOptions::condition asked for it
  /// From coarse to fine; the last one that was kept is the result's. None where FitOptions::subspace says how fine it
  /// is, or the coarsest fit failed.
  std::vector<ResolutionLevel> levels;
  std::vector<FitIteration> iterations;
  /// Whether any size was allowed and the template has kept its own, since the scan asks for no other.
  bool own_size = false;
  /// By how much the deformation has made it larger than the template in its pose: the ratio, less one, of the
  /// surfaces' root mean square distances from their centres, without unit. 0 of a fit that failed.
  double growth = 0;
  int iterations_in_all = 0;  ///< with those of fits that were not kept
  bool converged = false;
  std::string stopped_because;
  double overlap = 1;           ///< share of the scan taken for the template's; the rest was left out as other things
  double torn_off = 0;          ///< share left out though it hangs together with that, and so may be the template's
  double inlier_ratio = 0;      ///< of the scan points used, within inlier_distance of the fitted surface
  double rms = 0;               ///< of those, fraction of the fitted mesh's diagonal
  double visible_coverage = 1;  ///< of the fitted surface that the viewpoints should have seen, the share that they saw
  /// Of the fitted surface that the viewpoints have before them the share where they have nothing, neither it nor
  /// anything behind, where that is so much that points have been cut off the scan; not in `visible_coverage`.
  double cut_off = 0;
  /// Share of the points used in the largest set of those not explained that hang together: a part that the template
  /// lacks, or that lies elsewhere, and not noise; and its middle, in the scan's frame.
  double unexplained_part = 0;
  Eigen::Vector3d unexplained_at = Eigen::Vector3d::Zero();
  /// What the scan leaves open of the size, the largest first; not asked of a fit that failed.
  std::vector<OpenStretch> open_stretches;
  /// The largest of them, a share; 0 for none.
  double open_stretch() const { return open_stretches.empty() ? 0 : open_stretches.front().most(); }
  /// Where else the scan has the fitted surface as well; asked where the pose was found, of a fit that did not fail.
  std::vector<OpenPose> open_poses;
  /// How far the surface may be from where it was fitted by the farthest of them, of the diagonal; 0 for none.
  double open_distance() const {
    double most = 0;
    for (const OpenPose& open : open_poses) most = std::max(most, open.apart);
    return most;
  }
  /// inlier_ratio * visible_coverage, less what was torn off, once more the unexplained part, the largest open stretch
  /// and the open distance, in [0, 1]
  double confidence = 0;
  double landmark_rms =
      0;  ///< of handles and the landmarks that were not left out, fraction of the fitted mesh's diagonal
  std::vector<LandmarkAgreement> landmarks;  ///< the input's, in its order
  std::vector<char> seen;                    ///< #V: a scan point lies near the fitted vertex
  double hidden_fraction = 0;                ///< share of the fitted area around vertices not seen
  double field_residual = 0;                 ///< worst of the regions: see orbifit::field_residual
  std::vector<GroupAgreement> groups;        ///< what the scan says of the regions' groups, where that was asked
  std::vector<int> dropped;  ///< ids of regions that were left out since the scan has not their symmetry
  std::vector<StageTime> times;
};

struct FitInput {
  const Mesh& mesh;  ///< the template
  const SymmetryAnnotation& annotation;
  const PointCloud& scan;
  Similarity pose;  ///< rough pose, template -> scan
  /// Take precedence over a rough `pose`. Those that contradict the others are left out; where the scan contradicts
  /// them all, the pose is sought without them if FitOptions::place allows it.
  std::vector<Landmark> landmarks = {};
  std::vector<Handle> handles = {};  ///< their motions give places in the template's frame posed by `pose`
  /// Of the mesh and the annotation, as FitOptions::subspace says, where it is built already; null: built by fit().
  std::shared_ptr<const Subspace> subspace = nullptr;
  /// Told after each step of the iterations: its record, the pose, and the vertices then, #V by 3, in the template's
  /// frame. Where several starts are tried each of their steps is told, by several threads where the context has them.
  std::function<void(const FitIteration&, const Similarity&, const Points&)> watch = nullptr;
  /// More scans of the same object, each in a frame of its own, all at one scale: they have one shape together and a
  /// pose each. Kept by pointer.
  std::vector<const PointCloud*> others = {};
  /// Of the mesh, where it is known (ConsistentAnnotation has it); null: made by fit().
  std::shared_ptr<const SurfaceIndex> surface_index = nullptr;

  /// The same to be fitted with another annotation, which is kept by reference.
  FitInput with(const SymmetryAnnotation& other) const {
    return {mesh, other, scan, pose, landmarks, handles, nullptr, nullptr, others, surface_index};
  }
};

/// Whether a scan can be fitted to at all, as fit() asks of each. \param file  its name, for the message
/// \throw InputError where it has fewer than 10 points, or all of them at one place
void check_scan(const PointCloud& scan, const std::string& file = "");

/// Deforms a template to a scan within its symmetric subspace (docs/method.md 7): alternates correspondences and
/// a co-rotated solve in which the pose takes part, from stiff to soft.
/// The result's `converged` says whether it explains the scan; a fit that does not is still returned.
/// \throw InputError for a scan of fewer than 10 points, UsageError for options
FitResult fit(const FitInput& input, const FitOptions& options, const RunContext& context);

}  // namespace orbifit

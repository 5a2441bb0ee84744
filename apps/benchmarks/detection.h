#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "orbifit/datasets_tools/detection_score.h"
#include "orbifit/datasets_tools/truth.h"
#include "orbifit/detection/detect.h"
#include "orbifit/model/run_context.h"

#include "suite/detection_suite.h"

namespace orbifit::benchmarks {

/// What becomes of a model before it is detected.
struct CaseForm {
  bool remeshed = false;  ///< one surface whose triangles know nothing of the parts; else the assembly as it was built
  double noise = 0;       ///< standard deviation along the normals, fraction of the diagonal
  bool cut = false;       ///< without a fifth of its area, beyond a random plane

  bool operator==(const CaseForm&) const = default;
  std::string name() const;       ///< "assembly" or "remesh", ", cut"
  std::string file_name() const;  ///< "remesh-cut-noise0.001"
};

/// The model in this form, in a random pose and scale. The same seed gives the same bytes. Assemblies are subdivided
/// where they are cut or get noise, so that there is something to cut and to move.
/// \throw NoResultError, InputError when the model cannot be remeshed
TruthModel case_of(const SuiteModel& model, const CaseForm& form, RunContext& context);

/// One model in one form.
struct DetectionRow {
  std::string model, kind;
  CaseForm form;
  int vertices = 0, faces = 0;
  double seconds = 0;   ///< of the detection
  std::string failure;  ///< why there is no detection; empty where there is one
  DetectionScore score;
  int optional = 0;             ///< regions and patterns that are as right as those expected, but not missed
  int regions = 0;              ///< detected
  int within_tolerance = 0;     ///< of them, those whose residual.max is within the tolerance
  std::optional<double> again;  ///< share of regions found again in other orders and poses, where they were asked for

  /// Regions of finite groups that match nothing: on a shape without symmetry there should be none.
  int unfounded_groups() const;
};

/// The share of the regions detected on a mesh that are found again, with the same group and the same faces but for 2 %
/// of their area, in each of two other orders of vertices and faces and two other poses.
double found_again(const Mesh& mesh, const SymmetryAnnotation& detected, const DetectOptions& options,
                   RunContext& context);

/// The means over some rows; none where no row has the figure.
struct DetectionMeans {
  int rows = 0;
  std::optional<double> strict_recall, loose_recall, precision, f1, axis_error, offset_error;
  std::optional<double> listed;            ///< detected by expected and optional, of all rows together
  std::optional<double> within_tolerance;  ///< share of the detected regions of all rows
  std::optional<double> again;
  double seconds = 0;  ///< of all rows together
};

DetectionMeans means_of(const std::vector<const DetectionRow*>& rows);

/// The tables for people, at most 120 columns wide.
std::string detection_text(const std::vector<DetectionRow>& rows);

/// An object: "rows", and "means" by form and noise and by kind.
std::string detection_json(const std::vector<DetectionRow>& rows);

}  // namespace orbifit::benchmarks

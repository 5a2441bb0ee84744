#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/deformer.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/subspace.h"

#include "display_mesh.h"
#include "geometry/point_index.h"
#include "picker.h"
#include "residual_pairs.h"
#include "symmetric_images.h"

namespace orbifit::editor {

/// The two sides of a comparison.
enum Side { kSymmetric = 0, kFree = 1 };

/// What a solve took and reached.
struct SolveRecord {
  double solve_ms = 0, lift_ms = 0, show_ms = 0;
  double handle_error = 0;  ///< root mean square, fraction of the diagonal
  double energy = 0;
};

/// What is edited: a mesh, its annotation, the basis of its symmetric displacements, the handles on it, and how all
/// that looks. Beside it, where asked for, the same without symmetries. Everything heavy is made when it is needed
/// first. Errors are exceptions (errors.h), after which the session is as it was.
class Session {
 public:
  RunContext context;

  /// \throw InputError
  void read_mesh(const std::string& file);
  /// \param consistent  it is one that annotation() gave; others are made consistent, as `orbifit deform` does
  /// \throw InputError
  void read_annotation(const std::string& file, bool consistent);
  void read_basis(const std::string& file);
  void build_basis(const SubspaceOptions& options);
  void write_basis(const std::string& file) const;

  const Mesh& mesh() const { return mesh_; }
  const SymmetryAnnotation& annotation() const { return annotation_; }
  bool has_basis() const { return symmetric_side_.subspace != nullptr; }
  const Subspace& subspace() const { return *symmetric_side_.subspace; }  ///< \pre has_basis()
  std::size_t contacts() { return deformer(kSymmetric).contacts(); }

  /// Handles of both sides. \throw InputError
  void set_handles(const std::string& file);
  const HandleSet& handles() const { return handles_; }
  /// One motion a handle, which may scale as well. The vertices of that side move. \param onwards  from what was solved
  /// for last, so that few iterations do while a handle is dragged; else from rest
  SolveRecord solve(Side side, const std::vector<Motion>& motions, int iterations, bool onwards = false);
  /// All vertices of both sides as at rest.
  void rest();
  /// Vertices from elsewhere, such as a fit. \pre as many as the mesh has
  void show(const Points& vertices);

  /// Edits the same without symmetries as well. \param basis  file with one of an empty annotation, for a fair
  /// comparison on as many samples and in the same mode
  void compare(const std::string& basis);
  void stop_comparing() { free_.reset(); }

  const DisplayMesh& display(Side side) const { return need(side).display; }
  const Points& vertices(Side side) const { return need(side).vertices; }
  /// How far the displacement that was solved for last is from symmetric, in every region: as field_residuals().
  std::vector<Residual> residuals(Side side);
  /// How far the shape that is shown is from symmetric.
  std::vector<Residual> shape_residuals();
  Motion carried(int region) const;

  /// The point of the symmetric side that a ray meets first. \param origin, direction  in the shown mesh's frame
  std::optional<SurfacePoint> pick(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);
  /// Its orbit, and marks on the vertices within `radius`, mesh units, of its points.
  const std::vector<SurfacePoint>& orbit(const SurfacePoint& point, double radius);
  std::vector<int> regions_of(int face);
  /// Where a point of the rest surface is shown.
  Eigen::Vector3d shown(const SurfacePoint& point) const;

  /// Marks of the shown vertices, four bytes each: orbit under the cursor, region, handles, pins.
  enum Mark { kOrbit = 0, kRegion = 1, kHandle = 2, kPin = 3 };
  const std::vector<std::uint8_t>& marks() const { return marks_; }
  void clear_marks(Mark mark);
  void mark_region(int region);

  /// The nearest symmetric rest shape; blend() then shows what lies between, and keep_blend() makes it the rest shape.
  std::string symmetrize();
  void set_symmetric(Points vertices) { symmetric_ = std::move(vertices); }
  const Points& symmetric() const { return symmetric_; }
  void blend(double share);
  void keep_blend(double share);

  using FitStep = std::function<void(const FitIteration& iteration, int number)>;
  /// Fits the mesh to a scan file; what it has come to is shown at each step. \param place  find the pose first
  FitResult fit(const std::string& scan, bool place, const FitStep& step);

  void write_shown(const std::string& file) const;
  void write_rest(const std::string& file) const;

 private:
  struct Edited {
    std::unique_ptr<Subspace> subspace;
    std::unique_ptr<Deformer> deformer;
    SubspaceState state;
    Points vertices;
    DisplayMesh display;
    bool handles_set = false;
  };
  Edited& need(Side side) { return side == kFree && free_ ? *free_ : symmetric_side_; }
  const Edited& need(Side side) const { return side == kFree && free_ ? *free_ : symmetric_side_; }
  Deformer& deformer(Side side);
  SymmetricImages& images();
  ResidualPairs& pairs();
  void forget_shape();   // all that was made of the rest shape
  void forget_groups();  // all that was made of the annotation
  void take_vertices(Edited& edited, Points vertices);
  void mark_vertices(Mark mark, const std::vector<int>& vertices);

  Mesh mesh_;
  SymmetryAnnotation annotation_;
  Edited symmetric_side_;
  std::optional<Edited> free_;
  HandleSet handles_;
  Points symmetric_;
  std::optional<SymmetricImages> images_;
  std::optional<ResidualPairs> pairs_;
  std::optional<PointIndex> index_;  // of the vertices at rest
  std::optional<Picker> picker_;
  bool picker_stale_ = true;
  std::vector<SurfacePoint> orbit_;
  std::vector<std::uint8_t> marks_;
  std::vector<std::uint8_t> marked_;  // scratch, by vertex
};

}  // namespace orbifit::editor

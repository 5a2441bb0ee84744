#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

namespace orbifit::benchmarks {

/// One mesh of somebody's collection, as it is measured.
struct RealMesh {
  std::filesystem::path file;
  std::string name;  ///< its stem, behind its folder's name where another mesh has the same stem
  Mesh mesh;
};

/// What one mode of one mesh came to. Residuals are fractions of the diagonal.
struct RealMode {
  GroupMode mode = GroupMode::floating;
  std::string failure;  ///< empty: none
  int regions = 0;      ///< kept
  int patterns = 0;     ///< kept
  bool whole = true;    ///< the region of the whole is kept, or none was listed
  double build_seconds = 0;
  double solve_seconds = 0;   ///< prefactorisation and iterations
  double field_residual = 0;  ///< worst of the regions kept
  double mesh_residual = 0;   ///< worst over vertices that lie on one another's images at rest
  long long mesh_pairs = 0;   ///< pairs of those
  std::string messages;       ///< what building said, such as what it left out; parted by "; "
};

struct RealRow {
  std::string name;
  std::filesystem::path file;
  int vertices = 0, faces = 0;
  std::string failure;  ///< of reading or detecting; empty: none
  int regions = 0;      ///< listed
  int patterns = 0;     ///< listed
  bool whole = false;   ///< a region of the whole is listed
  double allowed_seconds = 0;
  std::optional<double> detect_seconds;  ///< none: the annotation was read
  std::vector<RealMode> modes;
};

/// Seconds that building the subspace of so many vertices may take.
double allowed_build_seconds(int vertices);

/// Detects a mesh, or reads the annotation where the file is there, builds its subspace in each of the modes as the
/// program does, drags two random handles and measures how symmetric the result is. Failures stand in the row.
/// \param annotation  file to read, or to write where there is none; empty: neither
/// \param stage_limit  seconds that detection and each mode may take; 0: no limit
/// \throw InterruptedError
RealRow measure_real(const RealMesh& real, const std::vector<GroupMode>& modes, const std::filesystem::path& annotation,
                     double stage_limit, const RunContext& context);

/// The table's lines above the meshes, and a mesh's, each with its line break.
std::string real_header(const std::vector<GroupMode>& modes);
std::string real_line(const RealRow& row, const std::vector<GroupMode>& modes);

/// How many build, are quick enough and exact, and how much is kept.
std::string real_summary(const std::vector<RealRow>& rows, const std::vector<GroupMode>& modes);

/// One line for each mesh and mode, below a line of names.
std::string real_csv(const std::vector<RealRow>& rows);

}  // namespace orbifit::benchmarks

#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// Changes to an annotation that need no look at the mesh.
struct AnnotationEdits {
  std::vector<int> remove;                          ///< ids
  std::vector<std::pair<int, std::string>> rename;  ///< ids and names

  bool empty() const { return remove.empty() && rename.empty(); }
};

/// Removes and renames regions; those left keep their ids, parents are set anew.
/// \return a line for each change \throw UsageError for an id that the annotation has not
std::vector<std::string> apply_edits(const AnnotationEdits& edits, SymmetryAnnotation& annotation);

/// Regions and patterns as a table for people, and as JSON.
std::string annotation_table(const SymmetryAnnotation& annotation, const Mesh& mesh);
nlohmann::ordered_json annotation_list(const SymmetryAnnotation& annotation, const Mesh& mesh);

}  // namespace orbifit

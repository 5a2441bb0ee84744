#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

#include "batch/collection.h"
#include "batch/manifest.h"

namespace orbifit::batch {

/// The rotations by which an object looks the same, as BOP's models_info.json has them (`symmetries_discrete` and
/// `symmetries_continuous`: https://github.com/thodan/bop_toolkit, docs/bop_datasets_format.md). Lengths are the
/// model's. \param text  the object's entry, JSON \return an annotation whose one region is all of the mesh; without
/// regions where the entry names no symmetry \throw InputError for an entry that is ill-formed, a matrix that is no
/// rotation to 1e-3, or matrices that do not form a group
SymmetryAnnotation annotation_from_bop(const std::string& text, const Mesh& mesh, const std::string& name);

/// The entry of an object, JSON: diameter, box and, of the first region that is all of the mesh, the rotations.
std::string annotation_to_bop(const SymmetryAnnotation& annotation, const Mesh& mesh);

/// Writes an annotation for each item of a BOP data set whose models_info.json (beside the models) names symmetries,
/// and adds it to the item. \param folder  for the annotations; made where it does not exist
void add_bop_annotation(Item& item, const std::filesystem::path& folder);

/// Writes models_info.json for the items of a collection whose ids end in obj_NNNNNN. \throw InputError for none
void write_models_info(const Collection& collection, const std::filesystem::path& file);

}  // namespace orbifit::batch

#pragma once

#include <filesystem>
#include <optional>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

namespace orbifit {

/// The upward direction that a file's format prescribes: +y for glTF and GLB; none for the others.
std::optional<Eigen::Vector3d> format_up(const std::filesystem::path& file);

/// Which of +z and +y is up, as the shape would stand. It stays +z, the usual choice of measured data and CAD, where
/// the shape rests on a flat face there, and becomes +y where the shape stands on that side and not, or worse, on the
/// other: what touches the ground spans most of the footprint, the centre of area is above it, and the shape differs
/// between its upper and lower halves (Fu et al., Upright Orientation of Man-Made Objects, SIGGRAPH 2008, have these
/// among their features).
Eigen::Vector3d guess_up(const Mesh& mesh);

/// What the annotation says, or else what the format prescribes, or else the guess. Where the annotation has an axis of
/// the whole shape that is no coordinate axis, the shape lies in no frame that means anything: the axis is up.
/// \param annotation  of the mesh, or null
Eigen::Vector3d up_of(const Mesh& mesh, const std::filesystem::path& file,
                      const SymmetryAnnotation* annotation = nullptr);

}  // namespace orbifit

#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"

#include "io/section_file.h"

namespace orbifit {

// What writing and reading a subspace share (docs/basis-format.md).

inline constexpr SectionFormat kBasisFormat{"ORBIFITB", 2, "a basis"};
inline constexpr std::size_t kBasisSections = 7;

using MotionRows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
inline constexpr int kMotionNumbers = 12;

template <class Count>
std::size_t size_of(Count count) {
  return static_cast<std::size_t>(count);
}

/// Of the vertices' coordinates and the faces.
std::uint64_t mesh_checksum(const Mesh& mesh);

/// Of groups, elements, motions and faces; names and residuals do not matter to a basis.
std::uint64_t annotation_checksum(const SymmetryAnnotation& annotation);

}  // namespace orbifit

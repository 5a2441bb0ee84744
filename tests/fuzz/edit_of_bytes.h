#pragma once

#include <cstdint>
#include <span>

namespace orbifit {

/// Makes a tiny mesh with nested groups of the bytes, writes its annotation, perhaps damages and reads it, makes it
/// consistent, builds a subspace and edits it with handles. An Error on the way is a fair end.
/// \throw std::logic_error where the edited mesh is not finite, or lost a symmetry that the mesh had
void edit_of_bytes(std::span<const std::uint8_t> bytes);

}  // namespace orbifit

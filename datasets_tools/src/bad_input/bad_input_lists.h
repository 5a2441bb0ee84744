#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "orbifit/model/mesh.h"

#include "bad_input/bad_input.h"

namespace orbifit {

using BadInputs = std::vector<BadInput>;

/// Adds a file to a list: what is wrong with it is a part of its name.
using AddText = std::function<void(const std::string& what, const std::string& content)>;

// The lists of which bad_input() is made, by format.
void add_bad_obj(BadInputs& files);
void add_bad_off(BadInputs& files);
void add_bad_ply(BadInputs& files);
void add_bad_stl(BadInputs& files);
void add_bad_gltf(BadInputs& files);
void add_bad_scans(BadInputs& files);
void add_bad_json(BadInputs& files);
void add_hard_shapes(BadInputs& files);

/// The text with the first `from` replaced. \pre it is there
std::string with(std::string text, std::string_view from, std::string_view to);

/// Copies of the file cut after 1/8, 2/8 ... of it, and one without its last byte.
void add_truncated(BadInputs& files, const std::string& stem, const std::string& ending, BadInputKind kind,
                   const std::string& content);

/// The unit cube about the origin.
Mesh cube_of_bad_input();

}  // namespace orbifit

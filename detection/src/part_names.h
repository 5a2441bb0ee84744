#pragma once

#include <optional>
#include <string>
#include <vector>

#include "orbifit/detection/detect.h"

namespace orbifit {

/// What the mesh's file calls its parts, as names for regions.
class PartNames {
 public:
  /// \param parts  names that are all the same but for numbers, or none, tell nothing \param faces  of the mesh
  PartNames(const NamedParts& parts, std::size_t faces);

  struct Noun {
    std::string text;
    bool whole = false;  ///< these parts, and not pieces of them
    int parts = 0;
  };

  /// What the parts have in common by name that hold the faces: "leg" of leg_1 and leg_2; nothing where some face has
  /// no name, or the names are different ones.
  std::optional<Noun> of(const std::vector<int>& faces) const;

 private:
  const NamedParts& parts_;
  std::vector<std::size_t> size_;   // faces of each part
  std::vector<std::string> stems_;  // of each part's name: without the number that counts parts of one kind
  bool telling_ = false;
};

}  // namespace orbifit

#pragma once

#include <string>
#include <string_view>

namespace orbifit::batch {

/// One of `count` parts of a collection. An item's shard depends on its id and `count` alone, so that it stays where it
/// is when others come or go, and no machine needs to know what the others do.
struct Shard {
  int index = 1;  ///< 1 ... count
  int count = 1;

  /// "2/8". \throw UsageError
  static Shard parse(const std::string& text);
  bool holds(std::string_view id) const;
};

}  // namespace orbifit::batch

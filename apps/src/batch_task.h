#pragma once

#include <string>
#include <utility>
#include <vector>

#include "batch/item_process.h"

namespace orbifit {

/// What a batch does with each of its items: the program's command of that name, as a person would call it.
struct BatchTask {
  std::string name;  ///< detect, fit, symmetrize or info
  std::uint64_t seed = 1;
  int threads = 1;  ///< of an item
  bool thumbnails = true;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< of the thumbnails
  std::vector<std::pair<std::string, std::string>>
      options{};  ///< for all items, which may have others; values are JSON

  /// \throw UsageError for an unknown task, or an option that the task's command has not or that is no value
  void validate() const;

  /// Everything above that results depend on, and the program's version.
  std::string settings() const;

  /// All that it may leave of an item.
  std::vector<std::string> kinds() const;

  /// In the item's own process: see batch::Task.
  batch::Outcome run(const batch::Item& item, const std::filesystem::path& folder) const;
};

}  // namespace orbifit

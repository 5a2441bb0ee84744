#pragma once

#include <string>
#include <vector>

namespace orbifit {

/// What the stages of a detection kept and dropped, in the order in which they did.
struct Explanation {
  struct Note {
    std::string stage;    ///< "whole", "parts", "sets", ...
    std::string subject;  ///< what was judged: a group and where
    bool kept = false;
    std::string reason;
  };
  std::vector<Note> notes;
};

}  // namespace orbifit

#pragma once

#include <string>

namespace orbifit {

/// The English plural of a name: of its last word before the first " of ", by rule but for what furniture and machines
/// are made of ("4 feet", "gear teeth", "boxes of door"). A word that does not end in a letter is its own plural.
std::string plural(const std::string& name);

}  // namespace orbifit

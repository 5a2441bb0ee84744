#pragma once

#include <string>
#include <vector>

#include "../command.h"

namespace orbifit {

/// What `convert A.json OUT --mesh M` is told.
struct AnnotationConversion {
  std::string input, output, mesh;
  int region = -1;            ///< id; -1: the first of a finite group
  std::vector<int> elements;  ///< numbers in the region's list; empty: all
  bool orbits = false;
  std::string style;  ///< of a .glb: "regions" or "instances"
};

/// Refuses before anything is read. \throw UsageError
void check_conversion(const AnnotationConversion& conversion);

/// Writes what the output's ending says, of an annotation or an entry of BOP's models_info.json.
int convert_annotation(const AnnotationConversion& conversion, CommandContext& context);

}  // namespace orbifit

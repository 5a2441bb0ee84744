#include <cstdio>

#include "orbifit/datasets_tools/generate.h"
#include "orbifit/detection/detect.h"
#include "orbifit/subspace/subspace.h"

int main() {
  orbifit::RunContext context;
  const orbifit::GeneratedModel model = orbifit::generate("bar");
  const orbifit::SymmetryAnnotation found = orbifit::detect(model.mesh, {}, context);
  const orbifit::Subspace subspace = orbifit::build_subspace(model.mesh, found, {}, context);
  std::printf("%s, %d degrees of freedom\n", found.regions.at(0).group.symbol().c_str(), subspace.degrees_of_freedom());
  return found.regions.at(0).group.symbol() == "D4h" && subspace.degrees_of_freedom() > 0 ? 0 : 1;
}

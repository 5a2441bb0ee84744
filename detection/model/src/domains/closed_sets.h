#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

#include "domains/domain_map.h"

namespace orbifit {

/// A region or a pattern of the annotation, by its place in the list there.
struct Claim {
  bool pattern = false;
  std::size_t number = 0;

  auto operator<=>(const Claim&) const = default;
};

/// Two claims, the lesser first, and how often the one's motions lose the other, or find it where it was not.
using Disagreements = std::map<std::pair<Claim, Claim>, int>;

/// Claims of which motions of others, that hold them, take one to the next: without one the others would have no image.
using ClaimFamily = std::vector<Claim>;

/// Of each pattern, the motions of its instances, as a DomainMap wants them.
std::vector<std::vector<Motion>> instance_motions(const SymmetryAnnotation& annotation);

/// Whether the motions of all regions and patterns take sets of places to sets of places, as a groupoid does: from each
/// set that a face or a vertex of the mesh has, each motion goes to one set that has an image of every member, its
/// inverse comes back, and to go by two motions of one group is to go by their product. Then the closure of a point
/// under the motions is the same wherever it begins, and a field made of such closures is exact by construction. Where
/// it does not hold, two claims are named each time. Empty: it holds. Cost O(F), and for each set the orders of the
/// groups that hold it.
/// \param domains  of the mesh and the annotation, its patterns' motions being instance_motions()
/// \param families  if given, all claims, each in one family, ascending
Disagreements disagreements(const DomainMap& domains, const SymmetryAnnotation& annotation, const RunContext& context,
                            std::vector<ClaimFamily>* families = nullptr);
Disagreements disagreements(const Mesh& mesh, const SymmetryAnnotation& annotation, const RunContext& context,
                            std::vector<ClaimFamily>* families = nullptr);

/// Pairs of regions whose motions take a face or a vertex, or what the motions take these to, to ever more places
/// (DomainMap::unclosed()). Sets of places may go to sets of places all the same. As disagreements() else.
Disagreements unclosed_groups(const DomainMap& domains, const SymmetryAnnotation& annotation, const RunContext& context,
                              std::vector<ClaimFamily>* families = nullptr);

}  // namespace orbifit

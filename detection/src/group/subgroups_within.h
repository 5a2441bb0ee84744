#pragma once

#include <vector>

#include <Eigen/Core>

namespace orbifit {

/// Subgroups whose elements all lie in one of the masks: closures of pairs of elements, the largest first.
/// \param linear all elements of a finite group, the identity first \param masks 1 for each element that is allowed
/// \return 1 for each element that belongs; none twice. Costs O(N^3 + M N^2 H) for N elements, M masks and subgroups
/// of H.
std::vector<std::vector<char>> subgroups_within(const std::vector<Eigen::Matrix3d>& linear,
                                                const std::vector<std::vector<char>>& masks);

}  // namespace orbifit

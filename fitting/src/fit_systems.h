#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "orbifit/fitting/fit.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"
#include "orbifit/subspace/subspace.h"

#include "solver/fit_system.h"
#include "start/placed_scan.h"

namespace orbifit {

/// What FitOptions ask to be kept touching.
std::vector<Contact> contacts_to_keep(const PlacedScan& start, const Subspace& subspace, const Mesh& mesh,
                                      const FitOptions& options, const RunContext& context);

/// Systems of one subspace for fits side by side, no more than threads. Each serves one fit after another; what it
/// knows by then changes how soon it answers, not what.
class FitSystems {
 public:
  /// References are kept. Arguments as of FitSystem.
  FitSystems(const Subspace& subspace, const Mesh& mesh, double stretch, std::vector<Contact> contacts);

  using Task = std::function<void(std::size_t number, FitSystem& system, const RunContext& own)>;

  /// Runs tasks 0 ... count - 1 on the context's threads, each with a system and a context of its own, which has its
  /// share of the threads and tells no progress where it is not the only one.
  void share(std::size_t count, const RunContext& context, const Task& task);

 private:
  std::unique_ptr<FitSystem> take();

  const Subspace& subspace_;
  const Mesh& mesh_;
  double stretch_;
  std::vector<Contact> contacts_;
  std::mutex guard_;
  std::vector<std::unique_ptr<FitSystem>> idle_;
};

}  // namespace orbifit

#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <type_traits>

/// What instrument.py has a mutated expression ask: which of the two operators is at work. All mutants are compiled at
/// once; the environment variable ORBIFIT_MUTANT has the number of the one that lives, and the numbers of those that
/// were reached are added to the file that ORBIFIT_REACHED names.
namespace orbifit_mutants {

constexpr std::size_t kMost = 8192;  // of mutants in one build

class Reached {
 public:
  Reached() = default;
  ~Reached() {
    const char* name = std::getenv("ORBIFIT_REACHED");
    std::FILE* file = name == nullptr ? nullptr : std::fopen(name, "a");
    if (file == nullptr) return;
    for (std::size_t i = 0; i < kMost; ++i) {
      if (seen_[i].load(std::memory_order_relaxed)) std::fprintf(file, "%zu\n", i);
    }
    std::fclose(file);
  }
  Reached(const Reached&) = delete;
  Reached& operator=(const Reached&) = delete;
  Reached(Reached&&) = delete;
  Reached& operator=(Reached&&) = delete;

  void add(std::size_t number) { seen_[number].store(true, std::memory_order_relaxed); }

 private:
  std::array<std::atomic<bool>, kMost> seen_{};
};

inline Reached reached;
inline const long living = std::getenv("ORBIFIT_MUTANT") == nullptr ? -1 : std::atol(std::getenv("ORBIFIT_MUTANT"));

constexpr bool lives(std::size_t number) {
  if (std::is_constant_evaluated()) return false;
  reached.add(number);
  return living == static_cast<long>(number);
}

}  // namespace orbifit_mutants

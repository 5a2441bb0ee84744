#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "sampling/symmetric_sampling.h"
#include "symmetry/region_map.h"

namespace orbifit {

/// One sample's part in the displacement of a point. In `full`, the sample's displacement; on a circle or sphere of a
/// continuous group, the part of it along the axis (`axial`) or across it (`across`) relative to the carried centre, or
/// the carried centre itself (`centre`, sample -1).
struct LiftTerm {
  enum class Kind : std::uint8_t { full, axial, across, centre };
  int sample = -1;
  Kind kind = Kind::full;
  int place = -1;  ///< whose axis or centre; -1 for `full`
  double weight = 0;
};

/// Gaussians about the samples as in the paper (section 5, "Lifting the displacements"), but a sample that lies outside
/// a place fades out as the point comes near that place: its part is multiplied by a smooth step of the point's
/// distance from the place, over one radius, and is next to nothing inside. So what happens in a place depends on the
/// samples of that place alone, and goes over continuously into its surroundings. Under a continuous group the
/// Gaussians are averaged over the circle or sphere in closed form (docs/method.md 2.4).
class PlainLift {
 public:
  /// \param faded false: the paper's lift, blind for the places
  PlainLift(const SymmetricSampling& sampling, const RegionMap& regions, bool faded);

  /// Room for one caller at a time.
  struct Scratch {
    std::vector<double> factors;               // by set
    std::vector<int> stamps;                   // by set
    std::vector<std::pair<int, double>> near;  // places at hand and what they leave of samples outside
    std::vector<LiftTerm> terms;
    std::vector<int> likely;        // by slot and place: see RegionMap::distance()
    std::vector<double> distances;  // by place: of Origin::point, where `asked` says that they are known
    std::vector<int> asked;         // by place
    int stamp = 0;
    int orbit = 0;
    bool blended = false;  ///< the last point lies in the fading band of a place
  };

  /// Where a point is an image: of `point`, places[i] being the place of which place i is the image; -1: not known.
  /// Distances to places are then those of the first point, which are looked up once an orbit: call begin_orbit()
  /// before an orbit's points.
  struct Origin {
    Eigen::Vector3d point;
    const int* places;
  };
  static void begin_orbit(Scratch& scratch) { ++scratch.orbit; }

  /// The terms for a point of a set, normalised so that those of kind full and centre sum to 1; in scratch.terms.
  /// A point under a continuous group must be in its canonical place. O(samples within 3.7 radii).
  /// \param slot  any number: points of the same one, asked for one after another, are mostly near one another
  void terms(const Eigen::Vector3d& point, int set, Scratch& scratch, std::size_t slot = 0,
             const Origin* origin = nullptr) const;

  /// The place whose continuum acts on points of the set; -1: none.
  int continuous_place(int set) const;

 private:
  void find_near(const Eigen::Vector3d& point, int set, Scratch& scratch, std::size_t slot, const Origin* origin) const;
  double factor(int sample, Scratch& scratch) const;
  void gaussian_terms(const Eigen::Vector3d& point, Scratch& scratch) const;
  void ring_terms(const Eigen::Vector3d& point, int place, Scratch& scratch) const;

  const SymmetricSampling& sampling_;
  const RegionMap& regions_;
  bool faded_;
  std::vector<int> partial_places_;      // those that do not hold the whole mesh
  std::vector<std::vector<int>> rings_;  // canonical samples, by place
  double reach_;                         // of the widest Gaussian
  double width_;                         // of the grid's cells
  Eigen::Vector3d origin_;
  std::array<int, 3> cells_{};
  std::vector<int> first_in_cell_, samples_by_cell_;
};

}  // namespace orbifit

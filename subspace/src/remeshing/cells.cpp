#include "remeshing/cells.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "base/random.h"
#include "geometry/sampling.h"
#include "geometry/surface_index.h"
#include "remeshing/indices.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

constexpr int kSamples = 64;       // of a cell, whose images say where it goes
constexpr double kMajority = 0.6;  // of them in one cell

struct Step {
  int from, to;
  Motion motion;
  std::size_t demand;
};

class CellSearch {
 public:
  CellSearch(const Mesh& mesh, const Components& components, const std::vector<Demand>& demands, double reach,
             const RunContext& context)
      : mesh_(mesh), components_(components), demands_(demands), reach_(reach), context_(context) {
    result_.refused.resize(demands.size());
    extent_ = diagonal(mesh.vertices);
    areas_ = face_areas(mesh);
    normals_ = face_normals(mesh);
  }

  Cells run() {
    while (!attempt()) context_.check();
    return std::move(result_);
  }

 private:
  // \return false where a demand had to be refused or components to be taken together
  bool attempt() {
    result_.cells.clear();
    steps_.clear();
    make_cells();
    for (std::size_t d = 0; d < demands_.size(); ++d) {
      if (!result_.refused[d] && !find_steps(d)) return false;
    }
    return find_words();
  }

  void make_cells() {
    std::vector<std::vector<int>> signature(components_.faces.size());
    int set = 0;
    for (std::size_t d = 0; d < demands_.size(); ++d) {
      for (const ComponentMotion& motion : demands_[d].motions) {
        if (!result_.refused[d]) {
          for (const int c : motion.from) signature[at(c)].push_back(set);
          for (const int c : motion.to) signature[at(c)].push_back(set + 1);
        }
        set += 2;
      }
    }
    std::map<std::vector<int>, int> kinds;
    kind_of_.clear();
    for (const std::vector<int>& sets : signature) {
      kind_of_.push_back(kinds.try_emplace(sets, static_cast<int>(kinds.size())).first->second);
    }
    std::map<std::array<int, 2>, int> numbers;
    cell_of_.assign(signature.size(), -1);
    for (std::size_t c = 0; c < signature.size(); ++c) {
      const int own = united_.contains(signature[c]) ? -1 : static_cast<int>(c);
      const auto [entry, added] = numbers.try_emplace({kind_of_[c], own}, static_cast<int>(result_.cells.size()));
      if (added) result_.cells.emplace_back();
      cell_of_[c] = entry->second;
      result_.cells[at(entry->second)].components.push_back(static_cast<int>(c));
    }
    signature_ = std::move(signature);
    faces_.assign(result_.cells.size(), {});
    for (std::size_t cell = 0; cell < result_.cells.size(); ++cell) {
      for (const int c : result_.cells[cell].components) {
        faces_[cell].insert(faces_[cell].end(), components_.faces[at(c)].begin(), components_.faces[at(c)].end());
      }
      std::ranges::sort(faces_[cell]);
    }
  }

  bool refuse(std::size_t demand, const std::string& reason = "its motions do not take components to components") {
    result_.refused[demand] = reason;
    return false;
  }

  // Components that cannot be told apart, or have no counterpart of their own, are taken together with all of their
  // kind. \return whether they were apart
  bool unite(int cell, int image) {
    bool any = false;
    for (const int which : {cell, image}) {
      if (which < 0) continue;
      any |= united_.insert(signature_[at(result_.cells[at(which)].components.front())]).second;
    }
    return any;
  }

  bool find_steps(std::size_t demand) {
    for (const ComponentMotion& motion : demands_[demand].motions) {
      std::vector<int> there;
      for (const int c : motion.to)
        there.insert(there.end(), components_.faces[at(c)].begin(), components_.faces[at(c)].end());
      std::ranges::sort(there);
      const SurfaceIndex index(mesh_, there);
      std::set<int> from;
      for (const int c : motion.from) from.insert(cell_of_[at(c)]);
      std::set<int> reached;
      for (const int cell : from) {
        const int image = image_of(cell, motion.motion, index);
        if (image < 0 || !reached.insert(image).second) {
          if (!unite(cell, image)) refuse(demand);
          return false;
        }
        steps_.push_back({cell, image, motion.motion, demand});
      }
    }
    return true;
  }

  int image_of(int cell, const Motion& motion, const SurfaceIndex& index) const {
    double area = 0;
    for (const int f : faces_[at(cell)]) area += areas_[f];
    if (!(area > 0)) return -1;
    Random random(1);
    const SurfaceSamples samples = sample_surface(mesh_, areas_, normals_, kSamples, random, faces_[at(cell)]);
    std::map<int, int> votes;
    for (Eigen::Index i = 0; i < samples.points.rows(); ++i) {
      const auto hit = index.nearest(motion(samples.points.row(i).transpose()), 2 * reach_);
      if (hit.face >= 0) ++votes[cell_of_[at(components_.component_of_face[at(hit.face)])]];
    }
    for (const auto& [image, count] : votes) {
      if (count >= kMajority * static_cast<double>(samples.points.rows())) return image;
    }
    return -1;
  }

  // Each cell that steps reach from an earlier one becomes its image; what then leads back forms its group.
  bool find_words() {
    std::vector<char> found(result_.cells.size(), 0);
    for (std::size_t source = 0; source < result_.cells.size(); ++source) {
      if (found[source] != 0) continue;
      const std::vector<int> orbit = spread_from(static_cast<int>(source), found);
      std::vector<Motion> loops;
      std::size_t last = 0;
      const std::set<int> members(orbit.begin(), orbit.end());
      for (const Step& step : steps_) {
        if (!members.contains(step.from)) continue;
        loops.push_back(inverse(result_.cells[at(step.to)].from_source) * step.motion *
                        result_.cells[at(step.from)].from_source);
        last = std::max(last, step.demand);
      }
      const Mesh part = submesh(mesh_, faces_[source]);
      const std::optional<FiniteGroup> group = generated_group(loops, bounding_box_centre(part.vertices), extent_);
      if (!group) return refuse(last, "it makes no finite group with those before it");
      result_.cells[source].group = *group;
    }
    return true;
  }

  std::vector<int> spread_from(int source, std::vector<char>& found) {
    std::vector<int> orbit{source};
    found[at(source)] = 1;
    result_.cells[at(source)].source = source;
    for (std::size_t next = 0; next < orbit.size(); ++next) {
      const int here = orbit[next];
      for (const Step& step : steps_) {
        const bool forth = step.from == here && found[at(step.to)] == 0;
        const bool back = step.to == here && found[at(step.from)] == 0;
        if (!forth && !back) continue;
        const int other = forth ? step.to : step.from;
        found[at(other)] = 1;
        MeshCell& cell = result_.cells[at(other)];
        cell.source = source;
        cell.from_source = (forth ? step.motion : inverse(step.motion)) * result_.cells[at(here)].from_source;
        orbit.push_back(other);
      }
    }
    return orbit;
  }

  const Mesh& mesh_;
  const Components& components_;
  const std::vector<Demand>& demands_;
  double reach_;
  const RunContext& context_;
  double extent_ = 0;
  Eigen::VectorXd areas_;
  Points normals_;
  Cells result_;
  std::vector<std::vector<int>> signature_;  // by component: the sets of demands that hold it
  std::set<std::vector<int>> united_;        // signatures whose components form one cell
  std::vector<int> kind_of_;                 // by component: its signature's number
  std::vector<int> cell_of_;                 // by component
  std::vector<std::vector<int>> faces_;      // by cell, ascending
  std::vector<Step> steps_;
};

}  // namespace

Cells find_cells(const Mesh& mesh, const Components& components, const std::vector<Demand>& demands, double reach,
                 const RunContext& context) {
  return CellSearch(mesh, components, demands, reach, context).run();
}

}  // namespace orbifit

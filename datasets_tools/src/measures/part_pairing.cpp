#include "measures/part_pairing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/point_index.h"
#include "geometry/topology.h"

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Divides a patch, whose faces are `faces` in the mesh.
std::optional<RegionParts::Division> divided(const Mesh& patch, const std::vector<int>& faces) {
  const std::vector<std::vector<int>> parts =
      touching_parts(patch, weld_vertices(patch.vertices), DoubledParts::apart).faces;
  // Loose triangles are no parts.
  constexpr std::size_t kFacesOfAPart = 4;
  if (parts.size() < 2 || kFacesOfAPart * parts.size() > faces.size()) return std::nullopt;
  RegionParts::Division division;
  division.part_of_vertex.assign(static_cast<std::size_t>(patch.vertices.rows()), -1);
  division.shared.assign(division.part_of_vertex.size(), 0);
  const Eigen::VectorXd areas = face_areas(patch);
  for (const std::vector<int>& part : parts) {
    std::vector<int> own;
    std::vector<int> vertices;
    Vector3d moment = Vector3d::Zero();
    double area = 0;
    for (const int f : part) {
      own.push_back(faces[static_cast<std::size_t>(f)]);
      area += areas[f];
      for (int k = 0; k < 3; ++k) {
        const int v = patch.faces(f, k);
        moment += areas[f] / 3 * patch.vertices.row(v).transpose();
        int& of_vertex = division.part_of_vertex[static_cast<std::size_t>(v)];
        const auto here = static_cast<int>(division.parts.size());
        if (of_vertex >= 0 && of_vertex != here) division.shared[static_cast<std::size_t>(v)] = 1;
        if (of_vertex >= 0) continue;
        of_vertex = here;
        vertices.push_back(v);
      }
    }
    std::ranges::sort(vertices);
    if (!(area > 0)) vertices.clear();  // nothing to tell it by
    const Vector3d centroid =
        area > 0 ? Vector3d(moment / area) : Vector3d(patch.vertices.row(patch.faces(part[0], 0)));
    division.parts.push_back({std::move(own), std::move(vertices), centroid, area});
  }
  return division;
}

// A part of `to` that may be the image of one of `from`.
struct Candidate {
  int part = 0;
  double squares = 0, farthest = 0, facing = 0;  // over the samples
  double count = 0;
};

// What is asked of one part of `to`: places of images, each for an answer elsewhere.
struct Request {
  std::vector<std::size_t> pairs;
  std::vector<Candidate*> answers;  // as many, or none
};

class Pairer {
 public:
  Pairer(const RegionParts& from, const RegionParts& to, const std::vector<Motion>& motions, const Points& images,
         double tolerance, double reach, const RunContext& context)
      : from_(from),
        to_(to),
        motions_(motions),
        images_(images),
        tolerance_(tolerance),
        reach_(reach),
        context_(context) {}

  Pairing result() {
    const std::size_t count = from_.whole().vertices().size();
    pairing_.places.resize(motions_.size() * count);
    done_.assign(pairing_.places.size(), false);
    find_lone_vertices();
    if (from_.division() && to_.division()) pair_division(*from_.division(), *to_.division());
    std::vector<std::size_t> rest;
    for (std::size_t i = 0; i < done_.size(); ++i) {
      if (done_[i]) continue;
      if (lone_[i] >= 0) {
        pairing_.places[i].vertex = to_.whole().vertices()[static_cast<std::size_t>(lone_[i])];
      } else {
        rest.push_back(i);
      }
    }
    const std::vector<SurfacePlace> places = places_on(to_.whole(), rest);
    for (std::size_t i = 0; i < rest.size(); ++i) pairing_.places[rest[i]] = places[i];
    return std::move(pairing_);
  }

 private:
  std::size_t pair_of(std::size_t motion, int vertex) const {
    return motion * from_.whole().vertices().size() + static_cast<std::size_t>(vertex);
  }

  // Of the vertex of `from`, where the motion turns it.
  Vector3d normal_of(std::size_t pair) const {
    const std::size_t count = from_.whole().vertices().size();
    return motions_[pair / count].linear * from_.whole().normals().row(static_cast<Index>(pair % count)).transpose();
  }

  void find_lone_vertices() {
    lone_.resize(static_cast<std::size_t>(images_.rows()));
    parallel_for(context_, lone_.size(), [&](std::size_t begin, std::size_t end) {
      VertexFinder::Walk walk(to_.whole().vertex_finder());
      for (std::size_t i = begin; i < end; ++i) {
        lone_[i] = walk.at(static_cast<int>(i), images_.row(static_cast<Index>(i)).transpose());
      }
    });
  }

  // Whether a vertex of `to`, by number, is of this part and no other: the part by itself has it as the whole has it.
  bool only_of(int vertex, std::size_t part) const {
    const auto v = static_cast<std::size_t>(vertex);
    return vertex >= 0 && to_.division()->part_of_vertex[v] == static_cast<int>(part) && to_.division()->shared[v] == 0;
  }

  // On one part of `to`. Where an image is at one vertex of all of `to`, and that is the part's, the part is not asked.
  std::vector<SurfacePlace> places_on_part(std::size_t part, const std::vector<std::size_t>& pairs) const {
    std::vector<SurfacePlace> result(pairs.size());
    std::vector<std::size_t> open;
    std::vector<std::size_t> open_pairs;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const int lone = lone_[pairs[i]];
      if (only_of(lone, part)) {
        result[i].vertex = to_.whole().vertices()[static_cast<std::size_t>(lone)];
      } else {
        open.push_back(i);
        open_pairs.push_back(pairs[i]);
      }
    }
    if (open.empty()) return result;
    const std::vector<SurfacePlace> places = places_on(to_.surface_of(part), open_pairs);
    for (std::size_t i = 0; i < open.size(); ++i) result[open[i]] = places[i];
    return result;
  }

  // Of a place that the part has for a pair.
  Vector3d normal_at(const SurfacePlace& place, std::size_t part, std::size_t pair) const {
    return (only_of(lone_[pair], part) ? to_.whole() : to_.surface_of(part)).normal_at(place);
  }

  std::vector<SurfacePlace> places_on(const RegionSurface& surface, const std::vector<std::size_t>& pairs) const {
    if (pairs.empty()) return {};
    Points points(static_cast<Index>(pairs.size()), 3);
    Points normals(points.rows(), 3);
    for (Index i = 0; i < points.rows(); ++i) {
      points.row(i) = images_.row(static_cast<Index>(pairs[static_cast<std::size_t>(i)]));
      normals.row(i) = normal_of(pairs[static_cast<std::size_t>(i)]).transpose();
    }
    return surface.places(points, normals, context_);
  }

  // Parts of `to` of about the same size about where the motion takes each part of `from`.
  std::vector<std::vector<Candidate>> candidates(const RegionParts::Division& from,
                                                 const RegionParts::Division& to) const {
    constexpr double kAreaRatio = 0.8;  // tessellations of a round part differ by less
    Points centroids(static_cast<Index>(to.parts.size()), 3);
    for (std::size_t k = 0; k < to.parts.size(); ++k) {
      centroids.row(static_cast<Index>(k)) = to.parts[k].centroid.transpose();
    }
    const PointIndex index(centroids);
    std::vector<std::vector<Candidate>> result(motions_.size() * from.parts.size());
    for (std::size_t m = 0; m < motions_.size(); ++m) {
      context_.check();
      for (std::size_t k = 0; k < from.parts.size(); ++k) {
        const RegionParts::Part& part = from.parts[k];
        for (const auto& near : index.within(motions_[m](part.centroid), 2 * tolerance_)) {
          const double area = to.parts[static_cast<std::size_t>(near.index)].area;
          if (std::min(area, part.area) < kAreaRatio * std::max(area, part.area)) continue;
          result[m * from.parts.size() + k].push_back({near.index, 0, 0, 0, 0});
        }
      }
    }
    return result;
  }

  // Measures the candidates on some vertices of the parts.
  void judge(const RegionParts::Division& from, const RegionParts::Division& to,
             std::vector<std::vector<Candidate>>& all) const {
    constexpr std::size_t kPartVertices = 12;  // of a part
    std::vector<Request> requests(to.parts.size());
    for (std::size_t c = 0; c < all.size(); ++c) {
      const std::vector<int>& vertices = from.parts[c % from.parts.size()].vertices;
      const std::size_t samples = std::min(kPartVertices, vertices.size());
      for (Candidate& candidate : all[c]) {
        Request& request = requests[static_cast<std::size_t>(candidate.part)];
        for (std::size_t s = 0; s < samples; ++s) {
          request.pairs.push_back(pair_of(c / from.parts.size(), vertices[s * vertices.size() / samples]));
          request.answers.push_back(&candidate);
        }
      }
    }
    for (std::size_t k = 0; k < requests.size(); ++k) {
      const Request& request = requests[k];
      const std::vector<SurfacePlace> places = places_on_part(k, request.pairs);
      for (std::size_t i = 0; i < places.size(); ++i) {
        const auto row = static_cast<Index>(request.pairs[i]);
        Candidate& candidate = *request.answers[i];
        const double distance = (to_.whole().point_at(places[i]) - images_.row(row).transpose()).norm();
        candidate.squares += distance * distance;
        candidate.farthest = std::max(candidate.farthest, distance);
        candidate.facing += normal_at(places[i], k, request.pairs[i]).dot(normal_of(request.pairs[i]));
        candidate.count += 1;
      }
    }
  }

  // The part that fits best and those that lie where it does; empty: none fits.
  std::vector<int> fitting(const std::vector<Candidate>& candidates) const {
    constexpr double kSameSide = 0.5;  // between cosines: the two sides of a sheet are 2 apart
    std::vector<Candidate> fit;
    double facing = -1;
    for (const Candidate& candidate : candidates) {
      if (candidate.farthest > tolerance_ || candidate.count == 0) continue;
      fit.push_back(candidate);
      facing = std::max(facing, candidate.facing / candidate.count);
    }
    std::erase_if(fit, [&](const Candidate& one) { return one.facing / one.count < facing - kSameSide; });
    double least = std::numeric_limits<double>::infinity();
    for (const Candidate& one : fit) least = std::min(least, std::sqrt(one.squares / one.count));
    std::erase_if(fit, [&](const Candidate& one) { return std::sqrt(one.squares / one.count) > least + reach_; });
    std::vector<int> parts;
    for (const Candidate& one : fit) parts.push_back(one.part);
    std::ranges::sort(parts);
    return parts;
  }

  void pair_division(const RegionParts::Division& from, const RegionParts::Division& to) {
    std::vector<std::vector<Candidate>> all = candidates(from, to);
    judge(from, to, all);
    // What is asked of each part of `to`: (choice, alternative) of each run of pairs; alternative 0 is taken at first.
    struct Wanted {
      std::size_t choice, alternative;
    };
    std::vector<std::vector<Wanted>> wanted(to.parts.size());
    std::vector<Pairing::Choice> choices;
    for (std::size_t c = 0; c < all.size(); ++c) {
      const std::vector<int> parts = fitting(all[c]);
      if (parts.empty()) continue;
      Pairing::Choice choice;
      for (const int vertex : from.parts[c % from.parts.size()].vertices) {
        const std::size_t pair = pair_of(c / from.parts.size(), vertex);
        choice.pairs.push_back(pair);
      }
      choice.alternatives.resize(parts.size());
      for (std::size_t a = 0; a < parts.size(); ++a) {
        wanted[static_cast<std::size_t>(parts[a])].push_back({choices.size(), a});
      }
      choices.push_back(std::move(choice));
    }
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      std::vector<std::size_t> pairs;
      for (const Wanted& one : wanted[k]) {
        pairs.insert(pairs.end(), choices[one.choice].pairs.begin(), choices[one.choice].pairs.end());
      }
      const std::vector<SurfacePlace> places = places_on_part(k, pairs);
      auto next = places.begin();
      for (const Wanted& one : wanted[k]) {
        const auto end = next + static_cast<std::ptrdiff_t>(choices[one.choice].pairs.size());
        choices[one.choice].alternatives[one.alternative].assign(next, end);
        next = end;
      }
    }
    for (Pairing::Choice& choice : choices) {
      std::erase_if(choice.alternatives, [&](const auto& places) { return !near_all(to_, choice.pairs, places); });
      if (choice.alternatives.empty()) continue;
      for (std::size_t i = 0; i < choice.pairs.size(); ++i) {
        pairing_.places[choice.pairs[i]] = choice.alternatives.front()[i];
        done_[choice.pairs[i]] = true;
      }
      choice.alternatives.erase(choice.alternatives.begin());
      if (!choice.alternatives.empty()) pairing_.choices.push_back(std::move(choice));
    }
  }

  // Whether the places are within the tolerance of their images: of a part that is no counterpart some are not.
  bool near_all(const RegionParts& to, const std::vector<std::size_t>& pairs,
                const std::vector<SurfacePlace>& places) const {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Vector3d image = images_.row(static_cast<Index>(pairs[i]));
      if ((to.whole().point_at(places[i]) - image).norm() > tolerance_) return false;
    }
    return true;
  }

  const RegionParts& from_;
  const RegionParts& to_;
  const std::vector<Motion>& motions_;
  const Points& images_;
  const double tolerance_;
  const double reach_;
  const RunContext& context_;
  Pairing pairing_;
  std::vector<bool> done_;
  std::vector<int> lone_;  // by pair: what VertexFinder::at() of all of `to` says of the image
};

}  // namespace

RegionParts::RegionParts(const Mesh& mesh, const std::vector<int>& faces, double reach)
    : mesh_(mesh), reach_(reach), whole_(mesh, faces, reach), division_(divided(whole_.patch(), faces)) {
  if (division_) surfaces_.resize(division_->parts.size());
}

const RegionSurface& RegionParts::surface_of(std::size_t part) const {
  std::unique_ptr<const RegionSurface>& surface = surfaces_[part];
  if (!surface) surface = std::make_unique<const RegionSurface>(mesh_, division_->parts[part].faces, reach_);
  return *surface;
}

Pairing pair_parts(const RegionParts& from, const RegionParts& to, const std::vector<Motion>& motions,
                   const Points& images, double tolerance, double reach, const RunContext& context) {
  return Pairer(from, to, motions, images, tolerance, reach, context).result();
}

}  // namespace orbifit

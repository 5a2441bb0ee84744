#include "models/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace orbifit {

namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;

std::vector<Vector3d> in_space(const std::vector<Vector2d>& profile) {
  std::vector<Vector3d> points;
  for (const Vector2d& point : profile) points.emplace_back(point.x(), 0, point.y());
  return points;
}

// Faces of a capped skin, ring by ring.
class SkinFaces {
 public:
  SkinFaces(const SkinCounts& counts, decltype(Mesh::faces)& faces) : counts_(counts), faces_(faces) {}

  // From a ring of `sectors` * i points to the next of `sectors` * (i + 1), or back.
  void widen(int inner, int outer, int i, bool opening) {
    const int around_inner = std::max(1, counts_.sectors * i);
    const int around_outer = counts_.sectors * (i + 1);
    for (int s = 0; s < counts_.sectors; ++s) {
      for (int a = 0; a <= i; ++a) {
        const int in = inner + (s * i + a) % around_inner;
        const int out = outer + s * (i + 1) + a;
        const int next_out = outer + (s * (i + 1) + a + 1) % around_outer;
        add(in, out, next_out, opening);
        if (a < i) add(in, next_out, inner + (s * i + a + 1) % around_inner, opening);
      }
    }
  }
  // Diagonals are mirrored in the middle of every sector and half way along.
  void side(int lower, int upper, bool second_half) {
    const int around = counts_.sectors * counts_.cap;
    for (int k = 0; k < around; ++k) {
      const int next = (k + 1) % around;
      const bool other = (2 * (k % counts_.cap) >= counts_.cap) != second_half;
      if (other) {
        add(lower + k, upper + k, lower + next, true);
        add(lower + next, upper + k, upper + next, true);
      } else {
        add(lower + k, upper + k, upper + next, true);
        add(lower + k, upper + next, lower + next, true);
      }
    }
  }

 private:
  void add(int a, int b, int c, bool forward) {
    if (forward) {
      faces_.row(face_++) << a, b, c;
    } else {
      faces_.row(face_++) << a, c, b;
    }
  }

  SkinCounts counts_;
  decltype(Mesh::faces)& faces_;
  Index face_ = 0;
};

}  // namespace

Mesh capped_skin(const SkinCounts& counts, const SkinPoint& point) {
  const int last = 2 * counts.cap + counts.rings;
  // Points of ring t and where they begin.
  const auto around = [&](int t) { return std::max(1, counts.sectors * std::min({t, last - t, counts.cap})); };
  std::vector<int> first{0};
  for (int t = 0; t <= last; ++t) first.push_back(first.back() + around(t));
  Mesh mesh;
  mesh.vertices.resize(first.back(), 3);
  mesh.faces.resize(2 * (first.back() - 2), 3);
  for (int t = 0; t <= last; ++t) {
    const int size = around(t);
    const double share = static_cast<double>(t) / last;
    for (int k = 0; k < size; ++k) {
      const double angle = 2 * std::numbers::pi * k / size;
      mesh.vertices.row(first[static_cast<std::size_t>(t)] + k) = point(share, std::cos(angle), std::sin(angle));
    }
  }
  SkinFaces faces(counts, mesh.faces);
  for (int t = 0; t < last; ++t) {
    const int here = first[static_cast<std::size_t>(t)];
    const int next = first[static_cast<std::size_t>(t) + 1];
    if (t < counts.cap) {
      faces.widen(here, next, t, true);
    } else if (t >= last - counts.cap) {
      faces.widen(next, here, last - t - 1, false);
    } else {
      faces.side(here, next, 2 * (t - counts.cap) >= counts.rings);
    }
  }
  if (signed_volume(mesh) < 0) mesh.faces.col(1).swap(mesh.faces.col(2));
  return mesh;
}

Curve::Curve(std::vector<Vector3d> points) : points_(std::move(points)), reached_{0} {
  for (std::size_t i = 1; i < points_.size(); ++i) {
    reached_.push_back(reached_.back() + (points_[i] - points_[i - 1]).norm());
  }
}

Curve::Curve(const std::vector<Vector2d>& profile) : Curve(in_space(profile)) {}

std::size_t Curve::piece(double share) const {
  const auto end = std::upper_bound(reached_.begin() + 1, reached_.end() - 1, share * length());
  return static_cast<std::size_t>(end - reached_.begin()) - 1;
}

Vector3d Curve::operator()(double share) const {
  const std::size_t i = piece(share);
  const double within = (share * length() - reached_[i]) / (reached_[i + 1] - reached_[i]);
  return points_[i] * (1 - within) + points_[i + 1] * within;
}

Vector3d Curve::tangent(double share) const {
  // Smooth from piece to piece, so that both ways along the line agree at its points.
  const auto at_point = [&](std::size_t k) {
    const Vector3d before = k > 0 ? Vector3d((points_[k] - points_[k - 1]).normalized()) : Vector3d::Zero();
    const Vector3d after =
        k + 1 < points_.size() ? Vector3d((points_[k + 1] - points_[k]).normalized()) : Vector3d::Zero();
    return Vector3d((before + after).normalized());
  };
  const std::size_t i = piece(share);
  const double within = std::clamp((share * length() - reached_[i]) / (reached_[i + 1] - reached_[i]), 0.0, 1.0);
  return (at_point(i) * (1 - within) + at_point(i + 1) * within).normalized();
}

Curve smooth_curve(const std::vector<Vector3d>& through) {
  constexpr int kPieces = 64;
  const std::size_t count = through.size();
  std::vector<Vector3d> slope(count);
  const auto chord = [&](std::size_t i) { return (through[i + 1] - through[i]).norm(); };
  for (std::size_t i = 0; i < count; ++i) {
    if (i == 0 || i + 1 == count) {
      const std::size_t from = i == 0 ? 0 : count - 2;
      slope[i] = (through[from + 1] - through[from]) / chord(from);
      continue;
    }
    const double before = chord(i - 1);
    const double after = chord(i);
    slope[i] = ((through[i] - through[i - 1]) / before * after + (through[i + 1] - through[i]) / after * before) /
               (before + after);
  }
  std::vector<Vector3d> points{through.front()};
  for (std::size_t i = 0; i + 1 < count; ++i) {
    for (int k = 1; k <= kPieces; ++k) {
      const double t = static_cast<double>(k) / kPieces;
      const double rise = t * t * (3 - 2 * t);
      points.emplace_back((1 - rise) * through[i] + rise * through[i + 1] +
                          chord(i) * (t * (1 - t) * (1 - t) * slope[i] - t * t * (1 - t) * slope[i + 1]));
    }
  }
  return Curve(std::move(points));
}

double smooth_table(std::initializer_list<std::pair<double, double>> entries, double place) {
  const std::pair<double, double>* table = entries.begin();
  const std::size_t last = entries.size() - 1;
  if (place <= table[0].first) return table[0].second;
  if (place >= table[last].first) return table[last].second;
  std::size_t i = 0;
  while (table[i + 1].first < place) ++i;
  const auto secant = [&](std::size_t k) {
    return (table[k + 1].second - table[k].second) / (table[k + 1].first - table[k].first);
  };
  // Harmonic means of the neighbouring slopes keep what rises rising (Fritsch and Butland 1984).
  const auto slope = [&](std::size_t k) {
    if (k == 0 || k == last) return 0.0;
    const double before = secant(k - 1);
    const double after = secant(k);
    return before * after <= 0 ? 0.0 : 2 * before * after / (before + after);
  };
  const double width = table[i + 1].first - table[i].first;
  const double t = (place - table[i].first) / width;
  const double rise = t * t * (3 - 2 * t);
  return (1 - rise) * table[i].second + rise * table[i + 1].second +
         width * (t * (1 - t) * (1 - t) * slope(i) - t * t * (1 - t) * slope(i + 1));
}

Vector2d rounded_square(double cosine, double sine, double exponent) {
  const double sum = std::pow(std::abs(cosine), exponent) + std::pow(std::abs(sine), exponent);
  return Vector2d(cosine, sine) * std::pow(sum, -1 / exponent);
}

Mesh turned(const SkinCounts& counts, const std::vector<Vector2d>& profile,
            const std::function<double(double share, double cosine, double sine)>& lobes) {
  const Curve meridian(profile);
  return capped_skin(counts, [&](double share, double cosine, double sine) {
    const Vector3d place = meridian(share);
    const double radius = place.x() * (lobes ? lobes(share, cosine, sine) : 1.0);
    return Vector3d(radius * cosine, radius * sine, place.z());
  });
}

Mesh tube(const SkinCounts& counts, const Curve& path, const Vector3d& normal,
          const std::function<double(double share)>& radius) {
  // Round ends: quarter circles of the radius that the tube has there.
  const double first = radius(0);
  const double last = radius(1);
  const std::vector<Vector2d> outline = trace_profile({{0, -first, 0, 1},
                                                       {first, -first, 0.999 * first, 1},
                                                       {last, path.length() + last, 0.999 * last, 1},
                                                       {0, path.length() + last, 0, 1}},
                                                      32, false);
  const Curve meridian(outline);
  return capped_skin(counts, [&](double share, double cosine, double sine) {
    const Vector3d place = meridian(share);
    const double along = place.z() / path.length();
    const double inside = std::clamp(along, 0.0, 1.0);
    const double straight = first + (last - first) * inside;
    const double wide = place.x() * radius(inside) / straight;
    const Vector3d across = normal.cross(path.tangent(along)).normalized();
    return Vector3d(path(along) + wide * (cosine * across + sine * normal));
  });
}

double cosine_of_multiple(int n, double cosine, double sine) {
  return std::cos(n * std::atan2(sine, cosine));
}

}  // namespace orbifit

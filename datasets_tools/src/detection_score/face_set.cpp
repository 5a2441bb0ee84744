#include "detection_score/face_set.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace orbifit::scoring {

int FaceSet::size() const {
  int count = 0;
  for (const auto& [first, end] : runs) count += end - first;
  return count;
}

FaceSet face_set(const std::vector<int>& faces) {
  FaceSet set;
  for (const int face : faces) {
    if (!set.runs.empty() && set.runs.back().second == face) {
      ++set.runs.back().second;
    } else {
      set.runs.emplace_back(face, face + 1);
    }
  }
  return set;
}

FaceSet intersection(const FaceSet& a, const FaceSet& b) {
  FaceSet result;
  for (std::size_t i = 0, j = 0; i < a.runs.size() && j < b.runs.size();) {
    const int first = std::max(a.runs[i].first, b.runs[j].first);
    const int end = std::min(a.runs[i].second, b.runs[j].second);
    if (first < end) result.runs.emplace_back(first, end);
    if (a.runs[i].second < b.runs[j].second) {
      ++i;
    } else {
      ++j;
    }
  }
  return result;
}

FaceSet united(const FaceSet& a, const FaceSet& b) {
  std::vector<std::pair<int, int>> all;
  std::ranges::merge(a.runs, b.runs, std::back_inserter(all));
  FaceSet result;
  for (const auto& run : all) {
    if (!result.runs.empty() && run.first <= result.runs.back().second) {
      result.runs.back().second = std::max(result.runs.back().second, run.second);
    } else {
      result.runs.push_back(run);
    }
  }
  return result;
}

std::vector<int> members(const FaceSet& set) {
  std::vector<int> result;
  for (const auto& [first, end] : set.runs) {
    for (int face = first; face < end; ++face) result.push_back(face);
  }
  return result;
}

MeasuredMesh::MeasuredMesh(const Mesh& given)
    : mesh(given),
      normals(face_normals(given)),
      areas(face_areas(given)),
      area_before(static_cast<std::size_t>(given.faces.rows()) + 1, 0.0),
      diagonal(orbifit::diagonal(given.vertices)) {
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    area_before[static_cast<std::size_t>(f) + 1] = area_before[static_cast<std::size_t>(f)] + areas[f];
  }
  area = area_before.back();
}

double MeasuredMesh::area_of(const FaceSet& set) const {
  double sum = 0;
  for (const auto& [first, end] : set.runs) {
    sum += area_before[static_cast<std::size_t>(end)] - area_before[static_cast<std::size_t>(first)];
  }
  return sum;
}

double MeasuredMesh::iou(const FaceSet& a, const FaceSet& b) const {
  const double shared = area_of(intersection(a, b));
  const double both = area_of(a) + area_of(b) - shared;
  return both > 0 ? shared / both : 0;
}

double MeasuredMesh::diagonal_of(const std::vector<int>& faces) const {
  Eigen::AlignedBox3d box;
  for (const int face : faces) {
    for (int k = 0; k < 3; ++k) box.extend(mesh.vertices.row(mesh.faces(face, k)).transpose());
  }
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

double MeasuredMesh::tolerance_of(const std::vector<int>& faces) const {
  return std::min(0.005 * diagonal, 0.02 * diagonal_of(faces));
}

Eigen::Vector3d MeasuredMesh::middle_of(const std::vector<int>& faces) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int face : faces) {
    for (int k = 0; k < 3; ++k) sum += mesh.vertices.row(mesh.faces(face, k)).transpose();
  }
  return sum / std::max<double>(3 * static_cast<double>(faces.size()), 1);
}

}  // namespace orbifit::scoring

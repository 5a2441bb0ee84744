#include "reading.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

#include <unistd.h>

#include "orbifit/fitting/landmarks.h"
#include "orbifit/subspace/handles.h"
#include "orbifit/subspace/radius_field.h"
#include "orbifit/subspace/subspace.h"
#include "orbifit/subspace/subspace_io.h"

#include "bad_input/bad_input_lists.h"
#include "batch/manifest.h"
#include "files/file.h"
#include "io/section_file.h"
#include "model_reading.h"

namespace orbifit {

namespace {

using Eigen::Vector3d;

// With the symmetry of all faces under x -> -x.
SymmetryAnnotation mirrored(const Mesh& mesh, const char* name) {
  SymmetryAnnotation annotation = empty_annotation(mesh, 0.005);
  GroupFrame frame = GroupFrame::Identity();
  frame.col(2) = Vector3d::UnitX();
  frame.col(0) = Vector3d::UnitY();
  frame.col(1) = Vector3d::UnitZ();
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces.rows()));
  std::iota(faces.begin(), faces.end(), 0);
  annotation.regions.push_back(make_region(*PointGroup::parse("Cs"), Vector3d::Zero(), frame, faces, name));
  return annotation;
}

std::string read(BadInputKind kind, const std::filesystem::path& file, const ReadingContext& context) {
  switch (kind) {
    case BadInputKind::mesh:
    case BadInputKind::scan:
    case BadInputKind::annotation:
      return model_reading(kind, file, context.mesh);
    case BadInputKind::handles:
      return counted(static_cast<long long>(read_handles(file, context.mesh).handles.size()), "handles");
    case BadInputKind::landmarks:
      return counted(static_cast<long long>(read_landmarks(file, context.mesh).size()), "landmarks");
    case BadInputKind::radius_field: {
      const RadiusFieldOptions options = read_radius_field(file, 0.2);
      if (!radius_field(context.mesh, options, RunContext{}).allFinite()) throw std::logic_error("no finite radius");
      return counted(static_cast<long long>(options.areas.size()), "areas");
    }
    case BadInputKind::basis:
      return counted(read_subspace(file, context.mesh, context.annotation, RunContext{}).degrees_of_freedom(),
                     "degrees of freedom");
    case BadInputKind::manifest: {
      const auto manifest = batch::Manifest::from_lines(file, batch::Shard{});
      for (std::size_t i = 0; i < manifest.size(); ++i) batch::manifest_line(manifest.item(i));
      return counted(static_cast<long long>(manifest.size()), "items");
    }
  }
  throw std::logic_error("no such kind");
}

}  // namespace

ReadingContext::ReadingContext(Mesh shape, SymmetryAnnotation symmetry, const SubspaceOptions& options)
    : mesh(std::move(shape)), annotation(std::move(symmetry)) {
  std::string folder = (std::filesystem::temp_directory_path() / "orbifit-reading-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw std::runtime_error("no temporary folder");
  const std::filesystem::path file = std::filesystem::path(folder) / "whole.basis";
  write_subspace(file, build_subspace(mesh, annotation, options, RunContext{}), mesh, annotation);
  basis = read_file(file);
  std::filesystem::remove_all(folder);
}

ReadingContext::ReadingContext()
    : ReadingContext(cube_of_bad_input(), mirrored(cube_of_bad_input(), "cube"), SubspaceOptions{}) {}

ReadingContext ReadingContext::columns() {
  constexpr int kCorners = 12;
  std::vector<Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (const double side : {-1.0, 1.0}) {
    const int first = static_cast<int>(vertices.size());
    for (int k = 0; k < kCorners; ++k) {
      const double angle = 2 * std::numbers::pi * k / kCorners;
      for (const double height : {0.0, 2.0}) {
        vertices.emplace_back(side * (1 + 0.4 * std::cos(angle)), 0.4 * std::sin(angle), height);
      }
    }
    for (const double height : {0.0, 2.0}) vertices.emplace_back(side, 0, height);
    for (int k = 0; k < kCorners; ++k) {
      const int here = first + 2 * k, next = first + 2 * ((k + 1) % kCorners), caps = first + 2 * kCorners;
      for (Eigen::Vector3i face : {Eigen::Vector3i(here, next, next + 1), Eigen::Vector3i(here, next + 1, here + 1),
                                   Eigen::Vector3i(caps, next, here), Eigen::Vector3i(caps + 1, here + 1, next + 1)}) {
        if (side < 0) std::swap(face[1], face[2]);
        faces.push_back(face);
      }
    }
  }
  Mesh mesh;
  mesh.vertices.resize(std::ssize(vertices), 3);
  mesh.faces.resize(std::ssize(faces), 3);
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) mesh.vertices.row(v) = vertices[static_cast<std::size_t>(v)];
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) mesh.faces.row(f) = faces[static_cast<std::size_t>(f)];
  SymmetryAnnotation annotation = mirrored(mesh, "both");
  for (const int column : {0, 1}) {
    std::vector<int> own(static_cast<std::size_t>(4 * kCorners));
    std::iota(own.begin(), own.end(), column * 4 * kCorners);
    annotation.regions.push_back(make_region(*PointGroup::parse("Cinfv"), {column == 0 ? -1.0 : 1.0, 0, 1},
                                             GroupFrame::Identity(), own, "column"));
    annotation.regions.back().id = column + 1;
  }
  set_parents(annotation.regions);
  SubspaceOptions options;
  options.mode = GroupMode::moving;
  options.samples = 60;
  return {std::move(mesh), std::move(annotation), options};
}

std::string with_right_checksums(std::string basis) {
  // docs/basis-format.md: the header's place of each field, and the rows of its table.
  constexpr std::size_t kSections = 12, kSize = 16, kChecksum = 24, kTable = 32, kRow = 32;
  if (basis.size() < kTable) return basis;
  const auto number = [&](std::size_t at) {
    std::uint64_t value = 0;
    std::memcpy(&value, basis.data() + at, sizeof value);
    return value;
  };
  const auto set = [&](std::size_t at, std::uint64_t value) { std::memcpy(basis.data() + at, &value, sizeof value); };
  const std::size_t sections = number(kSections) & 0xffU;
  if (basis.size() < kTable + sections * kRow) return basis;
  set(kSize, basis.size());
  for (std::size_t s = 0; s < sections; ++s) {
    const std::size_t row = kTable + s * kRow;
    const std::uint64_t start = number(row + 8);
    const std::uint64_t size = number(row + 16);
    if (start > basis.size() || size > basis.size() - start) continue;
    Checksum sum;
    sum.add(basis.data() + start, size);
    set(row + 24, sum.value());
  }
  Checksum sum;
  sum.add(basis.data(), kChecksum);
  sum.add(basis.data() + kTable, sections * kRow);
  set(kChecksum, sum.value());
  return basis;
}

std::string reading_of(BadInputKind kind, const std::filesystem::path& file, const ReadingContext& context) {
  return read_or_refused(file, [&] { return read(kind, file, context); });
}

}  // namespace orbifit

#include "reading.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>

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
    case BadInputKind::manifest:
      return counted(static_cast<long long>(batch::Manifest::from_lines(file, batch::Shard{}).size()), "items");
  }
  throw std::logic_error("no such kind");
}

}  // namespace

ReadingContext::ReadingContext() {
  mesh = cube_of_bad_input();
  annotation = empty_annotation(mesh, 0.005);
  GroupFrame frame = GroupFrame::Identity();
  frame.col(2) = Eigen::Vector3d::UnitX();
  frame.col(0) = Eigen::Vector3d::UnitY();
  frame.col(1) = Eigen::Vector3d::UnitZ();
  annotation.regions.push_back(make_region(*PointGroup::parse("Cs"), Eigen::Vector3d::Zero(), frame,
                                           {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, "cube"));
  std::string folder = (std::filesystem::temp_directory_path() / "orbifit-reading-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw std::runtime_error("no temporary folder");
  const std::filesystem::path file = std::filesystem::path(folder) / "cube.basis";
  write_subspace(file, build_subspace(mesh, annotation, SubspaceOptions{}, RunContext{}), mesh, annotation);
  basis = read_file(file);
  std::filesystem::remove_all(folder);
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

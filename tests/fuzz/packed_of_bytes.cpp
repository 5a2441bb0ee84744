#include "packed_of_bytes.h"

#include <array>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "files/draco.h"
#include "files/gltf.h"
#include "model_reading.h"
#include "scratch_file.h"
#include "three_mf_package.h"

namespace orbifit {

void read_three_mf_of_bytes(std::span<const std::uint8_t> bytes) {
  static const std::filesystem::path file = scratch_file(".3mf");
  write_three_mf_of(file, std::string(bytes.begin(), bytes.end()));
  read_or_refused(file, [] { return model_reading(BadInputKind::mesh, file, Mesh()); });
  std::filesystem::remove(file);
}

void decode_draco_of_bytes(std::span<const std::uint8_t> bytes) {
  constexpr std::array<gltf::DracoRequest, 7> kRequests{{{0, gltf::kFloat, 3},
                                                         {1, gltf::kByte, 2},
                                                         {0, gltf::kUnsignedByte, 3},
                                                         {0, gltf::kShort, 3},
                                                         {1, gltf::kUnsignedShort, 4},
                                                         {0, gltf::kUnsignedInt, 1},
                                                         {77, gltf::kFloat, 3}}};
  constexpr std::array<std::size_t, 7> kRowSizes{12, 2, 3, 6, 8, 4, 12};  // bytes
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (std::size_t count = 0; count <= kRequests.size(); ++count) {
    gltf::DracoMesh mesh;
    try {
      mesh = gltf::decode_draco(text, std::span(kRequests).first(count));
    } catch (const gltf::DracoError&) {
      return;
    }
    for (const std::uint32_t corner : mesh.corners) {
      if (corner >= mesh.points) throw std::logic_error("a corner without a point was decoded");
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (mesh.attributes.at(i).size() != static_cast<std::size_t>(mesh.points) * kRowSizes.at(i)) {
        throw std::logic_error("an attribute of another size was decoded");
      }
    }
  }
}

}  // namespace orbifit

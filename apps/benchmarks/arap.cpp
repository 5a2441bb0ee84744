#include "arap.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "files/file.h"
#include "subject.h"

namespace orbifit::benchmarks {

namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "orbifit-benchmark-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw InputError(name, "", "cannot be created");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  fs::path file(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

nlohmann::json as_json(const Handle& handle) {
  nlohmann::json motion = nlohmann::json::array();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) motion.push_back(handle.motion.linear(i, j));
    motion.push_back(handle.motion.translation[i]);
  }
  return {{"vertices", handle.vertices}, {"motion", motion}};
}

std::string output_of(const std::string& command) {
  std::string output;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), count);
  ::pclose(pipe);
  return output;
}

}  // namespace

ArapTimes arap_times(const BenchmarkModel& model, int repetitions) {
  std::error_code code;
  const fs::path peer = fs::read_symlink("/proc/self/exe", code).parent_path() / "orbifit-benchmark-arap";
  if (!fs::exists(peer, code))
    return {{}, {}, "it is not built: build the target orbifit-benchmark-arap, which needs CGAL"};
  const TemporaryFolder folder;
  write_mesh(folder.file("mesh.ply"), model.mesh);
  nlohmann::json order{{"iterations", kIterations}, {"repetitions", repetitions}, {"handles", nlohmann::json::array()}};
  for (const Handle& handle : model.handles) order["handles"].push_back(as_json(handle));
  write_file(folder.file("order.json"), order.dump());
  const nlohmann::json result =
      nlohmann::json::parse(output_of("'" + peer.string() + "' '" + folder.file("mesh.ply").string() + "' '" +
                                      folder.file("order.json").string() + "'"),
                            nullptr, false);
  if (!result.is_object()) return {{}, {}, "it gave no result"};
  ArapTimes times;
  times.note = result.value("note", "");
  if (result.contains("prefactor_ms")) times.prefactor_ms = result["prefactor_ms"].get<double>();
  if (result.contains("solve5_ms")) times.solve5_ms = result["solve5_ms"].get<double>();
  return times;
}

}  // namespace orbifit::benchmarks

#include "command.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <unistd.h>

#include "orbifit/model/errors.h"
#include "orbifit/model/mesh_io.h"

#include "files/file.h"

namespace orbifit {

namespace fs = std::filesystem;

namespace {

// ".obj, .off or .ply", each without its first `skip` letters.
std::string alternatives(const std::vector<std::string>& endings, std::size_t skip = 0) {
  std::string list;
  for (std::size_t i = 0; i < endings.size(); ++i) {
    list += (i == 0 ? "" : i + 1 == endings.size() ? " or " : ", ") + endings[i].substr(skip);
  }
  return list;
}

}  // namespace

void check_output(const fs::path& output, const std::vector<std::string>& endings,
                  const std::vector<fs::path>& inputs) {
  if (output.empty()) throw UsageError("the output's name is empty");
  if (is_standard_stream(output)) {
    const std::string ending = lower_extension(output);
    // With one format there is nothing to choose.
    if (endings.empty() ||
        (ending.empty() ? endings.size() == 1 : std::ranges::find(endings, ending) != endings.end())) {
      return;
    }
    throw UsageError("standard output needs a format: --output-format must be " + alternatives(endings, 1));
  }
  std::error_code code;
  const fs::file_status status = fs::status(output, code);
  if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) return;  // such as /dev/stdout
  if (!endings.empty() && std::ranges::find(endings, lower_extension(output)) == endings.end()) {
    throw UsageError(output.string() + ": the ending must be " + alternatives(endings));
  }
  if (fs::is_directory(status)) throw InputError(output.string(), "", "cannot be written: it is a folder");
  for (const fs::path& input : inputs) {
    if (fs::equivalent(output, input, code)) {
      throw UsageError(output.string() + ": would overwrite the input " + input.string());
    }
  }
  const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, code)) {
    throw InputError(output.string(), "", "cannot be written: the folder " + folder.string() + " does not exist");
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    throw InputError(output.string(), "", "cannot be written: the folder " + folder.string() + " does not allow it");
  }
}

void write_with_look(const std::filesystem::path& output, const Mesh& mesh, const Appearance& look,
                     const RunContext& run) {
  for (const std::string& problem : look.warnings) run.message("warning: " + problem);
  for (const std::string& problem : write_mesh(output, mesh, look)) run.message("warning: " + problem);
}

void write_edited(const std::filesystem::path& output, const std::filesystem::path& source, const Mesh& edited,
                  const RunContext& run) {
  for (const std::string& problem : write_edited_mesh(output, source, edited)) run.message("warning: " + problem);
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directory(folder, code);
  if (!std::filesystem::is_directory(folder)) {
    throw InputError(folder.string(), "", "is no folder and cannot be made" + (code ? ": " + code.message() : ""));
  }
}

Eigen::Vector3d to_point(const std::string& option, const std::vector<double>& values) {
  const bool finite = std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  if (values.size() != 3 || !finite) throw UsageError(option + " must be three numbers");
  return Eigen::Vector3d(values.data());
}

Eigen::Vector3d to_direction(const std::string& option, const std::vector<double>& values) {
  const Eigen::Vector3d vector = to_point(option, values);
  if (!(vector.stableNorm() > 0)) throw UsageError(option + " must be three numbers, not all 0");
  return vector.stableNormalized();
}

std::string count_of(long long count, const std::string& singular, const std::string& plural) {
  return std::to_string(count) + " " + (count == 1 ? singular : plural.empty() ? singular + "s" : plural);
}

std::string short_number(double number, int digits) {
  std::array<char, 64> buffer;
  const int length = std::snprintf(buffer.data(), buffer.size(), "%.*g", digits, number == 0 ? 0.0 : number);
  return {buffer.data(), static_cast<std::size_t>(std::clamp(length, 0, 63))};
}

std::string percent(double fraction) {
  return short_number(fraction < 1e-12 ? 0 : 100 * fraction, 3) + " %";
}

std::string TextTable::text() const {
  std::vector<std::size_t> widths;
  std::vector<bool> numeric;
  for (const auto& row : rows_) {
    widths.resize(std::max(widths.size(), row.size()), 0);
    numeric.resize(widths.size(), true);
    for (std::size_t c = 0; c < row.size(); ++c) {
      widths[c] = std::max(widths[c], row[c].size());
      const bool number = !row[c].empty() && std::strchr("-0123456789", row[c].front()) != nullptr;
      if (&row != rows_.data() && !number) numeric[c] = false;
    }
  }
  std::string result;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string padding(widths[c] - row[c].size(), ' ');
      line += "  " + (numeric[c] ? padding + row[c] : row[c] + padding);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    result += line + "\n";
  }
  return result;
}

void require_region(const std::string& option, int id, const SymmetryAnnotation& annotation) {
  if (std::ranges::find(annotation.regions, id, &Region::id) != annotation.regions.end()) return;
  std::string ids;
  for (const Region& region : annotation.regions) {
    ids +=
        (ids.empty() ? "" : ", ") + std::to_string(region.id) + (region.name.empty() ? "" : " (" + region.name + ")");
  }
  throw UsageError(option + ": the annotation has no region " + std::to_string(id) +
                   (ids.empty() ? "; it has none" : "; there are " + ids));
}

void print(CommandContext& context, const std::string& text) {
  std::atomic_ref(context.printed).store(true);  // a StopGuard may ask
  if (context.json || (!context.quiet && !context.data_on_output)) return print(text);
  if (!context.quiet) std::fwrite(text.data(), 1, text.size(), stderr);
}

void print(const std::string& text) {
  if (::isatty(STDERR_FILENO) == 1) std::fputs("\r\033[K", stderr);  // a progress bar may stand there
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw InputError("standard output", "", "cannot be written");
  }
}

}  // namespace orbifit

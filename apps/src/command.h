#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "orbifit/model/annotation.h"
#include "orbifit/model/appearance.h"
#include "orbifit/model/mesh.h"
#include "orbifit/model/run_context.h"

namespace CLI {
class App;
}

namespace orbifit {

/// Exit codes of the program, for all commands.
enum ExitCode {
  kDone = 0,
  kNoResult = 1,  ///< a fit that did not converge, a check above its limit
  kUsage = 2,
  kBadInput = 3,
  kTimeout = 4,     ///< or the memory allowed is used up (--max-memory)
  kSomeFailed = 5,  ///< items of a batch
  kInterrupted = 130
};

/// What every command gets beside its own options.
struct CommandContext {
  RunContext run;               ///< seed, threads, deadline, interruption, progress
  bool json = false;            ///< print one JSON object on stdout and nothing else
  bool quiet = false;           ///< print nothing but errors
  bool data_on_output = false;  ///< standard output carries a file's content ("-")
  bool printed = false;         ///< the command has printed what it found
};

/// Runs a command whose options have been parsed; returns its exit code. Failures are exceptions (errors.h).
using CommandBody = std::function<int(CommandContext&)>;

/// One row of the program's table of commands.
struct Command {
  const char* name;
  const char* summary;   ///< one line
  const char* examples;  ///< whole command lines, one a line
  CommandBody (*define)(
      CLI::App& app);             ///< adds the command's own options to `app`; null where another program does it
  const char* program = nullptr;  ///< the other program's name
};

/// Refuses an output before the long computation instead of after it.
/// \param inputs files that must not be overwritten by something of another kind
/// \throw UsageError for an ending not among `endings` (empty: any) or an output that is one of the inputs,
///        InputError when the folder is missing or cannot be written to
void check_output(const std::filesystem::path& output, const std::vector<std::string>& endings = {},
                  const std::vector<std::filesystem::path>& inputs = {});

/// Writes a mesh with its look, as far as the format has it (appearance.h). What is missing or lost is told as
/// warnings.
void write_with_look(const std::filesystem::path& output, const Mesh& mesh, const Appearance& look,
                     const RunContext& run);

/// Writes an edited mesh and keeps what else its source holds: see write_edited_mesh(). What could not be kept is told
/// as warnings.
void write_edited(const std::filesystem::path& output, const std::filesystem::path& source, const Mesh& edited,
                  const RunContext& run);

/// Makes a folder for outputs where there is none. \throw InputError where that cannot be
void make_folder(const std::filesystem::path& folder);

/// \throw UsageError naming the option, the id and the ids that there are, where the annotation has no such region
void require_region(const std::string& option, int id, const SymmetryAnnotation& annotation);

/// "--up 0 0 1" as a unit vector. \throw UsageError unless three numbers that are not all 0
Eigen::Vector3d to_direction(const std::string& option, const std::vector<double>& values);

/// "--viewpoint 0 0 0" as a point. \throw UsageError unless three finite numbers
Eigen::Vector3d to_point(const std::string& option, const std::vector<double>& values);

/// "1 face", "2 faces"; the plural is the singular with an s unless given.
std::string count_of(long long count, const std::string& singular, const std::string& plural = "");

/// Short text of a number for people: `digits` significant ones.
std::string short_number(double number, int digits = 4);

/// "12.3 %" of a fraction of 0.123; rounding errors are 0 %.
std::string percent(double fraction);

/// A table for people: columns aligned, text to the left, numbers to the right.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  /// Every line indented by two; trailing blanks cut.
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// Prints what a command found: JSON as it is; text, unless all is to be quiet, on stdout, or on stderr where stdout
/// carries data. \throw InputError when it cannot be written
void print(CommandContext& context, const std::string& text);

/// Writes to stdout. \throw InputError when stdout cannot be written
void print(const std::string& text);

}  // namespace orbifit

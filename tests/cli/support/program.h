#pragma once

#include <chrono>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "temporary_folder.h"

namespace orbifit {

struct ProgramResult {
  int code = -1;  ///< exit code; 128 and more for the number of a signal that ended it
  std::string output, errors;
};

/// Runs the program in a folder of the test's own, where the tests' files lie.
class Program {
 public:
  explicit Program(std::string name = ORBIFIT_PROGRAM) : name_(std::move(name)) {}

  const TemporaryFolder& folder() const { return folder_; }

  ProgramResult run(const std::vector<std::string>& arguments) const { return finish(start(arguments)); }

  /// Interrupts the program as soon as it has installed its handler.
  ProgramResult run_and_interrupt(const std::vector<std::string>& arguments) const {
    const pid_t child = start(arguments);
    while (!catches(child, SIGINT)) std::this_thread::yield();
    ::kill(child, SIGINT);
    return finish(child);
  }

  /// Sends a signal once the program catches it and has used so much processor time, if it has not ended by then.
  ProgramResult run_and_signal(const std::string& line, int signal, double seconds_used) const {
    const pid_t child = start(words(line));
    while (!catches(child, signal) || (!ended(child) && processor_time(child) < seconds_used)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ::kill(child, signal);
    return finish(child);
  }

  /// Every word of a line is an argument.
  ProgramResult run(const std::string& line) const { return run(words(line)); }
  ProgramResult run_and_interrupt(const std::string& line) const { return run_and_interrupt(words(line)); }

 private:
  static std::vector<std::string> words(const std::string& line) {
    std::istringstream stream(line);
    std::vector<std::string> result;
    for (std::string word; stream >> word;) result.push_back(word);
    return result;
  }

  static std::string content(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  static bool catches(pid_t child, int signal) {
    const std::string status = content("/proc/" + std::to_string(child) + "/status");
    const std::size_t at = status.find("SigCgt:");
    // A zombie has no such line's bits left: stop waiting.
    if (at == std::string::npos || status.find("State:\tZ") != std::string::npos) return true;
    return (std::stoull(status.substr(at + 7), nullptr, 16) & (1ULL << (signal - 1))) != 0;
  }

  static bool ended(pid_t child) {
    return content("/proc/" + std::to_string(child) + "/status").find("State:\tZ") != std::string::npos;
  }

  // In seconds, all threads together.
  static double processor_time(pid_t child) {
    clockid_t clock{};
    timespec time{};
    if (::clock_getcpuclockid(child, &clock) != 0 || ::clock_gettime(clock, &time) != 0) return 0;
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }

  pid_t start(const std::vector<std::string>& arguments) const {
    std::string name = name_;
    std::vector<std::string> copies = arguments;
    std::vector<char*> pointers{name.data()};
    for (std::string& argument : copies) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    const std::string output = logs_.file("output").string();
    const std::string errors = logs_.file("errors").string();
    const pid_t child = ::fork();
    if (child != 0) return child;
    const int output_file = ::open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    const int errors_file = ::open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(output_file, STDOUT_FILENO);
    ::dup2(errors_file, STDERR_FILENO);
    if (::chdir(folder_.path().c_str()) == 0) ::execv(name.c_str(), pointers.data());
    ::_exit(127);
  }

  ProgramResult finish(pid_t child) const {
    int status = 0;
    ::waitpid(child, &status, 0);
    ProgramResult result;
    result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.output = content(logs_.file("output"));
    result.errors = content(logs_.file("errors"));
    return result;
  }

  std::string name_;
  TemporaryFolder folder_, logs_;
};

}  // namespace orbifit

#include "console.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include <unistd.h>

namespace orbifit {

namespace {

constexpr int kWidth = 30;  // of the bar, characters

void write_line(const std::string& line) {
  std::fwrite(line.data(), 1, line.size(), stderr);
  std::fflush(stderr);
}

}  // namespace

Console::Console(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}

Console::~Console() {
  clear_bar();
}

void Console::progress(std::string_view stage, double fraction) {
  if (quiet_ || !terminal_) return;
  const double part = std::clamp(fraction, 0.0, 1.0);
  const int filled = static_cast<int>(std::lround(part * kWidth));
  std::string line = std::string(stage) + " [" + std::string(static_cast<std::size_t>(filled), '#') +
                     std::string(static_cast<std::size_t>(kWidth - filled), '.') + "] " +
                     std::to_string(static_cast<int>(100 * part)) + " %";
  if (line == last_) return;
  write_line("\r\033[K" + line);
  last_ = std::move(line);
  bar_ = true;
}

void Console::message(std::string_view text) {
  if (quiet_) return;
  clear_bar();
  write_line("orbifit: " + std::string(text) + "\n");
}

void Console::error(std::string_view text) {
  clear_bar();
  std::string line(text);
  std::ranges::replace(line, '\n', ' ');
  write_line("orbifit: " + line + "\n");
}

void Console::clear_bar() {
  if (bar_) write_line("\r\033[K");
  bar_ = false;
  last_.clear();
}

}  // namespace orbifit

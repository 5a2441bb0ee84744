#pragma once

#include <string>
#include <string_view>

namespace orbifit {

/// What goes to stderr: notes, and a progress bar where stderr is a terminal.
class Console {
 public:
  explicit Console(bool quiet);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;
  Console(Console&&) = delete;
  Console& operator=(Console&&) = delete;

  void progress(std::string_view stage, double fraction);
  void message(std::string_view text);  ///< nothing when quiet
  void error(std::string_view text);    ///< always, as one line

 private:
  void clear_bar();

  bool quiet_;
  bool terminal_;
  bool bar_ = false;
  std::string last_;
};

}  // namespace orbifit

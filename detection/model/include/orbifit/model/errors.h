#pragma once

#include <stdexcept>
#include <string>

namespace orbifit {

/// Every failure that Orbifit reports on purpose; the program turns the derived type into its exit code.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A call or a command line that makes no sense: names the option, its value and the rule (exit code 2).
class UsageError : public Error {
 public:
  using Error::Error;
};

/// \throw UsageError "FIELD is VALUE; it must be RULE" where the rule does not hold
void require(bool holds, const std::string& field, double value, const std::string& rule);

/// A file, or a value in it, that cannot be used: what() reads "FILE: WHERE: REASON" (exit code 3).
class InputError : public Error {
 public:
  /// \param file   path as the user gave it; empty when the data did not come from a file
  /// \param where  "line 12", "vertex 7", "regions[0].elements[3]"; empty when the whole file is meant
  /// \param reason what is wrong, with the offending value and the rule
  InputError(const std::string& file, const std::string& where, const std::string& reason)
      : Error((file.empty() ? "" : file + ": ") + (where.empty() ? "" : where + ": ") + reason) {}
};

/// The computation ran and has no answer to give, such as a fit that did not converge (exit code 1).
class NoResultError : public Error {
 public:
  using Error::Error;
};

/// The deadline of the RunContext has passed (exit code 4).
class TimeoutError : public Error {
 public:
  using Error::Error;
};

/// The user interrupted the run (exit code 130).
class InterruptedError : public Error {
 public:
  using Error::Error;
};

}  // namespace orbifit

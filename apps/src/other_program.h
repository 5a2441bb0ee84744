#pragma once

#include <string>

namespace orbifit {

/// Becomes another program, which has this one's process, streams and folder: the one that stands beside this program,
/// or else the first in PATH. \param name  of its file \param arguments  what follows the name, ended by a null pointer
/// \return only where there is no such program or it cannot be started, which is then said on stderr: kNoResult
int become_program(const std::string& name, char* const* arguments);

}  // namespace orbifit

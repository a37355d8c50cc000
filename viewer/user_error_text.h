#pragma once
// Error messages for users, without names of C++ types or functions. A free function.

#include <exception>
#include <string>

namespace collidoscope {

/// One or more lines. InputError, MachineError and OutOfMemory already hold such text. Standard library
/// errors become "Cannot use FILE: REASON" or the operating system's reason. Any other error is an internal
/// error.
std::string plain_text(const std::exception& error);

}  // namespace collidoscope

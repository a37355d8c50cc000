#pragma once
// The text of an error for people: no names of C++ types or functions. A free function.

#include <exception>
#include <string>

namespace collidoscope {

/// One or more lines. InputError, MachineError and OutOfMemory already hold such text. Errors of the standard
/// library become "Cannot use FILE: REASON", or the operating system's reason; anything else is named an
/// internal error.
std::string plain_text(const std::exception& error);

}  // namespace collidoscope

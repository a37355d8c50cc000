#pragma once
// OpenGL errors, caught in every build: the driver reports them at the call (KHR_debug, synchronous), and
// check() turns the first one since the last check into a MachineError that says what was being done.

#include <string>

namespace collidoscope::gl {

/// Makes the current context report; once per context, right after it was made. Throws MachineError if the
/// context is not OpenGL 4.5 core or later.
void watch_errors();

/// Throws MachineError "OpenGL refused <what>: <the driver's words>" if a call failed since the last check.
void check(const std::string& what);

/// Drops what is pending: for a caller who reports the fault in better words.
void forget_errors();

/// GL_RENDERER and GL_VERSION of the current context.
std::string renderer_name();
std::string version_name();
/// Whether that renderer draws on the CPU (llvmpipe, softpipe, swrast).
bool is_software_renderer();

}  // namespace collidoscope::gl

#pragma once
// OpenGL error handling in all builds. The driver reports errors at the call (KHR_debug, synchronous).
// check() throws the first one since the last check as a MachineError with the current operation.

#include <string>

namespace collidoscope::gl {

/// Enables error reports for the current context. Call once, after the context is created. Throws
/// MachineError if the context is older than OpenGL 4.5 core.
void watch_errors();

/// Throws MachineError "OpenGL: cannot <what>: <driver message>" if a call failed since the last check.
void check(const std::string& what);

/// Discards pending errors, for callers that report the error themselves.
void forget_errors();

/// GL_RENDERER and GL_VERSION of the current context.
std::string renderer_name();
std::string version_name();
/// Whether the renderer runs on the CPU (llvmpipe, softpipe, swrast).
bool is_software_renderer();

}  // namespace collidoscope::gl

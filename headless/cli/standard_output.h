#pragma once
// stdout, with every write checked. All results go through here. Free functions.

#include <string_view>

namespace collidoscope {

/// Throws MachineError, `stdout: writing failed: ...`, where the system refuses the text (a full disk, a
/// closed stdout). The text may wait in a buffer.
void print(std::string_view text);
/// Writes what waits in the buffer. Throws the same.
void flush_stdout();

}  // namespace collidoscope

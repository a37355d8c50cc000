#pragma once
// A file that a flag asks for, whole or as it was (atomic_file.h). Made before a simulation starts, so that a
// target that cannot be written is refused before hours are spent; the temporary file exists only from the
// first write() to commit() or the destructor.

#include <optional>
#include <string>
#include <string_view>

#include "sim_cuda/core/atomic_file.h"

namespace collidoscope {

class OutputFile {
 public:
  /// Tries a file beside the target, and removes it. Throws InputError, a line that begins with `flag`.
  OutputFile(std::string flag, const std::string& target);

  /// Throws MachineError (a full disk) with the operating system's words.
  void write(std::string_view text);
  /// Puts the file in its place. Once, last.
  void commit();
  /// As AtomicFile::commit_new() does it.
  bool commit_new(const std::string& target);

 private:
  /// Does it with the file, and names the flag in what it throws.
  template <class Work>
  void with_file(const Work& work);

  std::string flag_, target_;
  std::optional<AtomicFile> file_;
};

/// A folder that a flag names: makes it and tries a file in it. Call it before anything is simulated. Throws
/// InputError, a line that begins with `flag`.
void ensure_writable_folder(const std::string& flag, const std::string& folder);

}  // namespace collidoscope

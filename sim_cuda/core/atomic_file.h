#pragma once
// A file that is whole or as it was, whenever the program or the machine ends: written under a temporary name
// beside its target, brought to the disk, and only then renamed.

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim_cuda/core/error.h"

namespace collidoscope {

/// "FILE cannot be written: WHY"
struct FileWriteError : MachineError {
  FileWriteError(const std::string& file, const std::string& reason)
      : MachineError(file + " cannot be written: " + reason), why(reason) {}
  std::string why;  ///< in the operating system's words
};

/// For as long as one file is written. Owns the temporary file and a lock on it (flock), by which a program
/// that writes the same target sees that it must take another; one that a killed program left has no lock,
/// and is taken over. remove_temporary_files() knows it.
class AtomicFile {
 public:
  /// Opens the temporary file, `target` with ".collidoscope-0.part" behind it. Links are followed: a link
  /// stays one, and what it names is replaced. A target that is no regular file (/dev/null, a pipe) is
  /// written in place. Throws FileWriteError, as all members do (a full disk).
  explicit AtomicFile(const std::string& target);
  /// Without commit() the target is as it was.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// For libraries that write to one.
  std::FILE* stream() { return stream_; }
  void write(std::string_view bytes);
  /// Puts the file in its place. Once, last.
  void commit();
  /// The same under the name `target`, in the same folder. If a file has that name, returns false and changes
  /// nothing.
  bool commit_new(const std::string& target);
  /// Throws, with `why` or the operating system's last words.
  [[noreturn]] void fail(const std::string& why = "") const;

 private:
  void follow_links();
  void open_temporary();
  bool put(const std::filesystem::path& target, unsigned flags = 0);
  bool in_place() const { return temporary_.empty(); }

  friend void remove_temporary_files() noexcept;

  std::string name_;  ///< as it was given
  std::filesystem::path target_, temporary_;
  std::FILE* stream_ = nullptr;
  AtomicFile* next_ = nullptr;  ///< in the list of the files that have a temporary one
};

/// Deletes the temporary files of this process. For signal handlers: async-signal-safe. The process must end
/// afterwards: the next call that opens or commits a file does not return.
void remove_temporary_files() noexcept;

/// Makes a folder and all above it. Throws MachineError: "Cannot create folder FOLDER: REASON".
void make_folder(const std::string& folder);

/// Writes `text` so; makes the folder. Throws FileWriteError.
void write_file_atomically(const std::string& file, const std::string& text);

}  // namespace collidoscope

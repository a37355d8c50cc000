#pragma once
// Atomic file replacement. The data is written to a temporary file beside the target, flushed to disk, and
// renamed. After a crash or power loss the target is either complete or unchanged.

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "sim_cuda/core/error.h"

namespace collidoscope {

/// Message: "FILE cannot be written: WHY".
struct FileWriteError : MachineError {
  FileWriteError(const std::string& file, const std::string& reason)
      : MachineError(file + " cannot be written: " + reason), why(reason) {}
  std::string why;  ///< reason, as the operating system states it
};

/// Writes one file. Owns the temporary file and an exclusive lock on it (flock). A process that finds the
/// file locked uses another temporary name. A file left by a killed process has no lock and is reused.
/// remove_temporary_files() deletes the file.
class AtomicFile {
 public:
  /// Opens the temporary file: `target` with the suffix ".collidoscope-0.part". Symbolic links are followed:
  /// the link stays, and its destination is replaced. A target that is not a regular file (/dev/null, a pipe)
  /// is written in place. All members throw FileWriteError, for example if the disk is full.
  explicit AtomicFile(const std::string& target);
  /// Without commit() the target stays unchanged.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// For libraries that write to a FILE.
  std::FILE* stream() { return stream_; }
  void write(std::string_view bytes);
  /// Flushes the file and renames it to the target. Call once, as the last operation.
  void commit();
  /// Commits under the name `target`, which must be in the same folder. Returns false and changes nothing if
  /// a file of that name exists.
  bool commit_new(const std::string& target);
  /// Throws FileWriteError with `why`, or with the text of errno if `why` is empty.
  [[noreturn]] void fail(const std::string& why = "") const;

 private:
  void follow_links();
  void open_temporary();
  bool put(const std::filesystem::path& target, unsigned flags = 0);
  bool in_place() const { return temporary_.empty(); }

  friend void remove_temporary_files() noexcept;

  std::string name_;  ///< as given to the constructor
  std::filesystem::path target_, temporary_;
  std::FILE* stream_ = nullptr;
  AtomicFile* next_ = nullptr;  ///< linked list of the objects with a temporary file
};

/// Deletes the temporary files of this process. Async-signal-safe, for signal handlers. The process must end
/// afterwards: the next call that opens or commits a file does not return.
void remove_temporary_files() noexcept;

/// Creates a folder and its parents. Throws MachineError: "Cannot create folder FOLDER: REASON".
void make_folder(const std::string& folder);

/// Writes `text` with an AtomicFile, after creating the folder. Throws FileWriteError.
void write_file_atomically(const std::string& file, const std::string& text);

}  // namespace collidoscope

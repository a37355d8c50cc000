#pragma once
// A file that is whole or as it was: written under a temporary name beside its target and renamed by
// commit(). Made before a simulation starts, so that a target that cannot be written is refused before
// hours are spent; the temporary file exists only from the first write() to commit() or the destructor.

#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace collidoscope {

class OutputFile {
 public:
  /// Tries a file beside the target, and removes it. An existing target that is no regular file (/dev/null, a
  /// pipe) is written in place. Throws InputError, a line that begins with `flag`.
  OutputFile(std::string flag, const std::string& target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws MachineError (a full disk) with the operating system's words.
  void write(std::string_view text);
  /// Puts the file in its place. Once, last.
  void commit();

 private:
  void open();
  void close();

  std::string flag_;
  std::filesystem::path target_;     ///< links resolved: a link stays one, and what it names is replaced
  std::filesystem::path temporary_;  ///< the target itself where it is written in place
  std::FILE* file_ = nullptr;
};

}  // namespace collidoscope

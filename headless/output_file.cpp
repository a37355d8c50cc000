#include "headless/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "headless/flag_value.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {

namespace fs = std::filesystem;

OutputFile::OutputFile(std::string flag, const std::string& target)
    : flag_(std::move(flag)), target_(target) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(
        fmt::format("{}: {} cannot be written: {}; give a file in a folder that exists and can be written",
                    flag_, shown(target), why));
  };
  std::error_code failed;
  if (fs::is_symlink(target_, failed)) {
    const fs::path resolved = fs::weakly_canonical(target_, failed);
    if (!failed) target_ = resolved;
  }
  const fs::file_status status = fs::status(target_, failed);
  if (fs::is_directory(status)) refuse("it is a folder");
  if (target_.filename().empty()) refuse("it is no name of a file");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    temporary_ = target_;
    if (access(target_.c_str(), W_OK) != 0) refuse(std::strerror(errno));
    return;
  }
  // The process id keeps two runs that write the same target apart.
  temporary_ = target_;
  temporary_ += fmt::format(".{}.part", getpid());
  const int probe = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (probe < 0) refuse(std::strerror(errno));
  ::close(probe);
  unlink(temporary_.c_str());
}

OutputFile::~OutputFile() {
  if (!file_) return;
  std::fclose(file_);
  if (temporary_ != target_) unlink(temporary_.c_str());
}

void OutputFile::write(std::string_view text) {
  if (!file_) open();
  if (std::fwrite(text.data(), 1, text.size(), file_) != text.size())
    throw MachineError(
        fmt::format("{}: writing {} failed: {}", flag_, target_.string(), std::strerror(errno)));
}

void OutputFile::commit() {
  if (!file_) open();
  close();
  if (temporary_ != target_ && std::rename(temporary_.c_str(), target_.c_str()) != 0) {
    const std::string why = std::strerror(errno);
    unlink(temporary_.c_str());
    throw MachineError(fmt::format("{}: {} cannot be put in place: {}", flag_, target_.string(), why));
  }
}

void OutputFile::open() {
  file_ = std::fopen(temporary_.c_str(), "we");
  if (!file_)
    throw MachineError(
        fmt::format("{}: {} cannot be opened: {}", flag_, temporary_.string(), std::strerror(errno)));
}

void OutputFile::close() {
  const bool written = std::fflush(file_) == 0;
  const int why = errno;
  const bool closed = std::fclose(file_) == 0;
  file_ = nullptr;
  if (written && closed) return;
  if (temporary_ != target_) unlink(temporary_.c_str());
  throw MachineError(fmt::format("{}: writing {} failed: {}", flag_, target_.string(),
                                 std::strerror(written ? errno : why)));
}

}  // namespace collidoscope

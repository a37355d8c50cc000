#include "headless/cli/output_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "headless/cli/flag_value.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {

namespace fs = std::filesystem;

OutputFile::OutputFile(std::string flag, const std::string& target)
    : flag_(std::move(flag)), target_(target) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(
        fmt::format("{}: {} cannot be written: {}; expected a file in an existing writable folder", flag_,
                    shown(target), why));
  };
  std::error_code failed;
  const fs::file_status status = fs::status(target_, failed);
  if (fs::is_directory(status)) refuse("it is a folder");
  if (fs::path(target_).filename().empty()) refuse("it is not a file name");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    if (access(target_.c_str(), W_OK) != 0) refuse(std::strerror(errno));
    return;
  }
  try {
    AtomicFile probe(target_);
  } catch (const FileWriteError& error) {
    refuse(error.why);
  }
}

template <class Work>
void OutputFile::with_file(const Work& work) {
  try {
    if (!file_) file_.emplace(target_);
    work(*file_);
  } catch (const FileWriteError& error) {
    throw MachineError(flag_ + ": " + error.what());
  }
}

void OutputFile::write(std::string_view text) {
  with_file([&](AtomicFile& file) { file.write(text); });
}

void OutputFile::commit() {
  with_file([](AtomicFile& file) { file.commit(); });
  file_.reset();
}

bool OutputFile::commit_new(const std::string& target) {
  bool put = false;
  with_file([&](AtomicFile& file) { put = file.commit_new(target); });
  if (put) file_.reset();
  return put;
}

void ensure_writable_folder(const std::string& flag, const std::string& folder) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("{}: {}; expected a writable folder", flag, why));
  };
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed || !fs::is_directory(folder, failed))
    refuse(fmt::format("{} cannot be created: {}", shown(folder),
                       failed ? failed.message() : "a file of this name exists"));
  try {
    AtomicFile probe((fs::path(folder) / "trial").string());
  } catch (const FileWriteError& error) {
    refuse(fmt::format("{} cannot be written: {}", shown(folder), error.why));
  }
}

}  // namespace collidoscope

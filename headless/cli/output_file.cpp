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
        fmt::format("{}: {} cannot be written: {}; give a file in a folder that exists and can be written",
                    flag_, shown(target), why));
  };
  std::error_code failed;
  const fs::file_status status = fs::status(target_, failed);
  if (fs::is_directory(status)) refuse("it is a folder");
  if (fs::path(target_).filename().empty()) refuse("it is no name of a file");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    if (access(target_.c_str(), W_OK) != 0) refuse(std::strerror(errno));
    return;
  }
  try {
    WholeFile probe(target_);
  } catch (const NotWritten& error) {
    refuse(error.why);
  }
}

template <class Work>
void OutputFile::with_file(const Work& work) {
  try {
    if (!file_) file_.emplace(target_);
    work(*file_);
  } catch (const NotWritten& error) {
    throw MachineError(flag_ + ": " + error.what());
  }
}

void OutputFile::write(std::string_view text) {
  with_file([&](WholeFile& file) { file.write(text); });
}

void OutputFile::commit() {
  with_file([](WholeFile& file) { file.commit(); });
  file_.reset();
}

bool OutputFile::commit_new(const std::string& target) {
  bool put = false;
  with_file([&](WholeFile& file) { put = file.commit_new(target); });
  if (put) file_.reset();
  return put;
}

void ensure_writable_folder(const std::string& flag, const std::string& folder) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(fmt::format("{}: {}; give a folder that can be written", flag, why));
  };
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed || !fs::is_directory(folder, failed))
    refuse(fmt::format("{} cannot be made: {}", shown(folder),
                       failed ? failed.message() : "a file of this name is in the way"));
  try {
    WholeFile probe((fs::path(folder) / "trial").string());
  } catch (const NotWritten& error) {
    refuse(fmt::format("{} cannot be written: {}", shown(folder), error.why));
  }
}

}  // namespace collidoscope

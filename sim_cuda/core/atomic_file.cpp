#include "sim_cuda/core/atomic_file.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

namespace collidoscope {
namespace {

namespace fs = std::filesystem;

/// Whether `name` still refers to the file that is open as `handle`.
bool is_named(int handle, const fs::path& name) {
  struct stat of_handle {
  }, of_name{};
  return ::fstat(handle, &of_handle) == 0 && ::lstat(name.c_str(), &of_name) == 0 &&
         of_handle.st_ino == of_name.st_ino && of_handle.st_dev == of_name.st_dev;
}

std::atomic_flag list_locked = ATOMIC_FLAG_INIT;
AtomicFile* open_files = nullptr;  ///< objects with a temporary file; guarded by list_locked

bool try_lock_list() { return !list_locked.test_and_set(std::memory_order_acquire); }

/// Locks the list of open files and blocks all signals of this thread. A signal handler can therefore not
/// wait for a lock that its own thread holds.
class ListLock {
 public:
  ListLock() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &signals_before_);
    while (!try_lock_list()) ::sched_yield();
  }
  ~ListLock() {
    list_locked.clear(std::memory_order_release);
    ::pthread_sigmask(SIG_SETMASK, &signals_before_, nullptr);
  }
  ListLock(const ListLock&) = delete;
  ListLock& operator=(const ListLock&) = delete;

 private:
  sigset_t signals_before_;
};

void remove_from_list(const AtomicFile* file, AtomicFile* AtomicFile::*next) {
  AtomicFile** link = &open_files;
  while (*link != nullptr && *link != file) link = &((*link)->*next);
  if (*link != nullptr) *link = file->*next;
}

}  // namespace

void remove_temporary_files() noexcept {
  for (int waited_ms = 0; !try_lock_list(); ++waited_ms) {  // never unlocked
    if (waited_ms == 1000) return;  // std::terminate() may be called while the lock is held
    constexpr timespec millisecond{0, 1'000'000};
    ::nanosleep(&millisecond, nullptr);
  }
  for (const AtomicFile* file = open_files; file != nullptr; file = file->next_)
    ::unlink(file->temporary_.c_str());
}

AtomicFile::AtomicFile(const std::string& target) : name_(target), target_(target) {
  follow_links();
  std::error_code failed;
  const fs::file_status status = fs::status(target_, failed);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    stream_ = std::fopen(target_.c_str(), "we");
    if (stream_ == nullptr) fail();
    return;
  }
  open_temporary();
}

void AtomicFile::follow_links() {
  constexpr int max_links = 40;  // limit of the operating system
  std::error_code failed;
  if (fs::exists(target_, failed)) {
    if (!fs::is_symlink(target_, failed)) return;
    const fs::path resolved = fs::canonical(target_, failed);
    if (!failed) target_ = resolved;
    return;
  }
  // The target is a link to a file that does not exist yet.
  for (int links = 0; fs::is_symlink(target_, failed); ++links) {
    if (links == max_links) fail(std::strerror(ELOOP));
    const fs::path next = fs::read_symlink(target_, failed);
    if (failed) fail(failed.message());
    target_ = target_.parent_path() / next;
  }
}

/// Opens the first temporary file that is not locked: a new one, or one left by a killed process.
void AtomicFile::open_temporary() {
  const ListLock list;
  for (int k = 0; stream_ == nullptr;) {
    temporary_ = target_;
    temporary_ += ".collidoscope-" + std::to_string(k) + ".part";
    const int handle = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (handle < 0) fail();
    if (::flock(handle, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(handle);
      ++k;
      continue;
    }
    // The previous owner may have renamed the file before this process locked it.
    if (!is_named(handle, temporary_)) {
      ::close(handle);
      continue;
    }
    if (::ftruncate(handle, 0) == 0) stream_ = ::fdopen(handle, "w");
    if (stream_ != nullptr) {
      next_ = std::exchange(open_files, this);
      return;
    }
    const std::string why = std::strerror(errno);
    ::unlink(temporary_.c_str());
    ::close(handle);
    fail(why);
  }
}

AtomicFile::~AtomicFile() {
  if (stream_ == nullptr) return;
  if (!in_place()) {
    const ListLock list;
    ::unlink(temporary_.c_str());
    remove_from_list(this, &AtomicFile::next_);
  }
  std::fclose(stream_);
}

void AtomicFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) fail();
}

void AtomicFile::commit() { put(target_); }

bool AtomicFile::commit_new(const std::string& target) { return put(target, RENAME_NOREPLACE); }

bool AtomicFile::put(const fs::path& target, unsigned flags) {
  errno = 0;
  if (std::ferror(stream_) || std::fflush(stream_) != 0) fail();
  if (!in_place()) {
    // Without this, a file system may rename before it writes the data; a power loss then leaves an empty
    // file.
    if (::fsync(fileno(stream_)) != 0 && errno != EINVAL) fail();
    const ListLock list;
    int moved = ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, target.c_str(), flags);
    if (moved != 0 && flags == RENAME_NOREPLACE && errno == EEXIST) return false;
    // Some file systems and kernels do not support the flags.
    if (moved != 0 && (errno == EINVAL || errno == ENOSYS))
      moved = std::rename(temporary_.c_str(), target.c_str());
    if (moved != 0) fail();
    remove_from_list(this, &AtomicFile::next_);
    temporary_.clear();
  }
  std::FILE* const closed = std::exchange(stream_, nullptr);
  if (std::fclose(closed) != 0) fail();
  return true;
}

void AtomicFile::fail(const std::string& why) const {
  const int code = errno;
  throw FileWriteError(name_, !why.empty() ? why : code != 0 ? std::strerror(code) : "unknown error");
}

namespace {

/// Creates `folder`. Returns an empty text, or the reason of the failure.
std::string folder_error(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  std::error_code unknown;
  if (fs::is_directory(folder, unknown)) return "";
  if (fs::exists(folder, unknown)) return "a file with this name exists";
  return failed ? failed.message() : "unknown error";
}

}  // namespace

void make_folder(const std::string& folder) {
  const std::string error = folder_error(folder);
  if (!error.empty()) throw MachineError("Cannot create folder " + folder + ": " + error);
}

void write_file_atomically(const std::string& file, const std::string& text) {
  const fs::path folder = fs::path(file).parent_path();
  const std::string error = folder.empty() ? "" : folder_error(folder);
  if (!error.empty()) throw FileWriteError(file, "cannot create folder " + folder.string() + ": " + error);
  AtomicFile out(file);
  out.write(text);
  out.commit();
}

}  // namespace collidoscope

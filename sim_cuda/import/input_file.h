#pragma once
// A file of a foreign program: opened once, read in parts. Its size is known before memory is taken.

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace collidoscope {

/// A regular file. Owns its descriptor.
class InputFile {
 public:
  /// `wanted` completes "give the path of": "a NumPy file (.npy)". Throws InputError: `NAME: problem`.
  InputFile(const std::string& name, const std::string& wanted);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& name() const { return name_; }
  std::size_t bytes() const { return bytes_; }
  /// Reads up to `bytes` bytes from `offset`. Returns their number: less if the file became shorter, or
  /// cannot be read. Any thread.
  std::size_t read(std::size_t offset, void* to, std::size_t bytes) const;

 private:
  std::string name_;
  int file_ = -1;
  std::size_t bytes_ = 0;
};

/// The contents of a file.
class FileText {
 public:
  /// Reads with several threads. Throws InputError.
  explicit FileText(const InputFile& file);
  std::string_view text() const { return {bytes_.get(), size_}; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t size_ = 0;
};

/// Calls work(first, last) on disjoint ranges that cover [0, count), on several threads if `count` exceeds
/// `grain`. Returns after all calls have returned. `work` must not throw.
template <class Work>
void on_all_cores(std::size_t count, std::size_t grain, const Work& work);

namespace detail {
void share_among_cores(std::size_t count, std::size_t grain,
                       void (*work)(const void* context, std::size_t first, std::size_t last),
                       const void* context);
}  // namespace detail

template <class Work>
void on_all_cores(std::size_t count, std::size_t grain, const Work& work) {
  detail::share_among_cores(
      count, grain,
      [](const void* context, std::size_t first, std::size_t last) {
        (*static_cast<const Work*>(context))(first, last);
      },
      &work);
}

}  // namespace collidoscope

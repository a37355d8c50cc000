#pragma once
// The machine code of a compiled CUDA file: what two builds of it are compared by. Reads the cubins (ELF, of
// the machine EM_CUDA) inside of an object file whose device code is not compressed (nvcc --no-compress).

#include <filesystem>
#include <map>
#include <string>

namespace collidoscope {

struct KernelCode {
  std::string code;          ///< the bytes of its .text section
  int registers = 0;         ///< of a thread
  std::size_t constant = 0;  ///< bytes of its constant bank, which holds its parameters
  friend bool operator==(const KernelCode&, const KernelCode&) = default;
};

/// Kernels by mangled name, without what nvcc makes of a file's own namespace, which differs from compilation
/// to compilation. Throws InputError where the file cannot be read, or holds no machine code.
std::map<std::string, KernelCode> kernels_of(const std::filesystem::path& object);

}  // namespace collidoscope

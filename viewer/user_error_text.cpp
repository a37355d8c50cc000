#include "viewer/user_error_text.h"

#include <filesystem>
#include <new>
#include <system_error>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"

namespace collidoscope {

std::string plain_text(const std::exception& error) {
  if (const auto* out_of_memory = dynamic_cast<const OutOfMemory*>(&error))
    return std::string("out of memory while ") + out_of_memory->what() + "; use fewer bodies";
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr)
    return "out of memory: an allocation failed; use fewer bodies";
  if (const auto* large = dynamic_cast<const TooLarge*>(&error)) return large->plain();
  if (dynamic_cast<const InputError*>(&error) != nullptr ||
      dynamic_cast<const MachineError*>(&error) != nullptr)
    return error.what();
  if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return "Cannot use " + file->path1().string() + ": " + file->code().message();
  if (const auto* system = dynamic_cast<const std::system_error*>(&error))
    return "System error: " + system->code().message();
  return std::string("Internal error: ") + error.what();
}

}  // namespace collidoscope

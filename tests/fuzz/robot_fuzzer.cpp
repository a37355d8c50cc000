#include <cstddef>
#include <cstdint>

#include "tests/fuzz/reader_checks.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  collidoscope::check_robot({reinterpret_cast<const char*>(data), size});
  return 0;
}

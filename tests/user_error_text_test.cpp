// Tests the error texts in the window: they contain no C++ terms.

#include "viewer/user_error_text.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <new>
#include <stdexcept>
#include <system_error>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"

namespace collidoscope {
namespace {

TEST(PlainError, HasNoWordsOfCpp) {
  EXPECT_EQ(plain_text(InputError("a.json:1:2: what, and what would be right")),
            "a.json:1:2: what, and what would be right");
  EXPECT_EQ(plain_text(MachineError("no GPU")), "no GPU");
  EXPECT_EQ(plain_text(TooLarge("use --allow-large", "use fewer bodies")), "use fewer bodies");
  EXPECT_EQ(plain_text(OutOfMemory("computing a step")),
            "out of memory while computing a step; use fewer bodies");
  EXPECT_EQ(plain_text(std::bad_alloc()), "out of memory: an allocation failed; use fewer bodies");
  const auto denied = std::make_error_code(std::errc::permission_denied);
  EXPECT_EQ(plain_text(std::filesystem::filesystem_error("cannot create directories", "captures", denied)),
            "Cannot use captures: Permission denied");
  EXPECT_EQ(plain_text(std::system_error(denied, "thread::thread")), "System error: Permission denied");
  EXPECT_EQ(plain_text(std::logic_error("no such row")), "Internal error: no such row");
}

}  // namespace
}  // namespace collidoscope

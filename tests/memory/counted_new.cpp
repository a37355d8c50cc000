#include "tests/memory/counted_new.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

namespace collidoscope {
namespace {

constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max() / 2;

std::atomic<std::int64_t> live{0}, peak{0}, asked{0}, granted_yet{never};
std::atomic<bool> for_good{false};

bool may_be_taken() {
  asked.fetch_add(1, std::memory_order_relaxed);
  const std::int64_t left = granted_yet.fetch_sub(1, std::memory_order_relaxed);
  return left > 0 || (left < 0 && !for_good.load(std::memory_order_relaxed));
}

void* counted(void* memory) {
  if (memory == nullptr) return nullptr;
  const auto bytes = static_cast<std::int64_t>(malloc_usable_size(memory));
  const std::int64_t now = live.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  for (std::int64_t most = peak.load(std::memory_order_relaxed); now > most;)
    if (peak.compare_exchange_weak(most, now, std::memory_order_relaxed)) break;
  return memory;
}

void* take(std::size_t bytes) {
  return may_be_taken() ? counted(std::malloc(bytes > 0 ? bytes : 1)) : nullptr;
}

void* take(std::size_t bytes, std::align_val_t alignment) {
  void* memory = nullptr;
  if (!may_be_taken() ||
      posix_memalign(&memory, static_cast<std::size_t>(alignment), bytes > 0 ? bytes : 1) != 0)
    return nullptr;
  return counted(memory);
}

void give_back(void* memory) {
  if (memory == nullptr) return;
  live.fetch_sub(static_cast<std::int64_t>(malloc_usable_size(memory)), std::memory_order_relaxed);
  std::free(memory);
}

}  // namespace

CountedNew counted_new() { return {live, peak, asked}; }
void forget_peak() { peak = live.load(); }

RefusedNew::RefusedNew(std::int64_t granted, Refusal refusal) {
  for_good = refusal == Refusal::from_then_on;
  granted_yet = granted;
}
RefusedNew::~RefusedNew() { granted_yet = never; }
bool RefusedNew::refused() const { return granted_yet < 0; }

}  // namespace collidoscope

void* operator new(std::size_t bytes) {
  if (void* memory = collidoscope::take(bytes)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  if (void* memory = collidoscope::take(bytes, alignment)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept { return collidoscope::take(bytes); }
void* operator new(std::size_t bytes, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return collidoscope::take(bytes, alignment);
}
void operator delete(void* memory) noexcept { collidoscope::give_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { collidoscope::give_back(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { collidoscope::give_back(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  collidoscope::give_back(memory);
}

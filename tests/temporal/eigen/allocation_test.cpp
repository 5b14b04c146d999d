// Replaces the allocation functions of this test program by ones that can look.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

#include "temporal/methods.h"
#include "tests/support/analytic_source.h"

namespace {

std::atomic<bool> watching = false;
std::atomic<std::size_t> largest = 0;

void* allocate(std::size_t size, std::size_t alignment) {
  if (watching) {
    std::size_t seen = largest;
    while (size > seen && !largest.compare_exchange_weak(seen, size)) {
    }
  }
  const std::size_t rounded = (std::max<std::size_t>(size, 1) + alignment - 1) / alignment;
  void* memory = std::aligned_alloc(alignment, rounded * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

// Not inline, or GCC sees free() meet what it takes for another's new.
[[gnu::noinline]] void release(void* memory) { std::free(memory); }

}  // namespace

void* operator new(std::size_t size) { return allocate(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

namespace eigenlight {
namespace {

std::size_t largest_allocation_of_later_frames(std::string_view method) {
  AnalyticOptions options{.extent = {191, 107}, .frames = 8};
  options.slide = {0.7f, 0.3f};
  AnalyticSource source(options);
  const auto denoiser = make_denoiser(method, {options.extent, 3});
  for (int i = 0; i < 2; ++i) EXPECT_NE(denoiser->step(source), nullptr);
  largest = 0;
  watching = true;
  while (denoiser->step(source) != nullptr) {
  }
  watching = false;
  return largest;
}

// The threading library may take small blocks; 4 kB are less than a twentieth of one plane here.
TEST(Allocation, LaterFramesTakeNoPlanes) {
  EXPECT_LT(largest_allocation_of_later_frames("eigenlight"), 4096u);
}

TEST(Allocation, IsSeenByThisTest) {
  watching = true;
  largest = 0;
  const Plane<float> plane({191, 107});
  watching = false;
  EXPECT_GE(largest.load(), plane.storage().size_bytes());
}

}  // namespace
}  // namespace eigenlight

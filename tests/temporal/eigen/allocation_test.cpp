// Frames allocate no planes. Replaces the allocation functions of this test program by ones that
// record the largest request.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>

#include "frame/float_traps.h"
#include "frame/tiles.h"
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

// Not inline, because GCC would warn that free() releases memory of operator new.
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

// A lamp whose light moves over the plane: no gain explains it, so bases are born.
AnalyticOptions sweeping() {
  AnalyticOptions options{.extent = {191, 107}, .frames = 40};
  options.slide = {0.7f, 0.3f};
  options.light = [](glm::vec2 at, int frame) {
    return 1.0f + 0.8f * std::sin(0.1f * at.x + 0.4f * static_cast<float>(frame));
  };
  return options;
}

struct Allocations {
  std::size_t largest = 0;
  double largest_rank = 0.0;  // bases in use per tile
};

// Of all frames but the first two. The guided filter allocates the scratch memory of a thread when
// the thread first filters, so there is one thread, and an invalid pixel makes it filter in frame
// 0.
Allocations allocations_of_later_frames(AnalyticOptions options) {
  const FloatTrapsOff nan_is_meant;
  set_thread_count(1);
  options.edit = [](Frame& frame) {
    if (frame.index == 0) frame.lights[0].radiance[0](5, 5) = NAN;
  };
  AnalyticSource source(options);
  const auto denoiser = make_denoiser("eigenlight", {options.extent, 3});
  for (int i = 0; i < 2; ++i) EXPECT_NE(denoiser->step(source), nullptr);
  Allocations found;
  largest = 0;
  watching = true;
  while (denoiser->step(source) != nullptr) {
    found.largest_rank = std::max(found.largest_rank, denoiser->report().mean_rank);
  }
  watching = false;
  set_thread_count(0);
  found.largest = largest;
  return found;
}

// The threading library may allocate small blocks. 4 kB is less than a twentieth of a plane.
TEST(Allocation, LaterFramesAllocateNoPlanes) {
  AnalyticOptions steady = sweeping();
  steady.light = [](glm::vec2, int) { return 1.0f; };
  EXPECT_LT(allocations_of_later_frames(steady).largest, 4096u);
}

TEST(Allocation, BirthsOfBasesAllocateNoPlanes) {
  const Allocations found = allocations_of_later_frames(sweeping());
  EXPECT_GT(found.largest_rank, 1.5);  // a basis is born
  EXPECT_LT(found.largest, 4096u);
}

TEST(Allocation, PlaneAllocationIsDetected) {
  watching = true;
  largest = 0;
  const Plane<float> plane({191, 107});
  watching = false;
  EXPECT_GE(largest.load(), plane.storage().size_bytes());
}

}  // namespace
}  // namespace eigenlight

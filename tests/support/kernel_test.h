// Tests of vector kernels against their slow references, over image sizes, instruction sets and
// numbers of threads.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "frame/instruction_sets.h"
#include "frame/tiles.h"
#include "tests/support/extents.h"

namespace eigenlight {

/// Counts the calls of on_every_target(), so that no kernel test can forget it.
inline int kernel_test_runs = 0;

/// Calls body() for each instruction set with 1 and with 3 threads, until one fails. Failures show
/// both. body() runs the kernel over all tiles with for_each_tile() and compares the result.
inline void on_every_target(const std::function<void()>& body) {
  ++kernel_test_runs;
  for_each_instruction_set([&](std::string_view name) {
    for (const int threads : {1, 3}) {
      if (testing::Test::HasFailure()) return;
      const testing::ScopedTrace trace(__FILE__, __LINE__,
                                       std::string(name) + ", threads: " + std::to_string(threads));
      set_thread_count(threads);
      body();
    }
  });
  set_thread_count(0);
}

/// Calls check(extent) for all sizes of the sweep, until one fails.
inline void on_every_extent(const std::function<void(Extent)>& check) {
  for (const Extent extent : kSweepExtents) {
    if (testing::Test::HasFailure()) return;
    const testing::ScopedTrace trace(
        __FILE__, __LINE__, std::to_string(extent.width) + "x" + std::to_string(extent.height));
    kernel_test_runs = 0;
    check(extent);
    EXPECT_GT(kernel_test_runs, 0) << "the test never calls on_every_target()";
  }
}

}  // namespace eigenlight

/// A test of a kernel. Its body sees `extent`, computes what it expects, and runs the kernel inside
/// on_every_target(). tests/style/check.py demands one for every file of kernels.
#define EL_KERNEL_TEST(suite, name)                                           \
  static void suite##_##name##_Kernel(eigenlight::Extent extent);             \
  TEST(suite, name) { eigenlight::on_every_extent(suite##_##name##_Kernel); } \
  static void suite##_##name##_Kernel(eigenlight::Extent extent)

#include "frame/tiles.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <thread>

#ifdef EIGENLIGHT_USE_TBB
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#else
#include <atomic>
#include <exception>
#include <mutex>
#include <vector>
#endif

namespace eigenlight {
namespace {

int available_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

int chosen_threads = 0;  // 0: one per core
std::uint32_t loop_order = 0;

// i-th index of the chosen order: a walk through the loop in strides that meet every index once.
int reordered(int i, int count) {
  std::int64_t stride = 1 + loop_order * std::int64_t{2654435761} % count;
  while (std::gcd(stride, std::int64_t{count}) != 1) ++stride;
  return static_cast<int>((i * stride + loop_order) % count);
}

#ifdef EIGENLIGHT_USE_TBB
// One arena for the process; made anew only when the number of threads changes.
tbb::task_arena& arena() {
  static std::unique_ptr<tbb::task_arena> instance;
  if (!instance || instance->max_concurrency() != thread_count()) {
    instance = std::make_unique<tbb::task_arena>(thread_count());
  }
  return *instance;
}
#endif

}  // namespace

TileGrid::TileGrid(Extent extent, int tile_width, int tile_height)
    : extent_(extent), tile_width_(tile_width), tile_height_(tile_height) {
  check_extent(extent);
  EL_CHECK(tile_width >= 1 && tile_height >= 1, "tile size {}x{}: each side must be at least 1",
           tile_width, tile_height);
  columns_ = (extent.width + tile_width - 1) / tile_width;
  rows_ = (extent.height + tile_height - 1) / tile_height;
}

Tile TileGrid::tile(int index) const {
  EL_DCHECK(index >= 0 && index < count());
  const int x0 = index % columns_ * tile_width_;
  const int y0 = index / columns_ * tile_height_;
  return {{x0, y0, std::min(x0 + tile_width_, extent_.width),
           std::min(y0 + tile_height_, extent_.height)},
          index};
}

void set_thread_count(int threads) {
  EL_CHECK(threads >= 0 && threads <= 1024, "threads {}: expected 0 (one per core) to 1024",
           threads);
  chosen_threads = threads;
}

int thread_count() { return chosen_threads > 0 ? chosen_threads : available_threads(); }

void set_loop_order(std::uint32_t order) { loop_order = order; }

namespace {

#ifdef EIGENLIGHT_USE_TBB

void run_loop(int count, const std::function<void(int)>& body) {
  if (thread_count() == 1) {
    for (int i = 0; i < count; ++i) body(i);
    return;
  }
  arena().execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, count), [&](const tbb::blocked_range<int>& range) {
      for (int i = range.begin(); i != range.end(); ++i) body(i);
    });
  });
}

#else

// Thread sanitizer reports false races in a TBB that was not built for it: builds with it use this
// plain loop instead.
void run_loop(int count, const std::function<void(int)>& body) {
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    for (int i = next++; i < count; i = next++) {
      try {
        body(i);
      } catch (...) {
        const std::scoped_lock lock(failure_mutex);
        if (!failure) failure = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int t = 1; t < std::min(thread_count(), count); ++t) threads.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

#endif

}  // namespace

void parallel_for(int count, const std::function<void(int)>& body) {
  if (loop_order == 0) return run_loop(count, body);
  run_loop(count, [&](int i) { body(reordered(i, count)); });
}

void for_each_tile(const TileGrid& grid, const std::function<void(const Tile&)>& body) {
  parallel_for(grid.count(), [&](int index) { body(grid.tile(index)); });
}

}  // namespace eigenlight

// Two buffers that take turns: what a frame reads of the one before, and what it leaves to the
// next.
#pragma once

#include <utility>

namespace eigenlight {

template <typename T>
struct PingPong {
  T now, before;

  void swap() { std::swap(now, before); }
};

}  // namespace eigenlight

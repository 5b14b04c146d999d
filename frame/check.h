// Checks at the doors of stages: always on, and the message says what was expected.
#pragma once

#include <fmt/format.h>

#include <cassert>
#include <stdexcept>

/// Throws std::invalid_argument with the formatted message unless `condition` holds.
#define EL_CHECK(condition, ...)                                             \
  do {                                                                       \
    if (!(condition)) throw std::invalid_argument(fmt::format(__VA_ARGS__)); \
  } while (false)

/// Checked in debug builds only: for pixel loops, whose inputs were checked at the door.
#define EL_DCHECK(condition) assert(condition)

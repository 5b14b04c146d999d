// Runs a test once for each instruction set that this machine and this build have.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "frame/instruction_sets.h"

namespace eigenlight {

/// Calls body() for each instruction set, whose name failures show.
inline void for_each_target(const std::function<void()>& body) {
  for_each_instruction_set([&](std::string_view name) {
    const testing::ScopedTrace trace(__FILE__, __LINE__, std::string(name));
    body();
  });
}

}  // namespace eigenlight

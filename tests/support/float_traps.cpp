// Linked into every test binary: turns the traps of float_traps.h on before the first test.
#include "frame/float_traps.h"

#include <gtest/gtest.h>

namespace eigenlight {
namespace {

class FloatTraps final : public ::testing::Environment {
 public:
  void SetUp() override { trap_float_faults(); }
};

// GoogleTest owns it.
[[maybe_unused]] const auto* const kTraps = ::testing::AddGlobalTestEnvironment(new FloatTraps);

}  // namespace
}  // namespace eigenlight

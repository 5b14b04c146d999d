#include "sequences/files/machine.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

namespace eigenlight {
namespace {

TEST(Machine, TextAndJsonNameTheSameProcessor) {
  const Machine machine = this_machine();
  EXPECT_GT(machine.cores, 0u);
  EXPECT_FALSE(machine.processor.empty());
  const auto json = to_json(machine);
  EXPECT_EQ(json["processor"], machine.processor);
  EXPECT_EQ(json["cores"], machine.cores);
  EXPECT_EQ(to_text({"Some CPU", "AVX2", "GCC", 4}), "Some CPU, 4 cores, AVX2");
}

TEST(Machine, TodayIsAnIsoDate) {
  EXPECT_TRUE(std::regex_match(today(), std::regex("20\\d\\d-[01]\\d-[0-3]\\d"))) << today();
}

}  // namespace
}  // namespace eigenlight

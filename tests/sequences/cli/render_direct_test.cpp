// Direct light of `eigenlight render`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "tests/support/command_line.h"
#include "tests/support/compare.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;

class RenderDirect : public testing::Test {
 protected:
  Outcome render(const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> words{"render", "cornell", "-o",       dir_ / name,
                                   "--size", "64x36",   "--frames", "0-5"};
    words.insert(words.end(), options.begin(), options.end());
    return call(words);
  }
  [[nodiscard]] Planes<3> read(const std::string& name, const char* layer) const {
    return ExrReader(dir_ / name / "frame.0005.exr").read_planes<3>(layer);
  }
  [[nodiscard]] std::string description(const std::string& name, const char* key) const {
    return nlohmann::json::parse(read_whole_file(dir_ / name / "run.json"))[key].get<std::string>();
  }

  TempDir dir_;
};

double squared_error(const Planes<3>& light, const Planes<3>& truth) {
  double sum = 0.0;
  for (int y = 0; y < light[0].height(); ++y) {
    for (int x = 0; x < light[0].width(); ++x) {
      const auto d = static_cast<double>(light[1](x, y) - truth[1](x, y));
      sum += d * d;
    }
  }
  return sum;
}

TEST_F(RenderDirect, IsDenoisedByDefaultAndColorHoldsIt) {
  ASSERT_EQ(render("truth", {"--method", "reference", "--spp", "4", "--direct-spp", "512"}).status,
            0);
  ASSERT_EQ(render("a", {"--aa", "none"}).status, 0);
  const Planes<3> truth = read("truth", "direct"), direct = read("a", "direct");
  EXPECT_LT(squared_error(direct, truth), 0.25 * squared_error(read("a", "noisy_direct"), truth));
  const Planes<3> color = read("a", ""), indirect = read("a", "indirect");
  const Planes<3> emission = read("a", "emission");
  for (int y = 0; y < 36; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float sum = direct[0](x, y) + indirect[0](x, y) + emission[0](x, y);
      ASSERT_NEAR(color[0](x, y), sum, 4e-3f * std::max(1.0f, sum)) << x << ' ' << y;
    }
  }
  EXPECT_EQ(description("a", "direct"), "denoised");
  EXPECT_EQ(description("truth", "direct"), "noisy");
  EXPECT_THAT(read_whole_file(dir_ / "a/frames.jsonl"), HasSubstr("\"direct\":{"));
}

TEST_F(RenderDirect, StaysNoisyWhereThatIsAskedFor) {
  ASSERT_EQ(render("a", {"--direct", "noisy"}).status, 0);
  EXPECT_TRUE(planes_equal(read("a", "direct"), read("a", "noisy_direct")));
  EXPECT_EQ(description("a", "direct"), "noisy");
  ASSERT_EQ(render("b", {}).status, 0);
  EXPECT_FALSE(planes_equal(read("b", "direct"), read("b", "noisy_direct")));
  for (const char* layer : {"indirect", "noisy", "noisy_direct"}) {
    EXPECT_TRUE(planes_equal(read("a", layer), read("b", layer))) << layer;
  }
  const Outcome wrong = render("c", {"--direct", "clean"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("direct 'clean': expected denoised or noisy"));
  EXPECT_EQ(render("c", {"--direct-spp", "0"}).status, 2);
}

}  // namespace
}  // namespace eigenlight

// What `eigenlight compare` prints and draws besides its page: Markdown, crops, antialiasing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/ldr_image.h"
#include "tests/support/command_line.h"
#include "tests/support/compare.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Json = nlohmann::json;

class CompareTables : public testing::Test {
 protected:
  Outcome compare(const std::string& scene, const std::vector<std::string>& options) {
    std::vector<std::string> words{"compare", scene,       "-o", dir_ / "out", "--size",
                                   "48x27",   "--bounces", "1",  "--cache",    dir_ / "references"};
    words.insert(words.end(), options.begin(), options.end());
    return call(words);
  }
  // Two methods on frame 2, against references of 8 samples each.
  Outcome compare_two(std::vector<std::string> options) {
    options.insert(options.begin(), {"--methods", "noisy,mean", "--spp", "1", "--frames", "2",
                                     "--warmup", "1", "--reference-spp", "16"});
    return compare("cornell", options);
  }
  Outcome antialias(std::vector<std::string> options) {
    options.insert(options.begin(), {"--aa", "none,sraa,supersample:16", "--frames", "3-4", "--spp",
                                     "4", "--reference-spp", "64"});
    return compare("gallery", options);
  }
  [[nodiscard]] Json cells() const {
    const Json results = Json::parse(read_whole_file(dir_ / "out/results.json"));
    return results["scenes"][0]["cells"];
  }

  TempDir dir_;
};

TEST_F(CompareTables, MarkdownGoesToAFileBesideTheTable) {
  const Outcome run = compare_two({"--markdown", dir_ / "tables.md"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("relmse"), HasSubstr("index.html")));
  EXPECT_THAT(
      read_whole_file(dir_ / "tables.md"),
      AllOf(StartsWith("48x27, frames 2 after 1 of history, two independent references of 8"),
            HasSubstr("| cornell | 1 | `noisy` |"), HasSubstr("| cornell | 1 | `mean` |")));
}

TEST_F(CompareTables, MarkdownIsPrintedInsteadOfTheTable) {
  const Outcome run = compare_two({"--markdown", "-"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(StartsWith("48x27, "), Not(HasSubstr("index.html"))));
  EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST_F(CompareTables, MarkdownThatCannotBeWrittenIsNamed) {
  const Outcome run = compare_two({"--markdown", dir_ / "no/tables.md", "--quiet"});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("no/tables.md"));
}

TEST_F(CompareTables, CropsOfAllMethodsAreOnePicture) {
  const Outcome run = compare_two({"--crop", "24x12+3+5", "--crops-per-row", "2"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("crops-cornell.jpg: noisy, mean, reference"));
  const Planes<3> picture = read_ldr_image(dir_ / "out/crops-cornell.jpg");
  EXPECT_EQ(picture[0].extent(), (Extent{2 * 288 + 4, 2 * 144 + 4}));
}

TEST_F(CompareTables, AntialiasingIsMeasuredWithoutTheNoiseOfItsSamples) {
  const Outcome run = antialias({"--markdown", "-"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("| scene | spp | antialiasing | relMSE | / none | energy |"));
  const Json found = cells();
  ASSERT_EQ(found.size(), 3u);
  const Json &none = found[0], &sraa = found[1], &supersampled = found[2];
  EXPECT_EQ(supersampled["contender"], "supersample-16");
  EXPECT_LT(sraa["mean"]["relmse"], 0.8 * none["mean"]["relmse"].get<double>());
  // The reference itself, of other samples: what is left is noise, which drops out.
  EXPECT_LT(std::abs(supersampled["mean"]["relmse"].get<double>()),
            0.2 * none["mean"]["relmse"].get<double>());
  EXPECT_NEAR(supersampled["mean"]["energy"].get<double>(), 1.0, 0.01);
  EXPECT_EQ(none["mean"]["pixels"], 2 * 48 * 27) << "the sky counts too";
  EXPECT_TRUE(none["mean"].contains("temporal_error"));
  EXPECT_EQ(none["antialias"]["cpu_ms"], 0.0);
  EXPECT_EQ(none["antialias"]["unmatched"], 0.0);
  EXPECT_GT(sraa["antialias"]["cpu_ms"], 0.0);
  EXPECT_GT(sraa["antialias"]["reference_cpu_ms"], sraa["antialias"]["cpu_ms"]);
  EXPECT_GT(sraa["cpu_ms"]["total"], none["cpu_ms"]["total"]);
}

// The picture of `none` is the layer `color` that render writes, but for its samples.
TEST_F(CompareTables, AntialiasedPicturesShowTheLayerColor) {
  ASSERT_EQ(antialias({"--quiet"}).status, 0);
  const Outcome rendered =
      call({"render", "gallery", "-o", dir_ / "color", "--size", "48x27", "--frames", "4",
            "--bounces", "1", "--method", "reference", "--spp", "64", "--layers", "color"});
  ASSERT_EQ(rendered.status, 0) << rendered.err;
  const Planes<3> color = ExrReader(dir_ / "color/frame.0004.exr").read_planes<3>("");
  const Planes<3> none =
      ExrReader(dir_ / "out/frames/gallery/none/frame.0004.exr").read_planes<3>("");
  double sum = 0.0, wanted = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < 27; ++y) {
      for (int x = 0; x < 48; ++x) {
        sum += static_cast<double>(none[c](x, y));
        wanted += static_cast<double>(color[c](x, y));
      }
    }
  }
  EXPECT_NEAR(sum / wanted, 1.0, 0.05);
}

TEST_F(CompareTables, AntialiasingGoesOnWhereItWas) {
  ASSERT_EQ(antialias({}).status, 0);
  const std::string csv = read_whole_file(dir_ / "out/results.csv");
  const Outcome again = antialias({});
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(again.err, "") << "all was there";
  EXPECT_EQ(read_whole_file(dir_ / "out/results.csv"), csv);
}

TEST_F(CompareTables, AntialiasingExcludesMethods) {
  const Outcome run = antialias({"--methods", "mean"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, AllOf(HasSubstr("--aa"), HasSubstr("--methods")));
}

}  // namespace
}  // namespace eigenlight

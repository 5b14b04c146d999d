// `eigenlight compare` in this process, on the smallest built-in scene.
#include "sequences/cli/compare_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "frame/tiles.h"
#include "sequences/cli/cli.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "sequences/metrics/evaluate.h"
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

class CompareCommand : public testing::Test {
 protected:
  // Frames 2 and 3 of cornell at 48x27, after two of history.
  Outcome compare(const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> words{
        "compare",   "cornell",  "-o",      dir_ / name,         "--size",
        "48x27",     "--frames", "2-3",     "--warmup",          "2",
        "--bounces", "2",        "--cache", dir_ / "references", "--reference-spp",
        "16"};
    words.insert(words.end(), options.begin(), options.end());
    return call(words);
  }
  [[nodiscard]] Json results(const std::string& name) const {
    return Json::parse(read_whole_file(dir_ / name / "results.json"));
  }
  [[nodiscard]] std::filesystem::path references() const {
    for (const auto& entry : std::filesystem::directory_iterator(dir_ / "references")) {
      return entry.path();
    }
    return {};
  }
  static Json cell(const Json& results, const std::string& contender, int spp) {
    for (const Json& one : results["scenes"][0]["cells"]) {
      if (one["contender"] == contender && one["spp"] == spp) return one;
    }
    return {};
  }

  TempDir dir_;
};

TEST_F(CompareCommand, WritesResultsTableAndPage) {
  const Outcome run = compare("a", {"--methods", "eigenlight,noisy", "--spp", "1,2"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err,
              AllOf(HasSubstr("cornell: reference 2 of 2, 8 spp, 2 frames"),
                    HasSubstr("cornell, 2 spp: 2 methods, 4 frames"), HasSubstr("frame 3  4/4")));
  EXPECT_THAT(run.out, AllOf(HasSubstr("cornell, 2 spp, frames 2-3"), HasSubstr("index.html")));
  const Json found = results("a");
  EXPECT_EQ(found["scenes"][0]["cells"].size(), 4u);
  EXPECT_EQ(found["settings"]["rendered_frames"], "0-3");
  for (const char* name : {"eigenlight", "noisy"}) {
    for (const int spp : {1, 2}) {
      const Json one = cell(found, name, spp);
      EXPECT_GT(one["mean"]["relmse"], 0.0) << name;
      // Unbiased, so that a small one may lie below 0 by the noise of the references.
      EXPECT_TRUE(one["mean"]["temporal_error"].is_number()) << name;
      EXPECT_GT(one["cpu_ms"]["render"], 0.0) << name;
      EXPECT_GT(one["cpu_ms"]["denoise"], 0.0) << name;
      EXPECT_EQ(one["per_frame"].size(), 2u);
      EXPECT_EQ(one["mean"]["pixels"].get<int>(),
                one["young"]["pixels"].get<int>() + one["old"]["pixels"].get<int>());
    }
  }
  for (const char* figure : {"relmse", "temporal_error"}) {
    EXPECT_LT(cell(found, "eigenlight", 2)["mean"][figure],
              cell(found, "noisy", 2)["mean"][figure]);
  }
  EXPECT_GT(cell(found, "noisy", 2)["mean"]["temporal_error"], 0.0);
  // Sanitizers bring an allocator of their own, which keeps no books that mallinfo2() could read.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  EXPECT_GT(cell(found, "eigenlight", 2)["memory_mb"], cell(found, "noisy", 2)["memory_mb"]);
#endif
  const std::string page = read_whole_file(dir_ / "a/index.html");
  EXPECT_THAT(page, AllOf(HasSubstr("Error against time"), HasSubstr("data:image/jpeg")));
  EXPECT_FALSE(std::filesystem::exists(dir_ / "a/scratch"));
}

// With direct light, which programs get noisy: one that copies it is as good as the method noisy.
TEST_F(CompareCommand, MeasuresWholePictures) {
  const Outcome run = compare("whole", {"--layer", "color", "--methods", "eigenlight,noisy",
                                        "--spp", "3", "--external", "copy=cp {color} {output}"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json found = results("whole");
  const auto relmse = [&](const char* name) {
    return cell(found, name, 3)["mean"]["relmse"].get<double>();
  };
  EXPECT_LT(relmse("eigenlight"), 0.3 * relmse("noisy"));
  EXPECT_NEAR(relmse("copy"), relmse("noisy"), 1e-9);
  for (const std::string method : {"eigenlight", "noisy"}) {
    const Outcome rendered =
        call({"render", "cornell", "-o", dir_ / method, "--size", "48x27", "--frames", "0-3",
              "--bounces", "2", "--method", method, "--layers", "color", "--aa", "none"});
    ASSERT_EQ(rendered.status, 0) << rendered.err;
    const std::filesystem::path shown = dir_ / "whole" / "frames/cornell" / method;
    for (const char* file : {"frame.0002.exr", "frame.0003.exr"}) {
      EXPECT_TRUE(planes_equal(ExrReader(shown / file).read_planes<3>(""),
                               ExrReader(dir_ / method / file).read_planes<3>("")))
          << method << ' ' << file;
    }
  }
  // References of indirect light are others.
  ASSERT_EQ(compare("a", {"--methods", "noisy", "--spp", "3"}).status, 0);
  EXPECT_GT(
      std::abs(cell(results("a"), "noisy", 3)["mean"]["relmse"].get<double>() - relmse("noisy")),
      1e-3);
}

// Compared frames equal those of `render`, and figures equal those of `evaluate`.
TEST_F(CompareCommand, AgreesWithRenderAndEvaluate) {
  ASSERT_EQ(compare("a", {"--methods", "eigenlight,chen2012,meyer2006", "--spp", "3"}).status, 0);
  for (const std::string method : {"eigenlight", "chen2012", "meyer2006"}) {
    const Outcome rendered =
        call({"render", "cornell", "-o", dir_ / method, "--size", "48x27", "--frames", "0-3",
              "--bounces", "2", "--method", method, "--layers", "indirect,id"});
    ASSERT_EQ(rendered.status, 0) << rendered.err;
    const std::filesystem::path shown = dir_ / "a" / "frames/cornell" / method;
    for (const char* file : {"frame.0002.exr", "frame.0003.exr"}) {
      EXPECT_TRUE(planes_equal(ExrReader(shown / file).read_planes<3>("indirect"),
                               ExrReader(dir_ / method / file).read_planes<3>("indirect")))
          << method << ' ' << file;
    }
    EvaluateOptions options;
    options.test = dir_ / method / "frame.####.exr";
    options.reference = references() / "a/frame.####.exr";
    options.reference_b = references() / "b/frame.####.exr";
    options.frames = "2-3";
    const double relmse = *evaluate(options).mean[0][Metric::kRelmse];
    // Files hold half floats.
    EXPECT_NEAR(cell(results("a"), method, 3)["mean"]["relmse"].get<double>() / relmse, 1.0, 2e-3);
  }
}

TEST_F(CompareCommand, SecondRunMeasuresOnlyMissingResults) {
  const std::vector<std::string> options{"--methods", "mean,noisy", "--spp", "1"};
  ASSERT_EQ(compare("a", options).status, 0);
  const std::string csv = read_whole_file(dir_ / "a/results.csv");
  const Outcome again = compare("a", options);
  EXPECT_EQ(again.status, 0);
  EXPECT_EQ(again.err, "") << "all was there";
  EXPECT_EQ(read_whole_file(dir_ / "a/results.csv"), csv);

  std::filesystem::remove(references() / "b/frame.0003.exr");
  EXPECT_THAT(compare("a", options).err, HasSubstr("reference 2 of 2, 8 spp, 1 frames"));
  EXPECT_THAT(compare("a", {"--methods", "mean,noisy", "--spp", "1,2"}).err,
              AllOf(HasSubstr("2 spp: 2 methods"), Not(HasSubstr("1 spp"))));
  EXPECT_THAT(compare("a", {"--methods", "mean,noisy,eigenlight", "--spp", "1"}).err,
              AllOf(HasSubstr("1 spp: 1 methods"), Not(HasSubstr("reference"))));
  std::filesystem::remove_all(dir_ / "a/frames/cornell/mean");
  EXPECT_THAT(compare("a", options).err, HasSubstr("1 spp: 1 methods"));
  EXPECT_THAT(compare("a", {"--methods", "mean", "--spp", "1", "--seed", "1"}).err,
              HasSubstr("reference 1 of 2, 8 spp, 2 frames"));
}

TEST_F(CompareCommand, ExternalCopyEqualsTheNoisyMethod) {
  const Outcome run =
      compare("a", {"--methods", "noisy", "--spp", "2", "--external", "copy=cp {color} {output}",
                    "--external", "timed=cp {color} {output}; echo took 7.5 ms", "--external-time",
                    "timed=took ([0-9.]+) ms"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json found = results("a");
  const Json noisy = cell(found, "noisy", 2), copy = cell(found, "copy", 2);
  EXPECT_EQ(copy["mean"], noisy["mean"]);
  EXPECT_EQ(copy["per_frame"], noisy["per_frame"]);
  EXPECT_EQ(copy["cpu_ms"]["render"], noisy["cpu_ms"]["render"]);
  EXPECT_GT(copy["cpu_ms"]["denoise"], 0.0);
  EXPECT_EQ(cell(found, "timed", 2)["cpu_ms"]["denoise"], 7.5);
  EXPECT_EQ(found["settings"]["contenders"][1]["command"], "cp {color} {output}");
}

TEST_F(CompareCommand, FailingExternalProgramIsOneLine) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"x=echo no weights >&2; exit 3; : {color} {output}",
       "external 'x': exit status 3: no weights"},
      {"x=true {color} {output}", "external 'x': it left no "},
      {"x=oiiotool {color} --resize 10x10 -o {output}", "is 10x10, expected 48x27"},
  };
  for (const auto& [command, message] : mistakes) {
    const Outcome run =
        compare("a", {"--methods", "noisy", "--spp", "1", "--quiet", "--external", command});
    EXPECT_EQ(run.status, 1) << command;
    EXPECT_THAT(run.err, AllOf(StartsWith("eigenlight: "), HasSubstr(message)));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(dir_ / "a/scratch"));
    EXPECT_FALSE(std::filesystem::exists(dir_ / "a/index.html"));
  }
}

TEST_F(CompareCommand, EachPerturbationIsASceneOfItsOwn) {
  const Outcome run =
      compare("a", {"--methods", "noisy", "--spp", "1", "--perturb", "none,lights", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json found = Json::parse(run.out);
  ASSERT_EQ(found["scenes"].size(), 2u);
  EXPECT_EQ(found["scenes"][0]["name"], "cornell");
  EXPECT_EQ(found["scenes"][1]["name"], "cornell-lights");
  EXPECT_NE(found["scenes"][0]["references"], found["scenes"][1]["references"]);
  EXPECT_EQ(found, results("a"));
}

TEST_F(CompareCommand, QuietPrintsNothing) {
  const Outcome run = compare("a", {"--methods", "noisy", "--spp", "1", "--quiet"});
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.out + run.err, "");
}

TEST_F(CompareCommand, EachMistakeIsOneLineAndMakesNothing) {
  const std::pair<std::vector<std::string>, const char*> mistakes[] = {
      {{"--methods", "magic"}, "unknown method 'magic'; known: eigenlight, "},
      {{"--methods", "mean,,noisy"}, "methods 'mean,,noisy': expected names with one comma"},
      {{"--methods", "mean,mean"}, "'mean' is named twice"},
      {{"--spp", "1,many"}, "spp '1,many': 'many' is not a number from 1 to 65536"},
      {{"--spp", "0"}, "'0' is not a number from 1 to 65536"},
      {{"--frames", "2,4"}, "frames '2,4': expected one range without gaps"},
      {{"--warmup", "-1"}, "warmup -1: expected 0 to"},
      {{"--size", "48"}, "size '48': expected WIDTHxHEIGHT"},
      {{"--reference-spp", "7"}, "reference-spp 7: expected an even number"},
      {{"--equal-time", "0"}, "equal-time 0: expected milliseconds above 0"},
      {{"--perturb", "camera"}, "unknown perturbation 'camera'; known: none, "},
      {{"--seed", "-1"}, "seed -1: expected 0 to 1073741823"},
      {{"--external", "x=cp {color}"}, "external 'x': its command has no {output}"},
      {{"--external", "mean=cp {color} {output}"}, "external 'mean': a second method"},
      {{"--external-time", "x=(1)"}, "unknown external 'x'; known: none"},
  };
  for (const auto& [options, message] : mistakes) {
    std::vector<std::string> words{"compare", "cornell", "-o", dir_ / "never"};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = call(words);
    EXPECT_EQ(outcome.status, 2) << message;
    EXPECT_THAT(outcome.err, AllOf(StartsWith("eigenlight: "), HasSubstr(message)));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_THAT(call({"compare", "cornell", "cornell", "-o", dir_ / "never"}).err,
              HasSubstr("scene 'cornell': a second one called 'cornell'"));
  EXPECT_FALSE(std::filesystem::exists(dir_ / "never"));
  std::ofstream(dir_ / "file") << "x";
  for (const char* option : {"-o", "--cache"}) {
    std::vector<std::string> words{"compare", "cornell", "--methods", "noisy", "--size",
                                   "48x27",   "--spp",   "1",         option,  dir_ / "file"};
    if (words[8] == "--cache") words.insert(words.end(), {"-o", dir_ / "a"});
    const Outcome blocked = call(words);
    EXPECT_EQ(blocked.status, 1) << option;
    EXPECT_THAT(blocked.err, HasSubstr("cannot make the directory")) << option;
  }
}

}  // namespace
}  // namespace eigenlight

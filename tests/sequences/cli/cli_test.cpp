// The command line in this process: its output, its errors, and that equal runs give equal bits.
#include "sequences/cli/cli.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "frame/tiles.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "sequences/files/shell_quote.h"
#include "tests/support/command_line.h"
#include "tests/support/compare.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

class CliTest : public testing::Test {
 protected:
  // Renders the smallest built-in scene at 64x36 into a directory of this test.
  Outcome render(const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> words{"render", "cornell", "-o", dir_ / name, "--size", "64x36"};
    words.insert(words.end(), options.begin(), options.end());
    return call(words);
  }
  std::string bytes(const std::string& name) { return read_whole_file(dir_ / name); }

  TempDir dir_;
};

TEST_F(CliTest, RenderWritesFramesLogsAndPage) {
  const Outcome run = render("a", {"--frames", "3-4", "--method", "noisy"});
  EXPECT_EQ(run.status, 0);
  EXPECT_THAT(run.out, AllOf(HasSubstr("2 frames in"), HasSubstr("Mrays/s")));
  EXPECT_THAT(run.err, AllOf(HasSubstr("frame.0003.exr to "), HasSubstr("frame 4  2/2")));
  for (const char* name : {"frame.0003.exr", "frame.0004.exr", "frames.jsonl", "run.json",
                           "index.html", "state.bin"}) {
    EXPECT_TRUE(std::filesystem::exists(dir_ / "a" / name)) << name;
  }
  const auto description = nlohmann::json::parse(bytes("a/run.json"));
  EXPECT_EQ(description["scene"], "cornell");
  EXPECT_EQ(description["frames"], "3-4");
  EXPECT_EQ(description["method"], "noisy");
  const ExrReader reader(dir_ / "a/frame.0003.exr");
  EXPECT_EQ(reader.extent(), (Extent{64, 36}));
  EXPECT_EQ(std::get<std::string>(*reader.attribute("eigenlight.scene")), "cornell");
}

TEST_F(CliTest, LastValueOfARepeatedOptionWins) {
  EXPECT_EQ(
      render("a", {"-q", "--frames", "0-3", "--spp", "3", "--frames", "7", "--spp", "1"}).status,
      0);
  EXPECT_TRUE(std::filesystem::exists(dir_ / "a/frame.0007.exr"));
  EXPECT_FALSE(std::filesystem::exists(dir_ / "a/frame.0000.exr"));
  EXPECT_EQ(nlohmann::json::parse(bytes("a/run.json"))["spp"], 1);
}

TEST_F(CliTest, NegativeFramesCanBeRenderedResumedAndEvaluated) {
  ASSERT_EQ(render("a", {"-q", "--frames", "-2-1", "--perturb", "all"}).status, 0);
  ASSERT_EQ(render("b", {"-q", "--frames", "-2-1", "--perturb", "all", "--seed", "1"}).status, 0);
  for (const char* name :
       {"frame.-002.exr", "frame.-001.exr", "frame.0000.exr", "frame.0001.exr"}) {
    EXPECT_TRUE(std::filesystem::exists(dir_ / "a" / name)) << name;
  }
  const Outcome again = render("a", {"--frames", "-2-1", "--perturb", "all", "--resume"});
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.err, HasSubstr("all 4 frames are complete"));
  const Outcome measured = call({"evaluate", "-t", dir_ / "a/frame.####.exr", "-r",
                                 dir_ / "b/frame.####.exr", "--layer", "indirect"});
  EXPECT_EQ(measured.status, 0) << measured.err;
  EXPECT_THAT(measured.out, HasSubstr("4 frames"));
}

TEST_F(CliTest, FramesAreEqualForAnyThreadsAndAnyOtherFrames) {
  EXPECT_EQ(render("one", {"--frames", "0-2", "--threads", "1"}).status, 0);
  EXPECT_EQ(render("two", {"--frames", "0-2", "--threads", "2"}).status, 0);
  for (const char* name : {"/frame.0000.exr", "/frame.0001.exr", "/frame.0002.exr"}) {
    EXPECT_TRUE(bytes(std::string("one") + name) == bytes(std::string("two") + name)) << name;
  }
  EXPECT_EQ(render("alone", {"--frames", "2"}).status, 0);
  const auto alone = ExrReader(dir_ / "alone/frame.0002.exr").read_planes<3>("noisy");
  const auto among = ExrReader(dir_ / "one/frame.0002.exr").read_planes<3>("noisy");
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < 36; ++y) {
      for (int x = 0; x < 64; ++x) ASSERT_EQ(alone[c](x, y), among[c](x, y));
    }
  }
}

TEST_F(CliTest, OtherSeedsAndReferencesShareNoSamples) {
  const std::vector<std::string> common{"--frames", "0", "--method"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), common.begin(), common.end());
    return more;
  };
  EXPECT_EQ(render("zero", with({"noisy"})).status, 0);
  EXPECT_EQ(render("one", with({"noisy", "--seed", "1"})).status, 0);
  EXPECT_EQ(render("reference", with({"reference", "--spp", "3"})).status, 0);
  const auto noisy = [&](const std::string& name) {
    return ExrReader(dir_ / name / "frame.0000.exr").read_planes<3>("noisy");
  };
  const Planes<3> zero = noisy("zero");
  for (const char* name : {"one", "reference"}) {
    const Planes<3> other = noisy(name);
    int equal = 0;
    int lit = 0;
    for (int y = 0; y < 36; ++y) {
      for (int x = 0; x < 64; ++x) {
        if (zero[0](x, y) == 0.0f) continue;
        ++lit;
        if (zero[0](x, y) == other[0](x, y)) ++equal;
      }
    }
    EXPECT_GT(lit, 1000);
    EXPECT_LT(equal, lit / 50) << name;
  }
}

TEST_F(CliTest, QuietPrintsNothingAndJsonPrintsOneObject) {
  const Outcome quiet = render("a", {"--frames", "0", "--method", "noisy", "--quiet"});
  EXPECT_EQ(quiet.status, 0);
  EXPECT_EQ(quiet.out + quiet.err, "");
  const Outcome json = render("a", {"--frames", "0", "--method", "noisy", "--json"});
  const auto summary = nlohmann::json::parse(json.out);
  EXPECT_EQ(summary["frames"], 1);
  EXPECT_EQ(summary["directory"], (dir_ / "a").string());
  EXPECT_GT(summary["mrays_per_second"], 0.0);
  EXPECT_TRUE(summary["mean_ms"]["source"].contains("cpu"));
}

TEST_F(CliTest, PrintsListsVersionAndHelp) {
  EXPECT_THAT(call({"scenes"}).out, HasSubstr("cornell "));
  EXPECT_THAT(call({"methods"}).out, AllOf(HasSubstr("noisy "), HasSubstr("reference ")));
  EXPECT_THAT(call({"--version"}).out, StartsWith("eigenlight "));
  for (const Outcome& help : {call({"--help"}), call({"render", "--help"})}) {
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.out, HasSubstr("render"));
    EXPECT_EQ(help.err, "");
  }
}

struct Mistake {
  std::vector<std::string> options;
  const char* message;
};

TEST_F(CliTest, EachMistakeIsOneLineAndMakesNothing) {
  const Mistake mistakes[] = {
      {{"--method", "magic"}, "unknown method 'magic'; known: "},
      {{"--size", "640"}, "size '640': expected WIDTHxHEIGHT"},
      {{"--size", "0x10"}, "size '0x10': expected WIDTHxHEIGHT"},
      {{"--size", "10x10x"}, "size '10x10x': expected WIDTHxHEIGHT"},
      {{"--size", "65536x65536"}, "size 65536x65536: needs about"},
      {{"--spp", "0"}, "spp 0: expected 1 to 65536"},
      {{"--spp", "many"}, "Could not convert: --spp = many; see eigenlight render --help"},
      {{"--bases", "9"}, "bases 9: expected 1 to 8"},
      {{"--bounces", "0"}, "bounces 0: expected 1 to 64"},
      {{"--seed", "-1"}, "seed -1: expected 0 to 2147483647"},
      {{"--threads", "-2"}, "threads -2: expected 0 (one per core) to 1024"},
      {{"--frames", "1-q"}, "frames '1-q': expected 7, 1-10"},
      {{"--layers", "color,depth"}, "unknown layer 'depth'; known: color, "},
      {{"--perturb", "camera"},
       "unknown perturbation 'camera'; known: none, lights, objects, all, step, step:FRAME"},
      {{"--perturb", "step:0"}, "perturbation 'step:0': expected step:FRAME with a frame of 1 to"},
      {{"--aa", "fxaa"},
       "unknown aa 'fxaa'; known: none, lookup, sraa, sraa-geometry, supersample:N"},
      {{"--aa", "supersample:1"}, "aa 'supersample:1': expected supersample:N with N from 2"},
      {{"--frobnicate"}, "not expected: --frobnicate; see eigenlight render --help"},
      {{"--without", "magic"}, "method 'eigenlight' has no part 'magic' to turn off; it has: "},
  };
  for (const Mistake& mistake : mistakes) {
    std::vector<std::string> words{"render", "cornell", "-o", dir_ / "never"};
    words.insert(words.end(), mistake.options.begin(), mistake.options.end());
    const Outcome outcome = call(words);
    EXPECT_EQ(outcome.status, 2) << mistake.message;
    EXPECT_THAT(outcome.err, AllOf(StartsWith("eigenlight: "), HasSubstr(mistake.message)));
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_FALSE(std::filesystem::exists(dir_ / "never"));
  EXPECT_THAT(call({}).err, HasSubstr("A subcommand is required"));
  EXPECT_THAT(call({"frobnicate"}).err, HasSubstr("unknown command 'frobnicate'"));
  EXPECT_EQ(call({"frobnicate"}).status, 2);
}

TEST_F(CliTest, UnknownSceneIsAnError) {
  const Outcome unknown = call({"render", "nowhere", "-o", dir_ / "never"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("unknown scene 'nowhere'; built-in: cornell, "));
  const Outcome missing = call({"render", dir_ / "scene.json", "-o", dir_ / "never"});
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, HasSubstr("scene.json"));
  std::ofstream(dir_ / "scene.json") << "{ not json";
  const Outcome broken = call({"render", dir_ / "scene.json", "-o", dir_ / "never"});
  EXPECT_EQ(broken.status, 1);
  EXPECT_THAT(broken.err, HasSubstr("scene.json"));
  for (const Outcome& outcome : {unknown, missing, broken}) {
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(dir_ / "never"));
}

// As with `> /dev/full`: a script must not take lost results for success.
TEST(Cli, UnwritableStandardOutputIsAnError) {
  const std::vector<std::vector<const char*>> commands{
      {"eigenlight", "scenes"},
      {"eigenlight", "methods", "--parts"},
      {"eigenlight", "--help"},
      {"eigenlight", "stress", "--case", "algebra.black"}};
  for (const std::vector<const char*>& words : commands) {
    std::ostream full(nullptr);  // every write fails
    std::ostringstream err;
    EXPECT_EQ(run_command_line(words, {full, err}), 1) << words[1];
    EXPECT_EQ(err.str(), "eigenlight: cannot write to standard output\n") << words[1];
  }
}

TEST_F(CliTest, UnwritableDirectoryIsAnError) {
  std::ofstream(dir_ / "file") << "x";
  const Outcome outcome = render("file", {"--frames", "0"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.err, HasSubstr("file: cannot make the directory"));
  // A directory stands where the frame should go; no file can replace it.
  std::filesystem::create_directories(dir_ / "a/frame.0000.exr");
  const Outcome blocked = render("a", {"--frames", "0", "--quiet"});
  EXPECT_EQ(blocked.status, 1);
  EXPECT_THAT(blocked.err, AllOf(HasSubstr("frame.0000.exr: cannot write: "), EndsWith("\n")));
  for (const auto& entry : std::filesystem::directory_iterator(dir_ / "a")) {
    EXPECT_THAT(entry.path().filename().string(), testing::Not(EndsWith(".tmp")));
  }
}

TEST_F(CliTest, ResumingAFinishedRunRendersNothing) {
  EXPECT_EQ(render("a", {"--frames", "0-1"}).status, 0);
  const std::string frame = bytes("a/frame.0001.exr");
  const std::string log = bytes("a/frames.jsonl");
  const Outcome again = render("a", {"--frames", "0-1", "--resume"});
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.err, HasSubstr("all 2 frames are complete"));
  EXPECT_EQ(bytes("a/frames.jsonl"), log);
  EXPECT_TRUE(bytes("a/frame.0001.exr") == frame);
  const Outcome other = render("a", {"--frames", "0-1", "--resume", "--spp", "5"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("state.bin: of another run: spp is 3 there, 5 here"));
}

// All layers but the color are those of the guide rays, and run and files name the antialiasing.
TEST_F(CliTest, AntialiasingChangesOnlyTheColor) {
  EXPECT_EQ(render("plain", {"--frames", "0", "--aa", "none"}).status, 0);
  const ExrReader plain(dir_ / "plain/frame.0000.exr");
  for (const char* aa : {"lookup", "sraa", "supersample:2"}) {
    EXPECT_EQ(render(aa, {"--frames", "0", "--aa", aa}).status, 0);
    const ExrReader smooth(dir_ / (std::string(aa) + "/frame.0000.exr"));
    for (const char* layer : {"indirect", "direct", "emission", "albedo", "N", "noisy"}) {
      EXPECT_TRUE(planes_equal(smooth.read_planes<3>(layer), plain.read_planes<3>(layer))) << layer;
    }
    EXPECT_FALSE(planes_equal(smooth.read_planes<3>(""), plain.read_planes<3>("")));
    EXPECT_EQ(std::get<std::string>(*smooth.attribute("eigenlight.antialias")), aa);
    EXPECT_THAT(bytes(std::string(aa) + "/frames.jsonl"), HasSubstr("\"unmatched\":"));
  }
  const Outcome other = render("sraa", {"--frames", "0", "--aa", "lookup", "--resume"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("of another run: antialias is sraa there, lookup here"));
}

TEST_F(CliTest, DirectLightIsNotRenderedUnlessALayerShowsIt) {
  EXPECT_EQ(render("all", {"--frames", "0-1"}).status, 0);
  EXPECT_EQ(render("some", {"--frames", "0-1", "--layers", "indirect,noisy"}).status, 0);
  const auto rays = [&](const std::string& run) {
    const std::string log = bytes(run + "/frames.jsonl");
    return nlohmann::json::parse(log.substr(0, log.find('\n'))).at("rays").get<std::int64_t>();
  };
  EXPECT_LT(rays("some"), rays("all") - std::int64_t{64} * 36);  // two samples a pixel
  const ExrReader all(dir_ / "all/frame.0001.exr"), some(dir_ / "some/frame.0001.exr");
  for (const char* layer : {"indirect", "noisy"}) {
    EXPECT_TRUE(planes_equal(some.read_planes<3>(layer), all.read_planes<3>(layer))) << layer;
  }
}

}  // namespace
}  // namespace eigenlight

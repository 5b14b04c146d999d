#include "sequences/compare/external_method.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "sequences/compare/child_process.h"
#include "sequences/files/exr_io.h"
#include "tests/support/analytic_source.h"
#include "tests/support/compare.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

const auto kNever = [] { return false; };

TEST(ChildProcess, TellsStatusTimeMemoryAndWords) {
  const TempDir dir;
  const ChildResult fine = run_shell("echo out; echo err >&2", dir.path());
  EXPECT_EQ(fine.status, 0);
  EXPECT_EQ(fine.out, "out\n");
  EXPECT_EQ(fine.err, "err\n");
  EXPECT_EQ(run_shell("exit 7", dir.path()).status, 7);
  EXPECT_EQ(run_shell("kill -9 $$", dir.path()).status, 128 + 9);
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

TEST(ChildProcess, CountsTheTimeOfChildrenAndNotThatOfSleep) {
  const TempDir dir;
  const ChildResult busy =
      run_shell("i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done; true", dir.path());
  EXPECT_GT(busy.cpu_ms, 5.0);
  EXPECT_LT(run_shell("sleep 0.2", dir.path()).cpu_ms, 100.0);
}

// 60 MB of zeros in the memory of a grandchild.
TEST(ChildProcess, MeasuresTheMemoryOfTheProgramAndNotOurs) {
  const TempDir dir;
  const std::vector<char> ours(200'000'000, 1);
  EXPECT_EQ(ours.back(), 1);
  const ChildResult large = run_shell(
      "python3 -c 'import time; x = b\"1\" * 60000000; time.sleep(0.1)'; true", dir.path());
  ASSERT_EQ(large.status, 0) << large.err;
  EXPECT_GT(large.peak_mb, 60.0);
  EXPECT_LT(large.peak_mb, 120.0);
}

TEST(ExternalMethod, ReadsCommandsAndRefusesBadOnes) {
  const ExternalMethod one = parse_external("oidn=run {color} --frame={frame} -o {output}");
  EXPECT_EQ(one.name, "oidn");
  EXPECT_EQ(one.command, "run {color} --frame={frame} -o {output}");
  EXPECT_FALSE(one.runs_per_sequence());
  EXPECT_TRUE(parse_external("a=x {color} {output} {frames}").runs_per_sequence());
  EXPECT_FALSE(parse_external("a=x {color} {output} {frames}").takes_all_frames());
  EXPECT_TRUE(parse_external("a=x {color} {output} {all_frames}").takes_all_frames());
  EXPECT_NO_THROW((void)parse_external("a=${HOME}/x {color} {output} | awk '{ print }'"));
  const std::pair<const char*, const char*> mistakes[] = {
      {"run {color} {output}", "expected NAME="},
      {"=run", "expected NAME="},
      {"a=run {output}", "its command has no {color}"},
      {"a=run {color}", "its command has no {output}"},
      {"a=run {color} {depth} {output}", "unknown place '{depth}'; known: {color}, {albedo}"},
      {"a=run {color} {frame} {frames} {output}", "{frame} is for one run a frame"},
  };
  for (const auto& mistake : mistakes) {
    const auto parse = [&] { (void)parse_external(mistake.first); };
    EXPECT_THAT(parse, ThrowsMessage<std::invalid_argument>(HasSubstr(mistake.second)))
        << mistake.first;
  }
}

TEST(ExternalMethod, TimePatternsAreCheckedToo) {
  std::vector<ExternalMethod> methods{parse_external("a=x {color} {output}")};
  set_external_time("a=filter ms: ([0-9.]+)", methods);
  EXPECT_EQ(methods[0].time_pattern, "filter ms: ([0-9.]+)");
  EXPECT_THAT([&] { set_external_time("b=(x)", methods); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("unknown external 'b'; known: a")));
  EXPECT_THAT([&] { set_external_time("a=ms: [0-9]+", methods); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("expected a group")));
  EXPECT_THROW(set_external_time("a=(", methods), std::invalid_argument);
}

class ExternalRunTest : public testing::Test {
 protected:
  // Runs `command` over frames 3 and 4, of which 4 is measured.
  ExternalCost run(const std::string& command, const std::string& pattern = "") {
    method_ = parse_external("tool=" + command);
    method_.time_pattern = pattern;
    run_.emplace(method_, ExternalRun::Frames{{3, 4}, {4}}, dir_.path());
    AnalyticSource source({.extent = {24, 16}, .frames = 2, .first_frame = 3});
    while (source.next(frame_)) run_->add(frame_);
    ExternalCost cost;
    EXPECT_TRUE(run_->run(kNever, cost));
    return cost;
  }
  [[nodiscard]] std::string failure(const std::string& command, const std::string& pattern = "") {
    try {
      (void)run(command, pattern);
      (void)run_->output(4, {24, 16});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no failure";
  }

  TempDir dir_;
  Frame frame_;
  ExternalMethod method_;
  std::optional<ExternalRun> run_;
};

TEST_F(ExternalRunTest, HandsOverEveryFrameAndReadsItBack) {
  const ExternalCost cost = run("test -f {albedo} && test -f {normal} && cp {color} {output}");
  EXPECT_GT(cost.ms, 0.0);
  const Planes<3> output = run_->output(4, {24, 16});
  Planes<3> wanted = make_planes<3>({24, 16});
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 24; ++x) {
        wanted[c](x, y) = frame_.surface.albedo[c](x, y) * frame_.lights[0].radiance[c](x, y);
      }
    }
  }
  EXPECT_TRUE(planes_equal(output, wanted));
  const ExrReader normal(dir_ / "normal.0004.exr");
  constexpr const char* kAxes[] = {"X", "Y", "Z"};
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_TRUE(planes_equal(normal.read_planes<1>(kAxes[c])[0], frame_.surface.normal[c]));
  }
  EXPECT_FALSE(std::filesystem::exists(dir_ / "color.0003.exr")) << "not measured, not asked for";
}

TEST_F(ExternalRunTest, RunsOnceForASequence) {
  (void)run(
      "echo run >>{output}.log; for f in $(echo {all_frames} | tr - ' '); do cp $(printf "
      "{color} $f) $(printf {output} $f); done");
  EXPECT_TRUE(std::filesystem::exists(dir_ / "output.0003.exr"));
  EXPECT_TRUE(std::filesystem::exists(dir_ / "output.0004.exr"));
  std::ifstream log(dir_ / "output.%04d.exr.log");
  std::string runs((std::istreambuf_iterator<char>(log)), std::istreambuf_iterator<char>());
  EXPECT_EQ(runs, "run\n");
}

TEST_F(ExternalRunTest, TakesThePrintedTime) {
  const ExternalCost cost =
      run("cp {color} {output}; echo 'frame {frame}: filter ms: 12.5'; echo 'filter ms: 0.25' >&2",
          "filter ms: ([0-9.]+)");
  EXPECT_DOUBLE_EQ(cost.ms, 12.75);
}

TEST_F(ExternalRunTest, SequenceTimesAreSharedByItsFrames) {
  const ExternalCost cost =
      run("cp $(printf {color} 4) $(printf {output} 4); echo ms 10; echo ms 30; : {all_frames}",
          "ms ([0-9]+)");
  EXPECT_DOUBLE_EQ(cost.ms, 20.0);
}

TEST_F(ExternalRunTest, FailuresAreOneLineThatNamesTheMethod) {
  EXPECT_EQ(failure("echo 'no such network' >&2; echo more >&2; exit 3; : {color} {output}"),
            "external 'tool': exit status 3: no such network");
  EXPECT_THAT(failure("true {color} {output}"),
              AllOf(HasSubstr("external 'tool': it left no "), HasSubstr("output.0004.exr")));
  EXPECT_THAT(failure("cp {color} {output}; echo time: fast", "ms: (.*)"),
              HasSubstr("nothing that it printed matches 'ms: (.*)'"));
  EXPECT_THAT(failure("cp {color} {output}; echo ms: fast", "ms: (.*)"),
              HasSubstr("its time 'fast' is not a number"));
  EXPECT_THAT(failure("echo text >{output}; : {color}"), HasSubstr("output.0004.exr"));
}

TEST_F(ExternalRunTest, OutputsOfAnotherSizeAreRefused) {
  (void)run("cp {color} {output}");
  EXPECT_THAT(
      [&] {
        (void)run_->output(4, {24, 17});
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("is 24x16, expected 24x17")));
}

TEST_F(ExternalRunTest, StopsBetweenRuns) {
  (void)run("cp {color} {output}");
  ExternalCost cost;
  EXPECT_FALSE(run_->run([] { return true; }, cost));
}

}  // namespace
}  // namespace eigenlight

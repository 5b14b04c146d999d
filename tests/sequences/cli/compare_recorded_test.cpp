// `eigenlight compare` on recorded frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "sequences/files/atomic_file.h"
#include "sequences/files/exr_io.h"
#include "sequences/metrics/evaluate.h"
#include "tests/support/command_line.h"
#include "tests/support/compare.h"
#include "tests/support/fake_shot.h"
#include "tests/support/process.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using namespace std::chrono_literals;
using Json = nlohmann::json;

// Frames 1 to 6 of a shot; references of frames 3, 4 and 6.
class CompareRecorded : public testing::Test {
 protected:
  CompareRecorded() { write_shot({48, 32}); }

  void write_shot(Extent extent) {
    FakeShot shot{.extent = extent};
    for (int frame = 1; frame <= 6; ++frame) shot.write(path("s", frame), frame);
    for (const int frame : {3, 4, 6}) write_reference(shot, frame);
  }
  [[nodiscard]] fs::path path(const std::string& name, int frame) const {
    return dir_ / (name + ".000" + std::to_string(frame) + ".exr");
  }
  // Two halves: the truth with noise of their own; no surface in the left half, says the file.
  void write_reference(const FakeShot& shot, int frame) const {
    std::vector<Plane<float>> planes;
    std::vector<std::string> names;
    Plane<std::uint32_t> id(shot.extent);
    for (const std::uint32_t half : {1u, 2u}) {
      const std::uint32_t key = 7000 * half + static_cast<std::uint32_t>(frame);
      for (int c = 0; c < 3; ++c) {
        planes.emplace_back(shot.extent);
        names.push_back(std::string(half == 1 ? "HalfA" : "HalfB") + ".Combined." + "RGB"[c]);
        for (int y = 0; y < shot.extent.height; ++y) {
          for (int x = 0; x < shot.extent.width; ++x) {
            const float noise = 0.95f + 0.1f * to_unit(hash_key(key, x, y));
            planes.back()(x, y) = shot.beauty(frame, x, y, c) * noise;
            id(x, y) = x < shot.extent.width / 2 ? 0 : 1;
          }
        }
      }
    }
    std::vector<ExrChannel> channels{{"id", ExrType::kUint, &id}};
    for (std::size_t i = 0; i < planes.size(); ++i) {
      channels.push_back({names[i], ExrType::kFloat, &planes[i]});
    }
    write_exr(path("ref", frame), channels, {});
  }
  [[nodiscard]] std::string reference(const std::string& half) const {
    return (dir_ / "ref.####.exr:").string() + half;
  }
  [[nodiscard]] std::vector<std::string> words(const std::string& out,
                                               const std::vector<std::string>& more) const {
    std::vector<std::string> all{"compare",       dir_ / "s.####.exr", "-o",
                                 dir_ / out,      "--reference",       reference("HalfA"),
                                 "--reference-b", reference("HalfB")};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  [[nodiscard]] Outcome compare(const std::string& out,
                                const std::vector<std::string>& more = {}) const {
    return call(words(out, more));
  }
  [[nodiscard]] Json cell(const std::string& out, const std::string& contender) const {
    const Json found = Json::parse(read_whole_file(dir_ / out / "results.json"));
    for (const Json& one : found["scenes"][0]["cells"]) {
      if (one["contender"] == contender) return one;
    }
    return {};
  }
  [[nodiscard]] double evaluated(const std::string& test, Metric metric) const {
    EvaluateOptions options;
    options.test = test;
    options.reference = reference("HalfA");
    options.reference_b = reference("HalfB");
    options.layer = "color";
    options.frames = "3,4,6";
    options.takes_all_pixels = true;
    return *evaluate(options).mean[0][metric];
  }

  TempDir dir_;
};

TEST_F(CompareRecorded, MeasuresWhatDenoiseWritesAndWhatTheFilesHold) {
  const Outcome run = compare("a");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("s, frames 3-4,6\n"), HasSubstr("files ms denoise ms"),
                             HasSubstr("a/index.html")));
  const Outcome denoised = call({"denoise", dir_ / "s.####.exr", "-o", dir_ / "clean"});
  ASSERT_EQ(denoised.status, 0) << denoised.err;
  for (const int frame : {3, 4, 6}) {
    const std::string name = "frame.000" + std::to_string(frame) + ".exr";
    const ExrReader ours(dir_ / "a/frames/s/eigenlight" / name);
    const ExrReader whole(dir_ / ("clean/s.000" + std::to_string(frame) + ".exr"));
    EXPECT_TRUE(planes_equal(ours.read_planes<3>(""), whole.read_planes<3>("View.Combined")));
  }
  const std::pair<const char*, fs::path> both[] = {{"eigenlight", dir_ / "clean/s.####.exr"},
                                                   {"noisy", dir_ / "s.####.exr"}};
  for (const auto& [contender, files] : both) {
    const Json found = cell("a", contender);
    EXPECT_EQ(found["per_frame"].size(), 3u);
    EXPECT_DOUBLE_EQ(found["mean"]["relmse"], evaluated(files, Metric::kRelmse)) << contender;
    EXPECT_DOUBLE_EQ(found["mean"]["temporal_error"], evaluated(files, Metric::kTemporalError));
    EXPECT_EQ(found["mean"]["pixels"], 3 * 48 * 32);
    EXPECT_NEAR(found["mean"]["energy"].get<double>(), 1.0, 0.05);
  }
  EXPECT_LT(cell("a", "eigenlight")["mean"]["relmse"], cell("a", "noisy")["mean"]["relmse"]);
  EXPECT_GT(cell("a", "eigenlight")["cpu_ms"]["denoise"], 0.0);
  EXPECT_GT(cell("a", "eigenlight")["cpu_ms"]["files"], 0.0);
  EXPECT_EQ(cell("a", "noisy")["cpu_ms"]["total"], 0.0);
  EXPECT_THAT(read_whole_file(dir_ / "a/index.html"),
              AllOf(HasSubstr("data:image/jpeg"), HasSubstr("the beauty"), Not(HasSubstr(" spp"))));
  EXPECT_FALSE(fs::exists(dir_ / "a/denoised"));
}

TEST_F(CompareRecorded, ProgramsGetTheBeautyItsAlbedoAndNormals) {
  const Outcome run = compare(
      "a", {"--methods", "noisy", "--external", "copy=cp {color} {output}; echo took 7.5 ms",
            "--external-time", "copy=took ([0-9.]+) ms", "--external",
            "paint=cp {albedo} {output}; : {color}", "--external",
            "all=for f in 0003 0004 0006; do cp {color} {output}; done; : {normal} {frame}"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(cell("a", "copy")["per_frame"], cell("a", "noisy")["per_frame"]);
  EXPECT_EQ(cell("a", "copy")["cpu_ms"]["denoise"], 7.5);
  EXPECT_EQ(cell("a", "all")["per_frame"], cell("a", "noisy")["per_frame"]);
  EXPECT_TRUE(planes_equal(ExrReader(dir_ / "a/frames/s/paint/frame.0004.exr").read_planes<3>(""),
                           ExrReader(path("s", 4)).read_planes<3>("View.DiffCol")));
}

TEST_F(CompareRecorded, OurOtherMethodsRunOnEachLayerAndComposeTheBeauty) {
  const Outcome run = compare("a", {"--methods", "noisy,mean,svgf", "--markdown", "-"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("| shot | method | relMSE |"), HasSubstr("| s | `svgf` |"),
                             HasSubstr("frames 3-4,6 of 1-6")));
  for (const char* method : {"mean", "svgf"}) {
    EXPECT_LT(cell("a", method)["mean"]["relmse"].get<double>(),
              0.5 * cell("a", "noisy")["mean"]["relmse"].get<double>());
    EXPECT_NEAR(cell("a", method)["mean"]["energy"].get<double>(), 1.0, 0.05);
  }
}

TEST_F(CompareRecorded, ALayerAndFramesCanBeChosen) {
  // The reference of frame 3 is another noise of the same light.
  for (const int frame : {1, 2, 3}) {
    fs::copy_file(path("s", frame + 3), path("other", frame));
  }
  const Outcome run = call({"compare", dir_ / "s.####.exr", "--reference", dir_ / "other.####.exr",
                            "--layer", "DiffInd", "--frames", "2-3", "--warmup", "0", "--methods",
                            "noisy,mean", "-o", dir_ / "a", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json found = Json::parse(run.out);
  EXPECT_EQ(found["settings"]["layer"], "DiffInd");
  EXPECT_EQ(found["settings"]["frames"], "2-3");
  EXPECT_EQ(found["settings"]["denoised_frames"], "2-6");
  EXPECT_TRUE(planes_equal(ExrReader(dir_ / "a/frames/s/noisy/frame.0002.exr").read_planes<3>(""),
                           ExrReader(path("s", 2)).read_planes<3>("View.DiffInd")));
}

TEST_F(CompareRecorded, SecondRunMeasuresOnlyWhatIsMissingOrChanged) {
  const std::vector<std::string> options{"--methods", "noisy,mean"};
  ASSERT_EQ(compare("a", options).status, 0);
  const std::string csv = read_whole_file(dir_ / "a/results.csv");
  EXPECT_THAT(compare("a", options).err, Not(HasSubstr("s: "))) << "all was there";
  EXPECT_EQ(read_whole_file(dir_ / "a/results.csv"), csv);
  EXPECT_THAT(compare("a", {"--methods", "noisy,mean,eigenlight"}).err,
              AllOf(HasSubstr("s: eigenlight, 6 frames"), Not(HasSubstr("s: mean"))));
  fs::remove_all(dir_ / "a/frames/s/mean");
  EXPECT_THAT(compare("a", options).err,
              AllOf(HasSubstr("s: mean, 6 frames"), Not(HasSubstr("s: noisy"))));
  fs::last_write_time(path("s", 2), fs::file_time_type::clock::now() + 1h);
  EXPECT_THAT(compare("a", options).err,
              AllOf(HasSubstr("s: mean, 6 frames"), HasSubstr("s: noisy")));
}

TEST_F(CompareRecorded, GoesOnAfterAKillWithTheSameFigures) {
  write_shot({320, 200});
  std::vector<std::string> command = words("parts", {});
  command.insert(command.begin(), EIGENLIGHT_BINARY);
  {
    Process killed(command);
    const auto is_started = [&] {
      std::error_code error;
      for (const auto& entry : fs::recursive_directory_iterator(dir_ / "parts/denoised", error)) {
        if (entry.path().filename() == "s.0002.exr") return true;
      }
      return false;
    };
    for (int i = 0; i < 4000 && !is_started(); ++i) std::this_thread::sleep_for(1ms);
    killed.signal(SIGKILL);
    ASSERT_EQ(killed.wait(), 128 + SIGKILL) << "it was faster than the kill";
  }
  ASSERT_EQ(compare("parts").status, 0);
  ASSERT_EQ(compare("whole").status, 0);
  EXPECT_EQ(cell("parts", "eigenlight")["per_frame"], cell("whole", "eigenlight")["per_frame"]);
}

TEST_F(CompareRecorded, EachMistakeIsOneLineAndMakesNothing) {
  const std::pair<std::vector<std::string>, const char*> mistakes[] = {
      {words("x", {"--methods", "chen2012"}), "method 'chen2012': not on recorded frames: it asks"},
      {words("x", {"--methods", "meyer2006"}), "it reads the whole sequence ahead"},
      {words("x", {"--methods", "magic"}), "unknown method 'magic'"},
      {words("x", {"--ablate"}), "--ablate is for scenes, not for recorded frames"},
      {words("x", {"--spp", "4"}), "--spp is for scenes"},
      {words("x", {"--frames", "1-3"}), "ref.0001.exr: no such file"},
      {words("x", {"--layer", "Gloss"}), "no layer 'Gloss'; it has: "},
      {words("x", {"--warmup", "-1"}), "warmup -1: expected 0 or more"},
      {words("x", {"--crop", "90x9+0+0"}), "reaches beyond the picture of 48x32"},
      {{"compare", "cornell", dir_ / "s.####.exr", "-o", dir_ / "x", "--reference", "r.####.exr"},
       "scene 'cornell': recorded frames such as "},
      {{"compare", dir_ / "s.####.exr", "-o", dir_ / "x"}, "recorded frames need --reference"},
      {{"compare", path("s", 1), "-o", dir_ / "x", "--reference", "r.####.exr"},
       "expected a pattern such as shot.####.exr"},
      {{"compare", "cornell", "-o", dir_ / "x", "--layer", "DiffInd"},
       "layer 'DiffInd': expected indirect or color"},
      {{"compare", dir_ / "s.####.exr", "-o", dir_ / "x", "--reference", dir_ / "none.####.exr"},
       "none.####.exr: no frame of "},
  };
  for (const auto& [line, message] : mistakes) {
    const Outcome run = call(line);
    EXPECT_EQ(run.status, 2) << message;
    EXPECT_THAT(run.err, AllOf(StartsWith("eigenlight: "), HasSubstr(message)));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(fs::exists(dir_ / "x")) << message;
  }
}

TEST_F(CompareRecorded, AProgramThatNeedsWhatTheFilesLackIsNamed) {
  FakeShot bare{.extent = {48, 32}, .has_albedo = false};
  for (int frame = 1; frame <= 6; ++frame) bare.write(path("s", frame), frame);
  const Outcome run =
      compare("a", {"--methods", "noisy", "-q", "--external", "x=cp {color} {output} # {albedo}"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("s.0003.exr has no layer for {albedo}"));
}

}  // namespace
}  // namespace eigenlight

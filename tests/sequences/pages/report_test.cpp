#include "sequences/pages/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "sequences/files/atomic_file.h"
#include "sequences/pages/report_data.h"
#include "sequences/pages/report_pictures.h"
#include "tests/support/fake_run.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

std::vector<int> first_frames(int count) {
  std::vector<int> frames(static_cast<std::size_t>(count));
  std::iota(frames.begin(), frames.end(), 10);
  return frames;
}

std::string page_of(const std::filesystem::path& dir) {
  return read_whole_file(dir / "index.html");
}

// The JSON that the page's script reads.
nlohmann::json data_of(const std::string& page) {
  const std::string open = "id=\"data\">";
  const std::size_t begin = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

TEST(Report, OneFileHoldsPicturesAndNumbersOfAllFrames) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = first_frames(3)});
  write_report(dir.path());
  const std::string page = page_of(dir.path());
  EXPECT_THAT(page, AllOf(HasSubstr("<title>A made-up room: running-mean</title>"),
                          Not(HasSubstr("{{")), Not(HasSubstr("src=\"http"))));
  const auto data = data_of(page);
  EXPECT_EQ(data["frames"], nlohmann::json({10, 11, 12}));
  EXPECT_EQ(data["rank"].size(), 3u);
  EXPECT_EQ(data["new_share"][0], 1.0);
  for (const char* kind : {"beauty", "indirect"}) {
    for (const char* side : {"noisy", "denoised"}) {
      ASSERT_EQ(data["pictures"]["kinds"][kind][side].size(), 3u) << kind << side;
      EXPECT_THAT(data["pictures"]["kinds"][kind][side][2].get<std::string>(),
                  testing::StartsWith("data:image/jpeg;base64,/9j/"));
    }
  }
}

TEST(Report, TitleIsTextAndNeverMarkup) {
  const TempDir dir;
  write_fake_run(dir.path(), {.title = "</script><script>\"bad\" & {{data}}", .frames = {1}});
  write_report(dir.path());
  const std::string page = page_of(dir.path());
  EXPECT_THAT(page, Not(HasSubstr("</script><script>\"bad\"")));
  EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;script&gt;&quot;bad&quot; &amp; {{data}}"));
  EXPECT_EQ(data_of(page)["frames"], nlohmann::json({1}));
}

TEST(Report, LayersThatAreNotThereAreNotShown) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = {1}, .layers = "color"});
  auto pictures = report_pictures(dir.path(), {1}, {});
  EXPECT_EQ(pictures["kinds"].size(), 1u);
  EXPECT_FALSE(pictures["kinds"]["beauty"].contains("noisy"));
  const TempDir other;
  write_fake_run(other.path(), {.frames = {1}, .layers = "albedo"});
  EXPECT_TRUE(report_pictures(other.path(), {1}, {})["frames"].empty());
}

TEST(Report, LongRunsAreThinnedAndLargeOnesShrunk) {
  const TempDir dir;
  const FakeRun run{.frames = first_frames(10)};
  write_fake_run(dir.path(), run);
  const auto thinned = report_pictures(dir.path(), run.frames, {.max_frames = 4});
  EXPECT_EQ(thinned["frames"], nlohmann::json({10, 13, 16, 19}));
  EXPECT_NEAR(thinned["fps"].get<double>(), 9.6, 1e-5);
  const auto shrunk = report_pictures(dir.path(), run.frames, {.max_bytes = 30000});
  EXPECT_EQ(shrunk["frames"].size(), 10u);
  EXPECT_LT(shrunk["width"], run.extent.width);
  EXPECT_LT(shrunk.dump().size(), 30000u * 4 / 3 * 11 / 10);
  EXPECT_EQ(report_pictures(dir.path(), run.frames, {})["width"], run.extent.width);
}

TEST(Report, FramesWithoutAFileStayInThePlots) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = first_frames(3)});
  std::filesystem::remove(dir / "frame.0011.exr");
  write_report(dir.path());
  const auto data = data_of(page_of(dir.path()));
  EXPECT_EQ(data["frames"].size(), 3u);
  EXPECT_EQ(data["pictures"]["frames"], nlohmann::json({10, 12}));
}

TEST(Report, NamesFileAndLineOfWhatItCannotRead) {
  const TempDir dir;
  const auto write = [&] { write_report(dir.path()); };
  EXPECT_THAT(write, ThrowsMessage<std::runtime_error>(HasSubstr("run.json")));
  write_fake_run(dir.path(), {.frames = first_frames(2)});
  std::ofstream(dir / "frames.jsonl", std::ios::app) << "{\"frame\": 3}\n";
  EXPECT_THAT(write, ThrowsMessage<std::runtime_error>(
                         AllOf(HasSubstr("frames.jsonl: line 3: field '"), HasSubstr("missing"))));
  std::ofstream(dir / "frames.jsonl") << "oh\n";
  EXPECT_THAT(write, ThrowsMessage<std::runtime_error>(HasSubstr("line 1: expected a JSON")));
  std::ofstream(dir / "frames.jsonl") << "";
  EXPECT_THAT(write, ThrowsMessage<std::runtime_error>(HasSubstr("no frame is done yet")));
  EXPECT_FALSE(std::filesystem::exists(dir / "index.html"));
}

TEST(Report, UnreadablePictureIsNamed) {
  const TempDir dir;
  write_fake_run(dir.path(), {.frames = first_frames(2)});
  std::ofstream(dir / "frame.0011.exr") << "not a picture";
  EXPECT_THAT([&] { write_report(dir.path()); },
              ThrowsMessage<std::runtime_error>(HasSubstr("frame.0011.exr")));
}

}  // namespace
}  // namespace eigenlight

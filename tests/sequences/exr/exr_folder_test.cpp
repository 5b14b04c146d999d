// Files that others made, where they are at hand: EIGENLIGHT_EXR_FOLDER names a folder, and every
// file in it is either copied with everything equal, also where one channel of each part is
// replaced, or refused in one line that names it. Without the variable there is nothing to do.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "frame/bad_file.h"
#include "frame/tiles.h"
#include "sequences/exr/exr_rewrite.h"
#include "tests/support/exr_core.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_below(const char* folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_regular_file() || name == "LICENSE" || name.ends_with(".md")) continue;
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void expect_one_line(const std::string& message, const fs::path& file) {
  EXPECT_TRUE(message.starts_with(file.string() + ": ")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_EQ(message.rfind(file.string()), 0u) << "names the file twice: " << message;
}

// The first channel of each part that may have new pixels.
std::vector<int> first_channels(const ExrFile& file) {
  std::vector<int> chosen;
  for (int i = 0; i < static_cast<int>(file.channels().size()); ++i) {
    const ExrChannelInfo& c = file.channels()[static_cast<std::size_t>(i)];
    if (file.parts()[static_cast<std::size_t>(c.part)].is_deep || c.type == ExrType::kUint ||
        c.x_sampling != 1 || c.y_sampling != 1) {
      continue;
    }
    const bool has_part = std::any_of(chosen.begin(), chosen.end(), [&](int other) {
      return file.channels()[static_cast<std::size_t>(other)].part == c.part;
    });
    if (!has_part) chosen.push_back(i);
  }
  return chosen;
}

// What is wrong with the copy; empty if all is well.
std::string compare(const fs::path& in, const fs::path& out,
                    const std::vector<std::string>& replaced) {
  CoreFile one;
  try {
    one = CoreReader::read(in.string());
  } catch (const std::runtime_error& error) {
    return fmt::format("not compared: {}", error.what());
  }
  std::string text;
  for (const std::string& line : differences(one, CoreReader::read(out.string()), replaced)) {
    text += fmt::format("{}; ", line);
  }
  EXPECT_EQ(text, "") << in;
  return text;
}

std::string try_file(const fs::path& path, const fs::path& out) {
  const ExrFile file(path);
  rewrite_exr(file, out, {});
  std::string result = fmt::format("copied {}", compare(path, out, {}));
  const std::vector<int> chosen = first_channels(file);
  std::vector<Plane<float>> planes;
  std::vector<ExrReplacement> replacements;
  std::vector<std::string> names;
  for (const int index : chosen) {
    const ExrChannelInfo& c = file.channels()[static_cast<std::size_t>(index)];
    const ExrWindow& window = file.parts()[static_cast<std::size_t>(c.part)].data;
    try {
      planes.emplace_back(Extent{window.width, window.height}).fill(0.25f);
    } catch (const std::exception&) {
      (void)file.read(std::array{index});  // says why not
    }
    names.push_back(fmt::format("{} {}", c.part, c.name));
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) replacements.push_back({chosen[i], &planes[i]});
  const ExrRewriteReport report = rewrite_exr(file, out, replacements);
  result += fmt::format("; {} replaced {}", chosen.size(), compare(path, out, names));
  for (const std::string& line : report.recompressed) result += fmt::format("; {}", line);
  for (const std::string& line : report.levels) result += fmt::format("; {}", line);
  const ExrFile again(out);
  for (const Plane<float>& plane : again.read(chosen)) {
    for (int y = 0; y < plane.height(); ++y) {
      EXPECT_EQ(std::count(plane.row(y), plane.row(y) + plane.width(), 0.25f), plane.width());
    }
  }
  return result;
}

TEST(ExrFolder, EveryFileIsCopiedOrRefused) {
  const char* folder = std::getenv("EIGENLIGHT_EXR_FOLDER");
  if (!folder) GTEST_SKIP() << "EIGENLIGHT_EXR_FOLDER is not set";
  const TempDir dir;
  for (const fs::path& file : files_below(folder)) {
    std::printf("%s: ", file.filename().c_str());
    std::fflush(stdout);  // a crash must name its file
    std::string result;
    try {
      result = try_file(file, dir / "out.exr");
    } catch (const std::runtime_error& error) {
      expect_one_line(error.what(), file);
      result = fmt::format("refused: {}", error.what());
    }
    std::printf("%s\n", result.c_str());
  }
  fs::remove(dir / "out.exr");
  EXPECT_TRUE(fs::is_empty(dir.path()));
}

}  // namespace
}  // namespace eigenlight

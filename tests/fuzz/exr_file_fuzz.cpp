// Any bytes as an OpenEXR file: described, decoded and copied, or refused with an exception.
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "sequences/exr/exr_rewrite.h"
#include "sequences/files/atomic_file.h"
#include "tests/fuzz/target.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

void check_refusal(const std::string& message, const std::filesystem::path& path) {
  FUZZ_CHECK(message.starts_with(path.string() + ": "));
  FUZZ_CHECK(message.find('\n') == std::string::npos);
}

void read_channel(const ExrFile& file, int index) {
  const ExrChannelInfo& channel = file.channels()[static_cast<std::size_t>(index)];
  const ExrWindow& window = file.parts()[static_cast<std::size_t>(channel.part)].data;
  // Larger pictures take longer without being another case.
  if (static_cast<double>(window.width) * window.height > 1e6) return;
  try {
    if (channel.type == ExrType::kUint) {
      (void)file.read_uint(index);
    } else {
      const std::vector<Plane<float>> planes = file.read(std::array{index});
      FUZZ_CHECK(planes[0].width() == window.width && planes[0].height() == window.height);
    }
  } catch (const std::runtime_error& error) {
    check_refusal(error.what(), file.path());
  }
}

// The same file with new pixels in its first channels.
void rewrite_with_pixels(const ExrFile& file, const std::filesystem::path& out) {
  std::vector<Plane<float>> planes;
  std::vector<ExrReplacement> pixels;
  planes.reserve(4);
  for (int i = 0; i < static_cast<int>(file.channels().size()) && planes.size() < 4; ++i) {
    const ExrChannelInfo& channel = file.channels()[static_cast<std::size_t>(i)];
    const ExrWindow& window = file.parts()[static_cast<std::size_t>(channel.part)].data;
    if (static_cast<double>(window.width) * window.height > 1e6) continue;
    if (window.width < 1 || window.height < 1) continue;
    planes.emplace_back(Extent{window.width, window.height});
    planes.back().fill(0.5f);
    pixels.push_back({i, &planes.back()});
  }
  try {
    rewrite_exr(file, out, pixels);
    FUZZ_CHECK(ExrFile(out).channels().size() == file.channels().size());
  } catch (const std::runtime_error& error) {
    check_refusal(error.what(), file.path());
  }
}

void check_file(std::string_view bytes) {
  static const TempDir dir;
  write_file_atomically(dir / "in.exr", bytes);
  try {
    const ExrFile file(dir / "in.exr");
    FUZZ_CHECK(!file.parts().empty() && !file.channels().empty());
    for (int i = 0; i < static_cast<int>(file.channels().size()) && i < 8; ++i) {
      read_channel(file, i);
    }
    rewrite_with_pixels(file, dir / "new.exr");
    rewrite_exr(file, dir / "out.exr", {});
    // A copy is again a file with the same channels.
    FUZZ_CHECK(ExrFile(dir / "out.exr").channels().size() == file.channels().size());
  } catch (const std::runtime_error& error) {
    check_refusal(error.what(), dir / "in.exr");
  }
  FUZZ_CHECK(!std::filesystem::exists(dir / ".out.exr.tmp"));
}

}  // namespace
}  // namespace eigenlight

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eigenlight::check_file(eigenlight::as_text(data, size));
  return 0;
}

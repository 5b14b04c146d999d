// Frame ranges and file patterns of any text: refused with std::invalid_argument, or understood in
// a way that survives being written and read again.
#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

#include "sequences/files/file_pattern.h"
#include "sequences/files/frame_range.h"
#include "tests/fuzz/target.h"

namespace eigenlight {
namespace {

void check_range(std::string_view text) {
  std::vector<int> frames;
  try {
    frames = parse_frame_range(text);
  } catch (const std::invalid_argument&) {
    return;
  }
  FUZZ_CHECK(!frames.empty());
  FUZZ_CHECK(std::set<int>(frames.begin(), frames.end()).size() == frames.size());
  const std::string written = format_frame_range(frames);
  FUZZ_CHECK(parse_frame_range(written) == frames);
}

void check_pattern(std::string_view text) {
  try {
    const FilePattern pattern(text);
    for (const int frame : {0, 7, -3, 12345, 10'000'000}) {
      FUZZ_CHECK(pattern.frame(pattern.name(frame)) == frame);
    }
    FUZZ_CHECK(!pattern.frame(text) || pattern.name(*pattern.frame(text)) == text);
  } catch (const std::invalid_argument&) {
  }
}

}  // namespace
}  // namespace eigenlight

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = eigenlight::as_text(data, size);
  eigenlight::check_range(text);
  eigenlight::check_pattern(text);
  return 0;
}

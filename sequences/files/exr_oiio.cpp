#include "sequences/files/exr_oiio.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "frame/tiles.h"

namespace eigenlight {
namespace {

// Standard attributes that OpenImageIO spells in its own way.
struct Renamed {
  std::string_view exr;
  const char* oiio;
};
constexpr Renamed kRenamed[] = {{"worldToCamera", "worldtocamera"}, {"worldToNDC", "worldtoNDC"}};

}  // namespace

std::string oiio_name(const std::string& exr_name) {
  for (const Renamed& renamed : kRenamed) {
    if (exr_name == renamed.exr) return renamed.oiio;
  }
  return exr_name;
}

void fail_exr(const std::string& path, std::string reason) {
  // Reasons of OpenImageIO may span lines.
  std::replace(reason.begin(), reason.end(), '\n', ' ');
  throw std::runtime_error(fmt::format("{}: {}", path, reason));
}

void use_our_threads_for_exr() {
  static int current = 0;
  if (current == thread_count()) return;
  current = thread_count();
  OIIO::attribute("threads", current);
  OIIO::attribute("exr_threads", current);
}

}  // namespace eigenlight

#include "sequences/list_commands.h"

#include <fmt/format.h>

#include "render/builtin_scenes.h"
#include "sequences/render_plan.h"
#include "temporal/denoiser.h"

namespace eigenlight {
namespace {

constexpr int kNameWidth = 14;

}  // namespace

void list_scenes(std::ostream& out) {
  for (const BuiltinScene& scene : builtin_scenes()) {
    out << fmt::format("{:<{}}{}\n", scene.name, kNameWidth, scene.what);
  }
}

void list_methods(std::ostream& out) {
  for (const Method& method : methods()) {
    out << fmt::format("{:<{}}{}", method.name, kNameWidth, method.what);
    if (!method.paper.empty()) out << fmt::format(" ({})", method.paper);
    out << '\n';
  }
  out << fmt::format(
      "{:<{}}no denoising, {} samples unless --spp says otherwise, seeds of its own\n",
      kReferenceMethod, kNameWidth, kReferenceSpp);
}

void list_parts(std::ostream& out) {
  for (const Method& method : methods()) {
    if (!method.parts.empty()) out << method.name << '\n';
    for (const Part& part : method.parts) {
      out << fmt::format("  {:<{}}{}\n", part.name, kNameWidth, part.what);
    }
  }
}

}  // namespace eigenlight

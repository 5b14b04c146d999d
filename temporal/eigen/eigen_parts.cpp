#include "temporal/eigen/eigen_parts.h"

#include <algorithm>
#include <array>

namespace eigenlight {
namespace {

struct Switch {
  Part part;
  void (*turn_off)(EigenOptions& options, int& bases);
};

constexpr std::array kSwitches{
    Switch{{"project", "light is taken to be steady: all coefficients stay (1, 0, ...)"},
           [](EigenOptions& options, int&) { options.project = false; }},
    Switch{{"modes", "one basis: light may change by a gain only"},
           [](EigenOptions&, int& bases) { bases = 1; }},
    Switch{{"shrink", "coefficients as least squares gives them, noise and all"},
           [](EigenOptions& options, int&) { options.shrink.noise = 0.0; }},
    Switch{{"test", "ages grow whatever the residual says"},
           [](EigenOptions& options, int&) { options.innovation.test = false; }},
    Switch{{"edges", "pixels where surfaces meet remember as long as others"},
           [](EigenOptions& options, int&) { options.max_age_edge = 255.0f; }},
    Switch{{"correct", "no smoothed innovation, and so no new basis either"},
           [](EigenOptions& options, int&) { options.correct = false; }},
    Switch{{"resample", "young pixels get no extra samples"},
           [](EigenOptions& options, int&) { options.budget.share = 0.0; }},
    Switch{{"guided", "young pixels are not filled by the guided filter"},
           [](EigenOptions& options, int&) { options.young_age = 0.0f; }},
    Switch{{"atrous", "no a-trous passes over the output"},
           [](EigenOptions& options, int&) { options.filter = false; }},
    Switch{{"look-back", "a-trous passes tell edges of light by this frame alone"},
           [](EigenOptions& options, int&) {
             options.look_back = false;
             options.atrous.luminance_sigmas = 5.0f;
           }},
};

}  // namespace

std::span<const Part> eigen_parts() {
  static const auto kParts = [] {
    std::array<Part, kSwitches.size()> parts;
    std::transform(kSwitches.begin(), kSwitches.end(), parts.begin(),
                   [](const Switch& entry) { return entry.part; });
    return parts;
  }();
  return kParts;
}

std::unique_ptr<Denoiser> make_eigen_denoiser(const DenoiserOptions& options) {
  EigenOptions tuning;
  DenoiserOptions used = options;
  for (const std::string& name : options.without) {
    const auto found = std::find_if(kSwitches.begin(), kSwitches.end(),
                                    [&](const Switch& entry) { return entry.part.name == name; });
    EL_CHECK(found != kSwitches.end(), "eigenlight has no part '{}'", name);
    found->turn_off(tuning, used.bases);
  }
  return std::make_unique<EigenDenoiser>(used, tuning);
}

}  // namespace eigenlight

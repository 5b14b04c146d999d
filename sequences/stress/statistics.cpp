// Pure noise around a known light: what the method makes of it on average.
#include <cmath>

#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

constexpr int kFrames = 12;

// One image size and how many seeds of it.
struct Sample {
  Extent extent;
  int seeds;
};
// Many small images, and fewer in which a coefficient tile has all its neighbors: there even a
// small bias of the gain stands out of its noise and is followed.
constexpr Sample kMany{{16, 16}, 1000}, kLarge{{96, 96}, 30};

// Of the last picture of a method, under the same light 1 everywhere.
struct Moments {
  double bias = 0.0;  // of the mean over seeds and pixels
  double variance = 0.0;
  double rank = 0.0;
};

Moments moments(Lab& lab, std::string_view method, NoiseKind kind, const Sample& sample) {
  Moments result;
  double square = 0.0;
  for (int seed = 0; seed < sample.seeds; ++seed) {
    AnalyticOptions options{.extent = sample.extent, .frames = kFrames};
    options.seed = static_cast<std::uint32_t>(seed);
    options.noise = 0.57f;
    options.noise_kind = kind;
    options.pattern = 0.0f;
    StressRun run(lab, options, method);
    (void)run.finish();
    result.bias += relative_bias(run) / sample.seeds;
    square += relative_error(run) / sample.seeds;
    result.rank += run.report().mean_rank / sample.seeds;
  }
  result.variance = square - result.bias * result.bias;
  return result;
}

template <NoiseKind kKind>
StressFinding check_bias(Lab& lab) {
  lab.note(std::abs(moments(lab, "eigenlight", kKind, kMany).bias), "16x16");
  lab.note(std::abs(moments(lab, "eigenlight", kKind, kLarge).bias), "96x96");
  return worst_of(lab, 0.005);
}

StressFinding check_variance(Lab& lab) {
  const double ours = moments(lab, "eigenlight", NoiseKind::kUniform, kMany).variance;
  lab.note(ours / moments(lab, "mean", NoiseKind::kUniform, kMany).variance);
  return worst_of(lab, 1.0);
}

StressFinding check_rank(Lab& lab) {
  lab.note(moments(lab, "eigenlight", NoiseKind::kExponential, kMany).rank, "16x16");
  lab.note(moments(lab, "eigenlight", NoiseKind::kExponential, kLarge).rank, "96x96");
  return worst_of(lab, 1.05);
}

}  // namespace

std::vector<StressCase> statistics_cases() {
  return {{"statistics.bias", "1000 seeds of uniform noise: share of the light lost or gained",
           false, check_bias<NoiseKind::kUniform>},
          {"statistics.skewed-bias", "1000 seeds of exponential noise: the same", false,
           check_bias<NoiseKind::kExponential>},
          {"statistics.variance", "1000 seeds: variance over that of the running mean", false,
           check_variance},
          {"statistics.rank", "1000 seeds of exponential noise: mean rank", false, check_rank}};
}

}  // namespace eigenlight

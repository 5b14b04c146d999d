// Bias, variance and rank in noise around constant light.
#include <cmath>

#include "sequences/stress/measures.h"
#include "sequences/stress/stress_case.h"

namespace eigenlight {
namespace {

constexpr int kFrames = 12;

// An image size and a number of seeds.
struct Sample {
  Extent extent;
  int seeds;
};
// Many small images, and fewer large ones in which a coefficient tile has all its neighbors: there
// even a small bias of the gain exceeds its noise.
constexpr Sample kMany{{16, 16}, 1000}, kLarge{{96, 96}, 30};

// Moments of a method's last picture; the light is 1 everywhere.
struct Moments {
  double bias = 0.0;  // mean over seeds and pixels
  double variance = 0.0;
  double rank = 0.0;
};

Moments moments(StressLog& log, std::string_view method, NoiseKind kind, const Sample& sample) {
  Moments result;
  double square = 0.0;
  for (int seed = 0; seed < sample.seeds; ++seed) {
    AnalyticOptions options{.extent = sample.extent, .frames = kFrames};
    options.seed = static_cast<std::uint32_t>(seed);
    options.noise = 0.57f;
    options.noise_kind = kind;
    options.pattern = 0.0f;
    StressRun run(log, options, method);
    (void)run.finish();
    result.bias += relative_bias(run) / sample.seeds;
    square += relative_error(run) / sample.seeds;
    result.rank += run.report().mean_rank / sample.seeds;
  }
  result.variance = square - result.bias * result.bias;
  return result;
}

template <NoiseKind kKind>
StressFinding check_bias(StressLog& log) {
  log.note(std::abs(moments(log, "eigenlight", kKind, kMany).bias), "16x16");
  log.note(std::abs(moments(log, "eigenlight", kKind, kLarge).bias), "96x96");
  return worst_of(log, 0.005);
}

StressFinding check_variance(StressLog& log) {
  const double ours = moments(log, "eigenlight", NoiseKind::kUniform, kMany).variance;
  log.note(ours / moments(log, "mean", NoiseKind::kUniform, kMany).variance);
  return worst_of(log, 1.0);
}

StressFinding check_rank(StressLog& log) {
  log.note(moments(log, "eigenlight", NoiseKind::kExponential, kMany).rank, "16x16");
  log.note(moments(log, "eigenlight", NoiseKind::kExponential, kLarge).rank, "96x96");
  return worst_of(log, 1.05);
}

}  // namespace

std::vector<StressCase> statistics_cases() {
  return {
      {"statistics.bias", "1000 seeds of uniform noise: share of light lost or gained", false,
       check_bias<NoiseKind::kUniform>},
      {"statistics.skewed-bias", "1000 seeds of exponential noise: share of light lost or gained",
       false, check_bias<NoiseKind::kExponential>},
      {"statistics.variance",
       "1000 seeds of uniform noise: variance / variance of the running mean", false,
       check_variance},
      {"statistics.rank", "1000 seeds of exponential noise: mean rank", false, check_rank}};
}

}  // namespace eigenlight

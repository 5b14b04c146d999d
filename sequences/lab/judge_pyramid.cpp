#include "sequences/lab/judge_pyramid.h"

#include <algorithm>
#include <string>
#include <vector>

namespace eigenlight {
namespace {

std::string kind_of(const std::string& name, const PyramidPictures& pictures) {
  const auto is_in = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (is_in(pictures.images)) return "files";
  if (is_in(pictures.scenes)) return "frames, 1 sample";
  return name.ends_with("noisy") ? "painted, noisy" : "painted";
}

void add(const Similarity& one, Similarity& sum) { sum.psnr += one.psnr, sum.ssim += one.ssim; }

}  // namespace

std::vector<PyramidJudgement> judge_pyramid(const PyramidPictures& pictures, int radius, int side) {
  std::vector<PyramidJudgement> kinds;
  const auto r = static_cast<float>(radius);
  for (const auto& [name, example] : make_pyramid_examples(pictures, radius, side)) {
    const std::string kind = kind_of(name, pictures);
    auto at = std::find_if(kinds.begin(), kinds.end(),
                           [&](const PyramidJudgement& j) { return j.kind == kind; });
    if (at == kinds.end()) at = kinds.insert(at, PyramidJudgement{kind, radius, 0, {}, {}});
    const auto judge = [&one = example](const PyramidWeights& weights) {
      return similarity(one.filter(weights), one.target(), one.weight());
    };
    ++at->pictures;
    add(judge(trained_pyramid_table().weights(r)), at->trained);
    add(judge(untrained_pyramid_weights(r)), at->untrained);
  }
  for (PyramidJudgement& j : kinds) {
    for (Similarity* sum : {&j.trained, &j.untrained}) {
      sum->psnr /= static_cast<double>(j.pictures);
      sum->ssim /= static_cast<double>(j.pictures);
    }
  }
  return kinds;
}

}  // namespace eigenlight

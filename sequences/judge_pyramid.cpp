#include "sequences/judge_pyramid.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "frame/tiles.h"

namespace eigenlight {
namespace {

// Not those that the table was trained on: painted pictures from here on, another frame.
constexpr std::uint32_t kSeed = 1000;
constexpr int kFrame = 40;

struct CommandOptions {
  PyramidPictures pictures{.painted = 6, .seed = kSeed, .frame = kFrame};
  std::vector<int> radii{2, 4, 8, 16, 32, 64};
  int side = 128;
  int threads = 0;
};

std::string kind_of(const std::string& name, const PyramidPictures& pictures) {
  const auto is_in = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (is_in(pictures.images)) return "files";
  if (is_in(pictures.scenes)) return "frames, 1 sample";
  return name.ends_with("noisy") ? "painted, noisy" : "painted";
}

void add(const Likeness& one, Likeness& sum) { sum.psnr += one.psnr, sum.ssim += one.ssim; }

std::string row(const PyramidJudgement& j) {
  const auto better = [](double a, double b, const std::string& text) {
    return a > b ? "**" + text + "**" : text;
  };
  const auto cell = [&](const Likeness& a, const Likeness& b) {
    return better(a.psnr, b.psnr, fmt::format("{:.2f} dB", a.psnr)) + ", " +
           better(a.ssim, b.ssim, fmt::format("{:.4f}", a.ssim));
  };
  return fmt::format("| {} | {} | {} | {} | {} |\n", j.radius, j.kind, j.pictures,
                     cell(j.trained, j.untrained), cell(j.untrained, j.trained));
}

void run(const CommandOptions& options, const Console& console) {
  options.pictures.validate();
  EL_CHECK(options.side >= 8 && options.side <= 1024, "side {}: expected 8 to 1024", options.side);
  for (const int radius : options.radii) {
    EL_CHECK(radius >= 1 && radius <= 64, "radius {}: expected 1 to 64", radius);
  }
  set_thread_count(options.threads);
  console.out << "| radius | pictures | | trained | untrained |\n"
                 "| ---: | --- | ---: | ---: | ---: |\n";
  for (const int radius : options.radii) {
    for (const PyramidJudgement& j : judge_pyramid(options.pictures, radius, options.side)) {
      console.out << row(j) << std::flush;
    }
  }
}

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
      return likeness(one.filter(weights), one.target(), one.weight());
    };
    ++at->pictures;
    add(judge(trained_pyramid_table().weights(r)), at->trained);
    add(judge(untrained_pyramid_weights(r)), at->untrained);
  }
  for (PyramidJudgement& j : kinds) {
    for (Likeness* sum : {&j.trained, &j.untrained}) {
      sum->psnr /= static_cast<double>(j.pictures);
      sum->ssim /= static_cast<double>(j.pictures);
    }
  }
  return kinds;
}

void add_judge_pyramid_command(CLI::App& app, const Console& console) {
  CLI::App* command = app.add_subcommand(
      "judge-pyramid", "Compare the pyramid filter, trained and untrained, with brute force");
  const auto options = std::make_shared<CommandOptions>();
  command->add_option("--images", options->pictures.images,
                      "EXR, PNG or JPEG files to be judged by, besides the painted pictures");
  command->add_option("--painted", options->pictures.painted, "Pictures painted by code")
      ->capture_default_str();
  command->add_option("--scenes", options->pictures.scenes, "Built-in scenes, one noisy frame each")
      ->capture_default_str();
  command->add_option("--radii", options->radii, "Pixels, 1 to 64")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--side", options->side, "Of each picture, pixels")->capture_default_str();
  command->add_option("--threads", options->threads, "0: one per core")->capture_default_str();
  command->callback([options, &console] { run(*options, console); });
}

}  // namespace eigenlight

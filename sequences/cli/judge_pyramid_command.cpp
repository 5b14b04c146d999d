#include "sequences/cli/judge_pyramid_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "frame/tiles.h"
#include "sequences/lab/judge_pyramid.h"

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

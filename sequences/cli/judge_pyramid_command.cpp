#include "sequences/cli/judge_pyramid_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "sequences/cli/job.h"
#include "sequences/lab/judge_pyramid.h"

namespace eigenlight {
namespace {

// Painted pictures from this seed on and this frame are not among those that trained the table.
constexpr std::uint32_t kSeed = 1000;
constexpr int kFrame = 40;

constexpr std::string_view kTableHead =
    "| radius | pictures | | trained | untrained |\n"
    "| ---: | --- | ---: | ---: | ---: |\n";

struct JudgeCommand {
  PyramidPictures pictures{.painted = 6, .seed = kSeed, .frame = kFrame};
  std::vector<int> radii{2, 4, 8, 16, 32, 64};
  int side = 128;
  JobOptions job;
};

std::string row(const PyramidJudgement& j) {
  const auto better = [](double a, double b, const std::string& text) {
    return a > b ? "**" + text + "**" : text;
  };
  const auto cell = [&](const Similarity& a, const Similarity& b) {
    return better(a.psnr, b.psnr, fmt::format("{:.2f} dB", a.psnr)) + ", " +
           better(a.ssim, b.ssim, fmt::format("{:.4f}", a.ssim));
  };
  return fmt::format("| {} | {} | {} | {} | {} |\n", j.radius, j.kind, j.pictures,
                     cell(j.trained, j.untrained), cell(j.untrained, j.trained));
}

int run(const JudgeCommand& command, const Console& console) {
  command.pictures.validate();
  EL_CHECK(command.side >= 8 && command.side <= 1024, "side {}: expected 8 to 1024", command.side);
  for (const int radius : command.radii) {
    EL_CHECK(radius >= 1 && radius <= 64, "radius {}: expected 1 to 64", radius);
  }
  const Job job(command.job, console);
  bool has_head = false;
  for (const int radius : command.radii) {
    job.stop_if_interrupted("stopped");
    // Reads all files: errors come before the head of the table.
    const std::vector<PyramidJudgement> judgements =
        judge_pyramid(command.pictures, radius, command.side);
    if (!std::exchange(has_head, true)) console.out << kTableHead;
    for (const PyramidJudgement& j : judgements) console.out << row(j) << std::flush;
  }
  return kSuccess;
}

}  // namespace

Command add_judge_pyramid_command(CLI::App& app) {
  CLI::App* parser = app.add_subcommand(
      "judge-pyramid", "Compare the pyramid filter, trained and untrained, with brute force");
  const auto command = std::make_shared<JudgeCommand>();
  parser->add_option("--images", command->pictures.images,
                     "EXR, PNG or JPEG files to judge by, in addition to the painted pictures");
  parser->add_option("--painted", command->pictures.painted, "Number of painted pictures")
      ->capture_default_str();
  parser
      ->add_option("--scenes", command->pictures.scenes,
                   "Built-in scenes to judge by, one noisy frame each")
      ->capture_default_str();
  parser->add_option("--radii", command->radii, "Comma-separated radii in pixels, 1 to 64")
      ->delimiter(',')
      ->capture_default_str();
  parser->add_option("--side", command->side, "Width and height of each picture in pixels")
      ->capture_default_str();
  add_job_options(*parser, command->job);
  return {parser, [command](const Console& console) { return run(*command, console); }};
}

}  // namespace eigenlight

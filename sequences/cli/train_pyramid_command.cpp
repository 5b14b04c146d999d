#include "sequences/cli/train_pyramid_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "sequences/cli/job.h"
#include "sequences/files/atomic_file.h"
#include "sequences/lab/train_pyramid.h"

namespace eigenlight {
namespace {

struct TrainCommand {
  TrainPyramidOptions train;
  std::string output;
  JobOptions job;
};

// Training takes long: a directory that does not exist is reported before it.
void check_directory_of(const std::filesystem::path& file) {
  const std::filesystem::path directory = std::filesystem::absolute(file).parent_path();
  if (std::filesystem::is_directory(directory)) return;
  throw std::runtime_error(
      fmt::format("{}: cannot write: {} is not a directory", file.string(), directory.string()));
}

int run(const TrainCommand& command, const Console& console) {
  const Job job(command.job, console);
  check_directory_of(command.output);
  const PyramidTable table = train_pyramid_table(
      command.train,
      [&](const TrainedRadius& done) {
        job.say(fmt::format("radius {:>2}: loss {:.6f} untrained, {:.6f} trained", done.radius,
                            done.untrained_loss, done.trained_loss));
      },
      [&] { job.stop_if_interrupted("stopped; no table was written"); });
  write_file_atomically(command.output, pyramid_table_source(table, job.command_line()));
  return kSuccess;
}

}  // namespace

Command add_train_pyramid_command(CLI::App& app) {
  CLI::App* parser =
      app.add_subcommand("train-pyramid", "Fit the weights of the pyramid filter to brute force");
  const auto command = std::make_shared<TrainCommand>();
  TrainPyramidOptions& train = command->train;
  parser->add_option("-o,--output", command->output, "C++ source to write")->required();
  parser->add_option("--images", train.pictures.images,
                     "EXR, PNG or JPEG files to learn from, in addition to the painted pictures");
  parser->add_option("--painted", train.pictures.painted, "Number of painted pictures")
      ->capture_default_str();
  parser
      ->add_option("--scenes", train.pictures.scenes,
                   "Built-in scenes to learn geometric edges from")
      ->capture_default_str();
  parser->add_option("--steps", train.training.steps, "Steps of gradient descent for each radius")
      ->capture_default_str();
  add_job_options(*parser, command->job);
  return {parser, [command](const Console& console) { return run(*command, console); }};
}

}  // namespace eigenlight

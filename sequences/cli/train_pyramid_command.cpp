#include "sequences/cli/train_pyramid_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "frame/tiles.h"
#include "sequences/cli/interrupt.h"
#include "sequences/files/atomic_file.h"
#include "sequences/lab/train_pyramid.h"

namespace eigenlight {
namespace {

struct CommandOptions {
  TrainPyramidOptions train;
  std::string output;
  int threads = 0;
};

void run(const CommandOptions& options, const Console& console) {
  const InterruptGuard guard(InterruptGuard::Notice::kSilent);
  set_thread_count(options.threads);
  const PyramidTable table = train_pyramid_table(
      options.train,
      [&](const TrainedRadius& done) {
        console.err << fmt::format("radius {:>2}: loss {:.6f} untrained, {:.6f} trained\n",
                                   done.radius, done.untrained_loss, done.trained_loss)
                    << std::flush;
      },
      [&] { return !guard.interrupted(); });
  write_file_atomically(options.output, pyramid_table_source(table, console.command_line));
}

}  // namespace

void add_train_pyramid_command(CLI::App& app, const Console& console) {
  CLI::App* command =
      app.add_subcommand("train-pyramid", "Fit the weights of the pyramid filter to brute force");
  const auto options = std::make_shared<CommandOptions>();
  command->add_option("-o,--output", options->output, "C++ source to write")->required();
  command->add_option("--images", options->train.pictures.images,
                      "EXR, PNG or JPEG files to learn from, besides the painted pictures");
  command->add_option("--painted", options->train.pictures.painted, "Pictures painted by code")
      ->capture_default_str();
  command
      ->add_option("--scenes", options->train.pictures.scenes,
                   "Built-in scenes to learn edges of geometry from")
      ->capture_default_str();
  command->add_option("--steps", options->train.training.steps, "Steps of descent for each radius")
      ->capture_default_str();
  command->add_option("--threads", options->threads, "0: one per core")->capture_default_str();
  command->callback([options, &console] { run(*options, console); });
}

}  // namespace eigenlight

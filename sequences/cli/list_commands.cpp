#include "sequences/cli/list_commands.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "render/builtin/builtin_scenes.h"
#include "sequences/runs/render_plan.h"
#include "temporal/methods.h"

namespace eigenlight {
namespace {

struct Row {
  std::string name, what;
};

// One line per row; texts are aligned two spaces to the right of the longest name.
void list(std::ostream& out, const std::vector<Row>& rows, std::string_view indent = "") {
  std::size_t width = 0;
  for (const Row& row : rows) width = std::max(width, row.name.size());
  for (const Row& row : rows) {
    out << fmt::format("{}{:<{}}  {}\n", indent, row.name, width, row.what);
  }
}

}  // namespace

void list_scenes(std::ostream& out) {
  std::vector<Row> rows;
  for (const BuiltinScene& scene : builtin_scenes()) {
    rows.push_back({std::string(scene.name), std::string(scene.what)});
  }
  list(out, rows);
}

void list_methods(std::ostream& out) {
  std::vector<Row> rows;
  for (const Method& method : methods()) {
    std::string what(method.what);
    if (!method.paper.empty()) what += fmt::format(" ({})", method.paper);
    rows.push_back({std::string(method.name), what});
  }
  rows.push_back(
      {std::string(kReferenceMethod),
       fmt::format("no denoising, {} samples unless --spp says otherwise, seeds of its own",
                   kReferenceSpp)});
  list(out, rows);
}

void list_parts(std::ostream& out) {
  for (const Method& method : methods()) {
    if (!method.parts.empty()) out << method.name << '\n';
    std::vector<Row> rows;
    for (const Part& part : method.parts) {
      rows.push_back({std::string(part.name), std::string(part.what)});
    }
    list(out, rows, "  ");
  }
}

Command add_scenes_command(CLI::App& app) {
  return {app.add_subcommand("scenes", "List the built-in scenes"), [](const Console& console) {
            list_scenes(console.out);
            return kSuccess;
          }};
}

Command add_methods_command(CLI::App& app) {
  CLI::App* parser = app.add_subcommand("methods", "List the methods");
  const auto parts = std::make_shared<bool>(false);
  parser->add_flag("--parts", *parts, "List the parts that --without can turn off");
  return {parser, [parts](const Console& console) {
            (*parts ? list_parts : list_methods)(console.out);
            return kSuccess;
          }};
}

}  // namespace eigenlight

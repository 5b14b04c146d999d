// Channels of any names, one a line, and what a user says about layers: a plan that can be read, or
// a refusal in one line. A line is `[uint|float|half] NAME`; from the line `--map` on, lines are
// entries of --map; `--keep REGEX`, `--skip REGEX`, `--alpha` are the options.
#include <algorithm>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "frame/bad_file.h"
#include "sequences/denoise/file_headers.h"
#include "sequences/layers/layer_list.h"
#include "tests/fuzz/target.h"

namespace eigenlight {
namespace {

struct Input {
  FileHeader header;
  LayerChoice choice;
};

void read_line(std::string line, bool& in_map, Input& input) {
  const auto take = [&](std::string_view word) {
    if (!line.starts_with(word)) return false;
    line.erase(0, word.size());
    return true;
  };
  if (line == "--map") {
    in_map = true;
  } else if (in_map) {
    input.choice.map.push_back(line);
  } else if (take("--keep ")) {
    input.choice.keep = line.substr(0, 40);  // std::regex takes time, and stack, of its own
  } else if (take("--skip ")) {
    input.choice.skip = line.substr(0, 40);
  } else if (line == "--alpha") {
    input.choice.denoises_alpha = true;
  } else {
    ExrChannelInfo channel;
    channel.type = take("uint ")    ? ExrType::kUint
                   : take("float ") ? ExrType::kFloat
                                    : ExrType::kHalf;
    channel.name = channel.full_name = line;
    // OpenEXR has no two channels of one name.
    const bool is_new = std::none_of(input.header.channels.begin(), input.header.channels.end(),
                                     [&](const auto& c) { return c.full_name == line; });
    if (is_new) input.header.channels.push_back(channel);
  }
}

Input read_input(std::string_view text) {
  Input input;
  input.header.path = "in.exr";
  input.header.parts.emplace_back();
  bool in_map = false;
  while (!text.empty() && input.header.channels.size() < 200) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    read_line(std::string(text.substr(0, end)), in_map, input);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return input;
}

// Every channel is in exactly one layer.
void check_list(const Input& input, const std::vector<FileLayer>& layers) {
  std::vector<std::string> names;
  for (const FileLayer& layer : layers) {
    FUZZ_CHECK(layer.size() >= 1);
    names.insert(names.end(), layer.channels.begin(), layer.channels.end());
  }
  FUZZ_CHECK(names.size() == input.header.channels.size());
  for (const ExrChannelInfo& channel : input.header.channels) {
    FUZZ_CHECK(std::count(names.begin(), names.end(), channel.full_name) == 1);
  }
}

void check_plan(const Input& input, const std::vector<FileLayer>& layers) {
  const LayerPlan plan = plan_layers(layers, input.choice);
  FUZZ_CHECK(!plan.views.empty() && plan.rows.size() >= layers.size());
  check_layers({{input.header}}, plan);
  for (const ViewPlan& view : plan.views) {
    FUZZ_CHECK(!view.lights.empty());
    for (const PlannedLight& light : view.lights) {
      FUZZ_CHECK(light.layer && light.layer->type != ExrType::kUint);
      FUZZ_CHECK(light.layer->size() == 1 || light.layer->size() >= 3);
      FUZZ_CHECK(!light.color || light.color->size() >= 3);
    }
    for (const PlannedSum& sum : view.sums) {
      for (const std::size_t light : sum.lights) FUZZ_CHECK(light < view.lights.size());
    }
  }
}

void check(std::string_view text) {
  const Input input = read_input(text);
  try {
    const auto layers = list_layers(input.header.channels, input.header.parts, 0);
    check_list(input, layers);
    check_plan(input, layers);
  } catch (const std::invalid_argument&) {
  } catch (const BadFile& error) {
    FUZZ_CHECK(!std::string_view(error.what()).empty());
  }
}

}  // namespace
}  // namespace eigenlight

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  eigenlight::check(eigenlight::as_text(data, size));
  return 0;
}

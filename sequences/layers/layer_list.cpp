#include "sequences/layers/layer_list.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>

namespace eigenlight {
namespace {

struct Suffix {
  std::string_view name;
  char letter;
};

// Lower case.
constexpr std::array<Suffix, 14> kSuffixes{{{"r", 'R'},
                                            {"g", 'G'},
                                            {"b", 'B'},
                                            {"a", 'A'},
                                            {"red", 'R'},
                                            {"green", 'G'},
                                            {"blue", 'B'},
                                            {"alpha", 'A'},
                                            {"x", 'X'},
                                            {"y", 'Y'},
                                            {"z", 'Z'},
                                            {"w", 'W'},
                                            {"u", 'X'},
                                            {"v", 'Y'}}};
constexpr std::string_view kColor = "RGBA", kVector = "XYZW";

std::optional<char> letter_of(std::string_view suffix) {
  std::string lower(suffix);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto found = std::find_if(kSuffixes.begin(), kSuffixes.end(),
                                  [&](const Suffix& s) { return s.name == lower; });
  if (found == kSuffixes.end()) return std::nullopt;
  return found->letter;
}

struct Named {
  std::string prefix;  // of the channel's name, without its last word
  char letter = 0;     // 0: a layer of its own
  std::size_t index = 0;
};

// The words of a full name, without the view where it is one of them or the end of one.
std::string without_view(const std::string& name, const std::string& view) {
  if (view.empty()) return name;
  std::string kept;
  std::size_t start = 0;
  while (start <= name.size()) {
    const std::size_t end = std::min(name.find('.', start), name.size());
    std::string word = name.substr(start, end - start);
    for (const char separator : {'_', '.'}) {
      const std::string tail = separator + view;
      if (word.size() > tail.size() && word.ends_with(tail)) word.resize(word.size() - tail.size());
    }
    if (word != view) kept += kept.empty() ? word : '.' + word;
    start = end + 1;
  }
  return kept;
}

// A part that holds some letters of a color only: what its name says is not the name of a layer.
bool is_piece(const std::vector<ExrChannelInfo>& channels, const ExrChannelInfo& one) {
  const std::string prefix = one.name.substr(0, one.name.size() - 1);
  if (one.name.empty() || kColor.find(one.name.back()) == std::string_view::npos) return false;
  if (!prefix.empty() && prefix.back() != '.') return false;
  int in_part = 0, in_file = 0;
  for (const char letter : kColor) {
    for (const ExrChannelInfo& other : channels) {
      if (other.view != one.view || other.name != prefix + letter) continue;
      ++in_file;
      if (other.part == one.part) ++in_part;
    }
  }
  // Each letter once: in a second part of that kind they would be another layer.
  return in_part < 3 && in_file >= 3 && in_file <= 4;
}

Named split(const std::vector<ExrChannelInfo>& channels, const ExrChannelInfo& channel) {
  const std::string name =
      is_piece(channels, channel) ? channel.name : without_view(channel.full_name, channel.view);
  const std::size_t dot = name.rfind('.');
  const std::string last = dot == std::string::npos ? name : name.substr(dot + 1);
  const std::string prefix = dot == std::string::npos ? std::string() : name.substr(0, dot);
  const std::optional<char> letter = letter_of(last);
  if (letter) return {prefix, *letter, 0};
  return {name, 0, 0};
}

// Which layer a channel belongs to, and where it stands in it.
struct Place {
  std::string layer;
  std::size_t order = 0;
};

Place place_of(const Named& named, bool in_color) {
  const std::string_view set = in_color ? kColor : kVector;
  const std::size_t order = named.letter == 0 ? std::string_view::npos : set.find(named.letter);
  // Bare letters that are no color stand alone: the depth Z; Y, the gray of a luminance picture.
  const bool is_alone = order == std::string_view::npos || (named.prefix.empty() && !in_color);
  if (!is_alone) return {named.prefix, order};
  if (named.letter == 0) return {named.prefix, 0};
  const std::string letter(1, named.letter);
  return {named.prefix.empty() ? letter : named.prefix + '.' + letter, 0};
}

bool has_color(const std::vector<Named>& all, const std::vector<ExrChannelInfo>& channels,
               const Named& one, const std::string& view) {
  return std::any_of(all.begin(), all.end(), [&](const Named& other) {
    return other.prefix == one.prefix && channels[other.index].view == view &&
           kColor.find(other.letter) < 3;
  });
}

}  // namespace

std::string name_for_people(const FileLayer& layer) {
  const std::string name = layer.name.empty() ? "color" : layer.name;
  return layer.view.empty() ? name : layer.view + ": " + name;
}

std::vector<FileLayer> list_layers(const std::vector<ExrChannelInfo>& channels,
                                   const std::vector<ExrPart>& parts, int input) {
  std::vector<Named> names;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    names.push_back(split(channels, channels[i]));
    names.back().index = i;
  }
  std::vector<FileLayer> layers;
  std::vector<std::multimap<std::size_t, std::string>> members;  // full names by order
  for (const Named& named : names) {
    const ExrChannelInfo& channel = channels[named.index];
    const Place place = place_of(named, has_color(names, channels, named, channel.view));
    auto found = std::find_if(layers.begin(), layers.end(), [&](const FileLayer& l) {
      return l.name == place.layer && l.view == channel.view;
    });
    if (found == layers.end()) {
      layers.push_back(
          {place.layer, channel.view, input, channel.part, channel.type, false, false, {}});
      found = layers.end() - 1;
      members.emplace_back();
    }
    found->is_deep |= parts[static_cast<std::size_t>(channel.part)].is_deep;
    if (channel.type == ExrType::kUint) found->type = ExrType::kUint;
    found->is_subsampled |= channel.x_sampling != 1 || channel.y_sampling != 1;
    members[static_cast<std::size_t>(found - layers.begin())].emplace(place.order,
                                                                      channel.full_name);
  }
  for (std::size_t i = 0; i < layers.size(); ++i) {
    for (const auto& [order, name] : members[i]) layers[i].channels.push_back(name);
  }
  return layers;
}

}  // namespace eigenlight

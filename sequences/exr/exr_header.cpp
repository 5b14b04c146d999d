#include "sequences/exr/exr_header.h"

#include <OpenEXR/Iex.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "frame/bad_file.h"

namespace eigenlight {
namespace {

constexpr std::size_t kMaxName = 255;
constexpr std::array<unsigned char, 4> kMagic{0x76, 0x2f, 0x31, 0x01};

std::uint32_t read_word(ExrInput& file) {
  std::array<unsigned char, 4> bytes{};
  file.read(reinterpret_cast<char*>(bytes.data()), 4);
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) word |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  return word;
}

std::string read_name(ExrInput& file) {
  std::string name;
  for (char c = 0;; name += c) {
    file.read(&c, 1);
    if (c == 0) return name;
    if (name.size() == kMaxName) throw Iex::InputExc("a name in the header does not end");
  }
}

std::vector<ExrRawAttribute> read_attributes(ExrInput& file) {
  std::vector<ExrRawAttribute> attributes;
  for (;;) {
    ExrRawAttribute attribute;
    attribute.name = read_name(file);
    if (attribute.name.empty()) return attributes;
    attribute.type = read_name(file);
    attribute.size = static_cast<std::int32_t>(read_word(file));
    attribute.position = file.tellg();
    if (attribute.size < 0 ||
        static_cast<std::uint64_t>(attribute.size) > file.size() - attribute.position) {
      throw Iex::InputExc(fmt::format("attribute '{}' is longer than the file", attribute.name));
    }
    file.seekg(attribute.position + static_cast<std::uint64_t>(attribute.size));
    attributes.push_back(std::move(attribute));
  }
}

// A file that is still being written may be short, or hold zeros; any other start is that of
// another kind of file.
void check_start(ExrInput& file) {
  std::array<unsigned char, 8> bytes{};
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), bytes.size()));
  file.read_at(0, bytes.data(), count);
  const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(count);
  if (count == bytes.size() && std::all_of(bytes.begin(), end, [](auto b) { return b == 0; })) {
    throw Iex::InputExc("it starts with zeros: not written yet");
  }
  if (!std::equal(bytes.begin(),
                  bytes.begin() + static_cast<std::ptrdiff_t>(std::min(count, kMagic.size())),
                  kMagic.begin())) {
    throw BadFile(fmt::format("{}: cannot read: not an OpenEXR file", file.fileName()));
  }
  if (count < bytes.size()) throw Iex::InputExc("the file ends early");
}

void check_attributes(const std::vector<ExrRawAttribute>& attributes) {
  for (const char* needed :
       {"channels", "compression", "dataWindow", "displayWindow", "lineOrder"}) {
    if (std::none_of(attributes.begin(), attributes.end(),
                     [&](const ExrRawAttribute& a) { return a.name == needed; })) {
      throw Iex::InputExc(fmt::format("no attribute '{}'", needed));
    }
  }
}

}  // namespace

ExrRawHeader scan_exr_header(ExrInput& file) {
  check_start(file);
  file.seekg(kMagic.size());
  ExrRawHeader header;
  header.version = read_word(file);
  if ((header.version & 0xffU) != 2) {
    throw BadFile(fmt::format("{}: cannot read: version {} of OpenEXR, expected 2", file.fileName(),
                              header.version & 0xffU));
  }
  do {
    std::vector<ExrRawAttribute> attributes = read_attributes(file);
    if (attributes.empty() && header.is_multipart()) break;
    check_attributes(attributes);
    header.parts.push_back(std::move(attributes));
  } while (header.is_multipart());
  if (header.parts.empty()) throw Iex::InputExc("no part");
  header.end = file.tellg();
  file.seekg(0);
  return header;
}

}  // namespace eigenlight

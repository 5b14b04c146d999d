// Headers of OpenEXR in our words.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfMultiView.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTileDescription.h>
#include <fmt/format.h>

#include <array>
#include <string_view>

#include "sequences/exr/exr_chunks.h"
#include "sequences/exr/exr_state.h"

namespace eigenlight {
namespace {

constexpr std::array<const char*, 10> kCompressions{"none",  "rle", "zips", "zip",  "piz",
                                                    "pxr24", "b44", "b44a", "dwaa", "dwab"};

// `rgba.left` and `left.rgba` without the view; unchanged if there is none.
std::string without_view(const std::string& part, const std::string& view) {
  if (view.empty()) return part;
  for (const char mark : {'.', '_', '-', ' '}) {
    if (part.ends_with(mark + view)) return part.substr(0, part.size() - view.size() - 1);
    if (part.starts_with(view + mark)) return part.substr(view.size() + 1);
  }
  return part == view ? "" : part;
}

std::string behind(const std::string& part, const std::string& name) {
  if (part.empty() || name == part || name.starts_with(part + ".")) return name;
  return fmt::format("{}.{}", part, name);
}

void split(const std::string& name, ExrChannelInfo& info) {
  const std::size_t dot = name.rfind('.');
  if (dot != std::string::npos) {
    info.layer = name.substr(0, dot);
    info.channel = name.substr(dot + 1);
  } else if (name == "R" || name == "G" || name == "B" || name == "A") {
    info.channel = name;
  } else {
    info.layer = name;
  }
}

ExrType type_of(Imf::PixelType type) {
  switch (type) {
    case Imf::HALF:
      return ExrType::kHalf;
    case Imf::FLOAT:
      return ExrType::kFloat;
    default:
      return ExrType::kUint;
  }
}

}  // namespace

Imf::PixelType pixel_type(ExrType type) {
  switch (type) {
    case ExrType::kHalf:
      return Imf::HALF;
    case ExrType::kFloat:
      return Imf::FLOAT;
    case ExrType::kUint:
      return Imf::UINT;
  }
  return Imf::HALF;
}

std::size_t bytes_of(ExrType type) { return type == ExrType::kHalf ? 2 : 4; }

std::vector<ExrChannelInfo> describe_channels(const Imf::Header& header, int part,
                                              bool is_multipart) {
  const std::string part_name = is_multipart && header.hasName() ? header.name() : "";
  const std::string part_view = header.hasView() ? header.view() : "";
  std::vector<ExrChannelInfo> channels;
  const Imf::ChannelList& list = header.channels();
  for (auto c = list.begin(); c != list.end(); ++c) {
    ExrChannelInfo info;
    info.part = part;
    info.name = c.name();
    info.full_name = behind(part_name, info.name);
    info.view = part_view;
    if (part_view.empty() && Imf::hasMultiView(header) && !Imf::multiView(header).empty()) {
      info.view = Imf::viewFromChannelName(info.name, Imf::multiView(header));
    }
    std::string bare = info.name;
    if (!info.view.empty()) bare = Imf::removeViewName(bare, info.view);
    split(behind(without_view(part_name, part_view), bare), info);
    info.type = type_of(c.channel().type);
    info.x_sampling = c.channel().xSampling;
    info.y_sampling = c.channel().ySampling;
    channels.push_back(std::move(info));
  }
  return channels;
}

ExrPart describe_part(const Imf::Header& header) {
  ExrPart part;
  if (header.hasName()) part.name = header.name();
  if (header.hasView()) part.view = header.view();
  part.compression = kCompressions.at(static_cast<std::size_t>(header.compression()));
  const Imath::Box2i& window = header.dataWindow();
  part.data = {window.min.x, window.min.y, window.max.x - window.min.x + 1,
               window.max.y - window.min.y + 1};
  const std::string type = header.hasType() ? header.type() : Imf::SCANLINEIMAGE;
  part.is_deep = Imf::isDeepData(type);
  part.is_tiled = Imf::isTiled(type);
  part.levels = static_cast<int>(ExrChunkGrid(header, header.compression()).levels().size());
  return part;
}

}  // namespace eigenlight

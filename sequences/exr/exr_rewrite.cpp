#include "sequences/exr/exr_rewrite.h"

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfPartType.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "frame/bad_file.h"
#include "frame/check.h"
#include "frame/float_traps.h"
#include "sequences/exr/exr_encode.h"
#include "sequences/exr/exr_output.h"
#include "sequences/exr/exr_state.h"

namespace eigenlight {
namespace {

bool has_type(const Imf::ChannelList& channels, Imf::PixelType type) {
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    if (c.channel().type == type) return true;
  }
  return false;
}

// Whether encoding decoded pixels again would change them, or round new ones.
bool loses(const Imf::Header& header) {
  switch (header.compression()) {
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return true;
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
      return has_type(header.channels(), Imf::HALF);
    case Imf::PXR24_COMPRESSION:
      return has_type(header.channels(), Imf::FLOAT);
    default:
      return false;
  }
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

void check_replacements(const ExrFile& in, std::span<const ExrReplacement> replacements) {
  for (const ExrReplacement& r : replacements) {
    EL_CHECK(r.channel >= 0 && r.channel < static_cast<int>(in.channels().size()) && r.pixels,
             "channel {} of {}", r.channel, in.channels().size());
    const ExrChannelInfo& channel = in.channels()[static_cast<std::size_t>(r.channel)];
    const ExrPart& part = in.parts()[static_cast<std::size_t>(channel.part)];
    const auto refuse = [&](const char* what) {
      throw BadFile(
          fmt::format("{}: channel '{}' {}", in.path().string(), channel.full_name, what));
    };
    if (part.is_deep) refuse("is deep, it cannot have new pixels");
    if (channel.type == ExrType::kUint) refuse("holds integers, it cannot have new pixels");
    if (channel.x_sampling != 1 || channel.y_sampling != 1) {
      refuse("is subsampled, it cannot have new pixels");
    }
    const Extent extent{part.data.width, part.data.height};
    EL_CHECK(r.pixels->extent() == extent, "channel '{}': {}x{} new pixels, expected {}x{}",
             channel.full_name, r.pixels->width(), r.pixels->height(), extent.width, extent.height);
    EL_CHECK(std::count_if(replacements.begin(), replacements.end(),
                           [&](const ExrReplacement& o) { return o.channel == r.channel; }) == 1,
             "channel '{}' has new pixels twice", channel.full_name);
  }
}

// What becomes of each part.
struct Plan {
  std::vector<bool> is_new;
  std::vector<Imf::Compression> compression;
  std::vector<ExrChunkGrid> grids;
};

Plan make_plan(const ExrFile::State& in, std::span<const ExrReplacement> replacements,
               ExrRewriteReport& report) {
  Plan plan;
  for (int i = 0; i < in.file->parts(); ++i) {
    const Imf::Header& header = in.file->header(i);
    if (header.hasType() && !Imf::isSupportedType(header.type())) {
      throw BadFile(fmt::format("{}: part '{}' is of the unknown type '{}'", in.path.string(),
                                header.name(), header.type()));
    }
    const bool is_new =
        std::any_of(replacements.begin(), replacements.end(), [&](const ExrReplacement& r) {
          return in.channels[static_cast<std::size_t>(r.channel)].part == i;
        });
    const ExrPart& part = in.parts[static_cast<std::size_t>(i)];
    const bool to_zip = is_new && loses(header);
    if (to_zip) {
      report.recompressed.push_back(
          fmt::format("{}{} becomes ZIP", in.in_part(i), upper(part.compression)));
    }
    if (is_new && part.levels > 1) {
      report.levels.push_back(
          fmt::format("{}smaller levels of the new channels are averages of them", in.in_part(i)));
    }
    plan.is_new.push_back(is_new);
    plan.compression.push_back(to_zip ? Imf::ZIP_COMPRESSION : header.compression());
    plan.grids.emplace_back(header, plan.compression.back());
  }
  return plan;
}

// The header of the input, byte for byte but for compression and number of chunks.
std::string copy_header(const ExrFile::State& in, const Plan& plan) {
  std::string header(in.raw.end, '\0');
  in.bytes->read_at(0, header.data(), header.size());
  for (std::size_t i = 0; i < in.raw.parts.size(); ++i) {
    if (plan.compression[i] == in.file->header(static_cast<int>(i)).compression()) continue;
    for (const ExrRawAttribute& a : in.raw.parts[i]) {
      if (a.name == "compression" && a.size == 1) {
        header[a.position] = static_cast<char>(plan.compression[i]);
      }
      for (std::uint64_t b = 0; a.name == "chunkCount" && a.size == 4 && b < 4; ++b) {
        header[a.position + b] = static_cast<char>((plan.grids[i].count() >> (8 * b)) & 0xff);
      }
    }
  }
  return header;
}

void copy_part(const ExrFile::State& in, const Plan& plan, int part, ExrOutput& out) {
  const ExrChunkGrid& grid = plan.grids[static_cast<std::size_t>(part)];
  const std::size_t number_bytes = in.raw.is_multipart() ? 4 : 0;
  std::vector<unsigned char> head(grid.head_bytes()), number(4);
  std::vector<char> data;
  std::uint64_t end = in.raw.end;
  for (const std::uint64_t place : chunk_places(in, part)) {
    // A place of 0 was never filled in; chunks that overlap would make a small file huge.
    if (place < end) throw Iex::InputExc("chunks are missing or overlap");
    if (place > in.bytes->size()) throw Iex::InputExc("the file ends early");
    in.bytes->read_at(place, number.data(), number_bytes);
    const int found = number[0] | number[1] << 8 | number[2] << 16 | number[3] << 24;
    if (number_bytes > 0 && found != part) throw Iex::InputExc("a chunk of another part");
    in.bytes->read_at(place + number_bytes, head.data(), head.size());
    const std::int64_t bytes = grid.data_bytes(head);
    const std::uint64_t start = place + number_bytes + head.size();
    if (bytes < 0 || static_cast<std::uint64_t>(bytes) > in.bytes->size() - start) {
      throw Iex::InputExc("a chunk is longer than the file");
    }
    end = start + static_cast<std::uint64_t>(bytes);
    data.resize(static_cast<std::size_t>(bytes));
    in.bytes->read_at(start, data.data(), data.size());
    out.start_chunk(part, head);
    out.write({data.data(), data.size()});
  }
}

}  // namespace

ExrRewriteReport rewrite_exr(const ExrFile& in, const std::filesystem::path& out,
                             std::span<const ExrReplacement> replacements) {
  const FloatTrapsOff channels_may_hold_nan;
  use_our_threads_for_exr();
  check_replacements(in, replacements);
  ExrFile::State& state = in.state();
  ExrRewriteReport report;
  with_exr_errors(in.path(), "cannot copy", [&] {
    const Plan plan = make_plan(state, replacements, report);
    ExrOutput output(out, copy_header(state, plan), plan.grids, state.raw.is_multipart());
    for (int part = 0; part < state.file->parts(); ++part) {
      if (!plan.is_new[static_cast<std::size_t>(part)]) {
        copy_part(state, plan, part, output);
      } else {
        state.check_size(part);
        encode_part(state, part, plan.compression[static_cast<std::size_t>(part)], replacements,
                    output, report);
      }
    }
    output.finish();
  });
  return report;
}

}  // namespace eigenlight

#include "sequences/exr/exr_output.h"

#include <OpenEXR/Iex.h>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace eigenlight {
namespace {

constexpr std::size_t kBuffer = 1 << 20;

void append(std::vector<char>& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<char>((value >> (8 * i)) & 0xffU));
}

}  // namespace

ExrOutput::ExrOutput(const std::filesystem::path& path, std::string_view header,
                     std::vector<ExrChunkGrid> grids, bool is_multipart)
    : file_(path),
      grids_(std::move(grids)),
      is_multipart_(is_multipart),
      tables_start_(header.size()),
      position_(header.size()) {
  file_.write(header);
  for (const ExrChunkGrid& grid : grids_) {
    tables_.emplace_back(static_cast<std::size_t>(grid.count()), 0);
    const std::vector<char> room(tables_.back().size() * 8);
    file_.write({room.data(), room.size()});
    position_ += room.size();
  }
  buffer_.reserve(2 * kBuffer);
}

void ExrOutput::start_chunk(int part, const std::vector<unsigned char>& head) {
  const std::int64_t index = grid(part).index_of(head);
  if (index < 0) throw Iex::InputExc("a chunk of pixels outside the data window");
  std::uint64_t& place = tables_[static_cast<std::size_t>(part)][static_cast<std::size_t>(index)];
  if (place != 0) throw Iex::InputExc(fmt::format("chunk {} is there twice", index));
  place = position_;
  std::vector<char> number;
  if (is_multipart_) append(number, static_cast<std::uint64_t>(part), 4);
  write({number.data(), number.size()});
  write({reinterpret_cast<const char*>(head.data()), head.size()});
}

void ExrOutput::write(std::string_view bytes) {
  position_ += bytes.size();
  if (buffer_.size() + bytes.size() > buffer_.capacity()) flush();
  if (bytes.size() > kBuffer) {
    file_.write(bytes);
  } else {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  }
}

void ExrOutput::flush() {
  file_.write({buffer_.data(), buffer_.size()});
  buffer_.clear();
}

void ExrOutput::finish() {
  flush();
  std::vector<char> bytes;
  for (const auto& table : tables_) {
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (table[i] == 0) throw Iex::InputExc(fmt::format("chunk {} is missing", i));
      append(bytes, table[i], 8);
    }
  }
  file_.write_at(tables_start_, {bytes.data(), bytes.size()});
  file_.commit();
}

ExrChunkSink::ExrChunkSink(ExrOutput& output, int part)
    : OStream("new pixels"), output_(output), part_(part) {}

void ExrChunkSink::write(const char from[], int count) {
  position_ += static_cast<std::uint64_t>(count);
  if (!is_open_) return;
  const std::size_t head_bytes = output_.grid(part_).head_bytes();
  std::string_view bytes(from, static_cast<std::size_t>(count));
  while (!bytes.empty()) {
    if (data_left_ == 0) {
      const std::size_t taken = std::min(bytes.size(), head_bytes - head_.size());
      head_.insert(head_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
      bytes.remove_prefix(taken);
      if (head_.size() < head_bytes) return;
      data_left_ = output_.grid(part_).data_bytes(head_);
      output_.start_chunk(part_, head_);
      head_.clear();
    }
    const auto taken = std::min<std::size_t>(bytes.size(), static_cast<std::size_t>(data_left_));
    output_.write(bytes.substr(0, taken));
    bytes.remove_prefix(taken);
    data_left_ -= static_cast<std::int64_t>(taken);
  }
}

}  // namespace eigenlight

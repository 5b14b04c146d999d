#include "sequences/exr/exr_file.h"

#include <OpenEXR/Iex.h>
#include <fmt/format.h>

#include "frame/bad_file.h"
#include "frame/float_traps.h"
#include "sequences/exr/exr_chunks.h"
#include "sequences/exr/exr_state.h"

namespace eigenlight {
namespace {

// The chunks of each part need a table of their places.
void check_tables(const ExrFile::State& state) {
  std::uint64_t left = state.bytes->size() - state.raw.end;
  for (int i = 0; i < state.file->parts(); ++i) {
    const Imf::Header& header = state.file->header(i);
    const ExrChunkGrid grid(header, header.compression());
    const auto table = static_cast<std::uint64_t>(grid.count()) * 8;
    if (table > left) throw Iex::InputExc("the file ends within its tables");
    left -= table;
  }
}

void describe(ExrFile::State& state) {
  for (int i = 0; i < state.file->parts(); ++i) {
    const Imf::Header& header = state.file->header(i);
    state.parts.push_back(describe_part(header));
    for (ExrChannelInfo& c : describe_channels(header, i, state.raw.is_multipart())) {
      state.channels.push_back(std::move(c));
    }
  }
  const Imath::Box2i& window = state.file->header(0).displayWindow();
  state.display = {window.min.x, window.min.y, window.max.x - window.min.x + 1,
                   window.max.y - window.min.y + 1};
}

}  // namespace

ExrFile::ExrFile(const std::filesystem::path& path) : state_(std::make_unique<State>()) {
  const FloatTrapsOff headers_may_hold_nan;
  use_our_threads_for_exr();
  state_->path = path;
  state_->bytes = std::make_unique<ExrInput>(path);
  with_exr_errors(path, "cannot read", [&] {
    state_->raw = scan_exr_header(*state_->bytes);
    state_->file = std::make_unique<Imf::MultiPartInputFile>(*state_->bytes);
    if (state_->file->parts() != static_cast<int>(state_->raw.parts.size())) {
      throw Iex::InputExc("parts of the header cannot be told apart");
    }
    check_tables(*state_);
    describe(*state_);
  });
}

ExrFile::~ExrFile() = default;
ExrFile::ExrFile(ExrFile&&) noexcept = default;
ExrFile& ExrFile::operator=(ExrFile&&) noexcept = default;

const std::filesystem::path& ExrFile::path() const { return state_->path; }
std::uint64_t ExrFile::bytes() const { return state_->bytes->size(); }
const ExrWindow& ExrFile::display_window() const { return state_->display; }
const std::vector<ExrPart>& ExrFile::parts() const { return state_->parts; }
const std::vector<ExrChannelInfo>& ExrFile::channels() const { return state_->channels; }

std::string ExrFile::State::in_part(int part) const {
  if (parts.size() < 2) return "";
  return fmt::format("part '{}': ", parts[static_cast<std::size_t>(part)].name);
}

}  // namespace eigenlight

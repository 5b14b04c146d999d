// Checkpoints: of any bytes, and of states that are damaged behind a checksum that holds. The
// first byte chooses the method, the second how much of its state is cut off; then come patches of
// three bytes: where, and by what. So the inputs outlive changes of the states.
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>

#include "frame/float_traps.h"
#include "frame/tiles.h"
#include "sequences/files/atomic_file.h"
#include "sequences/files/checkpoint.h"
#include "temporal/methods.h"
#include "tests/fuzz/target.h"
#include "tests/support/analytic_source.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

constexpr Extent kExtent{5, 3};
constexpr int kBases = 2;

AnalyticSource frames_from(int first) {
  AnalyticOptions options{.extent = kExtent, .frames = 3};
  options.slide = {0.4f, 0.1f};
  options.first_frame = first;
  options.sky_columns = 1;
  return AnalyticSource(options);
}

// After three frames; made once for each method.
const std::vector<char>& sound_state(const Method& method) {
  static std::map<std::string_view, std::vector<char>> states;
  std::vector<char>& state = states[method.name];
  if (!state.empty()) return state;
  const auto denoiser = make_denoiser(method.name, {kExtent, kBases});
  AnalyticSource source = frames_from(0);
  while (denoiser->step(source) != nullptr) {
  }
  StateWriter out;
  denoiser->save(out);
  return state = out.bytes();
}

std::vector<char> damaged_state(const Method& method, std::string_view bytes) {
  std::vector<char> state = sound_state(method);
  if (!bytes.empty()) {
    const auto cut = static_cast<std::ptrdiff_t>(static_cast<unsigned char>(bytes[0]));
    state.erase(state.end() - std::min(cut, std::ssize(state)), state.end());
    bytes.remove_prefix(1);
  }
  for (; bytes.size() >= 3 && !state.empty(); bytes.remove_prefix(3)) {
    std::uint16_t where = 0;
    std::memcpy(&where, bytes.data(), sizeof(where));
    state[where % state.size()] = bytes[2];
  }
  return state;
}

// Refused with std::runtime_error, or good for another frame, whatever it shows.
void check_state(const std::filesystem::path& path, std::string_view bytes) {
  if (bytes.empty()) return;
  const auto choice = static_cast<std::size_t>(static_cast<unsigned char>(bytes[0]));
  const Method& method = methods()[choice % methods().size()];
  write_checkpoint(path, {"{}", 3, damaged_state(method, bytes.substr(1))});
  const Checkpoint checkpoint = read_checkpoint(path);
  const auto denoiser = make_denoiser(method.name, {kExtent, kBases});
  try {
    StateReader in({checkpoint.state.data(), checkpoint.state.size()});
    denoiser->load(in);
    in.finish();
  } catch (const std::runtime_error&) {
    return;
  }
  const FloatTrapsOff damaged_bases_may_hold_nan;
  AnalyticSource source = frames_from(3);
  FUZZ_CHECK(denoiser->step(source) != nullptr);
  FUZZ_CHECK(denoiser->step(source) != nullptr);
}

void check_file(const std::filesystem::path& path, std::string_view bytes) {
  write_file_atomically(path, bytes);
  try {
    const Checkpoint first = read_checkpoint(path);
    write_checkpoint(path, first);
    const Checkpoint second = read_checkpoint(path);
    FUZZ_CHECK(second.run == first.run && second.position == first.position &&
               second.state == first.state);
  } catch (const CheckpointError&) {
  }
}

}  // namespace
}  // namespace eigenlight

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace eigenlight;
  static const TempDir dir;
  set_thread_count(1);
  check_file(dir / "file.bin", as_text(data, size));
  check_state(dir / "state.bin", as_text(data, size));
  return 0;
}

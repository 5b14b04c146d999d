// Writes denoised frames in a thread of its own.
#pragma once

#include <filesystem>
#include <string>
#include <thread>

#include "sequences/denoise/bounded_queue.h"
#include "sequences/denoise/denoise_run.h"

namespace eigenlight {

/// Frames that wait between reading, computing and writing. One is enough to overlap them.
inline constexpr std::size_t kWaiting = 1;

/// A frame to be written.
struct FinishedFrame {
  std::shared_ptr<const RawFrame> raw;
  std::vector<std::vector<NewChannel>> outputs;  ///< for each input
  std::size_t index = 0;
  bool is_written = true;  ///< its outputs are not there yet
  DenoiseRecord record;
  bool is_checkpoint = false;  ///< a run can go on behind it: its position is written
};

/// Where the checkpoint of a run is.
[[nodiscard]] std::filesystem::path checkpoint_path(const DenoisePlan& plan);

/// Writes frames in the order of push(): the outputs, and a checkpoint behind them where one is
/// due. It holds no state, for the denoisers have none.
class OutputWriter {
 public:
  /// `description` tells the run from others. All must outlive the writer.
  OutputWriter(const DenoisePlan& plan, const DenoiseCallbacks& callbacks,
               const std::string& description, DenoiseTotals& totals);
  ~OutputWriter();
  OutputWriter(const OutputWriter&) = delete;
  OutputWriter& operator=(const OutputWriter&) = delete;

  /// Waits until there is room. False when writing has failed.
  [[nodiscard]] bool push(FinishedFrame frame) { return waiting_.push(std::move(frame)); }
  /// Waits for the last frame. Throws what writing threw.
  void finish();

 private:
  void run();
  void write(const FinishedFrame& frame, DenoiseRecord& record);
  void add_notes(const std::vector<std::string>& lines);

  const DenoisePlan& plan_;
  const DenoiseCallbacks& callbacks_;
  const std::string& description_;
  DenoiseTotals& totals_;
  BoundedQueue<FinishedFrame> waiting_;
  std::thread thread_;
};

}  // namespace eigenlight

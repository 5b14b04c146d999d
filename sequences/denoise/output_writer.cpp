#include "sequences/denoise/output_writer.h"

#include <fmt/format.h>

#include <algorithm>

#include "sequences/exr/exr_rewrite.h"
#include "sequences/files/checkpoint.h"
#include "sequences/files/directory.h"
#include "temporal/stage_clock.h"

namespace eigenlight {

namespace fs = std::filesystem;

fs::path checkpoint_path(const DenoisePlan& plan) {
  // Other shots, and other parts of this one, may go to the same folder at the same time.
  const fs::path& first = plan.frames.front().outputs.front();
  return first.parent_path() / fmt::format(".{}.eigenlight-state", first.filename().string());
}

OutputWriter::OutputWriter(const DenoisePlan& plan, const DenoiseCallbacks& callbacks,
                           const std::string& description, DenoiseTotals& totals)
    : plan_(plan),
      callbacks_(callbacks),
      description_(description),
      totals_(totals),
      waiting_(kWaiting),
      thread_([this] { run(); }) {}

OutputWriter::~OutputWriter() {
  waiting_.close();
  if (thread_.joinable()) thread_.join();
}

void OutputWriter::finish() {
  waiting_.close();
  thread_.join();
  (void)waiting_.pop();  // rethrows what stopped the writer
}

void OutputWriter::add_notes(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) {
    if (std::find(totals_.notes.begin(), totals_.notes.end(), line) == totals_.notes.end()) {
      totals_.notes.push_back(line);
    }
  }
}

void OutputWriter::write(const FinishedFrame& frame, DenoiseRecord& record) {
  StageClock clock;
  const FrameFiles& paths = plan_.frames[frame.index];
  for (std::size_t i = 0; i < paths.outputs.size(); ++i) {
    const fs::path folder = paths.outputs[i].parent_path();
    if (!folder.empty()) make_directory(folder);
    const ExrRewriteReport report =
        rewrite_exr(*frame.raw->files[i], paths.outputs[i], replacements_of(frame.outputs[i]));
    totals_.clamped += report.values.clamped;
    record.clamped += report.values.clamped;
    add_notes(report.recompressed);
    add_notes(report.levels);
  }
  ++totals_.frames;
  record.write_ms = clock.lap().wall_ms;
}

void OutputWriter::run() {
  try {
    while (const std::optional<FinishedFrame> frame = waiting_.pop()) {
      DenoiseRecord record = frame->record;
      if (frame->is_written) {
        write(*frame, record);
      } else {
        ++totals_.skipped;
      }
      if (callbacks_.record) callbacks_.record(record);
      if (frame->is_checkpoint) {
        write_checkpoint(checkpoint_path(plan_), {description_, frame->index + 1, {}});
      }
      callbacks_.frame_done(plan_.frames[frame->index].frame);
    }
  } catch (...) {
    waiting_.close(std::current_exception());
  }
}

}  // namespace eigenlight

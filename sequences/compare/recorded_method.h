// Methods made for our own renderer's frames, on those of others.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sequences/denoise/denoise_run.h"
#include "temporal/denoiser.h"

namespace eigenlight {

/// Runs one of methods() on each layer of light of each view, every layer as if it were the only
/// one, and composes the files as `eigenlight denoise` does. Without a camera, positions are those
/// of the camera that FrameBuilder assumes.
class RecordedMethod {
 public:
  /// `plan` must outlive this. Throws as make_denoiser() does.
  RecordedMethod(const std::string& method, const DenoisePlan& plan);
  RecordedMethod(const RecordedMethod&) = delete;
  RecordedMethod& operator=(const RecordedMethod&) = delete;

  /// Denoises a frame, in the order of the sequence. Returns CPU milliseconds of the method.
  double step(const std::shared_ptr<const RawFrame>& raw);
  /// The new channels of the frame of the last step(), for each input.
  [[nodiscard]] std::vector<std::vector<NewChannel>> compose() const;

 private:
  struct View {
    FrameBuilder builder;
    std::vector<std::unique_ptr<Denoiser>> denoisers;  // of each layer of light
    std::vector<const Planes<3>*> outputs;
  };

  const DenoisePlan& plan_;
  std::vector<View> views_;
  std::shared_ptr<const RawFrame> raw_;
  Frame frame_, single_;  // all layers of light, and one
};

/// Writes `channels` of one frame: each input with new channels to `folder`, under its own name.
/// Returns the paths of all inputs, those without new channels where they are.
[[nodiscard]] std::vector<std::filesystem::path> write_channels(
    const RawFrame& raw, const FrameFiles& files,
    const std::vector<std::vector<NewChannel>>& channels, const std::filesystem::path& folder);

/// CPU milliseconds a frame of all that a run does beside the method: reading, converting and
/// composing, and writing files into `folder`. Mean over the first of `frames`, three at most.
[[nodiscard]] double files_cpu_ms(const DenoisePlan& plan, const std::vector<int>& frames,
                                  const std::filesystem::path& folder);

}  // namespace eigenlight

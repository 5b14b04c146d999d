// Contenders on the frames of another renderer.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sequences/compare/compare_cell.h"
#include "sequences/compare/compare_pictures.h"
#include "sequences/compare/compare_plan.h"
#include "sequences/compare/reference_cache.h"

namespace eigenlight {

/// Where a contender's measured frames stand, as R,G,B of 32-bit floats.
[[nodiscard]] std::filesystem::path recorded_folder(const ComparePlan& plan,
                                                    const Contender& contender);

/// Names, sizes and times of all files that decide the figures, and all options that do.
[[nodiscard]] nlohmann::ordered_json recorded_identity(const ComparePlan& plan);

/// Runs the contenders of a plan of recorded frames, each over the whole sequence:
///   eigenlight   run_denoising(), as `eigenlight denoise` does; it goes on where it was stopped
///   noisy        the inputs as they are
///   others       RecordedMethod
///   programs     ExternalRun: {color} is the measured layer; {albedo} is what the renderer made
///   for
///                denoisers where the files have it, else that of diffuse surfaces; {normal} in
///                world space where the files have it. Both choices are the best for OIDN on
///                frames of Cycles.
/// The measured layer of each measured frame is written to recorded_folder(), and measured there by
/// evaluate(). Cells: files_ms is files_cpu_ms() and denoise_ms all other CPU time of ours; of
/// programs files_ms is 0 and denoise_ms what their cost is (external_method.h).
class RecordedRun {
 public:
  /// `plan` and `denoise`, whose outputs are in `work`, must outlive this. `work` is made and
  /// stays; frames that were denoised by an interrupted run are in it.
  RecordedRun(const ComparePlan& plan, const DenoisePlan& denoise, std::filesystem::path work,
              float exposure);

  /// Nothing if it was stopped. Throws std::runtime_error and BadFile naming the program or file
  /// that failed.
  [[nodiscard]] std::optional<Cell> run(const Contender& contender, const RunControl& control);

 private:
  struct Cost {
    double files_ms = 0.0, method_ms = 0.0;  // a frame
  };

  [[nodiscard]] bool run_denoiser(const Contender& contender, const RunControl& control,
                                  Cost& cost);
  [[nodiscard]] bool run_method(const Contender& contender, const RunControl& control, Cost& cost);
  [[nodiscard]] bool run_program(const Contender& contender, const RunControl& control,
                                 Cost& cost) const;
  void copy_inputs(const Contender& contender, const RunControl& control) const;
  void keep(const Contender& contender, int frame, const Planes<3>& layer) const;
  [[nodiscard]] double files_ms();
  [[nodiscard]] bool is_measured(int frame) const;

  const ComparePlan& plan_;
  const DenoisePlan& denoise_;
  std::filesystem::path work_;
  float exposure_;
  std::optional<double> files_ms_;
};

/// Pictures of the measured frames. `plan` must outlive them.
[[nodiscard]] ComparePictures recorded_pictures(const ComparePlan& plan, float exposure);

/// The power of two that brings the logarithmic mean of the reference's light nearest to middle
/// gray, 0.18.
[[nodiscard]] float recorded_exposure(const ComparePlan& plan);

}  // namespace eigenlight

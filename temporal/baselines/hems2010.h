// Spatio-temporal upsampling as a filter of full frames.
#pragma once

#include <vector>

#include "reproject/taps.h"
#include "spatial/rivals/cross_bilateral.h"
#include "temporal/baselines/point_taps.h"
#include "temporal/samples/pixel_counts.h"

namespace eigenlight {

struct HemsOptions {
  int frames = 16;     ///< [0, 16] past frames
  int radius = 8;      ///< [0, 16] pixels, of the window in space: 17 x 17; 0: none
  float color = 0.3f;  ///< (0, 100] difference of color, over color, at which the weight is e^-1/2
  TapOptions taps = {};

  void validate() const;  ///< throws std::invalid_argument naming the field
};

/// Herzog, Eisemann, Myszkowski and Seidel 2010, as Chen 2012 (section 4.2) compares with it. A
/// geometry-aware window filters each frame; the result is a weighted sum over the past 16 frames,
/// in which similar colors weigh more:
///   s = the cross bilateral filter of u (spatial/rivals/cross_bilateral.h), by normals and depth
///   alone, out(p) = sum_k w_k s_k / sum_k w_k,  k = 0 .. 16 frames ago, w_0 = 1,
///     w_k = exp(-|s_k - s_0|^2 / (2 color^2 (|s_k|^2 + |s_0|^2) / 2)).
/// s_k is read where the point was k frames ago: its motion is followed from frame to frame, and
/// each step must find the surface by the rule of reproject/taps.h. Every frame is shaded in full
/// here, as in Chen's comparison. Herzog's frames are sparse, and the window fills them. Chen does
/// not give the weights; w is that of a bilateral filter.
///
/// `age` is (sum w)^2 / sum w^2. Holds 48 bytes a pixel for each past frame: 177 MB at 640 x 360.
/// Samples that are not finite are ignored. Where the window is empty and no past frame shows the
/// point, the pixel is 0.
class Hems2010 final : public Denoiser {
 public:
  explicit Hems2010(const DenoiserOptions& options, const HemsOptions& parts = {});

  [[nodiscard]] const Planes<3>* step(FrameSource& source) override;
  [[nodiscard]] const Frame& frame() const override { return frame_; }
  [[nodiscard]] const FrameReport& report() const override { return report_; }
  [[nodiscard]] const Plane<float>& age() const override { return age_; }
  void reset() override { past_.clear(); }
  void save(StateWriter& out) const override;
  void load(StateReader& in) override;

 private:
  struct PastFrame {
    int index = 0;
    Camera camera;
    GBuffer surface;  // depth, normal and id
    Planes<2> motion;
    Plane<float> previous_depth;
    Planes<3> light;     // s
    Plane<float> known;  // 1 where s has a value, else 0
  };
  // A point of a past frame, weighted by its taps.
  struct Seen {
    glm::vec3 light{0.0f};  // times known
    float known = 0.0f;
    glm::vec3 normal{0.0f};  // of the tap that weighs most
    glm::vec2 motion{0.0f};
    float previous_depth = 0.0f;
  };

  void take_light(const Tile& tile, PixelCounts& counts);
  void smooth();
  void gather(const Tile& tile, PixelCounts& counts);
  [[nodiscard]] static Seen look(const PastFrame& past, const PointTaps& taps);
  [[nodiscard]] bool gather_pixel(glm::ivec2 p);  // whether any past frame shows the point
  void keep();

  HemsOptions options_;
  TileGrid tiles_;
  std::unique_ptr<CrossBilateral> window_;  // null for radius 0
  Frame frame_;
  FrameReport report_;
  std::vector<PastFrame> past_;  // the latest first
  Planes<3> light_, smooth_, output_;
  Plane<float> usable_, known_, age_;
  std::vector<PixelCounts> counts_;  // per tile
};

}  // namespace eigenlight

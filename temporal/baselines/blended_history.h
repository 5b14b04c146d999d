// A history into which each frame is blended, shared by mean, svgf and bmfr.
#pragma once

#include <string>
#include <vector>

#include "frame/tiles.h"
#include "temporal/baselines/basis_history.h"
#include "temporal/samples/pixel_counts.h"

namespace eigenlight {

/// For each frame, history is warped, each pixel's sample is blended into it (blend_tile), and the
/// picture is made from it (finish). A sample is usable if it lies on a surface and all of its
/// channels are finite. Other samples are ignored and counted.
class BlendedHistory : public Denoiser {
 public:
  [[nodiscard]] const Planes<3>* step(FrameSource& source) final;
  [[nodiscard]] const Frame& frame() const final { return frame_; }
  [[nodiscard]] const FrameReport& report() const final { return report_; }
  [[nodiscard]] const Plane<float>& age() const final { return age_; }
  void reset() final { history_.reset(); }
  void save(StateWriter& out) const final;
  /// Throws std::runtime_error on the state of another method or version, and where BasisHistory
  /// does.
  void load(StateReader& in) final;

 protected:
  struct HistorySetup {
    std::string name;      ///< of the method, written into its states
    std::int32_t version;  ///< of the format of its states
    int bases;             ///< number of bases in its history
    HistoryOptions history = {};
  };

  BlendedHistory(Extent extent, HistorySetup setup);

  /// Blends this frame into the history of a tile, by for_each_sample().
  virtual void blend_tile(const Tile& tile) = 0;
  /// Returns the picture, valid until the next frame. It may write into the history.
  [[nodiscard]] virtual const Planes<3>& finish() = 0;

  /// Calls blend(x, y, usable) for each pixel of the tile. blend() writes the new age into the
  /// history; it is copied to age().
  template <typename Blend>
  void for_each_sample(const Tile& tile, const Blend& blend);

  [[nodiscard]] const TileGrid& tiles() const { return tiles_; }
  [[nodiscard]] BasisField& bases() { return history_.bases(); }

 private:
  HistorySetup setup_;
  TileGrid tiles_;
  Frame frame_;
  FrameReport report_;
  BasisHistory history_;
  Plane<float> age_;
  std::vector<PixelCounts> counts_;  // per tile
};

template <typename Blend>
void BlendedHistory::for_each_sample(const Tile& tile, const Blend& blend) {
  const BasisField& field = history_.bases();
  PixelCounts& counts = counts_[static_cast<std::size_t>(tile.index)];
  counts = {};
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const bool fresh = frame_.surface.id(x, y) != 0 && field.age(x, y) == 0.0f;
      counts.fresh += fresh ? 1 : 0;
      blend(x, y, counts.add(frame_, x, y));
      age_(x, y) = field.age(x, y);
    }
  }
}

}  // namespace eigenlight

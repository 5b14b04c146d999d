// Statistical filtering of a whole sequence: offline PCA.
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "temporal/baselines/track_pca.h"
#include "temporal/denoiser.h"

namespace eigenlight {

struct MeyerOptions {
  /// >= 0 bytes that the frames and tracks of one sequence may take up together.
  std::int64_t most_bytes = std::int64_t{8} << 30;
  TrackPcaOptions pca = {};  ///< `bases` is taken from DenoiserOptions
  TapOptions taps = {};
};

/// Meyer and Anderson 2006, for comparison. The leading bases of a PCA of the whole sequence are
/// kept (8 in the paper, DenoiserOptions::bases here), and each frame is projected on them. The
/// paper takes the same points of the objects in every frame, visible or not. Here points are
/// followed through reprojected screen space while they are visible: PointTracks, TrackPca. A pixel
/// is the mean of the points on it, weighted by their bilinear shares and numbers of frames.
///
/// The first step() reads and analyzes all frames up to the end or the next cut. Each step() then
/// returns one of them, to which frame(), report() and age() refer. The time for reading and
/// analysis is shared equally among the reports. Throws std::runtime_error when the frames exceed
/// most_bytes; each pixel of a frame takes 150 bytes: 36 MB for a frame of 640 x 360, so 8 GiB hold
/// 248 such frames.
///
/// save() keeps the pictures that are left (16 bytes for each pixel and frame). After load() the
/// source must start with the first frame that was not returned, or step() throws
/// std::runtime_error. After reset() the rest of the sequence is analyzed as a sequence of its own.
///
/// Pixels that are not finite are missing data. `age` is the number of frames behind a pixel over
/// its number of bases; `new_pixels` counts the pixels that no other frame shows.
class Meyer2006 final : public Denoiser {
 public:
  explicit Meyer2006(const DenoiserOptions& options, const MeyerOptions& parts = {});

  [[nodiscard]] const Planes<3>* step(FrameSource& source) override;
  [[nodiscard]] const Frame& frame() const override { return frame_; }
  [[nodiscard]] const FrameReport& report() const override { return report_; }
  [[nodiscard]] const Plane<float>& age() const override { return picture_.age; }
  void reset() override;
  void save(StateWriter& out) const override;
  void load(StateReader& in) override;

 private:
  struct Picture {
    int index = 0;
    bool cut = false;
    std::int64_t fresh = 0;
    Planes<3> light;
    Plane<float> age;
  };

  void read_ahead(FrameSource& source);
  void analyze();
  [[nodiscard]] Picture picture(int t, int index) const;  // frame t of the analyzed sequence
  void take_picture(FrameSource& source);
  void write_report();

  MeyerOptions options_;
  Extent extent_;
  std::deque<Frame> frames_;   // read and not handed out
  std::optional<Frame> next_;  // the one that starts the next sequence
  std::unique_ptr<PointTracks> tracks_;
  std::unique_ptr<TrackPca> pca_;
  int done_ = 0;                  // frames of the analyzed sequence handed out
  std::deque<Picture> pictures_;  // from a state
  FrameReport shares_;            // of the time for reading and analysis
  Frame frame_;
  FrameReport report_;
  Picture picture_;
};

}  // namespace eigenlight

// Statistical filtering of a whole sequence: offline PCA.
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "temporal/baselines/track_pca.h"
#include "temporal/denoiser.h"

namespace eigenlight {

struct MeyerOptions {
  /// >= 0; frames and tracks of one sequence may take up so many bytes together.
  std::int64_t most_bytes = std::int64_t{8} << 30;
  TrackPcaOptions pca = {};  ///< `bases` is taken from DenoiserOptions
  TapOptions taps = {};
};

/// Meyer and Anderson 2006, for comparison: PCA of the whole sequence, of which the leading bases
/// are kept (8 in the paper; DenoiserOptions::bases here), and each frame is its projection on
/// them. They take the same points of the objects in every frame, seen or not. Here points are
/// followed through reprojected screen space and exist where they are seen: PointTracks, TrackPca.
/// A pixel is the mean of the points on it, by their bilinear share and the number of frames behind
/// them.
///
/// The first step() reads all frames up to the end or the next cut, and analyzes them; each step()
/// then hands out one, to which frame(), report() and age() refer. Reports bear equal shares of the
/// time for reading and analysis. Throws std::runtime_error when the frames exceed most_bytes, of
/// which a pixel of each frame takes 150: 36 MB a frame of 640 x 360, 248 such frames with 8 GiB.
///
/// save() keeps the pictures that are left (16 bytes a pixel and frame). After load() the source
/// has to start with the first frame that was not handed out, as a source does that goes on after a
/// restart; step() throws std::runtime_error where it does not. reset() makes what is left of the
/// sequence one of its own.
///
/// Pixels that are not finite are missing data. `age` is the number of frames behind a pixel over
/// its bases; `new_pixels` counts those of which no other frame knows.
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

#include "temporal/baselines/meyer2006.h"

#include <fmt/format.h>

#include <utility>

#include "temporal/samples/pixel_counts.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr std::int32_t kStateVersion = 1;
// Of a pixel: the planes of Frame, a sample and, spread over the frames of its track, its bases.
constexpr std::int64_t kPixelBytes = 150;

StageTime operator/(StageTime time, double parts) {
  return {time.wall_ms / parts, time.cpu_ms / parts};
}

// Saves or loads a picture.
template <typename Picture, typename State>
void archive(Picture& stored, State& state) {
  state.value("index", stored.index);
  state.value("cut", stored.cut);
  state.value("fresh", stored.fresh);
  state.planes("light", stored.light);
  state.plane("age", stored.age);
}

}  // namespace

Meyer2006::Meyer2006(const DenoiserOptions& options, const MeyerOptions& parts)
    : options_(parts), extent_(options.extent) {
  EL_CHECK(parts.most_bytes >= 0, "most_bytes {}: expected 0 or more", parts.most_bytes);
  options_.pca.bases = options.bases;
  options_.pca.validate();
  options_.taps.validate();
  picture_ = {0, false, 0, make_planes<3>(extent_), Plane<float>(extent_)};
}

const Planes<3>* Meyer2006::step(FrameSource& source) {
  if (!pictures_.empty()) {
    take_picture(source);
    return &picture_.light;
  }
  if (frames_.empty()) {
    StageClock clock;
    read_ahead(source);
    if (frames_.empty()) return nullptr;
    const StageTime time = clock.lap();
    analyze();
    shares_[Stage::kSource] = time / static_cast<double>(frames_.size());
  }
  StageClock clock;
  frame_ = std::move(frames_.front());
  frames_.pop_front();
  picture_ = picture(done_, frame_.index);
  ++done_;
  report_ = shares_;
  report_[Stage::kFilter] = clock.lap();
  write_report();
  return &picture_.light;
}

void Meyer2006::read_ahead(FrameSource& source) {
  if (next_) {
    frames_.push_back(std::move(*next_));
    next_.reset();
  }
  const auto pixels = static_cast<std::int64_t>(extent_.pixels());
  for (Frame frame; source.next(frame); frame = {}) {
    EL_CHECK(frame.extent() == extent_, "frame {} is {}x{}, expected {}x{}", frame.index,
             frame.extent().width, frame.extent().height, extent_.width, extent_.height);
    if (!frames_.empty() && frame.previous_index != frames_.back().index) {
      next_ = std::move(frame);
      return;
    }
    frames_.push_back(std::move(frame));
    const auto count = static_cast<std::int64_t>(frames_.size());
    if (count * pixels * kPixelBytes > options_.most_bytes) {
      throw std::runtime_error(fmt::format(
          "meyer2006 holds all frames at once: {} frames of {}x{} exceed its {} MB; expected fewer "
          "or smaller frames",
          count, extent_.width, extent_.height, options_.most_bytes / 1'000'000));
    }
  }
}

void Meyer2006::analyze() {
  StageClock clock;
  std::vector<const Frame*> frames;
  for (const Frame& frame : frames_) frames.push_back(&frame);
  const auto parts = static_cast<double>(frames.size());
  pca_.reset();
  tracks_ = std::make_unique<PointTracks>(frames, options_.taps);
  shares_ = {};
  shares_[Stage::kWarp] = clock.lap() / parts;
  pca_ = std::make_unique<TrackPca>(*tracks_, options_.pca);
  shares_[Stage::kProject] = clock.lap() / parts;
  shares_.mean_rank = pca_->bases();
  done_ = 0;
}

Meyer2006::Picture Meyer2006::picture(int t, int index) const {
  Picture made{index, t == 0, 0, make_planes<3>(extent_), Plane<float>(extent_)};
  Plane<float> weights(extent_), seen(extent_);
  for (const TrackSample& sample : tracks_->samples(t)) {
    const int frames = pca_->seen(sample.track);
    if (frames == 0) continue;
    const glm::vec3 light = pca_->light(sample.track, t);
    const float age = static_cast<float>(frames) / static_cast<float>(pca_->bases_of(sample.track));
    for (int i = 0; i < 4; ++i) {
      const float share = sample.weight[static_cast<std::size_t>(i)];
      if (!(share > 0.0f)) continue;
      const int x = sample.corner.x + i % 2, y = sample.corner.y + i / 2;
      const float weight = share * static_cast<float>(frames);
      weights(x, y) += weight;
      seen(x, y) += weight * static_cast<float>(frames);
      made.age(x, y) += weight * age;
      for (int c = 0; c < 3; ++c)
        made.light[static_cast<std::size_t>(c)](x, y) += weight * light[c];
    }
  }
  for (int y = 0; y < extent_.height; ++y) {
    for (int x = 0; x < extent_.width; ++x) {
      const float weight = weights(x, y);
      if (!(weight > 0.0f)) continue;
      for (auto& plane : made.light) plane(x, y) /= weight;
      made.age(x, y) /= weight;
      made.fresh += seen(x, y) / weight < 1.5f ? 1 : 0;
    }
  }
  return made;
}

void Meyer2006::take_picture(FrameSource& source) {
  StageClock clock;
  const Picture& stored = pictures_.front();
  if (!source.next(frame_) || frame_.index != stored.index) {
    throw std::runtime_error(fmt::format(
        "state of 'meyer2006' goes on with frame {}, which the source does not", stored.index));
  }
  report_ = {};
  report_[Stage::kSource] = clock.lap();
  picture_ = std::move(pictures_.front());
  pictures_.pop_front();
  write_report();
}

void Meyer2006::write_report() {
  report_.frame = frame_.index;
  report_.cut = picture_.cut;
  report_.rays = frame_.rays;
  report_.non_finite_samples = frame_.non_finite_samples;
  PixelCounts counts{.fresh = picture_.fresh};
  for (int y = 0; y < extent_.height; ++y) {
    for (int x = 0; x < extent_.width; ++x) counts.add(frame_, x, y);
  }
  counts.add_to(report_);
}

void Meyer2006::reset() {
  pictures_.clear();
  if (!frames_.empty()) analyze();
}

void Meyer2006::save(StateWriter& out) const {
  out.value("meyer2006", kStateVersion);
  out.value("bases", options_.pca.bases);
  out.value("size", extent_);
  out.value("pictures", pictures_.size() + frames_.size());
  for (const Picture& stored : pictures_) archive(stored, out);
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const Picture made = picture(done_ + static_cast<int>(i), frames_[i].index);
    archive(made, out);
  }
}

void Meyer2006::load(StateReader& in) {
  in.version("meyer2006", kStateVersion);
  int bases = 0;
  Extent size;
  in.value("bases", bases);
  in.value("size", size);
  if (bases != options_.pca.bases || size != extent_) {
    throw std::runtime_error(fmt::format("state: {} bases of {}x{}, expected {} of {}x{}", bases,
                                         size.width, size.height, options_.pca.bases, extent_.width,
                                         extent_.height));
  }
  std::size_t count = 0;
  in.value("pictures", count);
  pictures_.clear();
  frames_.clear();
  next_.reset();
  for (std::size_t i = 0; i < count; ++i) {
    Picture& stored = pictures_.emplace_back();
    archive(stored, in);
    if (stored.age.extent() != extent_ || stored.light[0].extent() != extent_) {
      throw std::runtime_error("state of 'meyer2006': a picture of another size");
    }
  }
}

}  // namespace eigenlight

#include "temporal/eigen/eigen_denoiser.h"

#include <algorithm>

#include "frame/strips.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr int kStateVersion = 6;

// Rows of pixels that a cell of the correction covers.
constexpr int kCellRows = 2;

int valid_layers(int layers) {
  EL_CHECK(layers >= 1 && layers <= kMaxLights, "layers {}: expected 1 to {}", layers, kMaxLights);
  return layers;
}

}  // namespace

EigenDenoiser::EigenDenoiser(const DenoiserOptions& options, const EigenOptions& tuning)
    : options_(tuning),
      shared_(options.extent, tuning),
      cell_filter_(options.extent, tuning.correction, valid_layers(options.layers)),
      atrous_(options.extent, tuning.atrous, std::min(options.layers, Atrous::kMostImages)) {
  tuning.validate();
  for (int i = 0; i < options.layers; ++i) layers_.emplace_back(i, options, tuning);
  if (options.layers > 1) lowest_age_ = Plane<float>(options.extent);
}

const Planes<3>* EigenDenoiser::step(FrameSource& source) {
  StageClock clock;
  const auto ends = [&](Stage stage) { report_[stage] += clock.lap(); };
  if (!read(source)) return nullptr;
  ends(Stage::kSource);
  warp();
  ends(Stage::kWarp);
  const std::int64_t planned = shared_.plan_samples(lowest_age());
  ends(Stage::kBudget);
  resample(source, planned);
  ends(Stage::kResample);
  // Layer by layer, but for the correction, which is shared: each step finds in the cache what the
  // steps before have left of its layer.
  for (LightLayer& layer : layers_) {
    layer.project();
    ends(Stage::kProject);
    layer.predict(shared_, resampled_);
    ends(Stage::kPredict);
    layer.bound(shared_);
    ends(Stage::kBound);
  }
  if (options_.correct) correct();
  ends(Stage::kCorrect);
  for (LightLayer& layer : layers_) {
    layer.learn();
    ends(Stage::kLearn);
    layer.update(shared_);
    ends(Stage::kUpdate);
    layer.fill_young(shared_);
    ends(Stage::kFilter);
  }
  if (options_.filter) filter();
  ends(Stage::kFilter);
  finish_report();
  shared_.finish();
  return &layers_.front().output();
}

// Reads a frame, counts its surfaces, and reads their geometry for the cells of the correction.
bool EigenDenoiser::read(FrameSource& source) {
  if (!shared_.read(source, layers())) return false;
  report_ = {};
  for_each_strip(shared_.tiles(), [&](const Strip& strip) {
    for_each_band(strip, kCellRows, [&](const Strip& band) {
      for_each_segment(shared_.tiles(), band,
                       [&](const Tile& row) { shared_.check_surfaces(row); });
      for (LightLayer& layer : layers_) layer.place_cells(shared_, band.area);
    });
  });
  return true;
}

// Reprojects history to this frame. The same visit sums the products of bases and light, which
// project() needs.
void EigenDenoiser::warp() {
  for (LightLayer& layer : layers_) layer.start_warp(shared_);
  for_each_strip(shared_.tiles(), [&](const Strip& strip) {
    for_each_band(strip, kSumRows, [&](const Strip& band) {
      for_each_band(band, 1, [&](const Strip& row) {
        if (shared_.is_moving()) warp_row(row);
        for (LightLayer& layer : layers_) layer.read_ages(row);
        if (layers() > 1) find_lowest_age(row.area);
      });
      if (shared_.is_cut()) return;
      for (LightLayer& layer : layers_) layer.sum_products(shared_, band);
    });
  });
  for (LightLayer& layer : layers_) layer.finish_warp(shared_);
}

// The taps of a whole row come first. Layers that took turns tile by tile would switch between
// streams of memory before the hardware has recognized them.
void EigenDenoiser::warp_row(const Strip& row) {
  std::array<TapSegment, kStripWidth / kCoefficientTile> taps;
  for_each_part(shared_.tiles(), row, [&](const Tile& part) {
    if (!shared_.is_empty(part)) {
      shared_.find_taps(part, taps[static_cast<std::size_t>(part.index - row.area.index)]);
    }
  });
  for (LightLayer& layer : layers_) layer.warp_row(shared_, taps, row);
}

// A pixel is as young as its youngest layer.
void EigenDenoiser::find_lowest_age(const Rect& row) {
  float* lowest = lowest_age_.at(row.x0, row.y0);
  const float* before = layers_.front().old_age().at(row.x0, row.y0);
  for (std::size_t layer = 1; layer < layers_.size(); ++layer, before = lowest) {
    const float* age = layers_[layer].old_age().at(row.x0, row.y0);
    for (int i = 0; i < row.width(); ++i) lowest[i] = age[i] < before[i] ? age[i] : before[i];
  }
}

void EigenDenoiser::resample(FrameSource& source, std::int64_t planned) {
  std::array<Planes<3>*, kMaxLights> means{};
  for (int i = 0; i < layers(); ++i) {
    means[static_cast<std::size_t>(i)] = &layers_[static_cast<std::size_t>(i)].extra_mean();
  }
  resampled_ = planned > 0 && source.resample(shared_.extra(), shared_.frame(),
                                              std::span(means).first(layers_.size()));
  if (resampled_) report_.extra_samples = planned;
}

void EigenDenoiser::correct() {
  std::vector<CorrectionLayer> ready;
  for (LightLayer& layer : layers_) ready.push_back(layer.prepare_correction(shared_));
  cell_filter_.correct(ready);
}

// The passes filter all layers at once, or as many as they can.
void EigenDenoiser::filter() {
  std::vector<AtrousImage> images;
  for (LightLayer& layer : layers_) images.push_back(layer.image());
  for (std::span<AtrousImage> left = images; !left.empty();) {
    const auto some = left.first(std::min(left.size(), std::size_t{Atrous::kMostImages}));
    report_.skipped_filter += atrous_.process(frame(), options_.quiet_variance, some);
    left = left.subspan(some.size());
  }
  for (LightLayer& layer : layers_) layer.keep_picture();
}

void EigenDenoiser::finish_report() {
  report_.frame = frame().index;
  report_.cut = shared_.is_cut();
  report_.rays = frame().rays;
  report_.non_finite_samples = frame().non_finite_samples;
  const TileGrid& tiles = shared_.tiles();
  const auto pixels = static_cast<std::int64_t>(tiles.extent().pixels());
  PixelCounts surfaces;
  for (int i = 0; i < tiles.count(); ++i) {
    surfaces += shared_.counts()[i];
    if (shared_.is_empty(tiles.tile(i))) report_.skipped_surface += tiles.tile(i).pixels();
  }
  surfaces.add_to(report_);
  for (const LightLayer& layer : layers_) layer.add_to(shared_, report_);
  report_.mean_rank /= static_cast<double>(layers());
  report_.skipped_warp = shared_.is_still() ? pixels : 0;
  report_.skipped_geometry = options_.filter ? atrous_.planar_pixels() : 0;
  if (!options_.filter) report_.skipped_filter = report_.surface_pixels * layers();
}

void EigenDenoiser::save(StateWriter& out) const {
  out.value("eigenlight", kStateVersion);
  out.value("layers", layers());
  shared_.save(out);
  for (const LightLayer& layer : layers_) layer.save(out);
}

void EigenDenoiser::load(StateReader& in) {
  in.version("eigenlight", kStateVersion);
  int layers = 0;
  in.value("layers", layers);
  if (layers != this->layers()) {
    throw std::runtime_error("state of 'eigenlight': " + std::to_string(layers) +
                             " layers of light, expected " + std::to_string(this->layers()));
  }
  shared_.load(in);
  for (LightLayer& layer : layers_) layer.load(in);
}

}  // namespace eigenlight

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

}  // namespace

EigenDenoiser::EigenDenoiser(const DenoiserOptions& options, const EigenOptions& tuning)
    : options_(tuning), shared_(options.extent, tuning) {
  tuning.validate();
  EL_CHECK(options.layers >= 1 && options.layers <= kMaxLights, "layers {}: expected 1 to {}",
           options.layers, kMaxLights);
  for (int i = 0; i < options.layers; ++i) layers_.emplace_back(i, options, tuning);
  if (options.layers > 1) lowest_age_ = Plane<float>(options.extent);
  noisy_ = PerTile<std::uint8_t>(stage_tiles(options.extent));
}

const Planes<3>* EigenDenoiser::step(FrameSource& source) {
  StageClock clock;
  const auto ends = [&](Stage stage) { report_[stage] = clock.lap(); };
  const auto each_layer = [&](auto run) {
    for (LightLayer& layer : layers_) run(layer);
  };
  if (!read(source)) return nullptr;
  ends(Stage::kSource);
  warp();
  ends(Stage::kWarp);
  const std::int64_t planned = shared_.plan_samples(lowest_age());
  ends(Stage::kBudget);
  resample(source, planned);
  ends(Stage::kResample);
  each_layer([](LightLayer& layer) { layer.project(); });
  ends(Stage::kProject);
  each_layer([&](LightLayer& layer) { layer.predict(shared_, resampled_); });
  ends(Stage::kPredict);
  each_layer([&](LightLayer& layer) { layer.bound(shared_); });
  ends(Stage::kBound);
  each_layer([&](LightLayer& layer) { layer.correct(shared_); });
  ends(Stage::kCorrect);
  each_layer([](LightLayer& layer) { layer.learn(); });
  ends(Stage::kLearn);
  each_layer([&](LightLayer& layer) { layer.update(shared_); });
  ends(Stage::kUpdate);
  filter();
  ends(Stage::kFilter);
  finish_report();
  shared_.finish();
  return &layers_.front().output();
}

// A frame, its surfaces, and their geometry at the grain of the correction.
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

// History comes to where its surfaces are now. The same visit sums the products of bases and light
// that project() solves for.
void EigenDenoiser::warp() {
  for (LightLayer& layer : layers_) layer.start_warp(shared_);
  for_each_strip(shared_.tiles(), [&](const Strip& strip) {
    for_each_band(strip, kSumRows, [&](const Strip& band) {
      for_each_segment(shared_.tiles(), band, [&](const Tile& row) {
        if (shared_.is_moving()) warp_row(row);
        for (LightLayer& layer : layers_) layer.read_ages(row);
      });
      if (shared_.is_cut()) return;
      for (LightLayer& layer : layers_) layer.sum_products(shared_, band);
    });
  });
  for (LightLayer& layer : layers_) layer.finish_warp(shared_);
}

void EigenDenoiser::warp_row(const Tile& row) {
  if (shared_.is_empty(row)) {
    for (LightLayer& layer : layers_) layer.clear_row(row);
    return;
  }
  TapSegment taps;
  shared_.find_taps(row, taps);
  for (LightLayer& layer : layers_) layer.warp_row(taps, row);
}

// A pixel is as young as its youngest layer.
const Plane<float>& EigenDenoiser::lowest_age() {
  if (layers() == 1) return layers_.front().old_age();
  for_each_segment(shared_.tiles(), [&](const Tile& row) {
    const int width = row.width();
    float* lowest = lowest_age_.at(row.x0, row.y0);
    std::copy_n(layers_.front().old_age().at(row.x0, row.y0), width, lowest);
    for (const LightLayer& layer : layers_) {
      const float* age = layer.old_age().at(row.x0, row.y0);
      for (int i = 0; i < width; ++i) lowest[i] = age[i] < lowest[i] ? age[i] : lowest[i];
    }
  });
  return lowest_age_;
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

// Young pixels are filled; then all layers share the planes of the frame.
void EigenDenoiser::filter() {
  for (LightLayer& layer : layers_) layer.fill_young(shared_);
  if (!options_.filter) return;
  noisy_.fill(0);
  for (LightLayer& layer : layers_) {
    const auto& noisy = layer.find_noisy(shared_);
    std::transform(noisy.begin(), noisy.end(), noisy_.begin(), noisy_.begin(), std::bit_or<>());
  }
  shared_.find_planes(noisy_);
  for (LightLayer& layer : layers_) layer.filter(shared_);
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
  report_.skipped_geometry = options_.filter ? shared_.planes().pixels() : 0;
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

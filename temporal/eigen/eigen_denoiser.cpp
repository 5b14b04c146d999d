#include "temporal/eigen/eigen_denoiser.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "frame/strips.h"
#include "reproject/warp.h"
#include "temporal/bases/predict.h"
#include "temporal/bases/update.h"
#include "temporal/change/edges.h"
#include "temporal/samples/guides.h"
#include "temporal/samples/signal.h"
#include "temporal/stage_clock.h"

namespace eigenlight {
namespace {

// Changes when the saved bytes do.
constexpr int kStateVersion = 5;

void expect_bases(int found, int wanted) {
  if (found == wanted) return;
  throw std::runtime_error(
      fmt::format("state of 'eigenlight': {} bases, expected {}", found, wanted));
}

// Longest age at edges, over that of the pixels around, where light changes.
constexpr float kEdgeShare = 2.0f / 3.0f;

}  // namespace

EigenDenoiser::EigenDenoiser(const DenoiserOptions& options, const EigenOptions& parts)
    : options_(parts),
      extent_(options.extent),
      tiles_(extent_, kCoefficientTile, kCoefficientTile),
      surfaces_(extent_),
      bases_(extent_, 1),
      warped_bases_(extent_, 1),
      variance_(extent_),
      warped_variance_(extent_),
      memory_(extent_, options.bases),
      budget_(extent_, parts.budget),
      fireflies_(extent_, parts.fireflies),
      correction_(extent_, parts.correction),
      filter_(extent_, parts),
      coefficients_(extent_, options.bases),
      learning_(extent_, options.bases),
      sums_(static_cast<std::size_t>(tiles_.count())),
      counts_(static_cast<std::size_t>(tiles_.count())),
      extra_(extent_),
      edge_(extent_),
      young_(extent_),
      residual_(make_planes<3>(extent_)),
      innovation_(extent_),
      expected_(extent_),
      output_(make_planes<3>(extent_)),
      samples_(extent_),
      old_age_(extent_),
      new_age_(extent_),
      output_variance_(extent_) {
  parts.validate();
}

const Planes<3>* EigenDenoiser::step(FrameSource& source) {
  StageClock clock;
  // Not before: until then the frame is the caller's to read.
  if (!std::exchange(is_taken_, true)) surfaces_.take(frame_);
  if (!source.next(frame_)) return nullptr;
  start_frame(clock.lap());
  warp_history();
  report_[Stage::kReproject] = clock.lap();
  const std::int64_t planned = budget_.process(frame_, old_age_, extra_).samples;
  report_[Stage::kBudget] = clock.lap();
  const bool resampled = resample(source, planned);
  report_[Stage::kResample] = clock.lap();
  project(resampled);
  report_[Stage::kProject] = clock.lap();
  update();
  report_[Stage::kUpdate] = clock.lap();
  filter();
  is_taken_ = false;
  report_[Stage::kFilter] = clock.lap();
  report_.rays = frame_.rays;
  report_.non_finite_samples = frame_.non_finite_samples;
  return &output_;
}

void EigenDenoiser::start_frame(const StageTime& time) {
  EL_CHECK(frame_.extent() == extent_, "frame {} is {}x{}, expected {}x{}", frame_.index,
           frame_.extent().width, frame_.extent().height, extent_.width, extent_.height);
  report_ = {};
  report_.frame = frame_.index;
  report_.cut = !surfaces_.is_followed_by(frame_);
  report_[Stage::kSource] = time;
  std::fill(counts_.begin(), counts_.end(), TileCount{});
  // Two rows at a time: those of a cell of the correction.
  for_each_strip(tiles_, [&](const Strip& strip) {
    for_each_band(strip, 2, [&](const Strip& band) {
      for_each_segment(tiles_, band, [&](const Tile& row) { count_surface(row); });
      if (options_.correct) correction_.place(frame_.surface, band.area);
    });
  });
}

void EigenDenoiser::count_surface(const Tile& row) {
  const GuideCounts found = count_guides(frame_.surface, row);
  TileCount& count = counts_[static_cast<std::size_t>(row.index)];
  count.surface += found.surface;
  count.unguided += found.surface - found.usable;
  if (found.usable < found.surface) drop_unusable(row);
}

void EigenDenoiser::drop_unusable(const Tile& row) {
  for (int x = row.x0; x < row.x1; ++x) {
    if (frame_.surface.id(x, row.y0) != 0 && !has_usable_guides(frame_.surface, x, row.y0)) {
      drop_guides(frame_, x, row.y0);
    }
  }
}

bool EigenDenoiser::is_empty(const Tile& tile) const {
  return options_.skip_empty && counts_[static_cast<std::size_t>(tile.index)].surface == 0;
}

void EigenDenoiser::warp_history() {
  const bool still = options_.skip_still && !report_.cut && frame_.is_static;
  std::fill(sums_.begin(), sums_.end(), TileSums{});
  if (report_.cut) {
    memory_.reset();
    bases_.reshape(memory_.active());
    bases_.clear();
    variance_.fill(0.0f);
  }
  warped_bases_.reshape(bases_.bases());
  const bool moving = !report_.cut && !still;
  has_edges_ = moving && options_.edge < options_.innovation.max_age;
  if (!moving) {
    std::swap(bases_, warped_bases_);
    std::swap(variance_, warped_variance_);
    filter_.keep();
  }
  const SumInputs history{warped_bases_, frame_, warped_variance_, memory_.active()};
  for_each_strip(tiles_, [&](const Strip& strip) {
    for_each_band(strip, kSumRows, [&](const Strip& band) {
      for_each_segment(tiles_, band, [&](const Tile& row) {
        if (moving) warp_row(row);
        warped_bases_.copy_ages(row, old_age_);
      });
      if (report_.cut) return;
      for_each_part(tiles_, band, [&](const Tile& part) {
        if (is_empty(part)) return;
        accumulate_tile(history, part, sums_[static_cast<std::size_t>(part.index)]);
      });
    });
  });
  for_each_tile(tiles_, [&](const Tile& tile) {
    admit_outliers(history, tile, sums_[static_cast<std::size_t>(tile.index)]);
  });
  std::swap(variance_, warped_variance_);
  if (still) report_.skipped_warp = static_cast<std::int64_t>(extent_.pixels());
}

void EigenDenoiser::warp_row(const Tile& row) {
  if (is_empty(row)) return warped_bases_.clear(row);
  TapSegment taps;
  compute_taps(frame_, surfaces_.previous(), options_.taps, row, taps);
  if (has_edges_) find_edges(frame_, options_.taps, row, edge_);
  warp_bases(bases_, taps, row, warped_bases_);
  warp_plane(variance_, taps, row, warped_variance_);
  filter_.warp(taps, row);
}

bool EigenDenoiser::resample(FrameSource& source, std::int64_t planned) {
  const bool resampled = planned > 0 && eigenlight::resample(source, extra_, frame_, residual_);
  if (resampled) report_.extra_samples = planned;
  return resampled;
}

CorrectionInputs EigenDenoiser::correction_inputs() const {
  return {frame_, residual_, innovation_, old_age_, samples_, variance_};
}

// What history expects of this frame's samples, and how they differ. Band by band: each step finds
// in the cache what the one before it left.
void EigenDenoiser::predict(bool resampled) {
  const SignalInputs signal{frame_, resampled ? &extra_ : nullptr, resampled ? &residual_ : nullptr,
                            old_age_};
  for_each_strip(tiles_, [&](const Strip& strip) {
    for_each_band(strip, kFireflyBlock, [&](const Strip& band) {
      for_each_segment(tiles_, band, [&](const Tile& row) {
        const SignalCounts found = merge_samples(signal, row, {residual_, samples_});
        TileCount& count = counts_[static_cast<std::size_t>(row.index)];
        count.fresh += found.fresh;
        count.non_finite += found.non_finite;
        predict_tile(warped_bases_, coefficients_, row,
                     {residual_, innovation_, expected_, variance_});
      });
      fireflies_.count({expected_, old_age_, samples_, variance_}, {residual_, innovation_},
                       band.area);
      if (options_.correct) correction_.count(correction_inputs(), band.area);
    });
  });
  for (const TileCount& count : counts_) {
    report_.surface_pixels += count.surface;
    report_.new_pixels += count.fresh;
    report_.non_finite_pixels += count.non_finite;
    report_.unguided_pixels += count.unguided;
  }
}

void EigenDenoiser::project(bool resampled) {
  if (options_.project) {
    solve_coefficients(sums_, memory_.expected(), options_.shrink, coefficients_);
  }
  coefficients_.set_used(memory_.active());
  predict(resampled);
  const auto count_again = [&](const Tile& block) {
    if (options_.correct) correction_.count(correction_inputs(), block);
  };
  report_.bounded_pixels = fireflies_.bound({expected_, old_age_, samples_, variance_},
                                            {residual_, innovation_}, count_again);
  const double corrected =
      options_.correct ? correction_.process(correction_inputs(), innovation_) : 0.0;
  report_.skipped_correction =
      options_.correct ? correction_.skipped() : static_cast<std::int64_t>(extent_.pixels());
  memory_.advance(coefficients_, learning_);
  newborn_ = corrected > options_.birth ? memory_.free_slot() : 0;
  report_rank();
}

void EigenDenoiser::report_rank() {
  double rank = 0.0, tiles = 0.0;
  for (int i = 0; i < tiles_.count(); ++i) {
    if (counts_[static_cast<std::size_t>(i)].surface == 0) {
      if (options_.skip_empty) report_.skipped_surface += tiles_.tile(i).pixels();
      continue;
    }
    const auto delta = coefficients_.tile(i).subspan(1);
    tiles += 1.0;
    rank += 1.0 + static_cast<double>(delta.size()) -
            static_cast<double>(std::count(delta.begin(), delta.end(), 0.0f));
  }
  report_.mean_rank = tiles > 0.0 ? rank / tiles : 0.0;
}

// Where light changes in ways that no basis knows, memory ends sooner: the longest age of a tile
// lies between the two by the share that each has in the weight of a frame.
float EigenDenoiser::longest_age(int tile) const {
  const float change = options_.correct ? correction_.change(tile) : 0.0f;
  const float most = options_.innovation.max_age, least = std::min(options_.changing, most);
  return change > 0.0f ? 1.0f / ((1.0f - change) / most + change / least) : most;
}

void EigenDenoiser::shorten_memory(const Tile& tile) {
  const float inside = longest_age(tile.index);
  const float at_edges = has_edges_ ? std::min(options_.edge, kEdgeShare * inside) : inside;
  if (!(at_edges < options_.innovation.max_age)) return;
  shorten_ages(edge_, samples_, {inside, at_edges}, tile, new_age_);
}

void EigenDenoiser::update() {
  const int bases = std::max(memory_.active(), newborn_ + 1);
  // In place: what is written over need not be fetched first.
  if (bases == warped_bases_.bases()) {
    std::swap(bases_, warped_bases_);
  } else {
    bases_.reshape(bases);
    bases_.assign(warped_bases_);
  }
  for_each_strip(tiles_, [&](const Strip& strip) {
    innovation_tile({innovation_, old_age_, samples_}, options_.innovation, strip.area,
                    {new_age_, variance_});
    for (int i = strip.area.index; i < strip.area.index + strip.tiles; ++i) {
      if (is_empty(tiles_.tile(i))) {
        clear_tile(tiles_.tile(i));
      } else {
        fresh_variance({frame_, samples_, old_age_, fireflies_.brightness()}, tiles_.tile(i),
                       variance_);
        shorten_memory(tiles_.tile(i));
      }
    }
    for_each_segment(tiles_, strip, [&](const Tile& row) {
      if (!is_empty(row)) update_row(row);
    });
  });
  if (newborn_ > 0) memory_.born(newborn_);
  for (const int k : memory_.retire()) bases_.clear_basis(k);
}

void EigenDenoiser::update_row(const Tile& row) {
  const Planes<3>* correction =
      correction_.is_open(row.index) ? &correction_.correction() : nullptr;
  update_tile({coefficients_, learning_, residual_, correction, samples_, old_age_, new_age_,
               memory_.active(), newborn_},
              row, {bases_, output_});
  estimate_variance({frame_.surface.id, new_age_, variance_, options_.young}, row,
                    {output_variance_, young_});
}

// What an earlier frame showed there is gone.
void EigenDenoiser::clear_tile(const Tile& tile) {
  for (auto& plane : output_) fill_rect(plane, tile, 0.0f);
  fill_rect(new_age_, tile, 0.0f);
  bases_.clear(tile);
  fill_rect(output_variance_, tile, 0.0f);
  fill_rect(young_, tile, std::uint8_t{0});
}

void EigenDenoiser::filter() {
  const FilterReport skipped =
      filter_.process({frame_, old_age_, new_age_, young_}, output_, output_variance_);
  report_.skipped_guided = skipped.guided;
  report_.skipped_filter = options_.filter ? skipped.atrous : report_.surface_pixels;
  report_.skipped_geometry = skipped.geometry;
}

void EigenDenoiser::save(StateWriter& out) const {
  out.value("eigenlight", kStateVersion);
  is_taken_ ? surfaces_.save(out) : SurfaceHistory::save(out, frame_);
  out.value("bases", memory_.bases());
  out.value("bases in use", bases_.bases());
  bases_.save(out);
  out.plane("variance", variance_);
  filter_.save(out);
  memory_.save(out);
}

void EigenDenoiser::load(StateReader& in) {
  in.version("eigenlight", kStateVersion);
  surfaces_.load(in);
  is_taken_ = true;
  int bases = 0;
  in.value("bases", bases);
  expect_bases(bases, memory_.bases());
  in.value("bases in use", bases);
  if (bases < 1 || bases > memory_.bases()) expect_bases(bases, memory_.active());
  bases_.reshape(bases);
  bases_.load(in);
  in.plane("variance", variance_);
  filter_.load(in);
  memory_.load(in);
}

}  // namespace eigenlight

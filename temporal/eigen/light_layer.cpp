#include "temporal/eigen/light_layer.h"

#include <algorithm>

#include "frame/strips.h"
#include "reproject/warp.h"
#include "temporal/bases/even_sums.h"
#include "temporal/bases/predict.h"
#include "temporal/bases/update.h"
#include "temporal/change/edges.h"
#include "temporal/samples/signal.h"

namespace eigenlight {
namespace {

// Longest age at edges, over that of the pixels around, where light changes.
constexpr float kEdgeShare = 2.0f / 3.0f;

PingPong<Plane<float>> two_planes(Extent extent) {
  return {Plane<float>(extent), Plane<float>(extent)};
}

// Room for all bases from the start: a basis that is born allocates nothing.
PingPong<BasisField> two_fields(Extent extent, int bases) {
  PingPong<BasisField> fields{BasisField(extent, bases), BasisField(extent, bases)};
  fields.now.reshape(1);
  fields.before.reshape(1);
  return fields;
}

}  // namespace

LightLayer::LightLayer(int index, const DenoiserOptions& options, const EigenOptions& tuning)
    : index_(index),
      options_(tuning),
      tiles_(options.extent, kCoefficientTile, kCoefficientTile),
      bases_(two_fields(options.extent, options.bases)),
      variance_(two_planes(options.extent)),
      coefficient_history_(options.extent, options.bases),
      fireflies_(options.extent, tuning.fireflies),
      correction_(options.extent, tuning.correction, tuning.taps),
      filter_(options.extent, tuning),
      coefficients_(options.extent, options.bases),
      learning_rates_(options.extent, options.bases),
      sums_(tiles_),
      counts_(tiles_),
      residual_(make_planes<3>(options.extent)),
      innovation_(options.extent),
      expected_(options.extent),
      samples_(options.extent),
      old_age_(options.extent),
      new_age_(options.extent),
      output_variance_(options.extent),
      young_(options.extent),
      output_(make_planes<3>(options.extent)) {}

// The parts of the tiles of a strip or band that show a surface.
template <typename Body>
void LightLayer::each_surface(const SharedFrame& shared, const Strip& band, Body&& body) const {
  for_each_part(tiles_, band, [&](const Tile& part) {
    if (!shared.is_empty(part)) body(part);
  });
}

void LightLayer::start_warp(const SharedFrame& shared) {
  sums_.fill({});
  if (shared.is_cut()) {
    coefficient_history_.reset();
    bases_.now.reshape(coefficient_history_.active());
    bases_.now.clear();
    variance_.now.fill(0.0f);
  }
  if (!shared.is_moving()) return;
  bases_.swap();
  bases_.now.reshape(bases_.before.bases());
  variance_.swap();
  filter_.start_warp();
}

// Field by field: along the row each of them is one stream of memory.
void LightLayer::warp_row(const SharedFrame& shared, std::span<const TapSegment> taps,
                          const Strip& row) {
  const auto taps_of = [&](const Tile& part) -> const TapSegment& {
    return taps[static_cast<std::size_t>(part.index - row.area.index)];
  };
  each_surface(shared, row, [&](const Tile& part) {
    warp_bases(bases_.before, taps_of(part), part, bases_.now);
  });
  each_surface(shared, row, [&](const Tile& part) {
    warp_plane(variance_.before, taps_of(part), part, variance_.now);
  });
  each_surface(shared, row, [&](const Tile& part) { filter_.warp(taps_of(part), part); });
  for_each_part(tiles_, row, [&](const Tile& part) {
    if (shared.is_empty(part)) bases_.now.clear(part);
  });
}

void LightLayer::read_ages(const Strip& row) {
  for_each_part(tiles_, row, [&](const Tile& part) { bases_.now.copy_ages(part, old_age_); });
}

void LightLayer::sum_products(const SharedFrame& shared, const Strip& band) {
  const Planes<3>& light = shared.frame().lights[static_cast<std::size_t>(index_)].radiance;
  const SumInputs history{bases_.now, light, variance_.now, coefficient_history_.active()};
  each_surface(shared, band, [&](const Tile& part) {
    if (options_.even_gain) return accumulate_even(history, part, sums_[part]);
    accumulate_tile(history, part, sums_[part]);
  });
}

void LightLayer::finish_warp(const SharedFrame& shared) {
  if (options_.even_gain) return;
  const Planes<3>& light = shared.frame().lights[static_cast<std::size_t>(index_)].radiance;
  const SumInputs history{bases_.now, light, variance_.now, coefficient_history_.active()};
  for_each_tile(tiles_, [&](const Tile& tile) { admit_outliers(history, tile, sums_[tile]); });
}

void LightLayer::project() {
  if (options_.project) {
    solve_coefficients(sums_.values(), coefficient_history_.expected(), options_.shrink,
                       coefficients_);
  }
  coefficients_.set_used(coefficient_history_.active());
}

CorrectionInputs LightLayer::correction_inputs(const SharedFrame& shared) const {
  return {shared.frame(), residual_, innovation_, old_age_, samples_, variance_.now};
}

void LightLayer::predict(const SharedFrame& shared, bool resampled) {
  const SignalInputs signal{
      shared.frame(), shared.frame().lights[static_cast<std::size_t>(index_)].radiance,
      resampled ? &shared.extra() : nullptr, resampled ? &residual_ : nullptr, old_age_};
  const PredictOutputs prediction{residual_, innovation_, expected_, variance_.now};
  counts_.fill({});
  for_each_strip(tiles_, [&](const Strip& strip) {
    for_each_band(strip, kFireflyBlock, [&](const Strip& band) {
      for_each_band(band, 1, [&](const Strip& row) {
        for_each_part(tiles_, row, [&](const Tile& part) {
          counts_[part] += merge_samples(signal, part, {residual_, samples_});
        });
        for_each_part(tiles_, row, [&](const Tile& part) {
          predict_tile(bases_.now, coefficients_, part, prediction);
        });
      });
      fireflies_.count({expected_, old_age_, samples_, variance_.now}, {residual_, innovation_},
                       band.area);
      if (options_.correct) correction_.count_blocks(correction_inputs(shared), band.area);
    });
  });
}

void LightLayer::bound(const SharedFrame& shared) {
  const auto count_again = [&](const Rect& block) {
    if (options_.correct) correction_.count_blocks(correction_inputs(shared), block);
  };
  bounded_ = fireflies_.bound({expected_, old_age_, samples_, variance_.now},
                              {residual_, innovation_}, count_again);
}

CorrectionLayer LightLayer::prepare_correction(const SharedFrame& shared) {
  correction_.prepare(correction_inputs(shared));
  return {correction_, shared.frame(), innovation_};
}

void LightLayer::learn() {
  coefficient_history_.learn(coefficients_, learning_rates_);
  newborn_ = correction_.share() > options_.birth_share ? coefficient_history_.free_slot() : 0;
}

void LightLayer::update(const SharedFrame& shared) {
  make_room(std::max(coefficient_history_.active(), newborn_ + 1));
  for_each_strip(tiles_, [&](const Strip& strip) {
    innovation_tile({innovation_, old_age_, samples_}, options_.innovation, strip.area,
                    {new_age_, variance_.now});
    for_each_part(tiles_, strip, [&](const Tile& tile) { test_tile(shared, tile); });
    for_each_band(strip, 1, [&](const Strip& row) { update_row(shared, row); });
  });
  if (newborn_ > 0) coefficient_history_.born(newborn_);
  for (const int k : coefficient_history_.retire()) bases_.now.clear_basis(k);
}

// In place: memory that is overwritten need not be fetched first. Only a birth moves the bases.
void LightLayer::make_room(int bases) {
  if (bases == bases_.now.bases()) return;
  bases_.before.reshape(bases);
  bases_.before.assign(bases_.now);
  bases_.swap();
}

// The noise of new pixels, and limits on ages, which innovation_tile() does not handle.
void LightLayer::test_tile(const SharedFrame& shared, const Tile& tile) {
  if (shared.is_empty(tile)) return clear_tile(tile);
  const Planes<3>& light = shared.frame().lights[static_cast<std::size_t>(index_)].radiance;
  fresh_variance({shared.frame(), light, samples_, old_age_, fireflies_.brightness()}, tile,
                 variance_.now);
  shorten_ages(shared, tile);
}

// Where light changes in ways that no basis explains, the longest age is lower. The weight of a
// frame, 1 / age, is interpolated between both limits.
float LightLayer::longest_age(const Tile& tile) const {
  const float change = options_.correct ? correction_.change(tile.index) : 0.0f;
  const float most = options_.innovation.max_age;
  const float least = std::min(options_.max_age_changing, most);
  return change > 0.0f ? 1.0f / ((1.0f - change) / most + change / least) : most;
}

void LightLayer::shorten_ages(const SharedFrame& shared, const Tile& tile) {
  const float inside = longest_age(tile);
  const float at_edges =
      shared.has_edges() ? std::min(options_.max_age_edge, kEdgeShare * inside) : inside;
  if (!(at_edges < options_.innovation.max_age)) return;
  eigenlight::shorten_ages(shared.edge(), samples_, {inside, at_edges}, tile, new_age_);
}

void LightLayer::update_row(const SharedFrame& shared, const Strip& row) {
  each_surface(shared, row, [&](const Tile& part) {
    const Planes<3>* correction =
        correction_.is_open(part.index) ? &correction_.correction() : nullptr;
    update_tile({coefficients_, learning_rates_, residual_, correction, samples_, old_age_,
                 new_age_, coefficient_history_.active(), newborn_},
                part, {bases_.now, output_});
  });
  each_surface(shared, row, [&](const Tile& part) {
    estimate_variance({shared.frame().surface.id, new_age_, variance_.now, options_.young_age},
                      part, {output_variance_, young_});
  });
}

// Forgets what an earlier frame showed there.
void LightLayer::clear_tile(const Tile& tile) {
  for (auto& plane : output_) fill_rect(plane, tile, 0.0f);
  fill_rect(new_age_, tile, 0.0f);
  bases_.now.clear(tile);
  fill_rect(output_variance_, tile, 0.0f);
  fill_rect(young_, tile, std::uint8_t{0});
}

void LightLayer::fill_young(const SharedFrame& shared) {
  skipped_guided_ =
      filter_.fill_young({shared.frame(), new_age_, young_}, output_, output_variance_);
}

double LightLayer::mean_rank(const SharedFrame& shared) const {
  double rank = 0.0, tiles = 0.0;
  for (int i = 0; i < tiles_.count(); ++i) {
    if (shared.counts()[i].surface == 0) continue;
    const auto delta = coefficients_.tile(i).subspan(1);
    tiles += 1.0;
    rank += 1.0 + static_cast<double>(delta.size()) -
            static_cast<double>(std::count(delta.begin(), delta.end(), 0.0f));
  }
  return tiles > 0.0 ? rank / tiles : 0.0;
}

void LightLayer::add_to(const SharedFrame& shared, FrameReport& report) const {
  PixelCounts all;
  for (const PixelCounts& count : counts_) all += count;
  report.new_pixels += all.fresh;
  report.non_finite_pixels += all.non_finite;
  report.bounded_pixels += bounded_;
  report.mean_rank += mean_rank(shared);
  const auto pixels = static_cast<std::int64_t>(tiles_.extent().pixels());
  report.skipped_correction += options_.correct ? correction_.skipped() : pixels;
  report.skipped_guided += skipped_guided_;
}

void LightLayer::save(StateWriter& out) const {
  out.value("bases", coefficient_history_.bases());
  out.value("bases in use", bases_.now.bases());
  bases_.now.save(out);
  out.plane("variance", variance_.now);
  filter_.save(out);
  coefficient_history_.save(out);
}

void LightLayer::load(StateReader& in) {
  const auto expect_bases = [](int found, int wanted) {
    if (found == wanted) return;
    throw std::runtime_error("state of 'eigenlight': " + std::to_string(found) +
                             " bases, expected " + std::to_string(wanted));
  };
  int bases = 0;
  in.value("bases", bases);
  expect_bases(bases, coefficient_history_.bases());
  in.value("bases in use", bases);
  if (bases < 1 || bases > coefficient_history_.bases())
    expect_bases(bases, coefficient_history_.active());
  bases_.now.reshape(bases);
  bases_.now.load(in);
  in.plane("variance", variance_.now);
  filter_.load(in);
  coefficient_history_.load(in);
}

}  // namespace eigenlight

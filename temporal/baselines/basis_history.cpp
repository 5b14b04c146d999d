#include "temporal/baselines/basis_history.h"

#include <fmt/format.h>

#include <bitset>
#include <cmath>
#include <utility>

#include "reproject/warp.h"
#include "temporal/baselines/point_taps.h"

namespace eigenlight {
namespace {

bool has_taps(const TapSegment& taps, int i) {
  return taps.weight[0][i] + taps.weight[1][i] + taps.weight[2][i] + taps.weight[3][i] > 0.0f;
}

void drop_empty_taps(const BasisField& from, int count, TapSegment& taps) {
  for (int i = 0; i < count; ++i) {
    float sum = 0.0f;
    bool dropped = false;
    for (int t = 0; t < 4; ++t) {
      float& weight = taps.weight[t][i];
      if (!(weight > 0.0f)) continue;
      const glm::ivec2 tap = taps.tap(t, i);
      const bool empty = !(from.age(tap.x, tap.y) > 0.0f);
      dropped = dropped || empty;
      if (empty) weight = 0.0f;
      sum += weight;
    }
    if (!dropped || !(sum > 0.0f)) continue;
    for (auto& weight : taps.weight) weight[i] /= sum;
  }
}

}  // namespace

BasisHistory::BasisHistory(Extent extent, int bases, const HistoryOptions& options)
    : options_(options), surfaces_(extent), bases_(extent, bases), warped_(extent, bases) {}

BasisHistory::Warp BasisHistory::warp(const FrameInput& frame) {
  EL_CHECK(frame.extent() == extent(), "frame {} is {}x{}, expected {}x{}", frame.index,
           frame.extent().width, frame.extent().height, extent().width, extent().height);
  if (!surfaces_.is_followed_by(frame)) {
    bases_.clear();
    return {.cut = true};
  }
  if (frame.is_static) return {.skipped = static_cast<std::int64_t>(extent().pixels())};
  const PreviousSurface previous = surfaces_.previous();
  for_each_tile(stage_tiles(extent()), [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      warp_row(frame, previous, {tile.x0, y, tile.x1, y + 1});
    }
  });
  std::swap(bases_, warped_);
  return {};
}

void BasisHistory::warp_row(const FrameInput& frame, const PreviousSurface& previous,
                            const Rect& row) {
  TapSegment taps;
  compute_taps(frame, previous, taps_, row, taps);
  const int count = row.x1 - row.x0;
  std::bitset<kSegment> lost;
  for (int i = 0; i < count && options_.widens; ++i) {
    const auto at = static_cast<std::size_t>(i);
    lost[at] = frame.surface.id(row.x0 + i, row.y0) != 0 && !has_taps(taps, i);
  }
  if (options_.drops_empty_taps) drop_empty_taps(bases_, count, taps);
  warp_bases(bases_, taps, row, warped_);
  for (int i = 0; i < count && lost.any(); ++i) {
    if (lost[static_cast<std::size_t>(i)]) widen(frame, previous, {row.x0 + i, row.y0});
  }
}

void BasisHistory::widen(const FrameInput& frame, const PreviousSurface& previous,
                         glm::ivec2 pixel) {
  const auto& normal = frame.surface.normal;
  const auto [x, y] = std::pair(pixel.x, pixel.y);
  const SoughtPoint point{
      frame.surface.id(x, y),
      {normal[0](x, y), normal[1](x, y), normal[2](x, y)},
      glm::vec2(pixel) + glm::vec2(frame.motion[0](x, y), frame.motion[1](x, y)),
      frame.previous_depth(x, y)};
  const Extent size = extent();
  // Also false for motion that is not finite.
  const bool near = point.pixel.x > -2.0f && point.pixel.y > -2.0f &&
                    point.pixel.x < static_cast<float>(size.width + 1) &&
                    point.pixel.y < static_cast<float>(size.height + 1);
  if (!near) return;
  const TapRule rule(previous, taps_, point);
  const glm::ivec2 middle(glm::round(point.pixel));
  float found = 0.0f;
  float* to = warped_.at(x, y);
  for (int j = middle.y - 1; j <= middle.y + 1; ++j) {
    for (int i = middle.x - 1; i <= middle.x + 1; ++i) {
      if (!rule.accepts(i, j) || !(bases_.age(i, j) > 0.0f)) continue;
      found += 1.0f;
      const float* from = bases_.at(i, j);
      for (int k = 0; k < kBlock * bases_.lines(); k += kBlock) to[k] += from[k];
    }
  }
  for (int k = 0; k < kBlock * bases_.lines() && found > 0.0f; k += kBlock) to[k] /= found;
}

void BasisHistory::save(StateWriter& out) const {
  surfaces_.save(out);
  out.value("bases", bases_.bases());
  bases_.save(out);
}

void BasisHistory::load(StateReader& in) {
  surfaces_.load(in);
  int bases = 0;
  in.value("bases", bases);
  if (bases != bases_.bases()) {
    throw std::runtime_error(fmt::format("state: {} bases, expected {}", bases, bases_.bases()));
  }
  bases_.load(in);
}

}  // namespace eigenlight

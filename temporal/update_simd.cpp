#include "reproject/basis_rows.h"
#include "temporal/update.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/update_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::ScalableTag<float>;
using VF = hn::Vec<F>;
using Line = float[kSegment];

// Plain loops over the pixels of a row: compiled once for each instruction set, they vectorize.
struct Row {
  BasisRows from, to;
  alignas(64) Line coefficient[kMaxBases];  // c; c_0 is the gain
  alignas(64) Line learning[kMaxBases];     // q
  alignas(64) Line leverage;                // 1 / h
  alignas(64) Line weight;                  // s / (n + h s); 0 without usable sample
  alignas(64) Line keep;                    // 1 with history, else 0
  alignas(64) Line step;                    // what q is multiplied with, of one channel
};

void LoadRow(const UpdateInputs& in, const Tile& segment, Row& row) {
  const int count = segment.x1 - segment.x0;
  in.learning.row(segment, 0, row.learning[0]);
  in.coefficients.row(segment, 0, row.coefficient[0]);
  alignas(64) Line h;
  for (int i = 0; i < count; ++i) h[i] = row.learning[0][i];
  for (int k = 1; k < in.active; ++k) {
    in.learning.row(segment, k, row.learning[k]);
    in.coefficients.row(segment, k, row.coefficient[k]);
    for (int i = 0; i < count; ++i) h[i] += row.coefficient[k][i] * row.learning[k][i];
  }
  const float* samples = in.samples.at(segment.x0, segment.y0);
  const float* old_age = in.old_age.at(segment.x0, segment.y0);
  const float* new_age = in.new_age.at(segment.x0, segment.y0);
  for (int i = 0; i < count; ++i) {
    // M is positive definite, so h >= 1 / M_00 = 1 at tile centers; interpolation may fall short.
    const float leverage = h[i] > 1.0f ? h[i] : 1.0f;
    const bool usable = samples[i] > 0.0f, known = old_age[i] > 0.0f;
    const float history = known && new_age[i] > samples[i] ? new_age[i] - samples[i] : 0.0f;
    row.leverage[i] = 1.0f / leverage;
    row.weight[i] = usable ? samples[i] / (history + leverage * samples[i]) : 0.0f;
    row.keep[i] = known ? 1.0f : 0.0f;
    row.to.age[i] = usable || known ? new_age[i] : 0.0f;
  }
}

// What q is multiplied with.
void FindStep(const UpdateInputs& in, const Tile& segment, std::size_t channel, Row& row) {
  const int count = segment.x1 - segment.x0;
  const float* light = in.light[channel].at(segment.x0, segment.y0);
  const float* prediction = in.prediction[channel].at(segment.x0, segment.y0);
  for (int i = 0; i < count; ++i) {
    const float r = light[i] - prediction[i];
    row.step[i] = row.weight[i] > 0.0f ? row.weight[i] * r : 0.0f;
  }
  if (in.correction == nullptr || in.newborn > 0) return;
  const float* correction = (*in.correction)[channel].at(segment.x0, segment.y0);
  for (int i = 0; i < count; ++i) {
    row.step[i] = row.keep[i] * correction[i] * row.leverage[i] + row.step[i];
  }
}

void UpdateChannel(const UpdateInputs& in, const Tile& segment, std::size_t channel, int bases,
                   Row& row, const UpdateOutputs& out) {
  const int count = segment.x1 - segment.x0, room = out.bases.bases();
  float* estimate = out.estimate[channel].at(segment.x0, segment.y0);
  const float(*from)[kSegment] = row.from.values + static_cast<int>(channel) * bases;
  float(*to)[kSegment] = row.to.values + static_cast<int>(channel) * room;
  FindStep(in, segment, channel, row);
  for (int i = 0; i < count; ++i) {
    to[0][i] = row.coefficient[0][i] * from[0][i] * row.keep[i] + row.learning[0][i] * row.step[i];
    estimate[i] = to[0][i];
  }
  for (int k = 1; k < in.active; ++k) {
    for (int i = 0; i < count; ++i) {
      to[k][i] = row.keep[i] * from[k][i] + row.learning[k][i] * row.step[i];
      estimate[i] += row.coefficient[k][i] * to[k][i];
    }
  }
  for (int k = in.active; k < room; ++k) {
    for (int i = 0; i < count; ++i) to[k][i] = 0.0f;
  }
  if (in.newborn == 0 || in.correction == nullptr) return;
  const float* correction = (*in.correction)[channel].at(segment.x0, segment.y0);
  for (int i = 0; i < count; ++i) {
    to[in.newborn][i] = row.keep[i] * correction[i];
    estimate[i] += to[in.newborn][i];
  }
}

void UpdateTile(const UpdateInputs& in, const Tile& tile, const BasisField& from,
                const UpdateOutputs& out) {
  Row row;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const Tile segment{tile.x0, y, tile.x1, y + 1, tile.index};
    load_rows(from, segment, row.from);
    LoadRow(in, segment, row);
    for (std::size_t c = 0; c < 3; ++c) UpdateChannel(in, segment, c, from.bases(), row, out);
    store_rows(row.to, segment, out.bases);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(UpdateTile);

void update_tile(const UpdateInputs& in, const Tile& tile, const BasisField& from,
                 const UpdateOutputs& out) {
  EL_DCHECK(tile.x1 - tile.x0 <= kSegment);
  EL_DCHECK(in.active <= from.bases() && in.active <= out.bases.bases() &&
            in.newborn < out.bases.bases());
  HWY_DYNAMIC_DISPATCH(UpdateTile)(in, tile, from, out);
}

}  // namespace eigenlight
#endif

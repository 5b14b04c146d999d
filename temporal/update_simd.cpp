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
  BasisRows bases;
  alignas(64) Line coefficient[kMaxBases];
  alignas(64) Line weight;    // w; 0 without usable sample
  alignas(64) Line residual;  // of one channel; u itself at a new pixel
  alignas(64) Line keep;      // 1 with history, else 0
};

void LoadRow(const UpdateInputs& in, const Tile& segment, int bases, Row& row) {
  const int count = segment.x1 - segment.x0;
  for (int k = 0; k < bases; ++k) in.coefficients.row(segment, k, row.coefficient[k]);
  const float* samples = in.samples.at(segment.x0, segment.y0);
  const float* old_age = in.old_age.at(segment.x0, segment.y0);
  const float* new_age = in.new_age.at(segment.x0, segment.y0);
  for (int i = 0; i < count; ++i) {
    const bool usable = samples[i] > 0.0f, known = old_age[i] > 0.0f;
    const float weight = known ? samples[i] / (new_age[i] > 0.0f ? new_age[i] : 1.0f) : 1.0f;
    row.weight[i] = usable ? weight : 0.0f;
    row.keep[i] = known ? 1.0f : 0.0f;
    row.bases.age[i] = usable || known ? new_age[i] : 0.0f;
  }
}

void UpdateChannel(const UpdateInputs& in, const Tile& segment, std::size_t channel, int bases,
                   Row& row, float* estimate) {
  const int count = segment.x1 - segment.x0;
  const int born = in.newborn[static_cast<std::size_t>(segment.index)];
  const float* light = in.light[channel].at(segment.x0, segment.y0);
  const float* prediction = in.prediction[channel].at(segment.x0, segment.y0);
  float(*values)[kSegment] = row.bases.values + static_cast<int>(channel) * bases;
  for (int i = 0; i < count; ++i) {
    const float r = light[i] - prediction[i];
    row.residual[i] = row.weight[i] > 0.0f ? r : 0.0f;
    values[0][i] =
        row.coefficient[0][i] * values[0][i] * row.keep[i] + row.weight[i] * row.residual[i];
    estimate[i] = values[0][i];
  }
  for (int k = 1; k < bases; ++k) {
    const float* c = row.coefficient[k];
    for (int i = 0; i < count; ++i) {
      const float w = row.weight[i] * row.keep[i];
      const float old = values[k][i] * row.keep[i];
      const float deflated = c[i] * old + row.residual[i];
      const float next = (1.0f - w) * old + w * c[i] * deflated;
      values[k][i] = k == born ? row.residual[i] * row.keep[i] : next;
      estimate[i] += c[i] * (k == born ? old : next);
    }
  }
}

void UpdateTile(const UpdateInputs& in, const Tile& tile, BasisField& bases, Planes<3>& estimate) {
  Row row;
  for (int y = tile.y0; y < tile.y1; ++y) {
    const Tile segment{tile.x0, y, tile.x1, y + 1, tile.index};
    load_rows(bases, segment, row.bases);
    LoadRow(in, segment, bases.bases(), row);
    for (std::size_t c = 0; c < 3; ++c) {
      UpdateChannel(in, segment, c, bases.bases(), row, estimate[c].at(tile.x0, y));
    }
    store_rows(row.bases, segment, bases);
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(UpdateTile);

void update_tile(const UpdateInputs& in, const Tile& tile, BasisField& bases, Planes<3>& estimate) {
  EL_DCHECK(tile.x1 - tile.x0 <= kSegment);
  HWY_DYNAMIC_DISPATCH(UpdateTile)(in, tile, bases, estimate);
}

}  // namespace eigenlight
#endif

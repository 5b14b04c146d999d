#include <limits>

#include "frame/float_traps.h"
#include "reproject/basis_rows.h"
#include "temporal/predict.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "temporal/predict_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

using Line = float[kSegment];

constexpr float kLargest = std::numeric_limits<float>::max();
// Of the largest usable light; a gain may ask for more than float can hold.
constexpr float kLargestVariance = kLargestLight * kLargestLight;

// Plain loops over the pixels of a row: compiled once for each instruction set, they vectorize.
void PredictTile(const BasisField& bases, const CoefficientField& coefficients,
                 const Planes<3>& light, const Tile& tile, const PredictOutputs& out) {
  const int count = tile.x1 - tile.x0, stride = bases.bases(), rank = coefficients.used();
  BasisRows rows;
  alignas(64) Line coefficient[kMaxBases];
  for (int y = tile.y0; y < tile.y1; ++y) {
    const Tile segment{tile.x0, y, tile.x1, y + 1, tile.index};
    load_rows(bases, segment, rows);
    for (int k = 0; k < rank; ++k) coefficients.row(segment, k, coefficient[k]);

    for (int c = 0; c < 3; ++c) {
      float* p = out.prediction[static_cast<std::size_t>(c)].at(tile.x0, y);
      const float* first = rows.values[c * stride];
      for (int i = 0; i < count; ++i) p[i] = coefficient[0][i] * first[i];
      for (int k = 1; k < rank; ++k) {
        const float* value = rows.values[c * stride + k];
        for (int i = 0; i < count; ++i) p[i] += coefficient[k][i] * value[i];
      }
    }

    const float* u[3] = {light[0].at(tile.x0, y), light[1].at(tile.x0, y), light[2].at(tile.x0, y)};
    const float* p[3] = {out.prediction[0].at(tile.x0, y), out.prediction[1].at(tile.x0, y),
                         out.prediction[2].at(tile.x0, y)};
    float* residual = out.residual.at(tile.x0, y);
    float* known = out.confirmed.at(tile.x0, y);
    float* age = out.age.at(tile.x0, y);
    float* variance = out.variance.at(tile.x0, y);
    for (int i = 0; i < count; ++i) {
      const float r = 0.2126f * (u[0][i] - p[0][i]) + 0.7152f * (u[1][i] - p[1][i]) +
                      0.0722f * (u[2][i] - p[2][i]);
      const float size = r < 0.0f ? -r : r;
      const bool confirmed = rows.age[i] > 0.0f && size <= kLargest;  // NaN fails
      residual[i] = confirmed ? r : 0.0f;
      known[i] = confirmed ? 1.0f : 0.0f;
      age[i] = rows.age[i];
      const float gain = coefficient[0][i];
      const float small = gain < 0.5f ? 2.0f * gain : 1.0f;
      const float beyond = gain > 2.0f ? 0.5f * gain : small;
      const float scaled = beyond * variance[i] * beyond;
      variance[i] = scaled < kLargestVariance ? scaled : kLargestVariance;
    }
  }
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(PredictTile);

void predict_tile(const BasisField& bases, const CoefficientField& coefficients,
                  const Planes<3>& light, const Tile& tile, const PredictOutputs& out) {
  EL_DCHECK(tile.x1 - tile.x0 <= kSegment);
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(PredictTile)(bases, coefficients, light, tile, out);
}

}  // namespace eigenlight
#endif

#include "temporal/predict.h"

#include <cmath>

#include "reproject/basis_rows.h"

namespace eigenlight {
namespace {

using Line = float[kSegment];

float luminance(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }

}  // namespace

void predict_tile(const BasisField& bases, const CoefficientField& coefficients,
                  const Planes<3>& light, const Tile& tile, const PredictOutputs& out) {
  const int count = tile.x1 - tile.x0, rank = bases.bases();
  BasisRows rows;
  alignas(64) Line coefficient[kMaxBases];
  for (int y = tile.y0; y < tile.y1; ++y) {
    const Tile segment{tile.x0, y, tile.x1, y + 1, tile.index};
    load_rows(bases, segment, rows);
    for (int k = 0; k < rank; ++k) coefficients.row(segment, k, coefficient[k]);

    for (int c = 0; c < 3; ++c) {
      float* p = out.prediction[static_cast<std::size_t>(c)].at(tile.x0, y);
      const float* first = rows.values[c * rank];
      for (int i = 0; i < count; ++i) p[i] = coefficient[0][i] * first[i];
      for (int k = 1; k < rank; ++k) {
        const float* value = rows.values[c * rank + k];
        for (int i = 0; i < count; ++i) p[i] += coefficient[k][i] * value[i];
      }
    }

    const float* u[3] = {light[0].at(tile.x0, y), light[1].at(tile.x0, y), light[2].at(tile.x0, y)};
    const float* p[3] = {out.prediction[0].at(tile.x0, y), out.prediction[1].at(tile.x0, y),
                         out.prediction[2].at(tile.x0, y)};
    for (int i = 0; i < count; ++i) {
      const float r = luminance(u[0][i] - p[0][i], u[1][i] - p[1][i], u[2][i] - p[2][i]);
      const bool confirmed = rows.age[i] > 0.0f && std::isfinite(r);
      out.residual(tile.x0 + i, y) = confirmed ? r : 0.0f;
      out.confirmed(tile.x0 + i, y) = confirmed ? 1.0f : 0.0f;
      out.age(tile.x0 + i, y) = rows.age[i];
    }
  }
}

}  // namespace eigenlight

// From a coarser level of the pyramid to the finer one: Xu et al. 2024, Eq. 2.
#include "spatial/rivals/pyramid_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/rivals/pyramid_up_simd.cpp"
#include <hwy/foreach_target.h>

#include "spatial/rivals/pyramid_energy-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// w_d w_c^Omega of coarser samples, for pixels of even and odd columns by turns: one more than
// lanes, for vectors of one lane.
struct Interpolation {
  float weight[2][9][17];  // of even and odd rows

  explicit Interpolation(const PyramidPass& pass) {
    for (int odd = 0; odd < 2; ++odd) {
      for (int i = 0; i < 9; ++i) {
        for (int lane = 0; lane < 17; ++lane) {
          weight[odd][i][lane] = pyramid_interpolation(lane % 2, i % 3 - 1) *
                                 pyramid_interpolation(odd, i / 3 - 1) *
                                 pass.coarse[static_cast<std::size_t>(i)];
        }
      }
    }
  }
};

// Where the channels of a vector of pixels lie.
struct Samples {
  const float* at[kPyramidChannels];

  // `row` and `column` count from the first pixel of the tile.
  template <typename Block>
  HWY_INLINE Samples(const Block& block, int row, int column) {
    for (int c = 0; c < kPyramidChannels; ++c) {
      at[c] = block.data[c][row + 1] + kPyramidMargin + column;
    }
  }
  [[nodiscard]] HWY_INLINE VF16 Load(int channel) const { return LoadU(F16(), at[channel]); }
  [[nodiscard]] HWY_INLINE Attributes LoadAttributes() const {
    return {{{Load(kNormal), Load(kNormal + 1), Load(kNormal + 2)}}, Load(kDepth)};
  }
};

// kCompensates: finer samples stand in for coarser ones (gamma > 0). Without, a fifth is saved.
template <bool kCompensates>
struct Sums {
  VF16 result[4], mean[4];  // Eq. 2, and finer samples by their range function alone
  VF16 total, alike, moved;

  // The pixels themselves are the first samples.
  HWY_INLINE Sums(const Samples& own, VF16 weight)
      : total(weight), alike(Set16(1.0f)), moved(Zero(F16())) {
    for (int c = 0; c < 4; ++c) {
      mean[c] = own.Load(c);
      result[c] = Mul(weight, mean[c]);
    }
  }

  HWY_INLINE void AddFine(const Energies& energies, const Samples& samples, VF16 weight) {
    MF16 is_alike;
    const VF16 energy = energies.Of(samples.LoadAttributes(), is_alike);
    const VF16 range = IfThenElseZero(is_alike, Range(energy));
    const VF16 w = Mul(weight, range);
    for (int c = 0; c < 4; ++c) {
      const VF16 value = samples.Load(c);
      result[c] = MulAdd(w, value, result[c]);
      if (kCompensates) mean[c] = MulAdd(range, value, mean[c]);
    }
    total = Add(total, w);
    if (kCompensates) alike = Add(alike, range);
  }

  HWY_INLINE void AddCoarse(const Energies& energies, const Samples& samples, VF16 weight,
                            VF16 gamma) {
    MF16 is_alike;
    const VF16 energy = energies.Of(samples.LoadAttributes(), is_alike);
    const VF16 basic = IfThenElseZero(is_alike, Mul(weight, Range(energy)));  // Eq. 2e
    VF16 kept = basic;
    if (kCompensates) {
      kept = Mul(basic, Range(Mul(gamma, energy)));  // Eq. 2c
      moved = Add(moved, Sub(basic, kept));
    }
    for (int c = 0; c < 4; ++c) result[c] = MulAdd(kept, samples.Load(c), result[c]);
    total = Add(total, basic);
  }

  // Eq. 2d: what coarser samples lost goes to the finer ones.
  HWY_INLINE void Compensate() {
    if (!kCompensates) return;
    const VF16 share = Div(moved, alike);
    for (int c = 0; c < 4; ++c) result[c] = MulAdd(share, mean[c], result[c]);
  }
};

// Eq. 2 for a vector of pixels at column `x` and row `y` of the tile: I_up times `total`.
template <bool kCompensates>
HWY_INLINE Sums<kCompensates> Blend(const PyramidUpPass& up, const PyramidFineBlock& fine,
                                    const PyramidCoarseBlock& coarse,
                                    const Interpolation& interpolation, int x, int y) {
  const Samples own(fine, y, x);
  const Energies energies(up.edge, own.LoadAttributes());
  Sums<kCompensates> sums(own, Set16(up.pass.fine[4]));
  const VF16 gamma = Set16(up.pass.gamma);
  for (int i = 0; i < 9; ++i) {
    const int dx = i % 3 - 1, dy = i / 3 - 1;
    if (i != 4) {
      sums.AddFine(energies, Samples(fine, y + dy, x + dx),
                   Set16(up.pass.fine[static_cast<std::size_t>(i)]));
    }
    const VF16 weight = LoadU(F16(), interpolation.weight[y % 2][i] + x % 2);
    sums.AddCoarse(energies, Samples(coarse, y / 2 + dy, x + 2 * dx), weight, gamma);
  }
  sums.Compensate();
  return sums;
}

template <bool kCompensates, typename Visit>
void ForEachBlend(const PyramidUpPass& up, const Rect& tile, const Visit& visit) {
  PyramidFineBlock fine;
  PyramidCoarseBlock coarse;
  load_pyramid_block(up.fine, tile.x0, tile.y0, 1, fine);
  load_coarser_block(up.coarse, tile, coarse);
  const Interpolation interpolation(up.pass);
  const auto blend = [&](int x, int y) {
    visit(Blend<kCompensates>(up, fine, coarse, interpolation, x - tile.x0, y - tile.y0), x, y);
  };
  ForEachVector(tile, blend, F16());
}

// Calls visit(sums, x, y) for each vector of pixels of the tile.
template <typename Visit>
void ForEachBlend(const PyramidUpPass& up, const Rect& tile, const Visit& visit) {
  up.pass.gamma > 0.0f ? ForEachBlend<true>(up, tile, visit) : ForEachBlend<false>(up, tile, visit);
}

void UpTile(const PyramidUpPass& up, const Rect& tile, Planes<4>& result) {
  ForEachBlend(up, tile, [&](const auto& sums, int x, int y) {
    for (int c = 0; c < 4; ++c) Store(Div(sums.result[c], sums.total), result[c], x, y, F16());
  });
}

void LastTile(const PyramidUpPass& up, const Rect& tile, Planes<3>& out) {
  const F16 d;
  ForEachBlend(up, tile, [&](const auto& sums, int x, int y) {
    const VF16 weight = sums.result[kWeight];
    const MF16 reached = Gt(weight, Zero(d));
    for (int c = 0; c < 3; ++c) {
      Store(IfThenElseZero(reached, Div(sums.result[c], weight)), out[c], x, y, d);
    }
  });
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(UpTile);
HWY_EXPORT(LastTile);

void pyramid_up_tile(const PyramidUpPass& up, const Rect& tile, Planes<4>& result) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(UpTile)(up, tile, result);
}

void pyramid_last_tile(const PyramidUpPass& up, const Rect& tile, Planes<3>& out) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(LastTile)(up, tile, out);
}

}  // namespace eigenlight
#endif

#include <algorithm>

#include "frame/float_traps.h"
#include "spatial/rivals/pyramid_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/rivals/pyramid_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;
using MF = hn::Mask<F>;

VF Set(float v) { return hn::Set(F(), v); }

// 2^x for x in [-126, 0]: Taylor series of 2^f, |f| <= 1/2, to 2.4e-6 of its value.
HWY_INLINE VF Exp2(VF x) {
  const F d;
  const VF whole = hn::Round(x), f = hn::Sub(x, whole);
  VF p = hn::MulAdd(f, Set(0.00133335581f), Set(0.00961812911f));
  p = hn::MulAdd(p, f, Set(0.0555041087f));
  p = hn::MulAdd(p, f, Set(0.240226507f));
  p = hn::MulAdd(p, f, Set(0.693147181f));
  p = hn::MulAdd(p, f, Set(1.0f));
  const hn::RebindToSigned<F> di;
  const auto exponent = hn::ShiftLeft<23>(hn::ConvertTo(di, whole));
  return hn::BitCast(d, hn::Add(hn::BitCast(di, p), exponent));
}

// f^R, or another power of it, from the energy in octaves; 2^-126 from there on.
HWY_INLINE VF Range(VF octaves) { return Exp2(hn::Max(hn::Neg(octaves), Set(-126.0f))); }

// What a vector of pixels compares its samples with.
struct Center {
  VF normal[3], depth;
  VF normal_scale, depth_scale;  // sigma_N log2(e), sigma_z log2(e) / z_p

  Center(const GlobalIlluminationEdge& edge, VF nx, VF ny, VF nz, VF z)
      : normal{nx, ny, nz}, depth(z) {
    const float log2e = 1.44269504f;
    normal_scale = Set(edge.normal_power * log2e);
    // Where nothing is, nothing divides by 0, and the normals of 0 keep all away.
    const VF safe = hn::IfThenElse(hn::Gt(z, hn::Zero(F())), z, Set(1.0f));
    depth_scale = hn::Div(Set(edge.depth_scale * log2e), safe);
  }

  // Energy in octaves of a sample; `alike` is false where it is infinite. -ln(cosine) as the first
  // four terms of its series in 1 - cosine: f^R is exact to 5e-4 at sigma_N = 8, to 1e-6 at 64.
  HWY_INLINE VF Energy(VF nx, VF ny, VF nz, VF z, MF& alike) const {
    const VF cosine = hn::MulAdd(normal[0], nx, hn::MulAdd(normal[1], ny, hn::Mul(normal[2], nz)));
    alike = hn::Gt(cosine, hn::Zero(F()));
    const VF u = hn::Max(hn::Sub(Set(1.0f), cosine), hn::Zero(F()));
    VF bend = hn::MulAdd(u, Set(0.25f), Set(1.0f / 3.0f));
    bend = hn::MulAdd(bend, u, Set(0.5f));
    bend = hn::MulAdd(bend, u, Set(1.0f));
    bend = hn::Mul(hn::Mul(bend, u), normal_scale);
    return hn::MulAdd(hn::Abs(hn::Sub(depth, z)), depth_scale, bend);
  }
};

// The four pixels under a coarser one, a vector of each.
struct Quad {
  VF normal[3], depth, values[4];
};

void LoadQuads(const PyramidFineBlock& block, int row, int column, Quad (&quad)[4]) {
  const F d;
  for (int r = 0; r < 2; ++r) {
    const auto load = [&](int channel, VF& even, VF& odd) {
      hn::LoadInterleaved2(d, block.data[channel][row + r] + column, even, odd);
    };
    Quad &even = quad[2 * r], &odd = quad[2 * r + 1];
    for (int c = 0; c < 4; ++c) load(kRed + c, even.values[c], odd.values[c]);
    for (int c = 0; c < 3; ++c) load(kNormal + c, even.normal[c], odd.normal[c]);
    load(kDepth, even.depth, odd.depth);
  }
}

HWY_INLINE MF Exists(const Quad& quad) { return hn::Gt(quad.depth, hn::Zero(F())); }

// The pixel closest to the mean of those that exist. Its normal's length only adds the same to all
// energies, so it is taken out, where the series is good.
Quad FindMajor(const GlobalIlluminationEdge& edge, const Quad (&quad)[4], VF& which) {
  const F d;
  VF n[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)}, z = hn::Zero(d), count = hn::Zero(d);
  for (const Quad& q : quad) {
    for (int c = 0; c < 3; ++c) n[c] = hn::Add(n[c], q.normal[c]);
    z = hn::Add(z, q.depth);
    count = hn::Add(count, hn::IfThenElseZero(Exists(q), Set(1.0f)));
  }
  const VF square = hn::MulAdd(n[0], n[0], hn::MulAdd(n[1], n[1], hn::Mul(n[2], n[2])));
  const VF scale = hn::Div(Set(1.0f), hn::Sqrt(hn::Max(square, Set(1e-12f))));
  for (VF& v : n) v = hn::Mul(v, scale);
  const Center mean(edge, n[0], n[1], n[2], hn::Div(z, hn::Max(count, Set(1.0f))));
  Quad major = quad[0];
  VF best = Set(3e38f);
  which = hn::Zero(d);
  MF found = hn::Lt(Set(1.0f), hn::Zero(d));
  for (int i = 0; i < 4; ++i) {
    MF alike;
    const Quad& q = quad[i];
    VF energy = mean.Energy(q.normal[0], q.normal[1], q.normal[2], q.depth, alike);
    energy = hn::IfThenElse(alike, energy, Set(2e38f));
    // The first that exists, then any that is closer by 1e-4 (pyramid_inl.h), in octaves.
    const MF closer = hn::Lt(energy, hn::Sub(best, Set(1.44269504e-4f)));
    const MF take = hn::And(Exists(q), hn::Or(hn::Not(found), closer));
    found = hn::Or(found, take);
    best = hn::IfThenElse(take, energy, best);
    which = hn::IfThenElse(take, Set(static_cast<float>(i)), which);
    for (int c = 0; c < 3; ++c) {
      major.normal[c] = hn::IfThenElse(take, q.normal[c], major.normal[c]);
    }
    major.depth = hn::IfThenElse(take, q.depth, major.depth);
  }
  return major;
}

// Eq. 3.
void DownTile(const PyramidView& fine, const GlobalIlluminationEdge& edge, const Rect& tile,
              PyramidPlanes& coarse) {
  const F d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  PyramidFineBlock block;
  load_pyramid_block(fine, 2 * tile.x0, 2 * tile.y0, 0, block);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      Quad quad[4];
      LoadQuads(block, 2 * (y - tile.y0) + 1, kPyramidMargin + 2 * (x - tile.x0), quad);
      VF which;
      Quad major = FindMajor(edge, quad, which);
      const Center center(edge, major.normal[0], major.normal[1], major.normal[2], major.depth);
      VF total = hn::Zero(d);
      for (VF& v : major.values) v = hn::Zero(d);
      for (int i = 0; i < 4; ++i) {
        const Quad& q = quad[i];
        MF alike;
        const VF energy = center.Energy(q.normal[0], q.normal[1], q.normal[2], q.depth, alike);
        VF w = hn::IfThenElseZero(hn::And(alike, Exists(q)), Range(energy));
        w = hn::IfThenElse(hn::Eq(which, Set(static_cast<float>(i))), Set(1.0f), w);
        total = hn::Add(total, w);
        for (int c = 0; c < 4; ++c) major.values[c] = hn::MulAdd(w, q.values[c], major.values[c]);
      }
      for (std::size_t c = 0; c < 4; ++c) {
        hn::StoreU(hn::Div(major.values[c], total), d, coarse.values[c].row(y) + x);
      }
      for (std::size_t c = 0; c < 3; ++c) {
        hn::StoreU(major.normal[c], d, coarse.normal[c].row(y) + x);
      }
      hn::StoreU(major.depth, d, coarse.depth.row(y) + x);
    }
  }
}

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

// kCompensates: finer samples stand in for coarser ones (gamma > 0). Without, a fifth is saved.
template <bool kCompensates>
struct Sums {
  VF result[4], mean[4];  // Eq. 2, and finer samples by their range function alone
  VF total, alike, moved;

  Sums() : total(hn::Zero(F())), alike(total), moved(total) {
    for (int c = 0; c < 4; ++c) result[c] = mean[c] = total;
  }
};

template <bool kCompensates>
HWY_INLINE void AddFine(const Center& center, const float* const (&at)[kPyramidChannels], VF weight,
                        Sums<kCompensates>& sums) {
  const F d;
  MF alike;
  const auto load = [&](int channel) { return hn::LoadU(d, at[channel]); };
  const VF energy =
      center.Energy(load(kNormal), load(kNormal + 1), load(kNormal + 2), load(kDepth), alike);
  const VF range = hn::IfThenElseZero(alike, Range(energy));
  const VF w = hn::Mul(weight, range);
  for (int c = 0; c < 4; ++c) {
    const VF value = load(c);
    sums.result[c] = hn::MulAdd(w, value, sums.result[c]);
    if (kCompensates) sums.mean[c] = hn::MulAdd(range, value, sums.mean[c]);
  }
  sums.total = hn::Add(sums.total, w);
  if (kCompensates) sums.alike = hn::Add(sums.alike, range);
}

template <bool kCompensates>
HWY_INLINE void AddCoarse(const Center& center, const float* const (&at)[kPyramidChannels],
                          VF weight, VF gamma, Sums<kCompensates>& sums) {
  const F d;
  MF alike;
  const auto load = [&](int channel) { return hn::LoadU(d, at[channel]); };
  const VF energy =
      center.Energy(load(kNormal), load(kNormal + 1), load(kNormal + 2), load(kDepth), alike);
  const VF basic = hn::IfThenElseZero(alike, hn::Mul(weight, Range(energy)));  // Eq. 2e
  VF kept = basic;
  if (kCompensates) {
    kept = hn::Mul(basic, Range(hn::Mul(gamma, energy)));  // Eq. 2c
    sums.moved = hn::Add(sums.moved, hn::Sub(basic, kept));
  }
  for (int c = 0; c < 4; ++c) sums.result[c] = hn::MulAdd(kept, load(c), sums.result[c]);
  sums.total = hn::Add(sums.total, basic);
}

// Eq. 2 for a vector of pixels at column `x` and row `y` of the tile: I_up times `sums.total`.
template <bool kCompensates>
HWY_INLINE void Blend(const PyramidUpPass& up, const PyramidFineBlock& fine,
                      const PyramidCoarseBlock& coarse, const Interpolation& interpolation, int x,
                      int y, Sums<kCompensates>& sums) {
  const F d;
  const float* at[kPyramidChannels];
  const auto point = [&](const auto& block, int row, int column) {
    for (int c = 0; c < kPyramidChannels; ++c) at[c] = block.data[c][row] + kPyramidMargin + column;
  };
  point(fine, y + 1, x);
  const auto load = [&](int channel) { return hn::LoadU(d, at[channel]); };
  const Center center(up.edge, load(kNormal), load(kNormal + 1), load(kNormal + 2), load(kDepth));
  const VF own = Set(up.pass.fine[4]);
  for (int c = 0; c < 4; ++c) {
    sums.mean[c] = load(c);
    sums.result[c] = hn::Mul(own, sums.mean[c]);
  }
  sums.total = own;
  sums.alike = Set(1.0f);
  const VF gamma = Set(up.pass.gamma);
  for (int i = 0; i < 9; ++i) {
    const int dx = i % 3 - 1, dy = i / 3 - 1;
    if (i != 4) {
      point(fine, y + 1 + dy, x + dx);
      AddFine(center, at, Set(up.pass.fine[static_cast<std::size_t>(i)]), sums);
    }
    point(coarse, y / 2 + 1 + dy, x + 2 * dx);
    AddCoarse(center, at, hn::LoadU(d, interpolation.weight[y % 2][i] + x % 2), gamma, sums);
  }
  if (!kCompensates) return;
  // Eq. 2d.
  const VF share = hn::Div(sums.moved, sums.alike);
  for (int c = 0; c < 4; ++c) {
    sums.result[c] = hn::MulAdd(share, sums.mean[c], sums.result[c]);
  }
}

template <bool kCompensates, typename Store>
void ForEachBlend(const PyramidUpPass& up, const Rect& tile, const Store& store) {
  const int lanes = static_cast<int>(hn::Lanes(F()));
  PyramidFineBlock fine;
  PyramidCoarseBlock coarse;
  load_pyramid_block(up.fine, tile.x0, tile.y0, 1, fine);
  load_coarser_block(up.coarse, tile, coarse);
  const Interpolation interpolation(up.pass);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += lanes) {
      Sums<kCompensates> sums;
      Blend(up, fine, coarse, interpolation, x - tile.x0, y - tile.y0, sums);
      store(sums, x, y);
    }
  }
}

template <typename Store>
void ForEachBlend(const PyramidUpPass& up, const Rect& tile, const Store& store) {
  if (up.pass.gamma > 0.0f) {
    ForEachBlend<true>(up, tile, store);
  } else {
    ForEachBlend<false>(up, tile, store);
  }
}

void UpTile(const PyramidUpPass& up, const Rect& tile, Planes<4>& result) {
  const F d;
  ForEachBlend(up, tile, [&](const auto& sums, int x, int y) {
    for (std::size_t c = 0; c < 4; ++c) {
      hn::StoreU(hn::Div(sums.result[c], sums.total), d, result[c].row(y) + x);
    }
  });
}

void LastTile(const PyramidUpPass& up, const Rect& tile, Planes<3>& out) {
  const F d;
  ForEachBlend(up, tile, [&](const auto& sums, int x, int y) {
    const MF reached = hn::Gt(sums.result[kWeight], hn::Zero(d));
    for (std::size_t c = 0; c < 3; ++c) {
      hn::StoreU(hn::IfThenElseZero(reached, hn::Div(sums.result[c], sums.result[kWeight])), d,
                 out[c].row(y) + x);
    }
  });
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(DownTile);
HWY_EXPORT(UpTile);
HWY_EXPORT(LastTile);

void pyramid_down_tile(const PyramidView& fine, const GlobalIlluminationEdge& edge,
                       const Rect& tile, PyramidPlanes& coarse) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(DownTile)(fine, edge, tile, coarse);
}

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

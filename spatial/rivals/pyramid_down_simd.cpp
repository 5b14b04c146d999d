// From one level of the pyramid to the coarser one: Xu et al. 2024, Eq. 3.
#include "spatial/rivals/pyramid_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "spatial/rivals/pyramid_down_simd.cpp"
#include <hwy/foreach_target.h>

#include "spatial/rivals/pyramid_energy-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

// One of the four pixels under each of a vector of coarser ones.
struct Member {
  Attributes attributes;
  VF16 values[4];
};

void LoadMembers(const PyramidFineBlock& block, int row, int column, Member (&members)[4]) {
  for (int r = 0; r < 2; ++r) {
    Member &even = members[2 * r], &odd = members[2 * r + 1];
    const auto load = [&](int channel, VF16& left, VF16& right) {
      hn::LoadInterleaved2(F16(), block.data[channel][row + r] + column, left, right);
    };
    for (int c = 0; c < 4; ++c) load(kRed + c, even.values[c], odd.values[c]);
    for (int c = 0; c < 3; ++c) {
      load(kNormal + c, even.attributes.normal[c], odd.attributes.normal[c]);
    }
    load(kDepth, even.attributes.depth, odd.attributes.depth);
  }
}

// The mean of the members that exist. Its normal is scaled to length 1, where the series of the
// energy is exact; the length would only add the same to all energies.
Attributes MeanOf(const Member (&members)[4]) {
  const F16 d;
  Attributes mean{{{Zero(d), Zero(d), Zero(d)}}, Zero(d)};
  VF16 count = Zero(d);
  for (const Member& m : members) {
    for (int c = 0; c < 3; ++c) mean.normal[c] = Add(mean.normal[c], m.attributes.normal[c]);
    mean.depth = Add(mean.depth, m.attributes.depth);
    count = Add(count, IfThenElseZero(m.attributes.Exists(), Set16(1.0f)));
  }
  const VF16 square = Dot(mean.normal, mean.normal);
  const VF16 scale = Div(Set16(1.0f), Sqrt(Max(square, Set16(1e-12f))));
  for (int c = 0; c < 3; ++c) mean.normal[c] = Mul(mean.normal[c], scale);
  mean.depth = Div(mean.depth, Max(count, Set16(1.0f)));
  return mean;
}

// The major member: the one closest to the mean of those that exist.
struct Major {
  Attributes attributes;
  VF16 index;
};

Major FindMajor(const GlobalIlluminationEdge& edge, const Member (&members)[4]) {
  const F16 d;
  const Energies energies(edge, MeanOf(members));
  Major major{members[0].attributes, Zero(d)};
  VF16 best = Set16(3e38f);
  MF16 found = Lt(Set16(1.0f), Zero(d));
  for (int i = 0; i < 4; ++i) {
    const Attributes& own = members[i].attributes;
    MF16 alike;
    VF16 energy = energies.Of(own, alike);
    energy = IfThenElse(alike, energy, Set16(2e38f));
    // The first that exists, then any that is closer by 1e-4 (pyramid_inl.h), in octaves.
    const MF16 closer = Lt(energy, Sub(best, Set16(1.44269504e-4f)));
    const MF16 take = And(own.Exists(), Or(Not(found), closer));
    found = Or(found, take);
    best = IfThenElse(take, energy, best);
    const auto choose = [&](VF16 value, VF16& to) { to = IfThenElse(take, value, to); };
    choose(Set16(static_cast<float>(i)), major.index);
    for (int c = 0; c < 3; ++c) choose(own.normal[c], major.attributes.normal[c]);
    choose(own.depth, major.attributes.depth);
  }
  return major;
}

// The members' values, weighted by how close they are to the major one.
void StoreMeans(const GlobalIlluminationEdge& edge, const Member (&members)[4], const Major& major,
                Planes<4>& out, int x, int y) {
  const F16 d;
  const Energies energies(edge, major.attributes);
  VF16 sum[4] = {Zero(d), Zero(d), Zero(d), Zero(d)}, total = Zero(d);
  for (int i = 0; i < 4; ++i) {
    const Member& member = members[i];
    MF16 alike;
    const VF16 energy = energies.Of(member.attributes, alike);
    VF16 w = IfThenElseZero(And(alike, member.attributes.Exists()), Range(energy));
    w = IfThenElse(Eq(major.index, Set16(static_cast<float>(i))), Set16(1.0f), w);
    total = Add(total, w);
    for (int c = 0; c < 4; ++c) sum[c] = MulAdd(w, member.values[c], sum[c]);
  }
  for (int c = 0; c < 4; ++c) Store(Div(sum[c], total), out[c], x, y, d);
}

void DownTile(const PyramidView& fine, const GlobalIlluminationEdge& edge, const Rect& tile,
              PyramidPlanes& coarse) {
  const F16 d;
  PyramidFineBlock block;
  load_pyramid_block(fine, 2 * tile.x0, 2 * tile.y0, 0, block);
  const auto down = [&](int x, int y) {
    Member members[4];
    LoadMembers(block, 2 * (y - tile.y0) + 1, kPyramidMargin + 2 * (x - tile.x0), members);
    const Major major = FindMajor(edge, members);
    StoreMeans(edge, members, major, coarse.values, x, y);
    Store(major.attributes.normal, coarse.normal, x, y, d);
    Store(major.attributes.depth, coarse.depth, x, y, d);
  };
  ForEachVector(tile, down, d);
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(DownTile);

void pyramid_down_tile(const PyramidView& fine, const GlobalIlluminationEdge& edge,
                       const Rect& tile, PyramidPlanes& coarse) {
  const FloatTrapsOff lanes_behind_masks_may_hold_anything;
  HWY_DYNAMIC_DISPATCH(DownTile)(fine, edge, tile, coarse);
}

}  // namespace eigenlight
#endif

#include <algorithm>
#include <cstdint>

#include "reproject/basis_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reproject/basis_rows_simd.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Planar row j of a pixel: 3 K values, the age, then padding that belongs to nobody.
float* Row(BasisRows& rows, float* spare, int bases, int j) {
  return j < 3 * bases ? rows.values[j] : j == 3 * bases ? rows.age : spare;
}

#if HWY_TARGET == HWY_SCALAR

void Load(const BasisField& field, const Tile& row, BasisRows& rows) {
  float spare[kSegment];
  const int floats = field.pixel_floats();
  for (int j = 0; j < floats; ++j) {
    float* out = Row(rows, spare, field.bases(), j);
    const float* in = field.pixel(row.x0, row.y0) + j;
    for (int i = 0; i < row.x1 - row.x0; ++i) out[i] = in[i * floats];
  }
}

void Save(const BasisRows& rows, const Tile& row, BasisField& field) {
  float zero[kSegment] = {};
  const int floats = field.pixel_floats();
  for (int j = 0; j < floats; ++j) {
    const float* in = Row(const_cast<BasisRows&>(rows), zero, field.bases(), j);
    float* out = field.pixel(row.x0, row.y0) + j;
    for (int i = 0; i < row.x1 - row.x0; ++i) out[i * floats] = in[i];
  }
}

#else

// Two groups of four pixels side by side where vectors are wide enough.
using D = hn::CappedTag<float, 8>;
using V = hn::Vec<D>;
constexpr int kGroup = static_cast<int>(hn::MaxLanes(D()));

// Turns four rows of four values into their columns, in each half of the vectors.
void Transpose(V& a, V& b, V& c, V& d) {
  const D tag;
  const hn::Repartition<std::uint64_t, D> pairs;
  const auto lower = [&](V x, V y) { return hn::BitCast(pairs, hn::InterleaveLower(tag, x, y)); };
  const auto upper = [&](V x, V y) { return hn::BitCast(pairs, hn::InterleaveUpper(tag, x, y)); };
  const auto ab_low = lower(a, b), ab_high = upper(a, b);
  const auto cd_low = lower(c, d), cd_high = upper(c, d);
  a = hn::BitCast(tag, hn::InterleaveLower(pairs, ab_low, cd_low));
  b = hn::BitCast(tag, hn::InterleaveUpper(pairs, ab_low, cd_low));
  c = hn::BitCast(tag, hn::InterleaveLower(pairs, ab_high, cd_high));
  d = hn::BitCast(tag, hn::InterleaveUpper(pairs, ab_high, cd_high));
}

// Four floats of the pixels n and, in wide vectors, n + 4.
template <typename Tag>
hn::Vec<Tag> LoadPixels(Tag tag, const float* n, const float* n_plus_4) {
  if constexpr (hn::MaxLanes(Tag()) == 4) {
    return hn::Load(tag, n);
  } else {
    const hn::Half<Tag> half;
    return hn::Combine(tag, hn::Load(half, n_plus_4), hn::Load(half, n));
  }
}

template <typename Tag>
void StorePixels(Tag tag, hn::Vec<Tag> v, float* n, float* n_plus_4) {
  if constexpr (hn::MaxLanes(Tag()) == 4) {
    hn::Store(v, tag, n);
  } else {
    const hn::Half<Tag> half;
    hn::Store(hn::LowerHalf(half, v), half, n);
    hn::Store(hn::UpperHalf(half, v), half, n_plus_4);
  }
}

// Where each float of a pixel goes to.
struct RowTable {
  float* row[3 * kMaxBases + 4];

  RowTable(BasisRows& rows, float* spare, int bases) {
    for (int j = 0; j < BasisField::pixel_floats(bases); ++j) row[j] = Row(rows, spare, bases, j);
  }
};

// Asks for the group of pixels under the one that starts at (x, y): rows of a tile are too short
// for the hardware to foresee the next one.
void PrefetchGroup(const BasisField& field, int x, int y) {
  if (y + 1 >= field.extent().height) return;
  const float* below = field.pixel(x, y + 1);
  for (int j = 0; j < kGroup * field.pixel_floats(); j += 16) hwy::Prefetch(below + j);
}

// A group of pixels at a time; a last one that is not whole reads its first pixel again.
void Load(const BasisField& field, const Tile& row, BasisRows& rows) {
  const D tag;
  alignas(64) float spare[kSegment];
  const RowTable table(rows, spare, field.bases());
  const int floats = field.pixel_floats(), count = row.x1 - row.x0;
  const float* in = field.pixel(row.x0, row.y0);
  for (int i = 0; i < count; i += kGroup) {
    PrefetchGroup(field, row.x0 + i, row.y0);
    const float* pixel[8];
    for (int n = 0; n < kGroup; ++n) pixel[n] = in + (i + (i + n < count ? n : 0)) * floats;
    for (int j = 0; j < floats; j += 4) {
      V v[4];
      for (int n = 0; n < 4; ++n) v[n] = LoadPixels(tag, pixel[n] + j, pixel[n + kGroup - 4] + j);
      Transpose(v[0], v[1], v[2], v[3]);
      for (int n = 0; n < 4; ++n) hn::Store(v[n], tag, table.row[j + n] + i);
    }
  }
}

// A group of pixels of which `count` are meant; what lies beyond goes where it does no harm.
void SaveGroup(const RowTable& table, int floats, int i, int count, float* out) {
  const D tag;
  alignas(64) float beyond[4];
  for (int j = 0; j < floats; j += 4) {
    V v[4];
    for (int n = 0; n < 4; ++n) v[n] = hn::Load(tag, table.row[j + n] + i);
    Transpose(v[0], v[1], v[2], v[3]);
    const auto pixel = [&](int n) { return n < count ? out + n * floats + j : beyond; };
    for (int n = 0; n < 4; ++n) StorePixels(tag, v[n], pixel(n), pixel(n + kGroup - 4));
  }
}

void Save(const BasisRows& rows, const Tile& row, BasisField& field) {
  alignas(64) static constexpr float kZero[kSegment] = {};
  const RowTable table(const_cast<BasisRows&>(rows), const_cast<float*>(kZero), field.bases());
  const int floats = field.pixel_floats(), count = row.x1 - row.x0;
  float* out = field.pixel(row.x0, row.y0);
  int i = 0;
  for (; i + kGroup <= count; i += kGroup) {
    PrefetchGroup(field, row.x0 + i, row.y0);
    // A constant count leaves no tests in the loop.
    SaveGroup(table, floats, i, kGroup, out + i * floats);
  }
  if (i < count) SaveGroup(table, floats, i, count - i, out + i * floats);
}

#endif

void LoadRows(const BasisField& field, const Tile& row, BasisRows& rows) {
  Load(field, row, rows);
  constexpr int kVector = static_cast<int>(Plane<float>::kLine / sizeof(float));
  const int count = row.x1 - row.x0, whole = (count + kVector - 1) / kVector * kVector;
  if (count == whole) return;
  const auto clear = [&](float* values) { std::fill(values + count, values + whole, 0.0f); };
  for (int j = 0; j < 3 * field.bases(); ++j) clear(rows.values[j]);
  clear(rows.age);
}

void StoreRows(const BasisRows& rows, const Tile& row, BasisField& field) {
  Save(rows, row, field);
}

}  // namespace
}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace eigenlight {

HWY_EXPORT(LoadRows);
HWY_EXPORT(StoreRows);

void load_rows(const BasisField& field, const Tile& row, BasisRows& rows) {
  EL_DCHECK(row.x1 - row.x0 <= kSegment);
  HWY_DYNAMIC_DISPATCH(LoadRows)(field, row, rows);
}

void store_rows(const BasisRows& rows, const Tile& row, BasisField& field) {
  EL_DCHECK(row.x1 - row.x0 <= kSegment);
  HWY_DYNAMIC_DISPATCH(StoreRows)(rows, row, field);
}

}  // namespace eigenlight
#endif

#include <cstring>

#include "reproject/basis_rows.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reproject/basis_rows_simd.cpp"
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

using D = hn::FixedTag<float, 4>;
using V = hn::Vec<D>;

// Turns four rows of four values into their columns.
void Transpose(V& a, V& b, V& c, V& d) {
  const D tag;
  const V ab_low = hn::InterleaveLower(tag, a, b), ab_high = hn::InterleaveUpper(tag, a, b);
  const V cd_low = hn::InterleaveLower(tag, c, d), cd_high = hn::InterleaveUpper(tag, c, d);
  a = hn::ConcatLowerLower(tag, cd_low, ab_low);
  b = hn::ConcatUpperUpper(tag, cd_low, ab_low);
  c = hn::ConcatLowerLower(tag, cd_high, ab_high);
  d = hn::ConcatUpperUpper(tag, cd_high, ab_high);
}

// Four pixels at a time; a last group that is not whole ends up in a copy.
void Load(const BasisField& field, const Tile& row, BasisRows& rows) {
  const D tag;
  alignas(64) float spare[kSegment];
  const int floats = field.pixel_floats(), count = row.x1 - row.x0;
  const float* in = field.pixel(row.x0, row.y0);
  for (int i = 0; i < count; i += 4) {
    const auto pixel = [&](int n) { return in + (i + (i + n < count ? n : 0)) * floats; };
    for (int j = 0; j < floats; j += 4) {
      V a = hn::Load(tag, pixel(0) + j), b = hn::Load(tag, pixel(1) + j);
      V c = hn::Load(tag, pixel(2) + j), d = hn::Load(tag, pixel(3) + j);
      Transpose(a, b, c, d);
      hn::Store(a, tag, Row(rows, spare, field.bases(), j) + i);
      hn::Store(b, tag, Row(rows, spare, field.bases(), j + 1) + i);
      hn::Store(c, tag, Row(rows, spare, field.bases(), j + 2) + i);
      hn::Store(d, tag, Row(rows, spare, field.bases(), j + 3) + i);
    }
  }
}

void Save(const BasisRows& rows, const Tile& row, BasisField& field) {
  const D tag;
  alignas(64) float zero[kSegment] = {};
  const int floats = field.pixel_floats(), count = row.x1 - row.x0;
  const auto in = [&](int j) { return Row(const_cast<BasisRows&>(rows), zero, field.bases(), j); };
  float* out = field.pixel(row.x0, row.y0);
  for (int i = 0; i < count; i += 4) {
    for (int j = 0; j < floats; j += 4) {
      V v[4] = {hn::Load(tag, in(j) + i), hn::Load(tag, in(j + 1) + i),
                hn::Load(tag, in(j + 2) + i), hn::Load(tag, in(j + 3) + i)};
      Transpose(v[0], v[1], v[2], v[3]);
      for (int n = 0; n < 4 && i + n < count; ++n) hn::Store(v[n], tag, out + (i + n) * floats + j);
    }
  }
}

#endif

void LoadRows(const BasisField& field, const Tile& row, BasisRows& rows) {
  Load(field, row, rows);
  const int count = row.x1 - row.x0;
  if (count == kSegment) return;
  const auto clear = [&](float* values) {
    std::memset(values + count, 0, static_cast<std::size_t>(kSegment - count) * sizeof(float));
  };
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

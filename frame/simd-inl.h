// What all kernels share: types of vectors, loads and stores of planes, luminance, masks.
//
// A kernel includes this after <hwy/foreach_target.h>. Like Highway's own -inl.h headers it is
// compiled once for each instruction set. Highway's operations need no namespace in kernels.
#if defined(EIGENLIGHT_FRAME_SIMD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef EIGENLIGHT_FRAME_SIMD_INL_H_
#undef EIGENLIGHT_FRAME_SIMD_INL_H_
#else
#define EIGENLIGHT_FRAME_SIMD_INL_H_
#endif

#include <hwy/highway.h>

#include <concepts>
#include <cstdint>
#include <limits>

#include "frame/float_traps.h"
#include "frame/frame.h"
#include "frame/luminance.h"
#include "frame/prefetch.h"
#include "frame/tiles.h"
#include "frame/usable_surface.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using hn::Abs;
using hn::Add;
using hn::AllFalse;
using hn::And;
using hn::AndNot;
using hn::ConvertTo;
using hn::Div;
using hn::Eq;
using hn::Ge;
using hn::Gt;
using hn::IfThenElse;
using hn::IfThenElseZero;
using hn::IfThenZeroElse;
using hn::Iota;
using hn::IsFinite;
using hn::IsNaN;
using hn::Le;
using hn::Load;
using hn::LoadU;
using hn::Lt;
using hn::Max;
using hn::Min;
using hn::Mul;
using hn::MulAdd;
using hn::MulSub;
using hn::Ne;
using hn::NegMulAdd;
using hn::Not;
using hn::Or;
using hn::RebindMask;
using hn::Set;
using hn::Sqrt;
using hn::Store;
using hn::StoreU;
using hn::Sub;
using hn::Zero;

/// Tags of the longest vectors of the CPU, and of vectors of at most 8 or 16 floats. The functions
/// below take a tag as their last argument; without it they work on the longest vectors.
using F = hn::ScalableTag<float>;
using F8 = hn::CappedTag<float, 8>;
using F16 = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;

using VF = hn::Vec<F>;
using VF8 = hn::Vec<F8>;
using VF16 = hn::Vec<F16>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;
using MF = hn::Mask<F>;
using MF8 = hn::Mask<F8>;
using MF16 = hn::Mask<F16>;

template <class D = F>
HWY_INLINE int LaneCount(D d = {}) {
  return static_cast<int>(hn::Lanes(d));
}

HWY_INLINE VF Zero() { return Zero(F()); }
HWY_INLINE VF Set(float value) { return Set(F(), value); }
template <std::integral T>
HWY_INLINE VF Set(T value) {
  return Set(static_cast<float>(value));
}
/// first, first + 1, ...
HWY_INLINE VF Iota(float first) { return Iota(F(), first); }
HWY_INLINE VF Iota(int first) { return Iota(static_cast<float>(first)); }
HWY_INLINE VF NaN() { return Set(std::numeric_limits<float>::quiet_NaN()); }

/// The first `count` lanes, or all of them if there are fewer.
template <class D = F>
HWY_INLINE hn::Mask<D> FirstLanes(int count, D d = {}) {
  return hn::FirstN(d, static_cast<std::size_t>(count));
}
template <class D = F>
HWY_INLINE int CountLanes(hn::Mask<D> mask, D d = {}) {
  return static_cast<int>(hn::CountTrue(d, mask));
}
template <class D = F>
HWY_INLINE double SumLanes(hn::Vec<D> v, D d = {}) {
  return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, v)));
}

/// Calls visit(x, y) for each vector of pixels (x, y), (x + 1, y), ... of an area, row by row. The
/// last vector of a row may reach beyond the area.
template <class Visit, class D = F>
HWY_INLINE void ForEachVector(const Rect& area, const Visit& visit, D d = {}) {
  for (int y = area.y0; y < area.y1; ++y) {
    for (int x = area.x0; x < area.x1; x += LaneCount(d)) visit(x, y);
  }
}

/// The pixels (x, y), (x + 1, y), ... of a plane. A plane may be a view: nothing is aligned.
template <class D = F>
HWY_INLINE hn::Vec<D> Load(const Plane<hn::TFromD<D>>& plane, int x, int y, D d = {}) {
  return LoadU(d, plane.row(y) + x);
}
template <class D = F>
HWY_INLINE void Store(hn::Vec<D> v, Plane<hn::TFromD<D>>& plane, int x, int y, D d = {}) {
  StoreU(v, d, plane.row(y) + x);
}

/// Load() and Store() for kernels that read or write a plane once, row by row: they also prefetch
/// the pixels below (frame/prefetch.h).
template <class D = F>
HWY_INLINE hn::Vec<D> LoadAndPrefetch(const Plane<hn::TFromD<D>>& plane, int x, int y, D d = {}) {
  prefetch_below(plane, x, y);
  return Load(plane, x, y, d);
}
template <class D = F>
HWY_INLINE void StoreAndPrefetch(hn::Vec<D> v, Plane<hn::TFromD<D>>& plane, int x, int y,
                                 D d = {}) {
  prefetch_below(plane, x, y);
  Store(v, plane, x, y, d);
}

/// Converts pixels of a plane of bytes to integers, and integers in [0, 255] back.
template <class D = I>
HWY_INLINE hn::Vec<D> LoadBytes(const Plane<std::uint8_t>& plane, int x, int y, D d = {}) {
  return hn::PromoteTo(d, LoadU(hn::Rebind<std::uint8_t, D>(), plane.row(y) + x));
}
template <class D = I>
HWY_INLINE void StoreBytes(hn::Vec<D> v, Plane<std::uint8_t>& plane, int x, int y, D = {}) {
  const hn::Rebind<std::uint8_t, D> bytes;
  StoreU(hn::DemoteTo(bytes, v), bytes, plane.row(y) + x);
}
/// 1 where `flag` holds, else 0.
HWY_INLINE void StoreFlags(MF flag, Plane<std::uint8_t>& plane, int x, int y) {
  StoreBytes(IfThenElseZero(RebindMask(I(), flag), Set(I(), 1)), plane, x, y);
}

/// Three channels of a vector of pixels: a color, or x, y and z.
template <class V>
struct Vec3 {
  V v[3];

  HWY_INLINE V& operator[](int c) { return v[c]; }
  HWY_INLINE const V& operator[](int c) const { return v[c]; }
};
using VF3 = Vec3<VF>;

template <class D = F>
HWY_INLINE Vec3<hn::Vec<D>> Load(const Planes<3>& planes, int x, int y, D d = {}) {
  return {{Load(planes[0], x, y, d), Load(planes[1], x, y, d), Load(planes[2], x, y, d)}};
}
template <class D = F>
HWY_INLINE Vec3<hn::Vec<D>> LoadAndPrefetch(const Planes<3>& planes, int x, int y, D d = {}) {
  return {{LoadAndPrefetch(planes[0], x, y, d), LoadAndPrefetch(planes[1], x, y, d),
           LoadAndPrefetch(planes[2], x, y, d)}};
}
template <class D = F>
HWY_INLINE void Store(const Vec3<hn::Vec<D>>& v, Planes<3>& planes, int x, int y, D d = {}) {
  for (int c = 0; c < 3; ++c) Store(v[c], planes[c], x, y, d);
}

/// a . b. Dot() adds from the last term to the first, DotInOrder() from the first to the last: they
/// round differently.
template <class V>
HWY_INLINE V Dot(const Vec3<V>& a, const Vec3<V>& b) {
  return MulAdd(a[0], b[0], MulAdd(a[1], b[1], Mul(a[2], b[2])));
}
template <class V>
HWY_INLINE V DotInOrder(const Vec3<V>& a, const Vec3<V>& b) {
  return MulAdd(a[2], b[2], MulAdd(a[1], b[1], Mul(a[0], b[0])));
}

template <class V>
HWY_INLINE V Luminance(const Vec3<V>& color) {
  const hn::DFromV<V> d;
  const auto weight = [&](int c) { return Set(d, static_cast<float>(kLuminance[c])); };
  return Dot({{weight(0), weight(1), weight(2)}}, color);
}

/// Where pixels show a surface.
template <class D = F>
HWY_INLINE hn::Mask<D> HasSurface(const Plane<std::uint32_t>& id, int x, int y, D d = {}) {
  const hn::RebindToUnsigned<D> du;
  return RebindMask(d, Ne(Load(id, x, y, du), Zero(du)));
}

/// is_usable_surface() without its test of the id: depth and normal are in range.
template <class D = F>
HWY_INLINE hn::Mask<D> IsUsable(hn::Vec<D> depth, const Vec3<hn::Vec<D>>& normal, D d = {}) {
  hn::Mask<D> usable = And(Ge(depth, Set(d, kNearestDepth)), Le(depth, Set(d, kFarthestDepth)));
  for (int c = 0; c < 3; ++c) {
    usable = And(usable, Le(Abs(normal[c]), Set(d, kLargestNormal)));
  }
  return usable;
}

}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target

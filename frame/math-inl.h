// Exponentials and logarithms of vectors. Included like frame/simd-inl.h.
#if defined(EIGENLIGHT_FRAME_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef EIGENLIGHT_FRAME_MATH_INL_H_
#undef EIGENLIGHT_FRAME_MATH_INL_H_
#else
#define EIGENLIGHT_FRAME_MATH_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>

#include "frame/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace eigenlight::HWY_NAMESPACE {

using hn::Exp;
using hn::Log;

}  // namespace eigenlight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per target

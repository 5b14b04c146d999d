// The pictures of a comparison.
#pragma once

#include <filesystem>
#include <functional>

#include "sequences/compare/compare_plan.h"
#include "sequences/compare/reference_cache.h"
#include "sequences/pages/page.h"

namespace eigenlight {

/// The measured frames of one scene at plan.shown_spp(). Both functions throw std::runtime_error
/// naming a file that cannot be read.
struct ComparePictures {
  const ComparePlan& plan;
  float exposure = 1.0f;
  /// One of two references; of one that has no second, both are the same.
  std::function<Planes<3>(ReferenceCache::Half, int frame)> half;
  /// What a contender made of the frame.
  std::function<Planes<3>(const Contender&, int frame)> output;

  /// The mean of both references.
  [[nodiscard]] Planes<3> reference(int frame) const;
};

/// Pictures of a scene, read back from their files. `folder`: as CompareGroup::pictures. All must
/// outlive the result.
[[nodiscard]] ComparePictures scene_pictures(const ComparePlan& plan,
                                             const ReferenceCache& references,
                                             std::filesystem::path folder, float exposure);

/// One tile for the reference (the mean of both references) and one for each contender, with three
/// kinds of pictures:
///   crop             a square of up to 128 x 128 pixels, placed where plan.ours() has most error
///   error            root of the relMSE of each pixel against the reference, whole picture
///   change of error  the same for the change of the error since the frame before
/// Shows at most 24 measured frames (thin_frames()). Heat maps are at most 480 pixels wide and
/// include the noise of the references. Throws std::runtime_error naming a file that cannot be
/// read.
[[nodiscard]] PageGallery compare_gallery(const ComparePictures& pictures);

}  // namespace eigenlight

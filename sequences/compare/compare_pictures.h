// The pictures of a comparison.
#pragma once

#include <filesystem>

#include "sequences/compare/compare_plan.h"
#include "sequences/compare/reference_cache.h"
#include "sequences/pages/page.h"

namespace eigenlight {

/// The measured frames of one scene at plan.shown_spp(), read back from their files.
struct ComparePictures {
  const ComparePlan& plan;
  const ReferenceCache& references;
  std::filesystem::path folder;  ///< as CompareGroup::pictures
  float exposure = 1.0f;

  /// The mean of both references. Throws std::runtime_error naming a file that cannot be read; so
  /// does output().
  [[nodiscard]] Planes<3> reference(int frame) const;
  /// What a contender made of the frame.
  [[nodiscard]] Planes<3> output(const Contender& contender, int frame) const;
};

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

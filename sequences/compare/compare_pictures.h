// The pictures of a comparison.
#pragma once

#include <filesystem>

#include "sequences/compare/compare_plan.h"
#include "sequences/compare/reference_cache.h"
#include "sequences/pages/page_builder.h"

namespace eigenlight {

struct ComparePictures {
  const ComparePlan& plan;
  const ReferenceCache& references;
  std::filesystem::path folder;  ///< as CompareGroup::pictures
  float exposure = 1.0f;
};

/// A tile for the reference (the mean of both) and for each contender, of three kinds:
///   crop    the square of up to 128 pixels a side where plan.ours() has most error
///   error   root of the pixel's relMSE against the reference, the whole picture
///   change  the same of the change of error since the frame before
/// At most 24 measured frames, thinned evenly. Heat maps are no wider than 480 pixels and hold the
/// references' noise too. Throws std::runtime_error naming a file that cannot be read.
[[nodiscard]] PageGallery compare_gallery(const ComparePictures& pictures);

}  // namespace eigenlight

#include "spatial/rivals/cross_bilateral.h"

#include "spatial/rivals/cross_bilateral_kernel.h"

namespace eigenlight {

void CrossBilateralOptions::validate() const {
  const auto check = [](float sigma, const char* name) {
    EL_CHECK(sigma > 0.0f && sigma <= 10.0f, "cross bilateral filter {} {}: expected (0, 10]", name,
             sigma);
  };
  EL_CHECK(radius >= 1 && radius <= 32, "cross bilateral filter radius {}: expected 1 to 32",
           radius);
  check(sigma_normal, "sigma_normal");
  check(sigma_plane, "sigma_plane");
  check(sigma_albedo, "sigma_albedo");
}

CrossBilateral::CrossBilateral(Extent extent, const CrossBilateralOptions& options)
    : options_((options.validate(), options)),
      grid_(stage_tiles(extent)),
      planes_(extent, options.radius) {}

void CrossBilateral::process(const SpatialInputs& in, Planes<3>& out) {
  check_spatial(in, out, grid_.extent(), "cross bilateral filter");
  planes_.load(in);
  for_each_tile(grid_,
                [&](const Rect& tile) { cross_bilateral_tile(planes_, options_, tile, out); });
}

}  // namespace eigenlight

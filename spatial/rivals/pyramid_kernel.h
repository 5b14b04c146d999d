// The pyramid filter for normals and depth, in vectors; see pyramid_filter.h.
#pragma once

#include <array>

#include "frame/frame.h"
#include "frame/tiles.h"
#include "spatial/rivals/pyramid_edges.h"
#include "spatial/rivals/pyramid_weights.h"

namespace eigenlight {

/// Wide enough for hardware to foresee the rows of the planes (64 columns take 1.4 times as long),
/// while all that a tile reads, 260 kB, stays in the second-level cache. A tile of a coarser level
/// is half as wide and high as one of the finer.
inline constexpr int kPyramidTileWidth = 256, kPyramidTileHeight = 16;

/// One level above the image, planar. Without surface: normal, depth, values and result are 0.
struct PyramidPlanes {
  Planes<3> normal;
  Plane<float> depth;
  Planes<4> values;  ///< I_down: signal times weight, weight
  Planes<4> result;  ///< I_up

  explicit PyramidPlanes(Extent extent)
      : normal(make_planes<3>(extent)),
        depth(extent),
        values(make_planes<4>(extent)),
        result(make_planes<4>(extent)) {}
};

/// Level 0, which is read where it lies and cleaned on the way.
struct PyramidImage {
  const GBuffer& surface;
  const Planes<3>& signal;
  const Plane<float>& weight;
};

/// A level to read: the image if `planes` is null.
struct PyramidView {
  const PyramidImage& image;
  const PyramidPlanes* planes;

  [[nodiscard]] Extent extent() const {
    return planes ? planes->depth.extent() : image.weight.extent();
  }
};

/// Fills a tile of `coarse` from the level below it.
void pyramid_down_tile(const PyramidView& fine, const GlobalIlluminationEdge& edge,
                       const Rect& tile, PyramidPlanes& coarse);

struct PyramidUpPass {
  PyramidView fine;
  const PyramidPlanes& coarse;
  const GlobalIlluminationEdge& edge;
  const PyramidPass& pass;
};

/// Writes a tile of I_up to `result` (a level's), or, of the image, I_up over its weight to `out`.
void pyramid_up_tile(const PyramidUpPass& up, const Rect& tile, Planes<4>& result);
void pyramid_last_tile(const PyramidUpPass& up, const Rect& tile, Planes<3>& out);

}  // namespace eigenlight

// The pyramid edge-preserving filter, for any edge-stopping function.
#pragma once

#include <array>
#include <vector>

#include "frame/tiles.h"
#include "spatial/rivals/pyramid_edges.h"
#include "spatial/rivals/pyramid_weights.h"

namespace eigenlight {

/// One level. Values are linear in the signal: (w r, w g, w b, w) with the signal's weight w.
struct PyramidLevel {
  Plane<float> attributes;  ///< Edge::kAttributes values a pixel
  Plane<float> values;      ///< I_down, 4 values a pixel
  Plane<float> result;      ///< I_up, the same
};

/// Energies of the 18 samples that a pixel gathers, in the order of PyramidPass; +inf: not there.
struct PyramidEnergies {
  std::array<float, 9> fine, coarse;
};

/// Levels 0 .. passes of an image; each side of a level is half of that below, rounded up.
[[nodiscard]] std::vector<PyramidLevel> make_pyramid_levels(Extent extent, int attributes,
                                                            int passes);

/// Writes signal times weight and weight to `values`; all 0 where the weight is not positive, or
/// where one of them is not a number below 1e36.
void load_pyramid_values(const Planes<3>& signal, const Plane<float>& weight, const Rect& tile,
                         Plane<float>& values);

/// Writes I_up / w to `out`, 0 where w is 0.
void store_pyramid_result(const Plane<float>& result, const Rect& tile, Planes<3>& out);

/// The weighted sum of Eq. 2 at pixel (x, y) of level `level`, from the energies of its samples,
/// written to the level's result.
void blend_pyramid_pixel(const PyramidEnergies& energies, const PyramidPass& pass,
                         std::vector<PyramidLevel>& levels, std::array<int, 3> level_x_y);

/// Eq. 3: fills level + 1 from level. Pixels that do not exist have no part; a coarser pixel exists
/// if one of its four does.
template <typename Edge>
void downsample_pyramid(const Edge& edge, const PyramidLevel& fine, float pixel_area,
                        PyramidLevel& coarse);

/// Energies of the samples of pixel (x, y) between `fine`, whose pixels cover `pixel_area` pixels
/// of the image, and `coarse`.
template <typename Edge>
[[nodiscard]] PyramidEnergies pyramid_energies(const Edge& edge, const PyramidLevel& fine,
                                               const PyramidLevel& coarse,
                                               std::array<int, 3> area_x_y);

struct PyramidInputs {
  const Plane<float>& attributes;  ///< Edge::kAttributes values a pixel
  const Planes<3>& signal;         ///< finite where it is to be used
  const Plane<float>& weight;      ///< >= 0; 0: the pixel's signal is not to be used
};

/// Xu et al. 2024, Eq. 2 and 3: approximates the bilateral filter
///   out(p) = sum_q I(q) w(q) f^Omega(p, q) f^R(A(p), A(q)) / sum_q w(q) f^Omega f^R
/// with a Gaussian f^Omega, at a cost that does not depend on its radius. The pyramid is linear in
/// what it filters, so it filters w I and w alike and divides at the end: with w = 1 this is the
/// paper's filter, and a pixel of weight 0, NaN or not, reaches nobody. It gets an output like all
/// others; pixels that do not exist, and those that no weight reaches, get 0.
///
/// Weights of a pass follow edge.radius() of the pixel's attributes at its level. The same bits for
/// any number of threads.
template <typename Edge>
class Pyramid {
 public:
  /// Throws std::invalid_argument on a bad size.
  Pyramid(Extent extent, const Edge& edge, const PyramidTable& table = trained_pyramid_table())
      : edge_(edge),
        table_(table),
        levels_(make_pyramid_levels(extent, Edge::kAttributes, kPyramidOctaves)) {}

  /// Writes every pixel of `out`. Throws std::invalid_argument if shapes differ or `out` is the
  /// signal itself.
  void process(const PyramidInputs& in, Planes<3>& out) {
    check(in, out);
    const TileGrid grid = stage_tiles(in.weight.extent());
    levels_[0].attributes.copy_from(in.attributes);
    for_each_tile(grid, [&](const Rect& tile) {
      load_pyramid_values(in.signal, in.weight, tile, levels_[0].values);
      for_pixels(tile, [&](int x, int y) {
        if (edge_.exists(in.attributes.at(x, y))) return;
        std::fill_n(levels_[0].values.at(x, y), 4, 0.0f);
      });
    });
    const int passes = pyramid_passes(largest_radius());
    float area = 1.0f;
    for (int l = 0; l < passes; ++l, area *= 4.0f) {
      downsample_pyramid(edge_, level(l), area, level(l + 1));
    }
    level(passes).result.copy_from(level(passes).values);
    for (int l = passes; l-- > 0;) upsample(l);
    for_each_tile(grid,
                  [&](const Rect& tile) { store_pyramid_result(level(0).result, tile, out); });
  }

 private:
  template <typename Body>
  static void for_pixels(const Rect& tile, const Body& body) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) body(x, y);
    }
  }
  [[nodiscard]] PyramidLevel& level(int l) { return levels_[static_cast<std::size_t>(l)]; }

  void check(const PyramidInputs& in, const Planes<3>& out) const {
    const Extent extent = levels_[0].values.extent();
    const auto fits = [&](const Plane<float>& plane) { return plane.extent() == extent; };
    EL_CHECK(fits(in.attributes) && in.attributes.channels() == Edge::kAttributes &&
                 fits(in.weight) && std::all_of(in.signal.begin(), in.signal.end(), fits) &&
                 std::all_of(out.begin(), out.end(), fits),
             "pyramid filter made for {}x{} and {} attributes: got planes of another shape",
             extent.width, extent.height, Edge::kAttributes);
    EL_CHECK(&in.signal != &out, "pyramid filter: the output must not be the signal itself");
  }

  [[nodiscard]] float largest_radius() {
    float largest = 0.0f;
    const Plane<float>& attributes = level(0).attributes;
    for_pixels({0, 0, attributes.width(), attributes.height()}, [&](int x, int y) {
      if (edge_.exists(attributes.at(x, y))) {
        largest = std::max(largest, edge_.radius(attributes.at(x, y)));
      }
    });
    return largest;
  }

  void upsample(int l) {
    PyramidLevel& fine = level(l);
    const int area = 1 << (2 * l);
    for_each_tile(stage_tiles(fine.values.extent()), [&](const Rect& tile) {
      float radius = -1.0f;
      PyramidPass pass;
      for_pixels(tile, [&](int x, int y) {
        const float* own = fine.attributes.at(x, y);
        if (!edge_.exists(own)) {
          std::fill_n(fine.result.at(x, y), 4, 0.0f);
          return;
        }
        if (edge_.radius(own) != radius) {
          radius = edge_.radius(own);
          pass = table_.at(radius, l);
          pass.gamma *= edge_.gamma();
        }
        blend_pyramid_pixel(pyramid_energies(edge_, fine, level(l + 1), {area, x, y}), pass,
                            levels_, {l, x, y});
      });
    });
  }

  Edge edge_;
  const PyramidTable& table_;
  std::vector<PyramidLevel> levels_;
};

}  // namespace eigenlight

#include "spatial/rivals/pyramid_inl.h"

// Incremental PCA of whole images, as Chen 2012 has it.
#pragma once

#include <functional>
#include <vector>

#include "frame/tiles.h"
#include "reproject/basis_field.h"

namespace eigenlight {

struct PcaFrame {
  const Planes<3>& light;      ///< u; read where `weight` > 0
  const Plane<float>& weight;  ///< w in [0, 1], per pixel; 0: no usable sample
  int number = 1;              ///< n, counted from 1 at the last cut
};

/// CCIPCA (Weng, Zhang and Hwang 2003) on images as vectors of all pixels' channels. Inner products
/// run over the pixels with a usable sample, in double and tile by tile: the same bits for any
/// number of threads. Bases are not normalized, |v_i| estimates the i-th eigenvalue of E[u u^T].
class ImagePca {
 public:
  ImagePca(Extent extent, int bases);

  /// Chen 2012, Algorithm 2. As printed, it deflates u and changes no basis but a new one. Its
  /// purpose is to make the bases orthogonal, so here the same sweep runs over the bases
  /// (Gram-Schmidt): v_i <- v_i - sum over j < i of (v_i . v_j) v_j / |v_j|^2, with the v_j already
  /// orthogonal. Products run over all pixels. A basis that depends linearly on those before it
  /// becomes 0.
  void orthogonalize(BasisField& bases);

  /// Chen 2012, Algorithm 1, with per-pixel weights (section 3.4.2). u_1 = u, and for
  /// i = 1 .. min(K, n):
  ///   v_i <- u_i                                       if i = n, or |v_i| = 0
  ///   v_i <- (1 - w) v_i + w u_i (u_i . v_i / |v_i|)   else
  ///   u_(i+1) = u_i - (u_i . v_i / |v_i|) v_i / |v_i|
  /// A basis of length 0 has no direction and starts again, as at i = n. A u_i with less than 1e-12
  /// of the energy of u is rounding error and counts as 0. Pixels of weight 0 keep their values.
  void update(const PcaFrame& frame, BasisField& bases);

  /// out = sum over i of (u . v_i / |v_i|) v_i / |v_i|, at all pixels. Returns the number of bases
  /// with a length.
  int reconstruct(const PcaFrame& frame, const BasisField& bases, Planes<3>& out);

 private:
  using Sums = std::array<double, kMaxBases*(kMaxBases + 1) / 2>;
  struct Factors {
    double projection = 0.0;  ///< (u_(i-1) . v_(i-1)) / |v_(i-1)|^2, not yet subtracted from u
    double energy = 0.0;      ///< |u|^2
    double dot = 0.0;         ///< u_i . v_i / |v_i|
    bool starts = false;
    bool lost = false;  ///< u_i is rounding error
  };

  [[nodiscard]] Sums reduce(const std::function<void(const Tile&, Sums&)>& add);
  void deflate_and_measure(const PcaFrame& frame, const BasisField& bases, int i, Factors& factors);
  void advance(const PcaFrame& frame, BasisField& bases, int i, Factors& factors);

  TileGrid tiles_;
  Planes<3> residual_;      // u_i
  std::vector<Sums> sums_;  // per tile
};

}  // namespace eigenlight

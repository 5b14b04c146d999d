#include "temporal/baselines/chen2012_pca.h"

#include <algorithm>
#include <cmath>

namespace eigenlight {
namespace {

constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }
constexpr std::size_t packed(int i, int j) { return static_cast<std::size_t>(j * (j + 1) / 2 + i); }

using Values = std::array<double, kMaxBases>;

// Channel c of all bases of a pixel.
Values values_at(const BasisField& bases, int x, int y, int c) {
  Values values{};
  for (int k = 0; k < bases.bases(); ++k) {
    values[static_cast<std::size_t>(k)] = static_cast<double>(bases.value(x, y, c, k));
  }
  return values;
}

template <typename Visit>
void for_pixels(const Tile& tile, const Visit& visit) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) visit(x, y);
  }
}

// Below 1e-12 of its former energy an image is rounding error: subtracting a multiple of an image
// from itself leaves 1e-14 of its energy.
constexpr double kLost = 1e-12;

// combination(i, j), j <= i: how much of the old basis j the i-th orthogonal one holds, given all
// inner products of the old ones. Classical Gram-Schmidt; rows of lost bases are 0.
using Combination = std::array<std::array<double, kMaxBases>, kMaxBases>;

template <typename Gram>
Combination gram_schmidt(const Gram& gram, int bases) {
  Combination made{};
  const auto old_dot = [&](int a, int b) { return gram[packed(std::min(a, b), std::max(a, b))]; };
  const auto row = [&](int i) -> auto& { return made[at(i)]; };
  for (int i = 0; i < bases; ++i) {
    std::array<double, kMaxBases> next{};
    next[at(i)] = 1.0;
    double left = old_dot(i, i);
    for (int j = 0; j < i; ++j) {
      double cross = 0.0, square = 0.0;
      for (int a = 0; a <= j; ++a) {
        const double part = row(j)[static_cast<std::size_t>(a)];
        cross += part * old_dot(i, a);
        for (int b = 0; b <= j; ++b)
          square += part * row(j)[static_cast<std::size_t>(b)] * old_dot(a, b);
      }
      if (!(square > 0.0)) continue;
      for (std::size_t a = 0; a <= static_cast<std::size_t>(j); ++a)
        next[a] -= cross / square * row(j)[a];
      left -= cross * cross / square;
    }
    if (left > kLost * old_dot(i, i)) row(i) = next;
  }
  return made;
}

}  // namespace

ImagePca::ImagePca(Extent extent, int bases)
    : tiles_(stage_tiles(extent)),
      residual_(make_planes<3>(extent)),
      sums_(static_cast<std::size_t>(tiles_.count())) {
  EL_CHECK(bases >= 1 && bases <= kMaxBases, "bases {}: expected 1 to {}", bases, kMaxBases);
}

ImagePca::Sums ImagePca::reduce(const std::function<void(const Tile&, Sums&)>& add) {
  for_each_tile(tiles_, [&](const Tile& tile) {
    Sums& sums = sums_[static_cast<std::size_t>(tile.index)];
    sums.fill(0.0);
    add(tile, sums);
  });
  Sums total{};
  for (const Sums& sums : sums_) {
    std::transform(sums.begin(), sums.end(), total.begin(), total.begin(), std::plus<>());
  }
  return total;
}

void ImagePca::orthogonalize(BasisField& bases) {
  const int count = bases.bases();
  const Sums gram = reduce([&](const Tile& tile, Sums& sums) {
    for_pixels(tile, [&](int x, int y) {
      for (int c = 0; c < 3; ++c) {
        const Values v = values_at(bases, x, y, c);
        for (int j = 0; j < count; ++j) {
          for (int i = 0; i <= j; ++i) sums[packed(i, j)] += v[at(i)] * v[at(j)];
        }
      }
    });
  });
  const Combination combination = gram_schmidt(gram, count);
  for_each_tile(tiles_, [&](const Tile& tile) {
    for_pixels(tile, [&](int x, int y) {
      for (int c = 0; c < 3; ++c) {
        const Values v = values_at(bases, x, y, c);
        for (int i = 0; i < count; ++i) {
          double sum = 0.0;
          for (int j = 0; j <= i; ++j) sum += combination[at(i)][at(j)] * v[at(j)];
          bases.value(x, y, c, i) = static_cast<float>(sum);
        }
      }
    });
  });
}

void ImagePca::update(const PcaFrame& frame, BasisField& bases) {
  EL_CHECK(bases.extent() == tiles_.extent() && frame.weight.extent() == tiles_.extent() &&
               frame.light[0].extent() == tiles_.extent(),
           "incremental PCA made for {}x{}: got planes of another size", tiles_.extent().width,
           tiles_.extent().height);
  for_each_tile(tiles_, [&](const Tile& tile) {
    for_pixels(tile, [&](int x, int y) {
      for (std::size_t c = 0; c < 3; ++c) {
        residual_[c](x, y) = frame.weight(x, y) > 0.0f ? frame.light[c](x, y) : 0.0f;
      }
    });
  });
  Factors factors;
  for (int i = 0; i < std::min(bases.bases(), frame.number); ++i) {
    deflate_and_measure(frame, bases, i, factors);
    advance(frame, bases, i, factors);
  }
}

void ImagePca::deflate_and_measure(const PcaFrame& frame, const BasisField& bases, int i,
                                   Factors& factors) {
  const int last = std::max(i - 1, 0);
  const double projection = i > 0 ? factors.projection : 0.0;
  const Sums sums = reduce([&](const Tile& tile, Sums& sum) {
    double dot = 0.0, length = 0.0, energy = 0.0;
    for (int y = tile.y0; y < tile.y1; ++y) {
      const float* weight = frame.weight.row(y);
      for (std::size_t c = 0; c < 3; ++c) {
        float* residual = residual_[c].row(y);
        for (int x = tile.x0; x < tile.x1; ++x) {
          if (!(weight[x] > 0.0f)) continue;
          const auto basis = [&](int k) {
            return static_cast<double>(bases.value(x, y, static_cast<int>(c), k));
          };
          residual[x] -= static_cast<float>(projection * basis(last));
          const double u = static_cast<double>(residual[x]), v = basis(i);
          dot += u * v;
          length += v * v;
          energy += u * u;
        }
      }
    }
    sum[0] = dot;
    sum[1] = length;
    sum[2] = energy;
  });
  if (i == 0) factors.energy = sums[2];
  factors.lost = !(sums[2] > kLost * factors.energy);
  factors.starts = i + 1 == frame.number || !(sums[1] > 0.0);
  factors.dot = factors.starts ? 0.0 : sums[0] / std::sqrt(sums[1]);
}

void ImagePca::advance(const PcaFrame& frame, BasisField& bases, int i, Factors& factors) {
  const Sums sums = reduce([&](const Tile& tile, Sums& sum) {
    double dot = 0.0, length = 0.0;
    for (int y = tile.y0; y < tile.y1; ++y) {
      const float* weight = frame.weight.row(y);
      for (std::size_t c = 0; c < 3; ++c) {
        const float* residual = residual_[c].row(y);
        for (int x = tile.x0; x < tile.x1; ++x) {
          const double w = static_cast<double>(weight[x]);
          if (!(w > 0.0)) continue;
          const double u = factors.lost ? 0.0 : static_cast<double>(residual[x]);
          float& value = bases.value(x, y, static_cast<int>(c), i);
          const double learned = (1.0 - w) * static_cast<double>(value) + w * u * factors.dot;
          value = static_cast<float>(factors.starts ? u : learned);
          const double v = static_cast<double>(value);
          dot += u * v;
          length += v * v;
        }
      }
    }
    sum[0] = dot;
    sum[1] = length;
  });
  factors.projection = sums[1] > 0.0 ? sums[0] / sums[1] : 0.0;
}

int ImagePca::reconstruct(const PcaFrame& frame, const BasisField& bases, Planes<3>& out) {
  const int count = bases.bases();
  const Sums sums = reduce([&](const Tile& tile, Sums& sum) {
    for_pixels(tile, [&](int x, int y) {
      if (!(frame.weight(x, y) > 0.0f)) return;
      for (int c = 0; c < 3; ++c) {
        const double u = static_cast<double>(frame.light[at(c)](x, y));
        const Values v = values_at(bases, x, y, c);
        for (int i = 0; i < count; ++i) {
          sum[at(i)] += u * v[at(i)];
          sum[at(kMaxBases + i)] += v[at(i)] * v[at(i)];
        }
      }
    });
  });
  std::array<double, kMaxBases> projection{};
  int rank = 0;
  for (int i = 0; i < count; ++i) {
    if (!(sums[at(kMaxBases + i)] > 0.0)) continue;
    projection[at(i)] = sums[at(i)] / sums[at(kMaxBases + i)];
    ++rank;
  }
  for_each_tile(tiles_, [&](const Tile& tile) {
    for_pixels(tile, [&](int x, int y) {
      for (int c = 0; c < 3; ++c) {
        const Values v = values_at(bases, x, y, c);
        double sum = 0.0;
        for (int i = 0; i < count; ++i) sum += projection[at(i)] * v[at(i)];
        out[at(c)](x, y) = static_cast<float>(sum);
      }
    });
  });
  return rank;
}

}  // namespace eigenlight

#include "sequences/exr/exr_pixels.h"

#include <Imath/half.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "frame/tiles.h"

namespace eigenlight {
namespace {

constexpr float kMaxHalf = 65504.0f;
constexpr float kRoundsToInf = 65520.0f;  // halfway to the next power of two

ExrOverflow count(const float* row, int width, bool as_half) {
  ExrOverflow found;
  for (int x = 0; x < width; ++x) {
    found.not_finite += !std::isfinite(row[x]);
    found.clamped += as_half && std::isfinite(row[x]) && std::abs(row[x]) >= kRoundsToInf;
  }
  return found;
}

std::uint16_t to_half(float value) {
  if (std::isfinite(value)) value = std::clamp(value, -kMaxHalf, kMaxHalf);
  return Imath::half(value).bits();
}

// For each of `to` pixels of a line, the pixels of a line of `from` that it covers, and how much of
// each.
struct Share {
  int first = 0;
  std::vector<double> weights;
};

std::vector<Share> shares(int from, int to) {
  std::vector<Share> all;
  const double step = static_cast<double>(from) / to;
  for (int i = 0; i < to; ++i) {
    const double start = i * step, end = std::min<double>((i + 1) * step, from);
    Share share{static_cast<int>(start), {}};
    for (int x = share.first; x < end; ++x) {
      share.weights.push_back((std::min<double>(x + 1, end) - std::max<double>(x, start)) / step);
    }
    all.push_back(std::move(share));
  }
  return all;
}

}  // namespace

ExrOverflow pack_rows(const Plane<float>& plane, int first, int rows, bool as_half, char* to) {
  const auto width = static_cast<std::size_t>(plane.width());
  std::vector<ExrOverflow> found(static_cast<std::size_t>(rows));
  parallel_for(rows, [&](int i) {
    const float* row = plane.row(first + i);
    found[static_cast<std::size_t>(i)] = count(row, plane.width(), as_half);
    if (!as_half) {
      std::memcpy(to + static_cast<std::size_t>(i) * width * 4, row, width * 4);
      return;
    }
    char* out = to + static_cast<std::size_t>(i) * width * 2;
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint16_t bits = to_half(row[x]);
      std::memcpy(out + 2 * x, &bits, 2);
    }
  });
  ExrOverflow sum;
  for (const ExrOverflow& row : found) {
    sum.clamped += row.clamped;
    sum.not_finite += row.not_finite;
  }
  return sum;
}

Plane<float> average_to(const Plane<float>& plane, Extent extent) {
  Plane<float> small(extent);
  const std::vector<Share> across = shares(plane.width(), extent.width);
  const std::vector<Share> down = shares(plane.height(), extent.height);
  parallel_for(extent.height, [&](int y) {
    const Share& lines = down[static_cast<std::size_t>(y)];
    std::vector<double> column(static_cast<std::size_t>(plane.width()), 0.0);
    for (std::size_t j = 0; j < lines.weights.size(); ++j) {
      const float* row = plane.row(lines.first + static_cast<int>(j));
      for (std::size_t x = 0; x < column.size(); ++x) column[x] += lines.weights[j] * row[x];
    }
    for (int x = 0; x < extent.width; ++x) {
      const Share& share = across[static_cast<std::size_t>(x)];
      double sum = 0;
      for (std::size_t i = 0; i < share.weights.size(); ++i) {
        sum += share.weights[i] * column[static_cast<std::size_t>(share.first) + i];
      }
      small(x, y) = static_cast<float>(sum);
    }
  });
  return small;
}

}  // namespace eigenlight

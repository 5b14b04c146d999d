#include "sequences/conventions/reprojection.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "sequences/conventions/background.h"

namespace eigenlight {
namespace {

constexpr float kDepthWidth = 0.02f, kNormalWidth = 0.6f, kAlbedoWidth = 0.3f;
// Depths of one surface within a pixel: more than that is another one.
constexpr float kSameSurface = 0.05f;
// A surface against the background.
constexpr double kOther = 1e4;

bool has(const Planes<3>& planes) { return !planes[0].empty(); }

// What is compared at one end of a vector. Depth is the log; nullopt: background, or not known.
struct Features {
  std::optional<float> depth;
  glm::vec3 normal{0.0f}, albedo{0.0f};
};

// The corner pixels around a place and their weights.
struct Corners {
  int x[4], y[4];
  float weight[4];
};

std::optional<Corners> corners_of(Extent extent, const glm::vec2& place) {
  const auto right = static_cast<float>(extent.width - 1);
  const auto bottom = static_cast<float>(extent.height - 1);
  if (place.x < -0.5f || place.y < -0.5f || place.x > right + 0.5f || place.y > bottom + 0.5f) {
    return std::nullopt;
  }
  const glm::vec2 inside(std::clamp(place.x, 0.0f, right), std::clamp(place.y, 0.0f, bottom));
  const int x0 = static_cast<int>(inside.x), y0 = static_cast<int>(inside.y);
  const float fx = inside.x - static_cast<float>(x0), fy = inside.y - static_cast<float>(y0);
  Corners corners{};
  for (int k = 0; k < 4; ++k) {
    corners.x[k] = std::min(x0 + (k & 1), extent.width - 1);
    corners.y[k] = std::min(y0 + (k >> 1), extent.height - 1);
    corners.weight[k] = ((k & 1) != 0 ? fx : 1.0f - fx) * ((k >> 1) != 0 ? fy : 1.0f - fy);
  }
  return corners;
}

// Leaves only the surface of the corner with the largest weight.
void keep_one_surface(const Plane<float>& depth, Corners& corners) {
  const auto nearest = std::max_element(corners.weight, corners.weight + 4) - corners.weight;
  const float reference = depth(corners.x[nearest], corners.y[nearest]);
  float sum = 0.0f;
  for (int k = 0; k < 4; ++k) {
    const float there = depth(corners.x[k], corners.y[k]);
    const bool same =
        is_background(reference)
            ? is_background(there)
            : !is_background(there) && std::abs(there - reference) < kSameSurface * reference;
    if (!same) corners.weight[k] = 0.0f;
    sum += corners.weight[k];
  }
  for (float& weight : corners.weight) weight /= sum;
}

glm::vec3 mean_of(const Planes<3>& planes, const Corners& corners) {
  glm::vec3 mean(0.0f);
  for (int k = 0; k < 4; ++k) {
    if (corners.weight[k] == 0.0f) continue;
    for (int c = 0; c < 3; ++c) {
      const float value = planes[c](corners.x[k], corners.y[k]);
      if (std::isfinite(value)) mean[c] += corners.weight[k] * std::clamp(value, -1e3f, 1e3f);
    }
  }
  return mean;
}

Features features_at(const RawGuides& frame, Corners corners) {
  Features features;
  if (!frame.depth.empty()) {
    keep_one_surface(frame.depth, corners);
    float log_depth = 0.0f;
    bool known = true;
    for (int k = 0; k < 4; ++k) {
      if (corners.weight[k] == 0.0f) continue;
      const float depth = frame.depth(corners.x[k], corners.y[k]);
      known = known && !is_background(depth);
      if (known) log_depth += corners.weight[k] * std::log(depth);
    }
    if (known) features.depth = log_depth;
  }
  if (has(frame.normal)) features.normal = mean_of(frame.normal, corners);
  if (has(frame.albedo)) features.albedo = mean_of(frame.albedo, corners);
  return features;
}

// One vector whose ends were looked up.
struct Ends {
  double rest = 0.0;        // d^2 of all but depth
  double log_change = 0.0;  // of depth
  bool has_depth = false;
  Eigen::Vector4d terms = Eigen::Vector4d::Zero();  // of the change that a camera brings
};

class Comparison {
 public:
  Comparison(const RawGuides& from, const RawGuides& to)
      : from_(from),
        to_(to),
        depth_(!from.depth.empty() && !to.depth.empty()),
        normal_(has(from.normal) && has(to.normal)),
        albedo_(has(from.albedo) && has(to.albedo)) {}

  [[nodiscard]] bool is_possible() const { return depth_ || normal_ || albedo_; }

  // nullopt: no surface to compare.
  [[nodiscard]] std::optional<Features> start(const PixelVector& vector) const {
    Features features = features_at(from_, *corners_of(from_.extent(), {vector.x, vector.y}));
    if (depth_ && !features.depth) return std::nullopt;
    return features;
  }

  // nullopt: the vector leads out of the picture.
  [[nodiscard]] std::optional<Ends> ends(const PixelVector& vector, const Features& start) const {
    const Extent extent = to_.extent();
    const glm::vec2 here(vector.x, vector.y);
    const auto corners = corners_of(extent, here + vector.vector);
    if (!corners) return std::nullopt;
    const Features end = features_at(to_, *corners);
    Ends ends;
    if (normal_) ends.rest += square(start.normal - end.normal, kNormalWidth);
    if (albedo_) ends.rest += square(start.albedo - end.albedo, kAlbedoWidth);
    if (!depth_) return ends;
    if (!end.depth) {
      ends.rest += kOther;
      return ends;
    }
    ends.has_depth = true;
    ends.log_change = static_cast<double>(*end.depth) - static_cast<double>(*start.depth);
    ends.terms = {1.0, 2.0 * vector.x / extent.width - 1.0, 2.0 * vector.y / extent.height - 1.0,
                  std::exp(-static_cast<double>(*start.depth))};
    return ends;
  }

 private:
  static double square(const glm::vec3& difference, float width) {
    const glm::dvec3 d(difference / width);
    return glm::dot(d, d);
  }

  const RawGuides &from_, &to_;
  bool depth_, normal_, albedo_;
};

double distance(const Ends& ends, const Eigen::Vector4d& camera, double width) {
  if (!ends.has_depth) return ends.rest;
  const double d = (ends.log_change - camera.dot(ends.terms)) / width;
  return ends.rest + d * d;
}

// The change of log depth that fits most vectors: least squares, reweighted, with widths that
// narrow.
Eigen::Vector4d fit_camera(const std::vector<Ends>& all) {
  Eigen::Vector4d camera = Eigen::Vector4d::Zero();
  for (const double width : {0.2, 0.1, 0.05, 0.02, 0.02}) {
    Eigen::Matrix4d square = Eigen::Matrix4d::Zero();
    Eigen::Vector4d side = Eigen::Vector4d::Zero();
    for (const Ends& ends : all) {
      if (!ends.has_depth) continue;
      const double fit = 1.0 + distance(ends, camera, width), weight = 1.0 / (fit * fit);
      square += weight * ends.terms * ends.terms.transpose();
      side += weight * ends.log_change * ends.terms;
    }
    const double trace = square.trace();
    if (!(trace > 0.0)) break;
    // Columns of very different size (1 / depth) are brought to one size first.
    const Eigen::Vector4d scale =
        (square.diagonal().array() + 1e-12 * trace).sqrt().inverse().matrix();
    Eigen::Matrix4d scaled = scale.asDiagonal() * square * scale.asDiagonal();
    scaled.diagonal().array() += 1e-6;
    camera = scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(side)));
  }
  return camera;
}

}  // namespace

Mismatch compare_along(const RawGuides& from, const RawGuides& to,
                       std::span<const PixelVector> vectors) {
  Mismatch result;
  const Comparison comparison(from, to);
  if (!comparison.is_possible()) return result;
  std::vector<Ends> all;
  all.reserve(vectors.size());
  int outside = 0;
  for (const PixelVector& vector : vectors) {
    const auto start = comparison.start(vector);
    if (!start) continue;
    const auto ends = comparison.ends(vector, *start);
    if (ends) {
      all.push_back(*ends);
    } else {
      ++outside;
    }
  }
  result.pixels = static_cast<int>(all.size());
  if (result.pixels <= outside) return result;
  const Eigen::Vector4d camera = fit_camera(all);
  double sum = 0.0;
  for (const Ends& ends : all) {
    const double d2 = distance(ends, camera, kDepthWidth);
    sum += d2 / (1.0 + d2);
  }
  result.residual = sum / result.pixels;
  return result;
}

}  // namespace eigenlight

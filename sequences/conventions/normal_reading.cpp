#include "sequences/conventions/normal_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "frame/tiles.h"
#include "sequences/conventions/depth_slopes.h"
#include "sequences/conventions/sampling.h"

namespace eigenlight {
namespace {

constexpr double kSampled = 20000;
// A reading is clear if its median angle is below that, and if at so large a share of the pixels
// where it differs from another one it is the nearer of both: noise of normals turns both to the
// same side, so the share is large even where the readings differ by less than the noise.
constexpr double kWorstAngle = 25.0, kClearShare = 0.65;
// Readings differ at a pixel from that angle on, and are one unless they do so at so many pixels.
constexpr double kSameAngle = 1.0, kFewestShare = 0.02;
constexpr std::size_t kFewest = 64;
// Sine of the angle that interpolated normals may face away by.
constexpr float kSilhouette = 0.1f;
constexpr double kToDegrees = 57.295779513082321;

struct Candidate {
  NormalReading reading;
  const char* name;
};

glm::mat3 rows(const glm::vec3& x, const glm::vec3& y, const glm::vec3& z) {
  return glm::transpose(glm::mat3(x, y, z));
}

// All turn to face the camera, so readings that differ by the sign of all axes are one.
std::vector<Candidate> candidates(bool may_be_encoded) {
  std::vector<Candidate> all;
  for (const bool encoded : {false, true}) {
    if (encoded && !may_be_encoded) break;
    const auto add = [&](bool camera, const glm::mat3& axes, const char* name) {
      all.push_back({{camera, encoded, axes}, name});
    };
    add(false, glm::mat3(1.0f), "in world space");
    add(false, rows({1, 0, 0}, {0, 0, 1}, {0, -1, 0}),
        "in world space, y and z exchanged (x, z, -y)");
    add(false, rows({1, 0, 0}, {0, 0, -1}, {0, 1, 0}),
        "in world space, y and z exchanged (x, -z, y)");
    add(true, rows({1, 0, 0}, {0, -1, 0}, {0, 0, -1}),
        "in camera space, y up, z toward the viewer");
    add(true, rows({1, 0, 0}, {0, -1, 0}, {0, 0, 1}), "in camera space, y up, z into the scene");
    add(true, glm::mat3(1.0f), "in camera space, y down, z into the scene");
    add(true, rows({1, 0, 0}, {0, 1, 0}, {0, 0, -1}),
        "in camera space, y down, z toward the viewer");
  }
  return all;
}

std::string name_of(const Candidate& candidate) {
  return fmt::format("{}, {}", candidate.name, candidate.reading.is_encoded ? "0 to 1" : "-1 to 1");
}

glm::vec3 raw_at(const Planes<3>& planes, int x, int y) {
  return {planes[0](x, y), planes[1](x, y), planes[2](x, y)};
}

bool is_usable(const glm::vec3& raw) {
  return std::isfinite(raw.x) && std::isfinite(raw.y) && std::isfinite(raw.z) &&
         raw != glm::vec3(0.0f);
}

glm::vec2 center_of(int x, int y) {
  return {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
}

// A pixel whose slope is known, and its normal as the file has it.
struct Sample {
  int x = 0, y = 0;
  glm::vec3 raw{0.0f}, slope{0.0f};  // slope: the unit normal from depth, world space
  const Camera* camera = nullptr;
};

std::vector<Sample> sample(std::span<const RawGuides> frames, const DepthReading& depth) {
  std::vector<Sample> samples;
  for (const RawGuides& frame : frames) {
    if (frame.normal[0].empty() || frame.depth.empty() || !frame.camera) continue;
    const DepthSlopes slopes(frame.depth, depth, *frame.camera);
    const Extent extent = frame.extent();
    const int step = grid_step(extent, kSampled);
    for (int y = step / 2; y < extent.height; y += step) {
      for (int x = step / 2; x < extent.width; x += step) {
        Sample sample{x, y, raw_at(frame.normal, x, y), {}, &*frame.camera};
        if (!is_usable(sample.raw) || !slopes.normal_at(x, y, sample.slope)) continue;
        samples.push_back(sample);
      }
    }
  }
  return samples;
}

double angle(const glm::vec3& a, const glm::vec3& b) {
  // The sine of small angles keeps its digits, the cosine does not.
  const double sine = glm::length(glm::cross(a, b)), cosine = glm::dot(a, b);
  return kToDegrees * std::atan2(sine, cosine);
}

using Normals = std::vector<glm::vec3>;

Normals normals_of(const std::vector<Sample>& samples, const NormalReading& reading) {
  Normals normals;
  normals.reserve(samples.size());
  for (const Sample& s : samples) {
    normals.push_back(world_normal(s.raw, reading, s.camera, s.x, s.y));
  }
  return normals;
}

double median_angle(const std::vector<Sample>& samples, const Normals& normals) {
  std::vector<double> angles;
  angles.reserve(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    angles.push_back(angle(samples[i].slope, normals[i]));
  }
  return median(std::move(angles));
}

// Two readings at the pixels where they differ.
struct Contest {
  bool is_told = false;      // there are enough of them
  double share = 1.0;        // where the first is the nearer one
  double other_angle = 0.0;  // median of the other
};

Contest compare(const std::vector<Sample>& samples, const Normals& a, const Normals& b) {
  std::vector<double> other;
  std::size_t nearer = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (angle(a[i], b[i]) < kSameAngle) continue;
    other.push_back(angle(b[i], samples[i].slope));
    if (angle(a[i], samples[i].slope) < other.back()) ++nearer;
  }
  const double count = static_cast<double>(other.size());
  Contest contest;
  contest.is_told =
      other.size() >= kFewest && count >= kFewestShare * static_cast<double>(samples.size());
  if (!contest.is_told) return contest;
  contest.share = static_cast<double>(nearer) / count;
  contest.other_angle = median(std::move(other));
  return contest;
}

// What lengths tell: nothing below 0, and nearer to 1 once decoded.
struct Lengths {
  bool may_be_encoded = false, is_encoded = false;
};

Lengths measure_lengths(std::span<const RawGuides> frames) {
  float least = 0.0f;
  double plain = 0.0, decoded = 0.0;
  for (const RawGuides& frame : frames) {
    if (frame.normal[0].empty()) continue;
    const Extent extent = frame.extent();
    const int step = grid_step(extent, kSampled);
    for (int y = step / 2; y < extent.height; y += step) {
      for (int x = step / 2; x < extent.width; x += step) {
        const glm::vec3 raw = raw_at(frame.normal, x, y);
        if (!is_usable(raw)) continue;
        least = std::min({least, raw.x, raw.y, raw.z});
        plain += std::abs(glm::length(raw) - 1.0f);
        decoded += std::abs(glm::length(2.0f * raw - 1.0f) - 1.0f);
      }
    }
  }
  Lengths lengths;
  lengths.may_be_encoded = least > -0.01f;
  lengths.is_encoded = lengths.may_be_encoded && decoded < plain;
  return lengths;
}

// Finds the best candidate, and the one that comes closest to it.
void judge(const std::vector<Sample>& samples, const std::vector<Candidate>& all, NormalFit& fit) {
  std::vector<Normals> normals;
  for (const Candidate& candidate : all) normals.push_back(normals_of(samples, candidate.reading));
  std::size_t best = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (compare(samples, normals[best], normals[i]).share < 0.5) best = i;
  }
  std::size_t next = best;
  double share = 2.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == best) continue;
    const Contest contest = compare(samples, normals[best], normals[i]);
    if (!contest.is_told || contest.share >= share) continue;
    next = i;
    share = contest.share;
    fit.next_residual = contest.other_angle;
  }
  fit.reading = all[best].reading;
  fit.next = all[next].reading;
  fit.residual = median_angle(samples, normals[best]);
  fit.is_clear = fit.residual < kWorstAngle && share >= kClearShare;
  fit.words = fmt::format("normals are {}{}: {:.1f} degrees from the slope of depth",
                          name_of(all[best]), fit.is_clear ? "" : " (not clear)", fit.residual);
  if (next == best) return;
  fit.words +=
      fmt::format(", {} {:.1f}; the former is nearer at {:.0f} % of the pixels where they differ",
                  name_of(all[next]), fit.next_residual, 100.0 * share);
}

}  // namespace

NormalFit find_normal(std::span<const RawGuides> frames, const DepthReading& depth) {
  NormalFit fit;
  const Lengths lengths = measure_lengths(frames);
  const std::vector<Sample> samples = sample(frames, depth);
  if (samples.size() < kFewest) {
    fit.reading.is_encoded = lengths.is_encoded;
    fit.words = fmt::format(
        "normals are taken to be in world space, {}: no depth and camera to compare them with",
        lengths.is_encoded ? "0 to 1" : "-1 to 1");
    return fit;
  }
  judge(samples, candidates(lengths.may_be_encoded), fit);
  return fit;
}

glm::vec3 world_normal(const glm::vec3& raw, const NormalReading& reading, const Camera* camera,
                       int x, int y, float* length) {
  if (length != nullptr) *length = 0.0f;
  if (!is_usable(raw)) return glm::vec3(0.0f);
  glm::vec3 normal = reading.axes * (reading.is_encoded ? 2.0f * raw - 1.0f : raw);
  const float norm = glm::length(normal);
  if (!std::isfinite(norm) || norm < 1e-6f) return glm::vec3(0.0f);
  if (length != nullptr) *length = norm;
  normal /= norm;
  if (camera == nullptr) return normal;
  const glm::mat3 to_world = glm::transpose(camera->world_to_view);
  if (reading.in_camera_space) normal = to_world * normal;
  const glm::vec3 ray = glm::normalize(to_world * camera->pixel_to_view(center_of(x, y)));
  const float away = glm::dot(normal, ray);
  if (away <= 0.0f) return normal;
  if (away > kSilhouette) return -normal;
  return glm::normalize(normal - away * ray);
}

void apply_normal(const Planes<3>& raw, const NormalReading& reading, const Camera* camera,
                  Planes<3>& normal, Planes<3>& mean) {
  const Extent extent = raw[0].extent();
  ensure_extent(normal, extent);
  ensure_extent(mean, extent);
  for_each_tile(stage_tiles(extent), [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        float length = 0.0f;
        const glm::vec3 unit = world_normal(raw_at(raw, x, y), reading, camera, x, y, &length);
        for (int c = 0; c < 3; ++c) {
          normal[c](x, y) = unit[c];
          mean[c](x, y) = unit[c] * length;
        }
      }
    }
  });
}

}  // namespace eigenlight

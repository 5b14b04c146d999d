// A shot as Cycles writes it, whose light is known: a painted wall that passes the camera.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "frame/random.h"
#include "sequences/exr/exr_write.h"

namespace eigenlight {

struct FakeShot {
  Extent extent{96, 64};
  int speed = 2;       ///< pixels a frame, to the left
  float noise = 0.5f;  ///< of light, over its mean
  int nan_pixels = 0;  ///< first pixels of row 10 whose light is NaN
  bool has_albedo = true;
  bool has_encoded_motion = false;  ///< as colors: 0.5 is still, 1 is 10 pixels

  /// Paint and light of the wall, by its own column.
  [[nodiscard]] static float paint(int u, int y, int c) {
    const float p = 0.37f * static_cast<float>(u) + 0.21f * static_cast<float>((c + 2) * y);
    return 0.5f + 0.2f * std::sin(p) + 0.15f * std::sin(0.618f * p + 0.11f * static_cast<float>(y));
  }
  [[nodiscard]] static float light(int u, int y) {
    return 1.0f +
           0.4f * std::sin(0.04f * static_cast<float>(u)) * std::cos(0.05f * static_cast<float>(y));
  }
  [[nodiscard]] static float glow(int u, int y) { return u % 50 < 4 && y < 8 ? 2.0f : 0.0f; }
  [[nodiscard]] float beauty(int frame, int x, int y, int c) const {
    const int u = x + speed * frame;
    return paint(u, y, c) * light(u, y) + glow(u, y);
  }

  /// Writes a frame: Combined, DiffInd, DiffCol, Emit, Normal, Depth, Vector, a matte that nothing
  /// reads, and ids.
  void write(const std::filesystem::path& path, int frame) const;
};

/// Channels of a file that is being made.
class ShotChannels {
 public:
  explicit ShotChannels(const FakeShot& shot, int frame)
      : shot_(shot), frame_(frame), id_(shot.extent) {
    for (int y = 0; y < shot.extent.height; ++y) {
      for (int x = 0; x < shot.extent.width; ++x) id_(x, y) = 7;
    }
  }

  /// value(x, y, u): u is the column of the wall.
  template <typename Value>
  void add(const std::string& name, const Value& value) {
    Plane<float> plane(shot_.extent);
    for (int y = 0; y < shot_.extent.height; ++y) {
      for (int x = 0; x < shot_.extent.width; ++x) {
        plane(x, y) = value(x, y, x + shot_.speed * frame_);
      }
    }
    planes_.push_back(std::move(plane));
    names_.push_back(name);
  }

  void write(const std::filesystem::path& path) const {
    std::vector<ExrChannel> channels;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      const bool is_float = names_[i] == "matte" || names_[i] == "View.Depth.Z";
      channels.push_back({names_[i], is_float ? ExrType::kFloat : ExrType::kHalf, &planes_[i]});
    }
    channels.push_back({"id", ExrType::kUint, &id_});
    const ExrAttribute attributes[] = {{"note", std::string("kept")}};
    write_exr(path, channels, attributes);
  }

 private:
  const FakeShot& shot_;
  int frame_;
  std::vector<Plane<float>> planes_;
  std::vector<std::string> names_;
  Plane<std::uint32_t> id_;
};

inline void FakeShot::write(const std::filesystem::path& path, int frame) const {
  ShotChannels file(*this, frame);
  const auto noisy = [&](int x, int y, int u) {
    if (y == 10 && x < nan_pixels) return std::numeric_limits<float>::quiet_NaN();
    const float draw = to_unit(hash_key(static_cast<std::uint32_t>(frame), x, y));
    return light(u, y) * (1.0f + noise * (2.0f * draw - 1.0f));
  };
  for (int c = 0; c < 3; ++c) {
    const std::string letter(1, "RGB"[c]), axis(1, "XYZ"[c]);
    file.add("View.Combined." + letter,
             [&](int x, int y, int u) { return paint(u, y, c) * noisy(x, y, u) + glow(u, y); });
    if (has_albedo) {
      file.add("View.DiffInd." + letter, noisy);
      file.add("View.DiffCol." + letter, [&](int, int y, int u) { return paint(u, y, c); });
      file.add("View.Emit." + letter, [&](int, int y, int u) { return glow(u, y); });
    }
    file.add("View.Normal." + axis, [&](int, int, int) { return c == 2 ? 1.0f : 0.0f; });
  }
  file.add("View.Combined.A", [](int, int, int) { return 1.0f; });
  file.add("View.Depth.Z", [](int, int, int) { return 5.0f; });
  const float zero = has_encoded_motion ? 0.5f : 0.0f, unit = has_encoded_motion ? 0.05f : 1.0f;
  file.add("View.Vector.X", [&](int, int, int) { return zero + unit * static_cast<float>(speed); });
  file.add("View.Vector.Y", [&](int, int, int) { return zero; });
  file.add("matte", [](int x, int y, int) { return 0.1f * static_cast<float>(x * y); });
  file.write(path);
}

}  // namespace eigenlight

// Small sequences of EXR files, to be evaluated.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sequences/files/exr_io.h"
#include "sequences/files/perturbation.h"
#include "sequences/metrics/evaluate.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {

inline constexpr Extent kFakeSize{16, 8};

/// An image of one color.
struct FakeImage {
  float value = 0.5f;
  std::string layer = "indirect.";  ///< with the dot; empty: bare R, G, B
  Extent extent = kFakeSize;
  bool has_masks = false;
  float first_pixel = -1.0f;  ///< replaces `value` at (0, 1), unless -1
  std::string perturb = {};   ///< attribute of the file; empty: none
};

/// Masks: the left half has age 1, the right half age 9; the upper row has no surface.
inline void write_fake_image(const std::filesystem::path& path, const FakeImage& fake) {
  Plane<float> color(fake.extent), age(fake.extent);
  color.fill(fake.value);
  if (fake.first_pixel != -1.0f) color(0, 1) = fake.first_pixel;
  Plane<std::uint32_t> id(fake.extent);
  for (int y = 1; y < fake.extent.height; ++y) {
    for (int x = 0; x < fake.extent.width; ++x) {
      id(x, y) = 1;
      age(x, y) = x < fake.extent.width / 2 ? 1.0f : 9.0f;
    }
  }
  std::vector<ExrChannel> channels;
  for (const char* c : {"R", "G", "B"}) {
    channels.push_back({fake.layer + c, ExrType::kFloat, &color});
  }
  if (fake.has_masks) {
    channels.push_back({"id", ExrType::kUint, &id});
    channels.push_back({"age", ExrType::kFloat, &age});
  }
  std::vector<ExrAttribute> attributes;
  if (!fake.perturb.empty()) attributes.push_back({kPerturbAttribute, fake.perturb});
  write_exr(path, channels, attributes);
}

class EvaluateTest : public testing::Test {
 protected:
  // Frames 1-3: test 0.75 with masks against 0.5.
  void SetUp() override {
    for (const char* frame : {"0001", "0002", "0003"}) {
      write_fake_image(file("t", frame), {.value = 0.75f, .has_masks = true});
      write_fake_image(file("r", frame), {});
    }
  }
  std::filesystem::path file(const std::string& name, const std::string& frame) const {
    return dir_ / (name + "." + frame + ".exr");
  }
  EvaluateOptions options() const {
    EvaluateOptions o;
    o.test = file("t", "####").string();
    o.reference = file("r", "####").string();
    return o;
  }
  void expect_failure(const EvaluateOptions& o, const testing::Matcher<std::string>& what) const {
    EXPECT_THAT([&] { (void)evaluate(o); }, testing::ThrowsMessage<std::runtime_error>(what));
  }

  TempDir dir_;
};

// A step from 0.25 to 0.5 at frame 5, which the test follows by halves.
class EvaluateStepTest : public EvaluateTest {
 protected:
  void SetUp() override {
    float missing = 0.25f;
    for (int frame = 4; frame <= 10; ++frame) {
      const std::string number = fmt::format("{:04}", frame);
      const float light = frame < 5 ? 0.25f : 0.5f;
      if (frame >= 5) missing *= 0.5f;
      write_fake_image(file("t", number), {.value = frame < 5 ? light : light - missing});
      write_fake_image(file("r", number), {.value = light});
      write_fake_image(file("h", number), {.value = light, .perturb = "step:5"});
    }
  }
};

}  // namespace eigenlight

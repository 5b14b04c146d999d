#include "sequences/runs/frame_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "temporal/baselines/frame_by_frame.h"
#include "tests/support/analytic_source.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

// One frame of an analytic source, its indirect light doubled in place of a denoiser.
struct Example {
  explicit Example(AnalyticOptions options = {}) {
    AnalyticSource source(std::move(options));
    if (!source.next(frame)) throw std::logic_error("no frame");
    indirect = make_planes<3>(frame.extent());
    age = Plane<float>(frame.extent());
    age.fill(5.0f);
    for (std::size_t c = 0; c < 3; ++c) {
      for (int y = 0; y < frame.extent().height; ++y) {
        for (int x = 0; x < frame.extent().width; ++x) {
          indirect[c](x, y) = 2.0f * frame.lights[0].radiance[c](x, y);
        }
      }
    }
  }
  Frame frame;
  Planes<3> indirect;
  Plane<float> age;
};

// v M of a point, divided by w.
glm::vec3 transform(const ExrMatrix& matrix, const glm::vec3& point) {
  const float v[4] = {point.x, point.y, point.z, 1.0f};
  float out[4] = {};
  for (std::size_t j = 0; j < 4; ++j) {
    for (std::size_t i = 0; i < 4; ++i) out[j] += v[i] * matrix[4 * i + j];
  }
  return glm::vec3(out[0], out[1], out[2]) / out[3];
}

TEST(FrameWriter, LayersAddUpToTheColor) {
  const TempDir dir;
  AnalyticOptions options;
  options.sky_columns = 9;
  options.first_frame = 7;
  const Example example(options);
  FrameWriter writer(dir.path(), parse_layers(""), {});
  writer.write({example.frame, example.indirect, example.age});
  const ExrReader reader(dir / "frame.0007.exr");
  const auto color = reader.read_planes<3>("");
  const auto indirect = reader.read_planes<3>("indirect");
  const auto noisy = reader.read_planes<3>("noisy");
  const auto direct = reader.read_planes<3>("direct");
  const auto emission = reader.read_planes<3>("emission");
  for (std::size_t c = 0; c < 3; ++c) {
    for (int y = 0; y < 36; ++y) {
      for (int x = 0; x < 64; ++x) {
        const float sum = direct[c](x, y) + indirect[c](x, y) + emission[c](x, y);
        ASSERT_NEAR(color[c](x, y), sum, 2e-3f * sum);
        ASSERT_NEAR(indirect[c](x, y), 2.0f * noisy[c](x, y), 2e-3f);
        const float truth = example.frame.surface.albedo[c](x, y) * example.indirect[c](x, y);
        ASSERT_NEAR(indirect[c](x, y), truth, 1e-3f * truth);
      }
    }
  }
  EXPECT_TRUE(std::isinf(reader.read("Z")[0](0, 0)));
  EXPECT_EQ(reader.read("Z")[0](20, 20), AnalyticSource::kDepth);
  EXPECT_EQ(reader.read("age")[0](20, 20), 5.0f);
  EXPECT_EQ(reader.read("N").size(), 3u);
  EXPECT_EQ(reader.read("motion").size(), 2u);
  EXPECT_EQ(reader.read_uint("id")(20, 20), 1u);
  EXPECT_EQ(reader.read("P")[0](20, 20), example.frame.position[0](20, 20));
}

TEST(FrameWriter, PictureReplacesTheComposedColor) {
  const TempDir dir;
  const Example example;
  Planes<3> picture = make_planes<3>(example.frame.extent());
  picture[1].fill(0.375f);
  FrameWriter writer(dir.path(), parse_layers("color,direct"), {});
  writer.write({example.frame, example.indirect, example.age, &picture});
  const ExrReader reader(dir / "frame.0000.exr");
  const auto color = reader.read_planes<3>("");
  EXPECT_EQ(color[0](20, 20), 0.0f);
  EXPECT_EQ(color[1](20, 20), 0.375f);
  EXPECT_GT(reader.read_planes<3>("direct")[0](20, 20), 0.0f);
}

TEST(FrameWriter, DenoisedDirectLightStandsBesideTheNoisy) {
  const TempDir dir;
  const Example example;
  Planes<3> direct = make_planes<3>(example.frame.extent());
  for (auto& plane : direct) plane.fill(2.0f);
  FrameWriter all(dir.path(), parse_layers(""), {});
  all.write({example.frame, example.indirect, example.age, nullptr, &direct});
  const ExrReader reader(dir / "frame.0000.exr");
  const auto shown = reader.read_planes<3>("direct"), noisy = reader.read_planes<3>("noisy_direct");
  const auto color = reader.read_planes<3>(""), indirect = reader.read_planes<3>("indirect");
  const float albedo = example.frame.surface.albedo[1](20, 20);
  EXPECT_NEAR(shown[1](20, 20), 2.0f * albedo, 2e-3f);
  EXPECT_NEAR(noisy[1](20, 20), example.frame.direct[1](20, 20) * albedo, 1e-3f);
  const float emission = example.frame.emission[1](20, 20);
  EXPECT_NEAR(color[1](20, 20), shown[1](20, 20) + indirect[1](20, 20) + emission, 4e-3f);
}

TEST(FrameWriter, ValuesBeyondHalfAreWrittenAsFloat) {
  const TempDir dir;
  Example example;
  example.frame.emission[1](2, 3) = 1e6f;
  example.frame.lights[0].radiance[0](4, 5) = std::numeric_limits<float>::quiet_NaN();
  example.frame.lights[0].radiance[0](5, 5) = std::numeric_limits<float>::infinity();
  FrameWriter writer(dir.path(), parse_layers(""), {});
  writer.write({example.frame, example.indirect, example.age});
  const ExrReader reader(dir / "frame.0000.exr");
  EXPECT_EQ(reader.read("emission")[1](2, 3), 1e6f);
  EXPECT_GT(reader.read("color")[1](2, 3), 1e6f);
  EXPECT_TRUE(std::isnan(reader.read("noisy")[0](4, 5)));
  EXPECT_TRUE(std::isinf(reader.read("noisy")[0](5, 5)));
}

TEST(FrameWriter, WritesOnlyTheChosenLayers) {
  const TempDir dir;
  const Example example;
  FrameWriter writer(dir.path(), parse_layers("noisy,Z,noisy"), {{"eigenlight.spp", 3}});
  writer.write({example.frame, example.indirect, example.age});
  const ExrReader reader(dir / "frame.0000.exr");
  EXPECT_THAT(reader.layers(), testing::UnorderedElementsAre("noisy", "Z"));
  EXPECT_EQ(std::get<int>(*reader.attribute("eigenlight.spp")), 3);
  EXPECT_EQ(std::get<int>(*reader.attribute("eigenlight.frame")), 0);
  EXPECT_THAT([] { (void)parse_layers("noisy,depth"); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("unknown layer 'depth'; known: color, indirect, noisy")));
  EXPECT_EQ(format_layers(parse_layers("Z,color")), "color,Z");
}

TEST(FrameWriter, CameraMatricesFollowOpenExr) {
  const Extent extent{64, 36};
  const Camera camera = look_at({3, 2, 5}, {0, 1, -1}, {0, 1, 0}, 40.0f, extent);
  const glm::vec3 forward = glm::normalize(glm::vec3(0, 1, -1) - camera.eye);
  // The camera looks along +z of its space, y up.
  const glm::vec3 ahead = transform(world_to_camera(camera), camera.eye + 2.0f * forward);
  EXPECT_NEAR(ahead.x, 0.0f, 1e-5f);
  EXPECT_NEAR(ahead.y, 0.0f, 1e-5f);
  EXPECT_NEAR(ahead.z, 2.0f, 1e-5f);
  const glm::vec3 above =
      transform(world_to_camera(camera), camera.eye + forward + glm::vec3(0, 0.1f, 0));
  EXPECT_GT(above.y, 0.05f);
  // NDC is the pixel over the size of the image.
  for (const glm::vec3 point :
       {glm::vec3(0, 1, -1), glm::vec3(0.5f, 0.2f, 0), glm::vec3(-1, 2, 1)}) {
    const glm::vec2 pixel = camera.view_to_pixel(camera.to_view(point));
    const glm::vec3 ndc = transform(world_to_ndc(camera, extent), point);
    EXPECT_NEAR(ndc.x, pixel.x / 64.0f, 1e-5f);
    EXPECT_NEAR(ndc.y, pixel.y / 36.0f, 1e-5f);
  }
}

}  // namespace
}  // namespace eigenlight

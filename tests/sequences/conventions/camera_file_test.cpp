#include "sequences/conventions/camera_file.h"

#include <gmock/gmock.h>

#include <fstream>
#include <string>

#include "frame/bad_file.h"
#include "tests/support/temp_dir.h"

namespace eigenlight {
namespace {

using ::testing::HasSubstr;

// A camera at (1, 2, 3) that looks along -z, for pictures of 2 : 1, shifted to the right by a tenth
// of the width.
constexpr const char* kGood = R"({"width": 200, "height": 100, "fps": 24, "frames": {
  "3": {"camera_to_world": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]],
        "projection": [[1.5,0,0.2,0],[0,3,0,0],[0,0,-1,-0.1],[0,0,-1,0]]},
  "-1": {"camera_to_world": [[0,0,1,0],[1,0,0,0],[0,1,0,0],[0,0,0,1]],
         "projection": [[1.5,0,0,0],[0,3,0,0],[0,0,-1,-0.1],[0,0,-1,0]]}}})";

class CameraFileTest : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const std::filesystem::path path = directory_.path() / "shot.camera.json";
    std::ofstream(path) << text;
    return path;
  }
  std::string error_of(const std::string& text) {
    try {
      const CameraFile file(write(text));
    } catch (const BadFile& error) {
      return error.what();
    }
    return "";
  }
  static std::string replaced(const char* from, const char* to) {
    std::string text = kGood;
    return text.replace(text.find(from), std::string(from).size(), to);
  }

  TempDir directory_;
};

TEST_F(CameraFileTest, ReadsBlendersCameras) {
  const CameraFile file(write(kGood));
  const auto camera = file.camera(3, {400, 200});
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->eye, glm::vec3(1, 2, 3));
  EXPECT_FLOAT_EQ(camera->focal, 300.0f);
  // A point straight ahead: x of NDC is -.2, so .4 of the width.
  const glm::vec2 ahead = camera->view_to_pixel(camera->to_view({1, 2, -7}));
  EXPECT_NEAR(ahead.x, 160.0f, 1e-3f);
  EXPECT_NEAR(ahead.y, 100.0f, 1e-3f);
  // Up is up: .5 over 10 times 300 pixels.
  EXPECT_NEAR(camera->view_to_pixel(camera->to_view({1, 2.5f, -7})).y, 85.0f, 1e-3f);
  const auto turned = file.camera(-1, {200, 100});
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->to_view({-5, 1, 2}), glm::vec3(1, -2, 5));
}

TEST_F(CameraFileTest, HasNoCameraForOtherFrames) {
  EXPECT_EQ(CameraFile(write(kGood)).camera(4, {200, 100}), std::nullopt);
}

TEST_F(CameraFileTest, RefusesFramesOfAnotherAspect) {
  const CameraFile file(write(kGood));
  try {
    (void)file.camera(3, {160, 90});
    FAIL() << "no error";
  } catch (const BadFile& error) {
    EXPECT_THAT(error.what(), HasSubstr("shot.camera.json: frames.3.projection: "));
    EXPECT_THAT(error.what(), HasSubstr("aspect 2, but the frames are 160x90 (1.778)"));
  }
}

TEST_F(CameraFileTest, NamesFileFieldAndFault) {
  EXPECT_THAT(error_of("{"), HasSubstr("shot.camera.json: JSON: "));
  EXPECT_THAT(error_of("[]"), HasSubstr("expected an object"));
  EXPECT_THAT(error_of("{}"), HasSubstr("frames: is missing"));
  EXPECT_THAT(error_of(replaced("\"3\"", "\"three\"")),
              HasSubstr("frames.three: expected a frame"));
  EXPECT_THAT(error_of(replaced("\"projection\"", "\"lens\"")),
              HasSubstr(".projection: is missing, expected 4 rows of 4 numbers"));
  EXPECT_THAT(error_of(replaced("[1,0,0,1],", "[1,0,0],")),
              HasSubstr("frames.3.camera_to_world: row 0: expected 4 numbers"));
  EXPECT_THAT(error_of(replaced("[1,0,0,1],", "[1,0,\"x\",1],")),
              HasSubstr("row 0, column 2: expected a number within 1e15"));
  EXPECT_THAT(error_of(replaced("[1,0,0,1],", "[1,0,1e300,1],")),
              HasSubstr("row 0, column 2: expected a number within 1e15"));
  EXPECT_THAT(error_of(replaced("[1,0,0,1],", "[1,0.5,0,1],")),
              HasSubstr("frames.3.camera_to_world: its first three columns"));
  EXPECT_THAT(error_of(replaced("[0,0,-1,0]]}", "[0,0,0,1]]}")),
              HasSubstr("expected a perspective projection"));
}

TEST_F(CameraFileTest, SaysThatAFileCannotBeRead) {
  EXPECT_THROW(CameraFile(directory_.path() / "none.json"), std::runtime_error);
}

// Numbers that float, or any picture, cannot hold.
TEST_F(CameraFileTest, LensesThatNoCameraHasAreRefused) {
  for (const char* lens : {"[[1e15,0,0,0],[0,1e15,0,0],[0,0,-1,0],[0,0,-1e-30,0]]",
                           "[[1.5,0,1e15,0],[0,3,0,0],[0,0,-1,-0.1],[0,0,-1,0]]",
                           "[[1e-300,0,0,0],[0,1e-300,0,0],[0,0,-1,0],[0,0,-1,0]]",
                           "[[1.5,0,0,0],[0,1e-9,0,0],[0,0,-1,-0.1],[0,0,-1,0]]"}) {
    const std::string error =
        error_of(replaced("[[1.5,0,0.2,0],[0,3,0,0],[0,0,-1,-0.1],[0,0,-1,0]]", lens));
    EXPECT_THAT(error, HasSubstr("frames.3.projection: a lens of ")) << lens;
  }
}

}  // namespace
}  // namespace eigenlight

// Files that are no plain pictures: cropped, gray, in other primaries, with masks that come and go.
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenImageIO/imagebufalgo.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frame/bad_file.h"
#include "sequences/exr/exr_rewrite.h"
#include "sequences/metrics/evaluate.h"
#include "tests/support/exr_maker.h"
#include "tests/support/fake_images.h"

namespace eigenlight {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

const Imath::Box2i kDisplay(Imath::V2i(10, 20), Imath::V2i(57, 51));  // 48x32

Imf::Header header(const Imath::Box2i& data, const std::vector<std::string>& channels) {
  Imf::Header made = exr_header(kDisplay, data, Imf::ZIP_COMPRESSION);
  for (const std::string& name : channels) made.channels().insert(name, Imf::Channel(Imf::FLOAT));
  return made;
}

// All channels have one value.
void write_flat(const std::filesystem::path& path, const Imf::Header& made, float value) {
  const std::filesystem::path random = path.string() + ".random";
  ExrMaker::write(random, made);
  const ExrFile file(random);
  const ExrWindow& window = file.parts()[0].data;
  Plane<float> plane({window.width, window.height});
  plane.fill(value);
  std::vector<ExrReplacement> pixels;
  for (std::size_t i = 0; i < file.channels().size(); ++i) {
    pixels.push_back({static_cast<int>(i), &plane});
  }
  rewrite_exr(file, path, pixels);
}

class EvaluateKinds : public testing::Test {
 protected:
  Evaluation compare(const std::string& layer = "color") const {
    EvaluateOptions o;
    o.test = (dir_ / "t.exr").string();
    o.reference = (dir_ / "r.exr").string();
    o.layer = layer;
    return evaluate(o);
  }
  TempDir dir_;
};

TEST_F(EvaluateKinds, OnlyPixelsThatBothFilesHaveCount) {
  const Imath::Box2i crop(Imath::V2i(12, 24), Imath::V2i(31, 39));  // 20x16
  const Imath::Box2i beyond(Imath::V2i(22, 0), Imath::V2i(90, 90));
  write_flat(dir_ / "t.exr", header(crop, {"R", "G", "B"}), 0.75f);
  write_flat(dir_ / "r.exr", header(beyond, {"R", "G", "B"}), 0.5f);
  const Evaluation e = compare();
  EXPECT_EQ(e.frames[0][PixelSet::kSurface].pixels, 10 * 16);
  EXPECT_EQ(e.outside_pixels, 48 * 32 - 10 * 16);
  EXPECT_EQ(e.bad_pixels, 0);
  EXPECT_NEAR(e.mean[0][Metric::kMse].value(), 0.0625, 1e-12);
  EXPECT_NEAR(e.mean[0][Metric::kLight].value(), 0.75, 1e-12);
}

TEST_F(EvaluateKinds, WithoutACommonPixelNothingIsCompared) {
  const Imath::Box2i left(Imath::V2i(10, 20), Imath::V2i(20, 30)),
      away(Imath::V2i(100, 100), Imath::V2i(110, 110));
  write_flat(dir_ / "t.exr", header(left, {"R", "G", "B"}), 0.75f);
  write_flat(dir_ / "r.exr", header(away, {"R", "G", "B"}), 0.75f);
  EXPECT_THAT([&] { (void)compare(); },
              ThrowsMessage<BadFile>(
                  AllOf(HasSubstr("t.exr: no pixel lies in its data window"), HasSubstr("r.exr"))));
}

TEST_F(EvaluateKinds, ALayerOfOneChannelIsGray) {
  write_flat(dir_ / "t.exr", header(kDisplay, {"Y"}), 0.75f);
  write_flat(dir_ / "r.exr", header(kDisplay, {"Y"}), 0.5f);
  for (const char* layer : {"Y", "color"}) {
    EXPECT_NEAR(compare(layer).mean[0][Metric::kMse].value(), 0.0625, 1e-12);
  }
  write_flat(dir_ / "r.exr", header(kDisplay, {"mv.X", "mv.Y"}), 0.5f);
  EXPECT_THAT([&] { (void)compare("mv"); }, ThrowsMessage<BadFile>(HasSubstr("no layer 'mv'")));
  write_flat(dir_ / "t.exr", header(kDisplay, {"mv.X", "mv.Y"}), 0.5f);
  EXPECT_THAT([&] { (void)compare("mv"); },
              ThrowsMessage<BadFile>(HasSubstr("layer 'mv' has 2 channels, expected 3")));
}

TEST_F(EvaluateKinds, OtherPrimariesAreNoted) {
  write_flat(dir_ / "r.exr", header(kDisplay, {"R", "G", "B"}), 0.5f);
  write_flat(dir_ / "t.exr", header(kDisplay, {"R", "G", "B"}), 0.5f);
  EXPECT_THAT(compare().notes, IsEmpty());
  Imf::Header wide = header(kDisplay, {"R", "G", "B"});
  Imf::addChromaticities(wide, Imf::Chromaticities());  // those of Rec. 709
  write_flat(dir_ / "t.exr", wide, 0.5f);
  EXPECT_THAT(compare().notes, IsEmpty());
  Imf::addChromaticities(wide, {{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}});
  write_flat(dir_ / "t.exr", wide, 0.5f);
  EXPECT_THAT(compare().notes, ElementsAre(AllOf(HasSubstr("the primaries of "), HasSubstr("t.exr"),
                                                 HasSubstr("differ"))));
}

// A header of a few hundred bytes.
TEST_F(EvaluateKinds, AHugeDisplayWindowIsNamedBeforeMemoryIsTaken) {
  write_flat(dir_ / "t.exr", header(kDisplay, {"R", "G", "B"}), 0.5f);
  const Imath::Box2i few(Imath::V2i(0, 0), Imath::V2i(7, 7));
  for (const auto& [side, words] :
       {std::pair{65536, "needs about 103 GB of memory"}, {100000, "expected sides of at most"}}) {
    const Imath::Box2i huge(Imath::V2i(0, 0), Imath::V2i(side - 1, side - 1));
    Imf::Header made = exr_header(huge, few, Imf::ZIP_COMPRESSION);
    for (const char* c : {"R", "G", "B"}) made.channels().insert(c, Imf::Channel(Imf::FLOAT));
    write_flat(dir_ / "r.exr", made, 0.5f);
    EXPECT_THAT([&] { (void)compare(); },
                ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("r.exr: "), HasSubstr(words))));
  }
}

TEST_F(EvaluateTest, MasksThatEndAreTold) {
  write_fake_image(file("t", "0003"), {.value = 0.75f});
  const Evaluation e = evaluate(options());
  EXPECT_EQ(e.surface_from, "test id in frames 1-2, all pixels in 3");
  EXPECT_EQ(e.age_from, "test age in frames 1-2, nowhere in 3");
}

// An `id` of floats, a depth of integers: nobody asked for them.
TEST_F(EvaluateTest, MasksOfAnotherTypeAreNotUsed) {
  Plane<float> color(kFakeSize);
  Plane<std::uint32_t> numbers(kFakeSize);
  const ExrChannel channels[] = {
      {"indirect.R", ExrType::kFloat, &color}, {"indirect.G", ExrType::kFloat, &color},
      {"indirect.B", ExrType::kFloat, &color}, {"id", ExrType::kFloat, &color},
      {"Z", ExrType::kUint, &numbers},         {"age", ExrType::kUint, &numbers}};
  write_exr(file("t", "0001"), channels, {});
  EvaluateOptions o = options();
  o.frames = "1";
  const Evaluation e = evaluate(o);
  EXPECT_EQ(e.surface_from, "all pixels");
  EXPECT_EQ(e.age_from, "");
}

TEST_F(EvaluateTest, MessagesTellTheImageFromTheSequence) {
  EvaluateOptions o = options();
  o.test = file("t", "0001").string();
  EXPECT_THAT([&] { (void)evaluate(o); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("t.0001.exr' is one image"),
                                                         HasSubstr("r.####.exr' is a sequence"))));
  std::swap(o.test, o.reference);
  EXPECT_THAT([&] { (void)evaluate(o); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("t.0001.exr' is one image"),
                                                         HasSubstr("r.####.exr' is a sequence"))));
}

TEST_F(EvaluateTest, AlphaOfPicturesIsLeftOut) {
  const auto write = [&](const char* name, int channels) {
    OIIO::ImageBuf picture(
        OIIO::ImageSpec(kFakeSize.width, kFakeSize.height, channels, OIIO::TypeUInt8));
    const float color[4] = {0.6f, 0.4f, 0.2f, 0.25f};
    OIIO::ImageBufAlgo::fill(picture, color);
    picture.specmod().attribute("oiio:UnassociatedAlpha", 1);
    ASSERT_TRUE(picture.write((dir_ / name).string()));
  };
  write("alpha.png", 4);
  write("opaque.png", 3);
  EvaluateOptions o;
  o.test = (dir_ / "alpha.png").string();
  o.reference = (dir_ / "opaque.png").string();
  EXPECT_EQ(evaluate(o).mean[0][Metric::kMse].value(), 0.0);
  EXPECT_NEAR(evaluate(o).mean[0][Metric::kLight].value(), 0.4, 1e-6);
}

}  // namespace
}  // namespace eigenlight

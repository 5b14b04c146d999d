#include "sequences/denoise/file_headers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frame/bad_file.h"
#include "sequences/layers/layer_list.h"

namespace eigenlight {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

FileHeader file(const std::string& name, ExrWindow data) {
  FileHeader made;
  made.path = name;
  made.display = {0, 0, 64, 48};
  made.parts.emplace_back();
  made.parts.back().data = data;
  for (const char* channel : {"B", "G", "R", "Z"}) {
    made.channels.emplace_back();
    made.channels.back().name = made.channels.back().full_name = channel;
  }
  return made;
}

LayerPlan plan_of(const FileHeader& header) {
  return plan_layers(list_layers(header.channels, header.parts, 0), {});
}

TEST(FileHeaders, TheCanvasHoldsTheWindowsOfAllFrames) {
  const std::vector<FrameHeaders> headers{{file("a.exr", {-4, 2, 10, 10})},
                                          {file("b.exr", {20, 0, 5, 50})}};
  const ExrWindow canvas = find_canvas(headers, plan_of(headers[0][0]));
  EXPECT_EQ(canvas, (ExrWindow{-4, 0, 29, 50}));
}

TEST(FileHeaders, AFrameWithoutALayerIsNamedBeforeTheRun) {
  std::vector<FrameHeaders> headers{{file("a.exr", {0, 0, 4, 4})}, {file("b.exr", {0, 0, 4, 4})}};
  const LayerPlan plan = plan_of(headers[0][0]);
  EXPECT_NO_THROW(check_layers(headers, plan));
  headers[1][0].channels.pop_back();
  EXPECT_THAT(
      [&] { check_layers(headers, plan); },
      ThrowsMessage<BadFile>(HasSubstr("b.exr: no channel 'Z', which the first frame has")));
}

TEST(FileHeaders, OtherPrimariesAreOneLine) {
  const ExrChromaticities rec709{{0.64f, 0.33f}, {0.3f, 0.6f}, {0.15f, 0.06f}, {0.3127f, 0.329f}};
  const ExrChromaticities acescg{
      {0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}};
  std::vector<FrameHeaders> headers;
  for (const char* name : {"a.exr", "b.exr", "c.exr", "d.exr"}) {
    headers.push_back({file(name, {0, 0, 4, 4})});
  }
  headers[1][0].chromaticities = rec709;  // what files without the attribute have
  EXPECT_EQ(other_primaries(headers), "");
  headers[2][0].chromaticities = headers[3][0].chromaticities = acescg;
  EXPECT_THAT(other_primaries(headers),
              HasSubstr("2 of 4 files have other primaries than a.exr, the first of them c.exr"));
}

}  // namespace
}  // namespace eigenlight

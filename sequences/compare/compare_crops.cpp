#include "sequences/compare/compare_crops.h"

#include <algorithm>
#include <vector>

#include "sequences/pages/tone_map.h"

namespace eigenlight {
namespace {

constexpr int kGap = 4;           // pixels between crops
constexpr int kUsualWidth = 288;  // of an enlarged crop: five stand side by side on a screen

// Copies the rectangle of `picture` to (x0, y0) of `out`, each pixel `factor` times as large.
void paste(const Plane<std::uint8_t>& picture, const CropPlan& crop, int factor, int x0, int y0,
           Plane<std::uint8_t>& out) {
  for (int y = 0; y < factor * crop.size.height; ++y) {
    for (int x = 0; x < factor * crop.size.width; ++x) {
      const std::uint8_t* from = picture.at(crop.x + x / factor, crop.y + y / factor);
      std::copy(from, from + 3, out.at(x0 + x, y0 + y));
    }
  }
}

}  // namespace

Plane<std::uint8_t> crop_rows(const ComparePictures& pictures) {
  const CropPlan& crop = *pictures.plan.crop;
  const int frame = pictures.plan.measured.back();
  const ToneMap screen(pictures.exposure);
  std::vector<Plane<std::uint8_t>> shown;
  for (const Contender& contender : pictures.plan.contenders) {
    shown.push_back(screen.apply(pictures.output(contender, frame), 1));
  }
  shown.push_back(screen.apply(pictures.reference(frame), 1));

  const int count = static_cast<int>(shown.size());
  const int columns = crop.per_row > 0 ? std::min(crop.per_row, count) : count;
  const int rows = (count + columns - 1) / columns;
  const int factor = std::max(kUsualWidth / crop.size.width, 1);
  const int width = factor * crop.size.width, height = factor * crop.size.height;
  Plane<std::uint8_t> out({columns * (width + kGap) - kGap, rows * (height + kGap) - kGap}, 3);
  for (int i = 0; i < count; ++i) {
    paste(shown[static_cast<std::size_t>(i)], crop, factor, i % columns * (width + kGap),
          i / columns * (height + kGap), out);
  }
  return out;
}

std::string crop_names(const ComparePlan& plan) {
  std::string names;
  for (const Contender& contender : plan.contenders) names += contender.label + ", ";
  return names + "reference";
}

}  // namespace eigenlight

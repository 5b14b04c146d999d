#include "temporal/gather/light_record.h"

#include <cmath>

#include "frame/check.h"
#include "frame/luminance.h"
#include "frame/tiles.h"

namespace eigenlight {
namespace {

void write_record(const Planes<3>& light, const Planes<3>& pilot, const Plane<float>& variance,
                  const Plane<PackedGuide>& guides, LightRecord& record) {
  ensure_extent(record, guides.extent());
  parallel_for(guides.height(), [&](int y) {
    for (int x = 0; x < guides.width(); ++x) {
      const float r = light[0](x, y), g = light[1](x, y), b = light[2](x, y);
      RecordedLight& to = record(x, y);
      to = {};
      if (!shows_surface(guides(x, y)) || !std::isfinite(r + g + b)) continue;
      const float mean = luminance(pilot, x, y);
      const float d = luminance(r, g, b) - mean;
      to = {r, g, b, mean, variance(x, y), d * d, 1.0f, 0.0f};
    }
  });
}

}  // namespace

LightRecorder::LightRecorder(Extent extent, int layers, const SoftAtrousOptions& filter,
                             float sigmas)
    : sigmas_(sigmas), filter_(extent, filter) {
  for (int i = 0; i < layers; ++i) {
    pilots_.push_back(make_planes<3>(extent));
    variances_.emplace_back(extent);
  }
}

void LightRecorder::record(const FrameInput& frame, const Plane<PackedGuide>& guides,
                           std::span<LightRecord> records) {
  EL_CHECK(frame.lights.size() == pilots_.size() && records.size() == pilots_.size(),
           "{} layers of light, expected {}", frame.lights.size(), pilots_.size());
  std::vector<SoftLayer> layers;
  for (std::size_t i = 0; i < pilots_.size(); ++i) {
    copy_planes(frame.lights[i].radiance, pilots_[i]);
    variance_of_frame(frame, frame.lights[i].radiance, variances_[i]);
    layers.push_back({&pilots_[i], &variances_[i], sigmas_});
  }
  filter_.process(guides, layers);
  for (std::size_t i = 0; i < pilots_.size(); ++i) {
    write_record(frame.lights[i].radiance, pilots_[i], variances_[i], guides, records[i]);
  }
}

}  // namespace eigenlight

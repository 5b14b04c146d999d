#include "sequences/runs/frame_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sequences/files/compose.h"

namespace eigenlight {
namespace {

constexpr std::array<std::string_view, 13> kLayerNames{
    "color", "indirect", "noisy", "direct", "noisy_direct", "emission", "albedo",
    "N",     "Z",        "P",     "motion", "id",           "age"};
constexpr float kLargestHalf = 65504.0f;

std::string_view name_of(Layer layer) { return kLayerNames[static_cast<std::size_t>(layer)]; }

[[nodiscard]] bool exceeds_half(const Plane<float>& plane) {
  for (int y = 0; y < plane.height(); ++y) {
    const float* row = plane.row(y);
    for (int x = 0; x < plane.width(); ++x) {
      // Half can hold NaN, which compares false, and Inf.
      if (std::isgreater(std::abs(row[x]), kLargestHalf) && !std::isinf(row[x])) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<Layer> parse_layers(std::string_view text) {
  std::array<bool, kLayerNames.size()> chosen{};
  if (text.empty()) chosen.fill(true);
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t comma = rest.find(',');
    const std::string_view name = rest.substr(0, comma);
    const auto known = std::find(kLayerNames.begin(), kLayerNames.end(), name);
    EL_CHECK(known != kLayerNames.end(), "unknown layer '{}'; known: {}", name,
             fmt::format("{}", fmt::join(kLayerNames, ", ")));
    chosen[static_cast<std::size_t>(known - kLayerNames.begin())] = true;
    rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
  }
  std::vector<Layer> layers;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (chosen[i]) layers.push_back(static_cast<Layer>(i));
  }
  return layers;
}

std::string format_layers(const std::vector<Layer>& layers) {
  std::vector<std::string_view> names;
  for (const Layer layer : layers) names.push_back(name_of(layer));
  return fmt::format("{}", fmt::join(names, ","));
}

ExrMatrix world_to_camera(const Camera& camera) {
  // Row j of the view rotation is column j here; our y points down, that of OpenEXR up.
  const glm::vec3 offset = camera.to_view(glm::vec3(0.0f));
  const float sign[3] = {1.0f, -1.0f, 1.0f};
  ExrMatrix matrix{};
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      matrix[static_cast<std::size_t>(4 * i + j)] = sign[j] * camera.world_to_view[i][j];
    }
    matrix[static_cast<std::size_t>(12 + j)] = sign[j] * offset[j];
  }
  matrix[15] = 1.0f;
  return matrix;
}

ExrMatrix world_to_ndc(const Camera& camera, Extent extent) {
  const glm::vec3 offset = camera.to_view(glm::vec3(0.0f));
  const glm::vec2 size(static_cast<float>(extent.width), static_cast<float>(extent.height));
  ExrMatrix matrix{};
  for (int i = 0; i < 4; ++i) {
    const glm::vec3 view = i < 3 ? camera.world_to_view[i] : offset;
    const glm::vec2 pixel = (camera.focal * glm::vec2(view) + camera.center * view.z) / size;
    float* row = matrix.data() + 4 * i;
    row[0] = pixel.x;
    row[1] = pixel.y;
    row[2] = i < 3 ? 0.0f : 1.0f;
    row[3] = view.z;
  }
  return matrix;
}

FrameWriter::FrameWriter(std::filesystem::path directory, std::vector<Layer> layers,
                         std::vector<ExrAttribute> attributes)
    : directory_(std::move(directory)),
      layers_(std::move(layers)),
      attributes_(std::move(attributes)) {
  scratch_.resize(layers_.size());
}

std::filesystem::path FrameWriter::path(int frame) const {
  return directory_ / pattern_.name(frame);
}

void FrameWriter::add_planes(std::string_view layer, std::string_view axes,
                             const Plane<float>* planes, bool wide) {
  const std::size_t count = std::max<std::size_t>(axes.size(), 1);
  for (std::size_t c = 0; c < count && !wide; ++c) wide = exceeds_half(planes[c]);
  for (std::size_t c = 0; c < count; ++c) {
    std::string name(layer);
    if (!name.empty() && !axes.empty()) name += '.';
    if (!axes.empty()) name += axes[c];
    channels_.push_back({std::move(name), wide ? ExrType::kFloat : ExrType::kHalf, planes + c});
  }
}

void FrameWriter::add(Layer layer, const DenoisedFrame& denoised) {
  const Frame& frame = denoised.frame;
  const Planes<3>& albedo = frame.surface.albedo;
  const Planes<3>& direct = denoised.direct ? *denoised.direct : frame.direct;
  Planes<3>& scratch = scratch_[used_scratch_++];
  switch (layer) {
    case Layer::kColor:
      if (denoised.picture) return add_planes("", "RGB", denoised.picture->data(), false);
      compose(frame, denoised.indirect, direct, scratch);
      return add_planes("", "RGB", scratch.data(), false);
    case Layer::kIndirect:
      modulate(albedo, denoised.indirect, scratch);
      return add_planes("indirect", "RGB", scratch.data(), false);
    case Layer::kNoisy:
      modulate(albedo, frame.lights[0].radiance, scratch);
      return add_planes("noisy", "RGB", scratch.data(), false);
    case Layer::kDirect:
    case Layer::kNoisyDirect:
      modulate(albedo, layer == Layer::kDirect ? direct : frame.direct, scratch);
      return add_planes(name_of(layer), "RGB", scratch.data(), false);
    case Layer::kEmission:
      return add_planes("emission", "RGB", frame.emission.data(), false);
    case Layer::kAlbedo:
      return add_planes("albedo", "RGB", albedo.data(), false);
    case Layer::kNormal:
      return add_planes("N", "XYZ", frame.surface.normal.data(), false);
    case Layer::kDepth:
      return add_planes("Z", "", &frame.surface.depth, true);
    case Layer::kPosition:
      return add_planes("P", "XYZ", frame.position.data(), true);
    case Layer::kMotion:
      return add_planes("motion", "XY", frame.motion.data(), true);
    case Layer::kId:
      channels_.push_back({"id", ExrType::kUint, &frame.surface.id});
      return;
    case Layer::kAge:
      return add_planes("age", "", &denoised.age, false);
  }
}

std::vector<ExrAttribute> FrameWriter::attributes_of(const Frame& frame) const {
  std::vector<ExrAttribute> all = attributes_;
  all.push_back({"worldToCamera", world_to_camera(frame.camera)});
  all.push_back({"worldToNDC", world_to_ndc(frame.camera, frame.extent())});
  const float half_height = 0.5f * static_cast<float>(frame.extent().height);
  const float fov = glm::degrees(2.0f * std::atan(half_height / frame.camera.focal));
  all.push_back({"eigenlight.fov_y_degrees", fov});
  all.push_back({"eigenlight.frame", frame.index});
  return all;
}

void FrameWriter::write(const DenoisedFrame& denoised) {
  channels_.clear();
  used_scratch_ = 0;
  for (const Layer layer : layers_) add(layer, denoised);
  write_exr(path(denoised.frame.index), channels_, attributes_of(denoised.frame));
}

}  // namespace eigenlight

#include "sequences/runs/perturb_objects.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "frame/tiles.h"
#include "render/scene/clearance.h"
#include "render/scene/mesh_builder.h"

namespace eigenlight {
namespace {

/// How an object crosses the view. Values by taste; heights and kRadius keep the two cones apart in
/// fields of view up to about 70 degrees.
struct Crossing {
  float frames;    ///< approximate length of one crossing back and forth
  float phase;     ///< [0, 1] of a crossing
  float height;    ///< above the center, in halves of the view's height
  float fraction;  ///< of the free distance
};
constexpr std::array<Crossing, ObjectPerturbation::kCount> kCrossings{
    {{44.0f, 0.0f, 0.32f, 0.45f}, {58.0f, 0.3f, -0.36f, 0.6f}}};
constexpr float kReach = 0.8f;    ///< of half the view's width, to each side
constexpr float kRadius = 0.24f;  ///< of half the view's smaller side
constexpr int kWindow = 12;       ///< frames to each side over which distances are smoothed

/// Free distances are cut off at this share of the scene's diagonal.
constexpr float kFarthest = 0.5f;

/// The minimum over kWindow frames to each side, then the mean of the minima over the same window:
/// smooth, and nowhere above `values`. Frames form a ring.
std::vector<float> lower_envelope(const std::vector<float>& values) {
  const int count = static_cast<int>(values.size());
  const auto at = [count](const std::vector<float>& ring, int i) {
    return ring[static_cast<std::size_t>(((i % count) + count) % count)];
  };
  std::vector<float> low(values.size()), smooth(values.size());
  for (int i = 0; i < count; ++i) {
    float lowest = at(values, i);
    for (int k = -kWindow; k <= kWindow; ++k) lowest = std::min(lowest, at(values, i + k));
    low[static_cast<std::size_t>(i)] = lowest;
  }
  for (int i = 0; i < count; ++i) {
    float sum = 0.0f;
    for (int k = -kWindow; k <= kWindow; ++k) sum += at(low, i + k);
    smooth[static_cast<std::size_t>(i)] = sum / static_cast<float>(2 * kWindow + 1);
  }
  return smooth;
}

void add_object(Scene& scene, Mesh mesh, const glm::vec3& color) {
  Material material;
  material.name = mesh.name;
  material.base_color = color;
  mesh.material = static_cast<int>(scene.materials.size());
  scene.materials.push_back(material);
  scene.instances.push_back({static_cast<int>(scene.meshes.size()), glm::mat4(1.0f)});
  scene.meshes.push_back(std::move(mesh));
}

/// Both objects fit into the unit ball.
void add_objects(Scene& scene) {
  MeshBuilder builder;
  MeshBuilder::Lathe sphere{.profile = {}, .segments = 48, .foot = glm::vec3(0.0f)};
  constexpr int kRings = 24;
  for (int i = 0; i <= kRings; ++i) {
    const float turn = glm::pi<float>() * static_cast<float>(i) / kRings;
    const bool pole = i == 0 || i == kRings;
    sphere.profile.emplace_back(pole ? 0.0f : std::sin(turn), -std::cos(turn));
  }
  builder.lathe(sphere);
  add_object(scene, builder.take("crossing ball", 0), {0.75f, 0.08f, 0.05f});
  const float half = 1.0f / std::sqrt(3.0f);
  builder.box(glm::vec3(-half), glm::vec3(half));
  add_object(scene, builder.take("crossing box", 0), {0.05f, 0.15f, 0.7f});
}

}  // namespace

ObjectPerturbation::ObjectPerturbation(Scene& scene, const CameraPath& path, Extent extent)
    : path_(path), up_(scene.up), fov_y_(scene.fov_y), extent_(extent) {
  const float half_height = std::tan(glm::radians(fov_y_) * 0.5f);
  const float aspect = static_cast<float>(extent.width) / static_cast<float>(extent.height);
  slope_ = kRadius * half_height * std::min(1.0f, aspect);
  const Clearance clearance(scene);
  const float limit = kFarthest * distance(clearance.lower(), clearance.upper());
  for (std::size_t i = 0; i < kCount; ++i) {
    std::vector<float> free(static_cast<std::size_t>(path_.period()));
    parallel_for(path_.period(), [&](int frame) {
      free[static_cast<std::size_t>(frame)] =
          kCrossings[i].fraction *
          clearance.free_travel({path_.at(frame).eye, direction(i, frame), slope_}, limit);
    });
    travel_[i] = lower_envelope(free);
  }
  add_objects(scene);
}

int ObjectPerturbation::wrapped(int frame) const {
  return ((frame % path_.period()) + path_.period()) % path_.period();
}

glm::vec3 ObjectPerturbation::direction(std::size_t i, int frame) const {
  const Crossing& crossing = kCrossings[i];
  const CameraPath::View view = path_.at(frame);
  const Camera camera = look_at(view.eye, view.look_at, up_, fov_y_, extent_);
  // A whole number of crossings per period of the path, so that all repeats with it.
  const float period = static_cast<float>(path_.period());
  const float crossings = std::max(1.0f, std::round(period / crossing.frames));
  const float turn = static_cast<float>(wrapped(frame)) / period * crossings + crossing.phase;
  const glm::vec2 half(static_cast<float>(extent_.width) * 0.5f,
                       static_cast<float>(extent_.height) * 0.5f);
  const glm::vec2 offset(kReach * std::sin(glm::two_pi<float>() * turn), -crossing.height);
  return normalize(transpose(camera.world_to_view) *
                   camera.pixel_to_view(camera.center + offset * half));
}

ObjectPerturbation::Ball ObjectPerturbation::ball(std::size_t i, int frame) const {
  const float travel = travel_[i][static_cast<std::size_t>(wrapped(frame))];
  return {path_.at(frame).eye + direction(i, frame) * travel, slope_ * travel};
}

std::vector<glm::mat4> ObjectPerturbation::at(int frame) const {
  std::vector<glm::mat4> poses;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Ball here = ball(i, frame);
    // Two rotations per period of the path.
    const float spin = 2.0f * glm::two_pi<float>() * static_cast<float>(wrapped(frame)) /
                       static_cast<float>(path_.period());
    glm::mat4 pose = glm::translate(glm::mat4(1.0f), here.center);
    pose = glm::rotate(pose, spin, normalize(glm::vec3(0.3f, 1.0f, 0.2f)));
    poses.push_back(glm::scale(pose, glm::vec3(here.radius)));
  }
  return poses;
}

}  // namespace eigenlight

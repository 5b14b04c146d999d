#include "render/live_source.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "frame/check.h"
#include "frame/random.h"
#include "frame/tiles.h"
#include "render/lights/light_set.h"
#include "render/paths/direct_sampler.h"
#include "render/paths/gbuffer.h"
#include "render/paths/path_tracer.h"
#include "render/paths/sample_mean.h"
#include "render/paths/sample_queue.h"
#include "render/paths/sampler.h"
#include "render/rays/embree_scene.h"
#include "render/rays/surface.h"

namespace eigenlight {
namespace {

// Small tiles balance a small image over many cores; larger tiles let neighboring rays share cache
// lines.
constexpr int kTileSide = 16;

std::size_t index_in(const Tile& tile, glm::ivec2 at) {
  return static_cast<std::size_t>((at.y - tile.y0) * kTileSide + at.x - tile.x0);
}

// Direct and indirect light draw from independent random sequences.
constexpr std::uint32_t kIndirectStream = 0;
constexpr std::uint32_t kDirectStream = 1;

bool same_place(const AreaRect& a, const AreaRect& b) {
  return a.center == b.center && a.half_u == b.half_u && a.half_v == b.half_v;
}
bool same_place(const SphereLight& a, const SphereLight& b) {
  return a.center == b.center && a.radius == b.radius;
}

bool same_places(const Lights& a, const Lights& b) {
  const auto same = [](const auto& p, const auto& q) { return same_place(p, q); };
  return std::equal(a.rects.begin(), a.rects.end(), b.rects.begin(), b.rects.end(), same) &&
         std::equal(a.spheres.begin(), a.spheres.end(), b.spheres.begin(), b.spheres.end(), same);
}

}  // namespace

void RenderOptions::validate() const {
  check_extent(extent);
  EL_CHECK(spp >= 1 && spp <= 65536, "spp {}: expected 1 to 65536", spp);
  EL_CHECK(direct_spp >= 0 && direct_spp <= 65536, "direct_spp {}: expected 0 to 65536",
           direct_spp);
  EL_CHECK(penumbra_spp >= 0 && penumbra_spp <= 65536, "penumbra_spp {}: expected 0 to 65536",
           penumbra_spp);
  EL_CHECK(bounces >= 1 && bounces <= 64, "bounces {}: expected 1 to 64", bounces);
}

struct LiveSource::State {
  State(const Scene& scene, const Animation& anim, const RenderOptions& opts, std::size_t moving)
      : animation(&anim),
        options(opts),
        geometry(scene, moving),
        surfaces(scene, geometry),
        lights(scene, geometry),
        tracer({geometry, surfaces, lights}, opts.bounces),
        direct(tracer, opts.extent, {opts.direct_spp, opts.spp, opts.penumbra_spp}),
        grid(opts.extent, kTileSide, kTileSide),
        hits(opts.extent),
        samples_drawn(opts.extent),
        counters(static_cast<std::size_t>(grid.count())) {}

  void set_scene(Frame& frame);
  void render(const Tile& tile, Frame& frame);
  template <typename Count>
  void sample_indirect(const Tile& tile, int frame, const Count& count, Planes<3>& mean,
                       RayCounters& tally);
  void refine(const Tile& tile, Frame& frame);
  void add_counters(FrameInput& frame) const;
  [[nodiscard]] std::uint32_t key(glm::ivec2 at, std::uint32_t stream, int frame) const {
    return hash_key(options.seed, frame, at.x, at.y, stream);
  }

  const Animation* animation;
  RenderOptions options;
  std::vector<int> frames;
  std::size_t position = 0;  // index in `frames` of the next frame
  EmbreeScene geometry;
  SurfaceTable surfaces;
  LightSet lights;
  PathTracer tracer;
  DirectSampler direct;
  TileGrid grid;
  PreviousView previous;
  std::vector<glm::mat4> previous_poses;  // of all instances
  Plane<GuideHit> hits;                   // of the last delivered frame
  Plane<std::uint32_t> samples_drawn;     // of indirect light, per pixel of that frame
  std::vector<RayCounters> counters;      // per tile
};

// Sets camera, poses and lights of `frame.index`, and remembers those of the previous frame.
void LiveSource::State::set_scene(Frame& frame) {
  const SceneState now = animation->state(frame.index);
  const SceneState then = animation->state(frame.previous_index);
  EL_CHECK(then.poses.size() == now.poses.size(),
           "frame {} has {} poses and frame {} has {}: expected the same number", frame.index,
           now.poses.size(), frame.previous_index, then.poses.size());
  geometry.set_poses(now.poses);
  lights.update(now.lights);
  frame.camera = now.camera;
  frame.is_static =
      now.camera == then.camera && now.poses == then.poses && same_places(now.lights, then.lights);
  const auto current = geometry.transforms();
  previous_poses.assign(current.begin(), current.end());
  std::copy(then.poses.begin(), then.poses.end(),
            previous_poses.end() - static_cast<std::ptrdiff_t>(then.poses.size()));
  previous = {then.camera, then.lights, previous_poses};
}

// Writes to `mean` the mean of `count(x, y)` new samples of indirect light at each surface pixel of
// the tile, and 0 at all other pixels. What their first rays met is direct light.
template <typename Count>
void LiveSource::State::sample_indirect(const Tile& tile, int frame, const Count& count,
                                        Planes<3>& mean, RayCounters& tally) {
  std::array<FiniteMean, kTileSide * kTileSide> means, met;
  SampleQueue queue(tracer, tally);
  auto pixel = means.begin();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x, ++pixel) {
      if (hits(x, y).kind != GuideHit::Kind::kSurface) continue;
      const std::uint32_t k = key({x, y}, kIndirectStream, frame);
      const std::uint32_t end = samples_drawn(x, y) + count(x, y);
      for (std::uint32_t& i = samples_drawn(x, y); i != end; ++i) {
        queue.add(hits(x, y).point, Sampler(k, i), *pixel,
                  options.direct_spp > 0 ? &met[index_in(tile, {x, y})] : nullptr);
      }
    }
  }
  queue.flush();
  pixel = means.begin();
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x, ++pixel) {
      const bool lit = hits(x, y).kind == GuideHit::Kind::kSurface && count(x, y) > 0;
      store_pixel(lit ? pixel->value() : glm::vec3(0.0f), x, y, mean);
      if (!lit) continue;
      const std::uint32_t drawn = count(x, y), before = samples_drawn(x, y) - drawn;
      direct.add_met({x, y}, met[index_in(tile, {x, y})].value(), drawn, before);
    }
  }
}

// Of direct light, once the first samples of all tiles are there.
void LiveSource::State::refine(const Tile& tile, Frame& frame) {
  RayCounters& tally = counters[static_cast<std::size_t>(tile.index)];
  const auto key_of = [&](glm::ivec2 at) { return key(at, kDirectStream, frame.index); };
  direct.refine(tile, hits, key_of, frame.direct, tally);
}

void LiveSource::State::render(const Tile& tile, Frame& frame) {
  RayCounters tally;
  tally.rays = trace_guides({geometry, surfaces, lights}, previous, tile, frame, hits);
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) samples_drawn(x, y) = 0;
  }
  const auto count = [this](int, int) { return static_cast<std::uint32_t>(options.spp); };
  sample_indirect(tile, frame.index, count, frame.lights[0].radiance, tally);
  const auto key_of = [&](glm::ivec2 at) { return key(at, kDirectStream, frame.index); };
  direct.sample(tile, hits, key_of, tally);
  counters[static_cast<std::size_t>(tile.index)] = tally;
}

void LiveSource::State::add_counters(FrameInput& frame) const {
  for (const RayCounters& tally : counters) {
    frame.rays += tally.rays;
    frame.non_finite_samples += tally.non_finite;
  }
}

LiveSource::LiveSource(const Scene& scene, const Animation& animation, const RenderOptions& options,
                       std::vector<int> frames, std::size_t first) {
  options.validate();
  EL_CHECK(first <= frames.size(), "first frame {}: expected at most {}, the number of frames",
           first, frames.size());
  for (const int frame : frames) {
    EL_CHECK(frame > std::numeric_limits<int>::min(),
             "frame {}: expected a larger number, because no integer precedes it", frame);
  }
  const int any = frames.empty() ? 0 : frames.front();
  state_ = std::make_unique<State>(scene, animation, options, animation.state(any).poses.size());
  state_->frames = std::move(frames);
  state_->position = first;
}

LiveSource::~LiveSource() = default;

bool LiveSource::next(Frame& frame) {
  State& s = *state_;
  if (s.position == s.frames.size()) return false;
  frame.resize(s.options.extent);
  frame.index = s.frames[s.position];
  frame.previous_index = s.position > 0 ? s.frames[s.position - 1] : frame.index - 1;
  frame.spp = s.options.spp;
  frame.rays = 0;
  frame.non_finite_samples = 0;
  s.set_scene(frame);
  for_each_tile(s.grid, [&](const Tile& tile) { s.render(tile, frame); });
  for_each_tile(s.grid, [&](const Tile& tile) { s.refine(tile, frame); });
  s.direct.finish();
  s.add_counters(frame);
  ++s.position;
  return true;
}

bool LiveSource::resample(const Plane<std::uint8_t>& extra, FrameInput& frame,
                          std::span<Planes<3>* const> means) {
  State& s = *state_;
  EL_CHECK(s.position > 0 && frame.index == s.frames[s.position - 1],
           "resample: frame {} is not the last frame that next() delivered", frame.index);
  EL_CHECK(extra.extent() == s.options.extent && frame.extent() == s.options.extent,
           "resample: extra samples have size {}x{}, expected {}x{}", extra.width(), extra.height(),
           s.options.extent.width, s.options.extent.height);
  EL_CHECK(means.size() == 1, "resample: {} layers of light, the source has 1", means.size());
  Planes<3>& mean = *means[0];
  ensure_extent(mean, s.options.extent);
  for_each_tile(s.grid, [&](const Tile& tile) {
    RayCounters tally;
    const auto count = [&extra](int x, int y) { return static_cast<std::uint32_t>(extra(x, y)); };
    s.sample_indirect(tile, frame.index, count, mean, tally);
    s.counters[static_cast<std::size_t>(tile.index)] = tally;
  });
  s.add_counters(frame);
  return true;
}

PictureStats LiveSource::picture(const AntialiasOptions& options, const Frame& frame,
                                 const Planes<3>& indirect, Planes<3>& out,
                                 const Planes<3>* direct) {
  const State& s = *state_;
  EL_CHECK(s.position > 0 && frame.index == s.frames[s.position - 1],
           "picture: frame {} is not the last frame that next() delivered", frame.index);
  EL_CHECK(s.options.direct_spp > 0, "picture: direct_spp is 0, expected at least 1");
  const World world{s.geometry, s.surfaces, s.lights};
  const GuideMap guides{frame, s.hits, indirect, direct ? *direct : frame.direct};
  return render_picture(options,
                        {world, s.tracer, guides, s.options.spp, s.options.direct_spp,
                         s.options.seed, direct ? &s.direct.sun() : nullptr},
                        out);
}

const Planes<3>& LiveSource::sun() const { return state_->direct.sun(); }
const Planes<3>& LiveSource::soft() const { return state_->direct.soft(); }

void LiveSource::rewind_resampling() {
  // Pixels without a surface draw no samples, so their value does not matter.
  state_->samples_drawn.fill(static_cast<std::uint32_t>(state_->options.spp));
  state_->direct.rewind();
}

}  // namespace eigenlight

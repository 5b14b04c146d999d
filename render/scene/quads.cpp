#include "render/scene/quads.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace eigenlight {
namespace {

// Two triangles are paired if the surface area of their common box is at most this many times the
// sum of the areas of their own boxes.
constexpr float kMaxGrowth = 2.0f;

struct Box {
  glm::vec3 low, high;
  [[nodiscard]] float surface() const {  // half of the surface area
    const glm::vec3 d = high - low;
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

Box box_of(const Mesh& mesh, std::uint32_t triangle) {
  const glm::uvec3 t = mesh.triangles[triangle];
  const auto& p = mesh.positions;
  return {glm::min(p[t.x], glm::min(p[t.y], p[t.z])), glm::max(p[t.x], glm::max(p[t.y], p[t.z]))};
}

float growth(const Box& a, const Box& b) {
  const Box both{glm::min(a.low, b.low), glm::max(a.high, b.high)};
  return both.surface() / (a.surface() + b.surface());
}

// Side k of a triangle goes from corner k to the next corner.
struct Side {
  std::uint64_t ends = 0;  // vertex indices: start in the high 32 bits, end in the low ones
  std::uint32_t triangle = 0;
  int side = 0;
};

std::uint64_t ends(std::uint32_t from, std::uint32_t to) {
  return static_cast<std::uint64_t>(from) << 32 | to;
}

std::uint32_t corner(const glm::uvec3& t, int k) { return t[k % 3]; }

class Sides {
 public:
  Sides(const Mesh& mesh, std::span<const std::uint32_t> triangles)
      : mesh_(mesh), taken_(mesh.triangles.size(), false) {
    sides_.reserve(3 * triangles.size());
    for (const std::uint32_t i : triangles) {
      const glm::uvec3& t = mesh.triangles[i];
      for (int k = 0; k < 3; ++k) sides_.push_back({ends(t[k], corner(t, k + 1)), i, k});
    }
    std::stable_sort(sides_.begin(), sides_.end(),
                     [](const Side& a, const Side& b) { return a.ends < b.ends; });
  }

  [[nodiscard]] bool is_taken(std::uint32_t triangle) const { return taken_[triangle]; }
  void take(std::uint32_t triangle) { taken_[triangle] = true; }

  struct Match {
    int side = 0;  // of the given triangle
    Side other;
  };
  /// Returns the unpaired neighbor whose common box grows least.
  [[nodiscard]] std::optional<Match> best_match(std::uint32_t triangle) const {
    std::optional<Match> best;
    float least = kMaxGrowth;
    const glm::uvec3& t = mesh_.triangles[triangle];
    const Box box = box_of(mesh_, triangle);
    for (int k = 0; k < 3; ++k) {
      const Side back{ends(corner(t, k + 1), t[k])};
      const auto less = [](const Side& a, const Side& b) { return a.ends < b.ends; };
      const auto [from, to] = std::equal_range(sides_.begin(), sides_.end(), back, less);
      for (auto s = from; s != to; ++s) {
        if (s->triangle == triangle || taken_[s->triangle]) continue;
        const float g = growth(box, box_of(mesh_, s->triangle));
        if (!(g <= least)) continue;
        least = g;
        best = Match{k, *s};
      }
    }
    return best;
  }

 private:
  const Mesh& mesh_;
  std::vector<Side> sides_;  // sorted by ends
  std::vector<bool> taken_;
};

}  // namespace

Quads::Quads(const Mesh& mesh, std::span<const std::uint32_t> triangles) {
  Sides sides(mesh, triangles);
  for (const std::uint32_t i : triangles) {
    if (sides.is_taken(i)) continue;
    const auto match = sides.best_match(i);
    sides.take(i);
    if (match) {
      sides.take(match->other.triangle);
      add(mesh, i, match->side, match->other.triangle, match->other.side);
    } else {
      add(mesh, i);
    }
  }
}

void Quads::add(const Mesh& mesh, std::uint32_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  corners_.emplace_back(t.x, t.y, t.z, t.z);
  halves_.push_back({triangle << 2, triangle << 2});
}

// Both triangles start at the corner that the other one does not have.
void Quads::add(const Mesh& mesh, std::uint32_t triangle, int side, std::uint32_t other,
                int other_side) {
  const glm::uvec3& t = mesh.triangles[triangle];
  const glm::uvec3& o = mesh.triangles[other];
  const int turn = (side + 2) % 3;
  const int other_turn = (other_side + 2) % 3;
  corners_.emplace_back(t[turn], t[side], o[other_turn], corner(t, side + 1));
  halves_.push_back({triangle << 2 | static_cast<std::uint32_t>(turn),
                     other << 2 | static_cast<std::uint32_t>(other_turn)});
}

Quads::Point Quads::point(std::uint32_t quad, float u, float v) const {
  const Halves& halves = halves_[quad];
  const bool beyond = u + v > 1.0f && halves.second != halves.first;
  const std::uint32_t half = beyond ? halves.second : halves.first;
  if (beyond) {
    u = 1.0f - u;
    v = 1.0f - v;
  }
  // u and v weigh the two corners that follow the corner where the quad starts.
  switch (half & 3U) {
    case 0:
      return {half >> 2, u, v};
    case 1:
      return {half >> 2, 1.0f - u - v, u};
    default:
      return {half >> 2, v, 1.0f - u - v};
  }
}

}  // namespace eigenlight

// Twin of temporal/change/edges: one pixel, in double.
#pragma once

#include <algorithm>
#include <cmath>

#include "temporal/change/edges.h"
#include "tests/reference/surface_points.h"

namespace eigenlight::reference {

struct Edge {
  bool found = false;
  double margin = 1.0;  ///< how far the nearest decision was from falling the other way
};

inline Edge edge(const FrameInput& frame, const TapOptions& options, glm::ivec2 p) {
  Edge out;
  const auto& id = frame.surface.id;
  double blend = 0.0;
  for (const auto& plane : frame.motion) {
    const double motion = plane(p.x, p.y);
    blend += std::abs(motion - std::round(motion));
  }
  if (id(p.x, p.y) == 0 || !(blend > 1e-3)) return out;
  const SurfacePoint here = surface_point(frame, p);
  const double bound = options.plane_distance * here.depth;
  const Extent extent = frame.extent();
  for (const glm::ivec2 step : {glm::ivec2(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
    const glm::ivec2 q = p + step;
    if (q.x < 0 || q.y < 0 || q.x >= extent.width || q.y >= extent.height) continue;
    if (id(q.x, q.y) != id(p.x, p.y)) {
      out.found = true;
      continue;
    }
    const SurfacePoint there = surface_point(frame, q);
    const double off = std::abs(glm::dot(here.normal, there.position - here.position));
    const double cosine = glm::dot(here.normal, there.normal);
    out.margin = std::min({out.margin, std::abs(off - bound) / here.depth,
                           std::abs(cosine - static_cast<double>(options.normal_cosine))});
    if (!(off <= bound && cosine >= options.normal_cosine)) out.found = true;
  }
  return out;
}

/// Age of a pixel after shorten_ages(); `longest` is that of its kind.
inline double shortened_age(double age, double samples, double longest) {
  return std::min(age, std::max(longest, samples));
}

}  // namespace eigenlight::reference
